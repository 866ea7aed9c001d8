#pragma once
#include <filesystem>
#include <vector>

namespace robomill::live {

/// alarm_12.345s.wav, with a number behind it where there is one already.
[[nodiscard]] std::filesystem::path free_alarm_name(const std::filesystem::path& folder, double time_s);

/// @param samples  channels interleaved
/// @param sample_rate_hz  WAV has whole numbers of Hz: rounded
/// @throws InvalidInput if the place cannot be written
void write_alarm(const std::filesystem::path& file, const std::vector<float>& samples, int channels,
                 double sample_rate_hz);

}  // namespace robomill::live
