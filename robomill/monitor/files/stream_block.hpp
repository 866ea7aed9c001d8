#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace robomill::monitor {

/// Samples as a sensor's gateway publishes them: one MQTT message.
struct StreamBlock {
  std::uint64_t sequence = 0;   ///< one more in each block
  double sample_rate_hz = 0.0;  ///< [Hz], > 0
  /// [rad/s]; NaN or negative: not known; 0: the spindle stands still
  double spindle_speed_rad_per_s = std::numeric_limits<double>::quiet_NaN();
  int channels = 0;            ///< 1 to 256
  std::vector<float> samples;  ///< channels interleaved; NaN and ±inf may stand in them

  [[nodiscard]] std::size_t frames() const {
    return channels > 0 ? samples.size() / static_cast<std::size_t>(channels) : 0;
  }
};

/// The header, all of it little-endian: "RMSB", version (u16, 1), channels (u16), sequence (u64), sample rate in Hz
/// (f64), spindle speed in rpm (f64, NaN: not known), frames (u32), zero (u32).
inline constexpr std::size_t stream_header_bytes = 40;
/// Larger messages are rejected unread.
inline constexpr std::size_t max_stream_block_bytes = std::size_t{1} << 20;

/// The message of a block. @throws InvalidInput if it holds no whole number of frames, none or too many
[[nodiscard]] std::string encode_stream_block(const StreamBlock& block);

/// A message read; what is wrong with it where it is none. Any bytes may come.
struct DecodedBlock {
  std::optional<StreamBlock> block;
  const char* rejection = "";  ///< "is cut off", …
};
[[nodiscard]] DecodedBlock decode_stream_block(std::span<const std::byte> message);

}  // namespace robomill::monitor
