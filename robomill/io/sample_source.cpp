#include "robomill/io/sample_source.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/labview/lvm.hpp"
#include "robomill/io/records/record_formats.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/records/samples/sample_alignment.hpp"
#include "robomill/io/records/samples/sample_parts.hpp"
#include "robomill/io/records/text/maker_text.hpp"
#include "robomill/io/system/confinement.hpp"

namespace robomill::io {
namespace {

constexpr std::size_t max_line_bytes = std::size_t{1} << 20;
constexpr std::size_t read_bytes = std::size_t{1} << 16;
constexpr int wait_ms = 50;  ///< between looks at `stop`

std::optional<std::size_t> number_from_1(const std::string& text) {
  std::size_t number = 0;
  const char* const end = text.data() + text.size();
  const std::from_chars_result read = std::from_chars(text.data(), end, number);
  if (read.ec != std::errc() || read.ptr != end || number < 1) return std::nullopt;
  return number;
}

/// float32 or int16, little-endian, columns interleaved.
class RawSource : public SampleSource {
 public:
  RawSource(std::unique_ptr<ByteReader> bytes, const SampleColumns& columns, const std::string& where, bool is_int16)
      : bytes_(std::move(bytes)), is_int16_(is_int16), scale_(columns.scale) {
    columns_ = columns.channels.size();
    for (const std::string& name : columns.channels) columns_ = std::max(columns_, number_from_1(name).value_or(0));
    if (columns.raw_columns > 0) columns_ = static_cast<std::size_t>(columns.raw_columns);
    pick_ = pick_columns(columns, {}, columns_, where);
    alignment_ = SampleAlignment(columns_, is_int16_);
    if (is_int16_) {
      scale_ /= 32768.0;
      full_scale_ = 32767.0 * std::abs(scale_);
    }
  }

  bool next(std::size_t frames, SampleBlock& block) override {
    block.samples.clear();
    const std::size_t width = is_int16_ ? 2 : 4;
    const std::size_t frame_bytes = width * columns_;
    const std::string_view there = bytes_->wait(frame_bytes);
    const std::size_t count = std::min(frames, there.size() / frame_bytes);
    if (count == 0) return false;
    block.samples.reserve(count * pick_.size());
    for (std::size_t frame = 0; frame < count; ++frame) {
      for (const std::size_t column : pick_)
        block.samples.push_back(value(there.data() + frame * frame_bytes + width * column));
    }
    if (alignment_.take(there.substr(0, count * frame_bytes))) {
      // Such numbers mean nothing: they must not be taken for vibration.
      std::fill(block.samples.begin(), block.samples.end(), std::numeric_limits<float>::infinity());
      misaligned_frames_ += count;
    }
    bytes_->consume(count * frame_bytes);
    return true;
  }

 private:
  [[nodiscard]] float value(const char* at) const {
    const auto byte = [at](int i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(at[i])) << (8 * i); };
    if (is_int16_) {
      const auto bits = static_cast<std::uint16_t>(byte(0) | byte(1));
      return static_cast<float>(scale_ * static_cast<double>(std::bit_cast<std::int16_t>(bits)));
    }
    const auto sample = std::bit_cast<float>(byte(0) | byte(1) | byte(2) | byte(3));
    return static_cast<float>(scale_ * static_cast<double>(sample));
  }

  std::unique_ptr<ByteReader> bytes_;
  bool is_int16_ = false;
  double scale_ = 1.0;
  std::size_t columns_ = 0;
  SampleAlignment alignment_{0, false};
  std::vector<std::size_t> pick_;
};

bool is_text(std::string_view bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  return std::all_of(bytes.begin(), bytes.end(), [](char letter) {
    const auto code = static_cast<unsigned char>(letter);
    return code == '\t' || code == '\n' || code == '\r' || (code >= 32 && code != 127);
  });
}

std::unique_ptr<SampleSource> open_bytes(std::unique_ptr<ByteReader> bytes, const std::string& where,
                                         const SampleColumns& columns, RawFormat format, bool is_file) {
  if (format == RawFormat::automatic) {
    // Float32 of any vibration has bytes that no text has.
    format = is_text(bytes->wait(64).substr(0, 4096)) ? RawFormat::csv : RawFormat::float32;
  }
  if (format == RawFormat::csv) return text_source(std::move(bytes), columns, where, is_file);
  return raw_source(std::move(bytes), columns, where, format == RawFormat::int16);
}

}  // namespace

