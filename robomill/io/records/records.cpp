#include "robomill/io/records/records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/labview/lvm.hpp"
#include "robomill/io/records/labview/tdms.hpp"
#include "robomill/io/records/mat.hpp"
#include "robomill/io/records/sound_file.hpp"
#include "robomill/io/records/uff.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/table.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {
namespace {

using Path = std::filesystem::path;

Eigen::VectorXd vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

struct UnreadEnding {
  std::string_view ending, what;
};
constexpr UnreadEnding unread_endings[] = {{".tdm", "a LabVIEW TDM file"},
                                           {".npy", "a NumPy file"},
                                           {".npz", "a NumPy file"},
                                           {".h5", "an HDF5 file"},
                                           {".hdf5", "an HDF5 file"},
                                           {".mf4", "an ASAM MDF file"},
                                           {".mdf", "an ASAM MDF file"},
                                           {".dxd", "a Dewesoft file"},
                                           {".d7d", "a Dewesoft file"},
                                           {".xls", "a spreadsheet"},
                                           {".xlsx", "a spreadsheet"},
                                           {".ods", "a spreadsheet"},
                                           {".flac", "a compressed sound file"},
                                           {".mp3", "a compressed sound file"},
                                           {".m4a", "a compressed sound file"},
                                           {".ogg", "a compressed sound file"}};
constexpr const char* as_csv =
    "Export it as CSV with a column of time in s, or as a universal file (.uff); in N and m/s^2 where it can be chosen";

InvalidInput unread_error(const Path& path, const UnreadRecord& unread) {
  return InvalidInput(path.string(), "is " + unread.what, unread.remedy);
}

/// The number behind a word of a header's line, where the line has that word; in lower case.
std::optional<double> number_behind(std::string_view line, std::string_view word, std::string_view& unit) {
  const std::size_t at = line.find(word);
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; };
  if (at == std::string_view::npos || (at > 0 && is_letter(line[at - 1]))) return std::nullopt;
  std::string_view rest = line.substr(at + word.size());
  if (!rest.empty() && is_letter(rest.front())) return std::nullopt;
  const auto skip_blanks = [&] { rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r:=;,\""), rest.size())); };
  skip_blanks();
  unit = {};
  if (!rest.empty() && (rest.front() == '[' || rest.front() == '(')) {  // "sample rate [kHz]: 25.6"
    const std::size_t close = rest.find_first_of("])");
    if (close == std::string_view::npos) return std::nullopt;
    unit = trimmed(rest.substr(1, close - 1));
    rest.remove_prefix(close + 1);
    skip_blanks();
  }
  const std::size_t end = std::min(rest.find_first_not_of("0123456789.,e+-"), rest.size());
  const std::string_view number = rest.substr(0, end);
  // "51,200" is 51200 to some and 51.2 to others.
  if (number.empty() || (number.find(',') != std::string_view::npos && number.size() - number.find(',') == 4)) {
    return std::nullopt;
  }
  const std::string_view behind = trimmed(rest.substr(end));
  if (unit.empty()) unit = behind.substr(0, std::min(behind.find_first_of(" \t;,)]"), behind.size()));
  return parse_cell(number);
}

/// The rate that the lines above the numbers state; 0: none.
double stated_rate_hz(std::string_view content) {
  constexpr int most_lines = 100;
  constexpr std::string_view rates[] = {
      "sample rate",        "sampling rate",    "sample_rate_hz", "sample_rate",    "samplerate", "sampling frequency",
      "sampling_frequency", "sample frequency", "abtastrate",     "abtastfrequenz", "fs"};
  constexpr std::string_view steps[] = {"delta_x",           "delta x",   "delta_t",       "sample interval",
                                        "sampling interval", "time step", "time interval", "dt"};
  for (int i = 0; i < most_lines && !content.empty(); ++i) {
    const std::string line = lowered(content.substr(0, content.find('\n')));
    content.remove_prefix(std::min(line.size() + 1, content.size()));
    std::string_view unit;
    for (const std::string_view word : rates) {
      const std::optional<double> value = number_behind(line, word, unit);
      if (value && *value > 0.0) return unit == "khz" ? 1e3 * *value : *value;
    }
    for (const std::string_view word : steps) {
      const std::optional<double> value = number_behind(line, word, unit);
      const bool ms = unit == "ms", us = unit == "us";
      if (value && *value > 0.0) return (ms ? 1e3 : us ? 1e6 : 1.0) / *value;
    }
  }
  return 0.0;
}

