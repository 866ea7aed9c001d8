#include "robomill/io/records/records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/labview/lvm.hpp"
#include "robomill/io/records/labview/tdms.hpp"
#include "robomill/io/records/numpy/numpy_record.hpp"
#include "robomill/io/records/record_formats.hpp"
#include "robomill/io/records/sound_file.hpp"
#include "robomill/io/records/text/text_record.hpp"
#include "robomill/io/records/tree/tree_record.hpp"
#include "robomill/io/records/uff_record.hpp"
#include "robomill/io/records/units_agree.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {
namespace {

using Path = std::filesystem::path;

/// What one of a unit is, whatever it is of; 0: unknown.
double size_of(const std::string& unit) {
  if (const double s = seconds_in(unit); s > 0.0) return s;
  if (const double volts = volts_in(unit); volts > 0.0) return volts;
  const SiFactor si = parse_unit(unit);
  return si.quantity == Quantity::unknown ? 0.0 : si.factor;
}

/// Times come in s. @throws InvalidInput where name and row of a column state two units
void take_units(Record& record) {
  for (std::size_t i = 0; i < record.units.size(); ++i) {
    std::string& unit = record.units[i];
    if (unit == "-") unit.clear();
    const std::string of_name = unit_of_column(record.names[i]);
    if (!units_agree(unit, of_name)) {
      throw InvalidInput(record.file.string(), fmt::format("column {} is in {} by its name and in {} by {}",
                                                           record.names[i], of_name, unit, record.units_by));
    }
    const double s = seconds_in(unit);
    if (s == 0.0 || s == 1.0) continue;
    record.notes.push_back(fmt::format("{}: column {} is in {} by {}: converted to s", record.file.string(),
                                       record.names[i], unit, record.units_by));
    record.columns[i] *= s;
    record.units[i] = "s";
  }
}

/// Without headers it is a table.
Record read_lvm_or_text(const Path& path, const RecordOptions& options) {
  if (!is_lvm(path)) return read_text_record(path);
  if (options.time == lvm_time) {
    throw InvalidInput(path.string(), fmt::format("{} is no column: it is counted as the time already", lvm_time),
                       "Leave time out");
  }
  return read_lvm(path);
}

/// As many as the header states, where the file may hold them.
Eigen::Index likely_frames(const SoundFile& file) {
  constexpr std::uintmax_t most_samples_a_byte = 8;
  std::error_code ignored;
  const std::uintmax_t bytes = std::filesystem::file_size(file.path, ignored);
  const std::uintmax_t most = most_samples_a_byte * (ignored ? 0 : bytes) / static_cast<unsigned>(file.info.channels);
  const auto stated = static_cast<std::uintmax_t>(std::max<sf_count_t>(file.info.frames, 0));
  return static_cast<Eigen::Index>(std::min(most, stated));
}

Record read_wav_record(const Path& path, double scale) {
  const SoundFile file = open_sound(path);
  const auto channels = static_cast<std::size_t>(file.info.channels);
  Record record{.file = path, .sample_rate_hz = static_cast<double>(file.info.samplerate), .names = {}, .columns = {}};
  if (!file.note.empty()) record.notes.push_back(file.note);
  record.names.resize(channels);
  // In blocks, and columns that grow: what the header says of the length may be wrong.
  const auto block_frames = std::max<Eigen::Index>(1, 8192 / static_cast<Eigen::Index>(channels));
  std::vector<double> block(static_cast<std::size_t>(block_frames) * channels);
  record.columns.reserve(channels);
  while (record.columns.size() < channels) record.columns.emplace_back(likely_frames(file));
  Eigen::Index length = 0;
  sf_count_t frames = 0;
  while ((frames = sf_readf_double(file.sound.get(), block.data(), block_frames)) > 0) {
    const Eigen::Index needed = length + frames;
    for (std::size_t i = 0; i < channels; ++i) {
      Eigen::VectorXd& column = record.columns[i];
      if (needed > column.size()) column.conservativeResize(std::max(needed, 2 * column.size()));
      for (Eigen::Index k = 0; k < frames; ++k) {
        column[length + k] = scale * block[static_cast<std::size_t>(k) * channels + i];
      }
    }
    length = needed;
  }
  require_read(file);
  if (length == 0) throw InvalidInput(path.string(), "holds no samples");
  for (Eigen::VectorXd& column : record.columns) column.conservativeResize(length);
  return record;
}

void find_sample_rate(Record& record, const RecordOptions& options) {
  std::string time = options.time;
  if (time.empty()) {
    const auto known = std::find_if(record.names.begin(), record.names.end(), is_time_column);
    if (known == record.names.end()) return;
    time = *known;
    // What it is too coarse for is left to who knows the rate.
    if (rounded_sample_rate_of(record.column(time)) > 0.0) {
      std::string note =
          fmt::format("{}: column {} is rounded and does not count as the time", record.file.string(), time);
      if (std::ranges::find(record.notes, note) == record.notes.end()) record.notes.push_back(std::move(note));
      return;
    }
  }
  const double stated_hz = record.rate_is_stated ? record.sample_rate_hz : 0.0;
  record.sample_rate_hz = sample_rate_of(record.column(time), record.file.string());
  record.rate_is_stated = false;
  if (stated_hz > 0.0 && std::abs(stated_hz / record.sample_rate_hz - 1.0) > 0.01) {
    record.notes.push_back(
        fmt::format("{}{}: its header states {:.6g} Hz, and column {} runs at {:.6g} Hz, which counts", warning_label,
                    record.file.string(), stated_hz, time, record.sample_rate_hz));
  }
}

/// Whether its reader looked for the rate in times too.
bool has_found_rate(const Record& record, const RecordOptions& options) {
  const RecordFormat format = record_format_of(record.file);
  const bool of_named_values =
      format == RecordFormat::numpy || format == RecordFormat::hdf5 || format == RecordFormat::mat;
  return of_named_values && options.time.empty() && record.sample_rate_hz > 0.0;
}

/// Of a file that is none by its ending.
InvalidInput no_record(const Path& path) {
  (void)read_file(path);  // says what is wrong with a missing one
  const UnreadRecord unread = unread_record(path);
  if (!unread.what.empty()) return InvalidInput(path.string(), "is " + unread.what, unread.remedy);
  return InvalidInput(path.string(), "is no record by its ending", "Records are " + record_endings_text());
}

}  // namespace