void SampleColumns::validate() const {
  if (channels.empty()) throw InvalidInput("channels", "must name one column at least");
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (channels[i].empty()) throw InvalidInput("channels", "must not hold an empty name");
    if (std::find(channels.begin(), channels.begin() + static_cast<std::ptrdiff_t>(i), channels[i]) !=
        channels.begin() + static_cast<std::ptrdiff_t>(i)) {
      throw InvalidInput("channels", "must not name " + channels[i] + " twice");
    }
  }
  if (raw_columns < 0 || raw_columns > 1024) {
    throw InvalidInput("columns", raw_columns, "", "must lie between 0 and 1024");
  }
  if (!std::isfinite(scale) || scale == 0.0) throw InvalidInput("scale", scale, "", "must be a finite number, not 0");
  require_non_negative("sample_rate_hz", sample_rate_hz, "Hz");
}

ByteReader::~ByteReader() {
  if (owned_) ::close(descriptor_);
}

bool ByteReader::fill() {
  if (ended_) return false;
  if (begin_ > 0) {
    bytes_.erase(0, begin_);
    begin_ = 0;
  }
  while (true) {
    if (stop_ != nullptr && *stop_) break;
    pollfd waiting = {.fd = descriptor_, .events = POLLIN, .revents = 0};
    const int ready = ::poll(&waiting, 1, wait_ms);
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;
    const std::size_t before = bytes_.size();
    bytes_.resize(before + read_bytes);
    const ssize_t count = ::read(descriptor_, bytes_.data() + before, read_bytes);
    bytes_.resize(before + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    if (count > 0) return true;
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count == 0) break;
    ended_ = true;
    throw InvalidInput(where_, "cannot be read to its end", std::strerror(errno));
  }
  ended_ = true;
  return false;
}

std::string_view ByteReader::wait(std::size_t least) {
  while (here().size() < least && fill()) {
  }
  return here();
}

std::optional<std::string_view> ByteReader::line() {
  std::size_t end = std::string_view::npos;
  std::size_t looked = 0;
  while ((end = here().find('\n', looked)) == std::string_view::npos) {
    looked = here().size();
    if (looked > max_line_bytes) {
      consume(looked - max_line_bytes / 2);
      looked = 0;
    }
    if (!fill()) break;
  }
  if (end == std::string_view::npos && here().empty()) return std::nullopt;
  std::string_view text = here().substr(0, end);
  consume(std::min(text.size() + 1, here().size()));
  if (text.ends_with('\r')) text.remove_suffix(1);
  return text;
}

bool ByteReader::line_here() const {
  return here().find('\n') != std::string_view::npos;
}

std::vector<std::size_t> pick_columns(const SampleColumns& wanted, const std::vector<std::string>& names,
                                      std::size_t count, const std::string& where,
                                      const std::vector<std::string>& left_out) {
  const std::vector<std::string>& asked = wanted.channels;
  const bool nameless = std::all_of(names.begin(), names.end(), [](const std::string& name) { return name.empty(); });
  std::vector<std::size_t> pick;
  for (const std::string& name : asked) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) {
      if (std::find(found + 1, names.end(), name) != names.end()) {
        throw InvalidInput(where, "has several columns " + name, "Name them by number, from 1");
      }
      pick.push_back(static_cast<std::size_t>(found - names.begin()));
    } else if (const std::optional<std::size_t> number = number_from_1(name); number && *number <= count) {
      pick.push_back(*number - 1);
    } else if (nameless && !number && count == asked.size()) {
      pick.push_back(pick.size());
    } else {
      std::string known;
      for (const std::string& column : names) {
        if (!column.empty()) known += (known.empty() ? "" : ", ") + column;
      }
      throw InvalidInput(
          where, "has no column " + name,
          fmt::format("It has {} column{}{}{}{}{}. Write signal.channels with their names, or numbers from 1", count,
                      count == 1 ? "" : "s", known.empty() ? " without names" : ": ", known,
                      left_out.empty() ? "" : ". Left out: ", fmt::join(left_out, ", ")));
    }
  }
  for (std::size_t i = 0; i < pick.size(); ++i) {
    if (std::find(pick.begin(), pick.begin() + static_cast<std::ptrdiff_t>(i), pick[i]) !=
        pick.begin() + static_cast<std::ptrdiff_t>(i)) {
      throw InvalidInput(where, fmt::format("column {} would be two channels, {} among them", pick[i] + 1, asked[i]));
    }
  }
  return pick;
}