/// What one of a unit is, whatever it is of; 0: unknown.
double size_of(const std::string& unit) {
  if (const double s = seconds_in(unit); s > 0.0) return s;
  if (const double volts = volts_in(unit); volts > 0.0) return volts;
  const SiFactor si = parse_unit(unit);
  return si.quantity == Quantity::unknown ? 0.0 : si.factor;
}

/// Whether two texts may state one unit.
bool may_be_one(const std::string& a, const std::string& b) {
  const double size_a = size_of(a), size_b = size_of(b);
  if (size_a == 0.0 || size_b == 0.0) return true;
  const bool same = parse_unit(a).quantity == parse_unit(b).quantity &&
                    (seconds_in(a) > 0.0) == (seconds_in(b) > 0.0) && (volts_in(a) > 0.0) == (volts_in(b) > 0.0);
  return same && std::abs(size_a / size_b - 1.0) < 1e-3;
}

/// Times come in s. @throws InvalidInput where name and row of a column state two units
void take_units(Record& record) {
  for (std::size_t i = 0; i < record.units.size(); ++i) {
    std::string& unit = record.units[i];
    if (unit == "-") unit.clear();
    const std::string of_name = unit_of_column(record.names[i]);
    if (!may_be_one(unit, of_name)) {
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

Record read_text_record(const Path& path) {
  const std::string content = read_file(path);
  Record record{.file = path, .names = {}, .columns = {}};
  const Table table = parse_table(content, path.string(), record.notes);
  record.names = table.names;
  record.sample_rate_hz = stated_rate_hz(std::string_view(content).substr(0, table.begin));
  record.rate_is_stated = record.sample_rate_hz > 0.0;
  record.names.resize(table.columns.size());
  record.units = table.units;
  record.units.resize(table.columns.size());
  for (const std::vector<double>& column : table.columns) record.columns.push_back(vector(column));
  return record;
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

Record read_mat_record(const Path& path) {
  Record record{.file = path, .names = {}, .columns = {}};
  for (const MatVariable& variable : read_mat(path)) {
    if (variable.im.size() > 0) {
      record.notes.push_back(fmt::format("{}: variable {} is complex and left out", path.string(), variable.name));
      continue;
    }
    const std::string name = lowered(variable.name);
    if (variable.re.size() == 1) {
      if (name == "sample_rate_hz" || name == "fs") record.sample_rate_hz = variable.re(0, 0);
      continue;
    }
    const bool is_vector = variable.re.rows() == 1 || variable.re.cols() == 1;
    const Eigen::Index columns = is_vector ? 1 : variable.re.cols();
    for (Eigen::Index column = 0; column < columns; ++column) {
      record.names.push_back(is_vector ? variable.name : fmt::format("{}(:,{})", variable.name, column + 1));
      if (is_vector) {
        record.columns.emplace_back(variable.re.reshaped());
      } else {
        record.columns.emplace_back(variable.re.col(column));
      }
    }
  }
  return record;
}

/// The name of a time response: its axis' label where it has one, else its own description.
std::string name_of(const UffFunction& function) {
  const std::string& label = function.numerator.label;
  return label.empty() || label == "NONE" ? function.id[0] : label;
}

Record read_uff_record(const Path& path) {
  const UffFile file = parse_uff(read_file(path), path.string());
  Record record{.file = path, .names = {}, .columns = {}, .notes = file.notes};
  for (const UffFunction& function : file.functions) {
    const std::string where = fmt::format("{}:{}", path.string(), function.line);
    if (function.type != 1 && function.type != 0) {
      record.notes.push_back(
          fmt::format("{}: function type {} is no time response and left out", where, function.type));
      continue;
    }
    if (function.is_complex) throw InvalidInput(where, "the time response has complex values");
    const double rate_hz = sample_rate_of(function.abscissa, where);
    if (record.sample_rate_hz != 0.0 && std::abs(rate_hz - record.sample_rate_hz) > 1e-6 * rate_hz) {
      throw InvalidInput(where, fmt::format("the sample rate {:.6g} Hz differs from {:.6g} Hz before it", rate_hz,
                                            record.sample_rate_hz));
    }
    record.sample_rate_hz = rate_hz;
    const SiFactor si = si_factor(function.numerator, function.length_factor, function.force_factor);
    if (!si.note.empty()) record.notes.push_back(fmt::format("{}: {}", where, si.note));
    record.names.push_back(name_of(function));
    record.columns.emplace_back(function.values.real() * si.factor);
  }
  return record;
}

Record read_wav_record(const Path& path, double scale) {
  const SoundFile file = open_sound(path);
  const auto channels = static_cast<std::size_t>(file.info.channels);
  Record record{.file = path, .sample_rate_hz = static_cast<double>(file.info.samplerate), .names = {}, .columns = {}};
  if (!file.note.empty()) record.notes.push_back(file.note);
  record.names.resize(channels);
  std::vector<std::vector<double>> columns(channels);
  // In blocks: what the header says of the length may be wrong.
  const std::size_t block_frames = std::max<std::size_t>(1, 8192 / channels);
  std::vector<double> block(block_frames * channels);
  sf_count_t frames = 0;
  while ((frames = sf_readf_double(file.sound.get(), block.data(), static_cast<sf_count_t>(block_frames))) > 0) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(frames) * channels; ++i) {
      columns[i % channels].push_back(scale * block[i]);
    }
  }
  require_read(file);
  if (columns.front().empty()) throw InvalidInput(path.string(), "holds no samples");
  for (const std::vector<double>& column : columns) record.columns.push_back(vector(column));
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
      record.notes.push_back(
          fmt::format("{}: column {} is rounded and does not count as the time", record.file.string(), time));
      return;
    }
  }
  record.sample_rate_hz = sample_rate_of(record.column(time), record.file.string());
  record.rate_is_stated = false;
}

}  // namespace

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

