#include "robomill/live/files/alarm_wav.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "robomill/io/sample_source.hpp"

namespace robomill::live {

std::filesystem::path free_alarm_name(const std::filesystem::path& folder, double time_s) {
  const std::string stem = fmt::format("alarm_{:.3f}s", time_s);
  std::filesystem::path file = folder / (stem + ".wav");
  std::error_code ignored;
  for (int i = 2; std::filesystem::exists(file, ignored) && i < 10'000; ++i) {
    file = folder / fmt::format("{}_{}.wav", stem, i);
  }
  return file;
}

void write_alarm(const std::filesystem::path& file, const std::vector<float>& samples, int channels,
                 double sample_rate_hz) {
  io::write_wav(file, samples, channels, std::max(1.0, std::round(sample_rate_hz)));
}

}  // namespace robomill::live