std::vector<std::size_t> pick_channels(const SampleColumns& columns, std::size_t count, const std::string& where) {
  return pick_columns(columns, {}, count, where);
}

void check_rate(double own_hz, double wanted_hz, double tolerance, const std::string& where) {
  if (own_hz <= 0.0 || wanted_hz <= 0.0 || std::abs(own_hz / wanted_hz - 1.0) <= tolerance) return;
  throw InvalidInput(
      where, fmt::format("was sampled at {:.6g} Hz, not at signal.sample_rate_hz = {:.6g} Hz", own_hz, wanted_hz),
      "Correct the one that is wrong, or leave the key out");
}

std::unique_ptr<SampleSource> raw_source(std::unique_ptr<ByteReader> bytes, const SampleColumns& columns,
                                         const std::string& where, bool is_int16) {
  return std::make_unique<RawSource>(std::move(bytes), columns, where, is_int16);
}

bool is_held_whole(const std::filesystem::path& path) {
  switch (record_format_of(path)) {
    case RecordFormat::none:
    case RecordFormat::wav:
      return false;
    case RecordFormat::text:
    case RecordFormat::lvm:  // without headers it is a table
      return is_lvm(path) || text_maker_of(path) != TextMaker::none;
    default:
      return true;
  }
}

std::unique_ptr<SampleSource> open_samples(const std::filesystem::path& path, const SampleColumns& columns,
                                           RawFormat format, const std::atomic<bool>* stop) {
  columns.validate();
  if (format == RawFormat::automatic) {
    const RecordFormat of_ending = record_format_of(path);
    if (of_ending == RecordFormat::none) {
      (void)open_file(path);
      throw InvalidInput(path.string(), "is no recording by its ending",
                         fmt::format("Recordings are {}; others need --format f32, i16 or csv", record_endings_text()));
    }
    if (of_ending == RecordFormat::wav) return wav_source(path, columns);
    if (is_held_whole(path)) return record_source({path}, columns);
    format = RawFormat::csv;
  }
  std::error_code ignored;
  // Says what is wrong with a missing one. A pipe is opened once: its writer would see the first reader go.
  if (is_confined() || !std::filesystem::is_fifo(path, ignored)) (void)open_file(path);
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);  // NOLINT: open is variadic
  if (descriptor < 0) throw InvalidInput(path.string(), std::string("cannot be read: ") + std::strerror(errno));
  return open_bytes(std::make_unique<ByteReader>(descriptor, true, stop, path.string()), path.string(), columns, format,
                    true);
}

std::unique_ptr<SampleSource> open_samples(const std::vector<std::filesystem::path>& files,
                                           const SampleColumns& columns) {
  if (files.size() == 1) return open_samples(files.front(), columns);
  columns.validate();
  if (files.empty()) throw InvalidInput("files", "must name one at least");
  return record_source(files, columns);
}

std::unique_ptr<SampleSource> open_sample_stream(int descriptor, const std::string& where, const SampleColumns& columns,
                                                 RawFormat format, const std::atomic<bool>* stop) {
  columns.validate();
  return open_bytes(std::make_unique<ByteReader>(descriptor, false, stop, where), where, columns, format, false);
}

}  // namespace robomill::io