bool is_read_as_record(const Path& path) {
  switch (format_of(path)) {
    case Format::csv:
    case Format::text:
    case Format::mat:
    case Format::uff:
    case Format::wav:
    case Format::lvm:
    case Format::tdms:
      return true;
    default:
      return false;
  }
}

UnreadRecord unread_record(const Path& path) {
  const std::string ending = lowered(path.extension().string());
  const auto* const found = std::ranges::find(unread_endings, ending, &UnreadEnding::ending);
  if (found == std::end(unread_endings)) return {};
  return {.what = fmt::format("{}, which is not read yet", found->what), .remedy = as_csv};
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
  switch (format_of(path)) {
    case Format::csv:
    case Format::text:
    case Format::lvm:
      record = read_lvm_or_text(path, options);
      take_units(record);
      break;
    case Format::tdms:
      record = read_tdms(path);
      take_units(record);
      break;
    case Format::mat:
      record = read_mat_record(path);
      break;
    case Format::uff:
      record = read_uff_record(path);
      break;
    case Format::wav:
      record = read_wav_record(path, options.scale);
      break;
    default:
      (void)read_file(path);
      if (const UnreadRecord unread = unread_record(path); !unread.what.empty()) throw unread_error(path, unread);
      throw InvalidInput(path.string(), "is no record by its ending",
                         "Records are .csv, .txt, .mat, .uff, .wav, .lvm and .tdms");
  }
  if (record.columns.empty()) throw InvalidInput(path.string(), "holds no column of samples");
  for (std::size_t i = 0; i < record.columns.size(); ++i) {
    if (!record.columns[i].allFinite()) {
      throw InvalidInput(path.string(), fmt::format("column {} holds a value that is no finite number", i + 1));
    }
  }
  find_sample_rate(record, options);
  return record;
}

}  // namespace robomill::io