bool units_agree(const std::string& a, const std::string& b) {
  const double size_a = size_of(a), size_b = size_of(b);
  if (size_a == 0.0 || size_b == 0.0) return true;
  const bool same = parse_unit(a).quantity == parse_unit(b).quantity &&
                    (seconds_in(a) > 0.0) == (seconds_in(b) > 0.0) && (volts_in(a) > 0.0) == (volts_in(b) > 0.0);
  return same && std::abs(size_a / size_b - 1.0) < 1e-3;
}

void RecordOptions::validate() const {
  if (!std::isfinite(scale) || scale == 0.0) throw InvalidInput("scale", scale, "", "must be a finite number, not 0");
}

const Eigen::VectorXd& Record::column(const std::string& name_or_number) const {
  return columns[place(name_or_number)];
}

std::string Record::unit(std::size_t place) const {
  if (place < units.size() && !units[place].empty()) return units[place];
  return place < names.size() ? unit_of_column(names[place]) : std::string();
}

std::size_t Record::place(const std::string& name_or_number) const {
  const auto found = std::find(names.begin(), names.end(), name_or_number);
  if (found != names.end()) {
    if (std::find(found + 1, names.end(), name_or_number) != names.end()) {
      throw InvalidInput(file.string(), "has several columns " + name_or_number, "Name them by number, from 1");
    }
    return static_cast<std::size_t>(found - names.begin());
  }
  std::size_t number = 0;
  const char* const end = name_or_number.data() + name_or_number.size();
  const std::from_chars_result read = std::from_chars(name_or_number.data(), end, number);
  if (read.ec == std::errc() && read.ptr == end && number >= 1 && number <= columns.size()) return number - 1;
  std::string known;
  for (const std::string& name : names) {
    if (!name.empty()) known += (known.empty() ? "" : ", ") + name;
  }
  throw InvalidInput(
      file.string(), "has no column " + name_or_number,
      fmt::format("It has {} column{}{}{}{}{}", columns.size(), columns.size() == 1 ? "" : "s",
                  known.empty() ? "" : ": ", known, left_out.empty() ? "" : ". Left out: ", fmt::join(left_out, ", ")));
}

