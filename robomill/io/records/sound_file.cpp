#include "robomill/io/records/sound_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>

#include "robomill/base/error.hpp"
#include "robomill/io/byte_order.hpp"
#include "robomill/io/file.hpp"

namespace robomill::io {
namespace {

/// How long the samples are by the header, and how long they are.
struct WavLength {
  std::uint64_t stated_bytes = 0, bytes = 0, bytes_per_s = 0;
};

/// Some bytes of a file; fewer at its end.
std::string_view read_at(int file, std::uint64_t offset, std::span<char> to) {
  std::size_t count = 0;
  if (read_all_at(file, to, offset, count) != 0) return {};
  return {to.data(), count};
}

/// None where the file is no WAV or has as many samples as follow.
std::optional<WavLength> wav_length(int file, std::uint64_t file_bytes) {
  constexpr std::uint64_t unknown = 0xFFFFFFFF;
  constexpr int most_chunks = 1000;
  std::array<char, 24> buffer{};
  const std::string_view head = read_at(file, 0, std::span(buffer).first(12));
  if (head.size() < 12 || head.substr(8, 4) != "WAVE") return std::nullopt;
  const std::string form(head.substr(0, 4));
  if (form != "RIFF" && form != "RIFX" && form != "RF64") return std::nullopt;
  const bool big_endian = form == "RIFX";  // RIFF is little-endian
  WavLength out;
  std::uint64_t long_size = 0;  // of the samples of an RF64 file
  std::uint64_t offset = 12;
  for (int i = 0; i < most_chunks; ++i) {
    const std::string_view chunk = read_at(file, offset, buffer);
    if (chunk.size() < 8) return std::nullopt;
    const std::string_view name = chunk.substr(0, 4);
    const std::uint64_t size = number_at(chunk, 4, 4, big_endian);
    if (name == "data") {
      out.stated_bytes = size == unknown ? long_size : size;  // unknown: as a stream's recorder leaves it
      out.bytes = file_bytes - std::min(file_bytes, offset + 8);
      return size == unknown && long_size == 0 ? std::nullopt : std::optional(out);
    }
    if (name == "ds64" && chunk.size() == 24) long_size = number_at(chunk, 16, 8, big_endian);
    if (name == "fmt " && chunk.size() >= 20) out.bytes_per_s = number_at(chunk, 16, 4, big_endian);
    offset += 8 + size + size % 2;
  }
  return std::nullopt;
}

/// @throws InvalidInput if no samples are stated and there are some: the library would find none
std::string note_of(const std::filesystem::path& path, const WavLength& length) {
  if (length.stated_bytes == 0 && length.bytes > 0) {
    throw InvalidInput(path.string(), fmt::format("states no samples, and {} bytes of them follow", length.bytes),
                       "Its recorder was not stopped: the lengths in its header must be set");
  }
  if (length.bytes >= length.stated_bytes) return {};
  const double rate = static_cast<double>(length.bytes_per_s);
  const auto text = [rate](std::uint64_t bytes) {
    const auto count = static_cast<double>(bytes);
    return rate > 0.0 ? fmt::format("{:.4g} s", count / rate) : fmt::format("{:.0f} bytes", count);
  };
  return fmt::format("Warning: {} holds {} of the {} that its header states: it was cut off", path.string(),
                     text(length.bytes), text(length.stated_bytes));
}

}  // namespace

SoundFile open_sound(const std::filesystem::path& path) {
  const std::uint64_t file_bytes = [&] {
    (void)open_file(path);  // says what is wrong with a missing one
    std::error_code ignored;
    return std::filesystem::file_size(path, ignored);
  }();
  SoundFile out;
  out.path = path;
  int error = 0;
  out.file = open_descriptor(path.c_str(), O_RDONLY, error);
  if (error != 0) throw InvalidInput(path.string(), "cannot be read", error_text(error));
  if (const auto length = wav_length(out.file.get(), file_bytes)) out.note = note_of(path, *length);
  out.sound.reset(sf_open_fd(out.file.get(), SFM_READ, &out.info, SF_FALSE));
  if (!out.sound) throw InvalidInput(path.string(), std::string("is no sound file: ") + sf_strerror(nullptr));
  require_read(out);
  if (out.info.channels < 1 || out.info.samplerate < 1) {
    throw InvalidInput(path.string(), "has no channel or no sample rate");
  }
  return out;
}

void require_read(const SoundFile& file) {
  if (sf_error(file.sound.get()) == SF_ERR_NO_ERROR) return;
  throw InvalidInput(file.path.string(), "cannot be read to its end", sf_strerror(file.sound.get()));
}

}  // namespace robomill::io
