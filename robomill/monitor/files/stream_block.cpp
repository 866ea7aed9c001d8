#include "robomill/monitor/files/stream_block.hpp"

#include <bit>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/text.hpp"

namespace robomill::monitor {
namespace {

constexpr std::string_view magic = "RMSB";
constexpr std::uint16_t version = 1;
constexpr int max_channels = 256;
constexpr double max_sample_rate_hz = 1e7;

template <class Number>
void put(std::string& out, Number number) {
  for (std::size_t i = 0; i < sizeof(Number); ++i) out.push_back(static_cast<char>((number >> (8 * i)) & 0xFF));
}

template <class Number>
Number take(const std::byte* from) {
  Number number = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    number = static_cast<Number>(number | static_cast<Number>(static_cast<Number>(from[i]) << (8 * i)));
  }
  return number;
}

bool is_magic(std::span<const std::byte> message) {
  for (std::size_t i = 0; i < magic.size(); ++i) {
    if (static_cast<char>(message[i]) != magic[i]) return false;
  }
  return true;
}

}  // namespace

std::string encode_stream_block(const StreamBlock& block) {
  if (block.channels < 1 || block.channels > max_channels) {
    throw InvalidInput("channels", block.channels, "", "must lie between 1 and 256");
  }
  if (block.samples.empty() || block.samples.size() % static_cast<std::size_t>(block.channels) != 0) {
    throw InvalidInput("samples", "must hold one frame at least, each of all channels");
  }
  const std::size_t bytes = stream_header_bytes + sizeof(float) * block.samples.size();
  if (bytes > max_stream_block_bytes) {
    throw InvalidInput("samples", static_cast<double>(bytes), "bytes", "must not make a message above 1 MiB");
  }
  std::string out;
  out.reserve(bytes);
  out.append(magic);
  put(out, version);
  put(out, static_cast<std::uint16_t>(block.channels));
  put(out, block.sequence);
  put(out, std::bit_cast<std::uint64_t>(block.sample_rate_hz));
  put(out, std::bit_cast<std::uint64_t>(io::round_15(block.spindle_speed_rad_per_s / units::rpm)));
  put(out, static_cast<std::uint32_t>(block.frames()));
  put(out, std::uint32_t{0});
  for (const float sample : block.samples) put(out, std::bit_cast<std::uint32_t>(sample));
  return out;
}

DecodedBlock decode_stream_block(std::span<const std::byte> message) {
  const auto rejected = [](const char* why) { return DecodedBlock{.block = {}, .rejection = why}; };
  if (message.size() > max_stream_block_bytes) return rejected("is larger than 1 MiB");
  if (message.size() < stream_header_bytes) return rejected("is shorter than its header");
  if (!is_magic(message)) return rejected("does not begin with RMSB");
  const std::byte* const at = message.data();
  if (take<std::uint16_t>(at + 4) != version) return rejected("is of an unknown version");
  const int channels = take<std::uint16_t>(at + 6);
  if (channels < 1 || channels > max_channels) return rejected("has no channel or more than 256");
  const std::size_t frames = take<std::uint32_t>(at + 32);
  // Divided, not multiplied: the count may be anything.
  const std::size_t numbers = (message.size() - stream_header_bytes) / sizeof(float);
  if (frames == 0) return rejected("holds no frame");
  if (numbers / static_cast<std::size_t>(channels) < frames) return rejected("is cut off");
  if (stream_header_bytes + sizeof(float) * frames * static_cast<std::size_t>(channels) != message.size()) {
    return rejected("is longer than its count says");
  }
  StreamBlock block;
  block.channels = channels;
  block.sequence = take<std::uint64_t>(at + 8);
  block.sample_rate_hz = std::bit_cast<double>(take<std::uint64_t>(at + 16));
  if (!(block.sample_rate_hz > 0.0 && block.sample_rate_hz <= max_sample_rate_hz)) {
    return rejected("has no sample rate between 0 and 10 MHz");
  }
  const double rpm = std::bit_cast<double>(take<std::uint64_t>(at + 24));
  // A speed that cannot be is none; the samples are still good.
  if (rpm >= 0.0 && rpm <= 1e6) block.spindle_speed_rad_per_s = rpm * units::rpm;
  block.samples.resize(numbers);
  for (std::size_t i = 0; i < numbers; ++i) {
    block.samples[i] = std::bit_cast<float>(take<std::uint32_t>(at + stream_header_bytes + sizeof(float) * i));
  }
  return {.block = std::move(block), .rejection = ""};
}

}  // namespace robomill::monitor