double rate_of(const Record& record, double given_hz, std::string_view key, std::vector<std::string>& notes) {
  constexpr double tolerance = 1e-3;
  const double own_hz = record.sample_rate_hz;
  const bool is_coarse = record.rate_error > tolerance;
  if (is_coarse && given_hz <= 0.0) {
    notes.push_back(fmt::format("{}{}: its digits give the sample rate as {:.6g} Hz to {:.2g} %: give {}",
                                warning_label, record.file.string(), own_hz, 100.0 * record.rate_error, key));
  }
  if (own_hz <= 0.0 || given_hz <= 0.0) return std::max(own_hz, given_hz);
  if (std::abs(own_hz / given_hz - 1.0) <= std::max(tolerance, record.rate_error)) {
    return record.rate_is_stated || is_coarse ? given_hz : own_hz;
  }
  if (!record.rate_is_stated) {
    throw InvalidInput(record.file.string(),
                       fmt::format("was sampled at {:.6g} Hz, not at {} = {:.6g} Hz", own_hz, key, given_hz));
  }
  notes.push_back(fmt::format("{}{}: its header states {:.6g} Hz, and {} = {:.6g} Hz is taken. One of them is wrong.",
                              warning_label, record.file.string(), own_hz, key, given_hz));
  return given_hz;
}

double rounded_sample_rate_of(const Eigen::VectorXd& time_s) {
  constexpr double least_share = 0.01;  // of steps that are 0
  constexpr double straight = 0.01;     // of the span
  const Eigen::Index n = time_s.size();
  if (n < 3) return 0.0;
  const Eigen::ArrayXd steps = time_s.tail(n - 1) - time_s.head(n - 1);
  const double span = time_s(n - 1) - time_s(0);
  if (!(span > 0.0) || !(steps.minCoeff() >= 0.0)) return 0.0;
  if (static_cast<double>((steps == 0.0).count()) < least_share * static_cast<double>(n)) return 0.0;
  const Eigen::ArrayXd index =
      Eigen::ArrayXd::LinSpaced(n, -0.5 * static_cast<double>(n - 1), 0.5 * static_cast<double>(n - 1));
  const Eigen::ArrayXd about_mean = time_s.array() - time_s.mean();
  const double step_s = (index * about_mean).sum() / index.square().sum();
  return (about_mean - step_s * index).abs().maxCoeff() <= straight * span ? 1.0 / step_s : 0.0;
}

double sample_rate_of(const Eigen::VectorXd& time_s, const std::string& where) {
  const Eigen::Index n = time_s.size();
  if (n < 2) throw InvalidInput(where, "has fewer than two samples");
  const double step_s = (time_s(n - 1) - time_s(0)) / static_cast<double>(n - 1);
  if (!std::isfinite(step_s) || step_s <= 0.0) {
    throw InvalidInput(where, "the time does not rise", "Is the column of the time the right one?");
  }
  for (Eigen::Index i = 1; i < n; ++i) {
    const double off = time_s(i) - time_s(i - 1) - step_s;
    if (!(std::abs(off) <= 0.5 * step_s)) {
      throw InvalidInput(
          where,
          fmt::format("the time does not run evenly: from {:.9g} s to {:.9g} s where {:.6g} s are a step (sample {})",
                      time_s(i - 1), time_s(i), step_s, i + 1),
          "Are samples missing, or has the time too few digits? Then give sample_rate_hz instead of the column");
    }
  }
  return 1.0 / step_s;
}

Record read_record(const Path& path, const RecordOptions& options) {
  options.validate();
  Record record;
  switch (record_format_of(path)) {
    case RecordFormat::text:
    case RecordFormat::lvm:
      record = read_lvm_or_text(path, options);
      take_units(record);
      break;
    case RecordFormat::tdms:
      record = read_tdms(path);
      take_units(record);
      break;
    case RecordFormat::mat:
      record = read_mat_record(path, options.time);
      break;
    case RecordFormat::hdf5:
      record = read_hdf5_record(path, options.time);
      break;
    case RecordFormat::uff:
      record = read_uff_record(path);
      break;
    case RecordFormat::wav:
      record = read_wav_record(path, options.scale);
      break;
    case RecordFormat::numpy:
      record = read_numpy(path, options.time);
      break;
    case RecordFormat::none:
      throw no_record(path);
  }
  if (record.columns.empty()) throw InvalidInput(path.string(), "holds no column of samples");
  for (std::size_t i = 0; i < record.columns.size(); ++i) {
    if (!record.columns[i].allFinite()) {
      throw InvalidInput(path.string(), fmt::format("column {} holds a value that is no finite number", i + 1));
    }
  }
  if (!has_found_rate(record, options)) find_sample_rate(record, options);
  return record;
}

}  // namespace robomill::io
