#include "robomill/io/joined_records.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::io {
namespace {

using Eigen::Index;

/// Where a record lies in time, and how well it says so.
struct Extent {
  double rate_hz = 0.0;                ///< 0: not said
  double rate_error = 0.0;             ///< relative
  std::optional<double> begin_s = {};  ///< of a column of time
  double begin_error_s = 0.0;
  Index samples = 0;
};

std::string file_name(const Record& record) {
  return record.file.filename().string();
}

bool is_number(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

bool has_name(const Record& record, std::string_view name) {
  return !name.empty() && std::ranges::find(record.names, name) != record.names.end();
}

std::string file_names(const std::vector<Record>& parts) {
  std::string out;
  for (const Record& part : parts) out += (out.empty() ? "" : ", ") + file_name(part);
  return out;
}

/// "force.txt has Time, Hammer; accel.txt has 2 columns"
std::string columns_of(const std::vector<Record>& parts) {
  std::string out;
  for (const Record& part : parts) {
    std::string names;
    for (const std::string& name : part.names) {
      if (!name.empty()) names += (names.empty() ? "" : ", ") + name;
    }
    if (names.empty()) names = fmt::format("{} columns", part.columns.size());
    out += fmt::format("{}{} has {}", out.empty() ? "" : "; ", file_name(part), names);
  }
  return out;
}

InvalidInput ambiguous(const std::vector<Record>& parts, const std::string& text, const std::string& rule) {
  return InvalidInput(parts.front().file.string(), rule,
                      fmt::format("Write the file before it: \"{}:{}\"", file_name(parts.back()), text));
}

Extent extent_of(const Record& record, const std::string& given_time) {
  constexpr double smallest_error = 1e-5;  // as of hits that are averaged
  Extent out{.rate_hz = record.sample_rate_hz,
             .rate_error = std::max(record.rate_error, smallest_error),
             .samples = record.columns.front().size()};
  const std::string name = time_column_of(record, given_time);
  if (name.empty() || out.samples < 3) return out;
  const Eigen::VectorXd& time_s = record.column(name);
  if (time_s.size() != out.samples) return out;
  const double span_s = time_s(out.samples - 1) - time_s(0);
  if (!(span_s > 0.0)) return out;
  // Of times with few digits those at the begin are the best, and the line through all gives the rate.
  const Eigen::VectorXd line = Eigen::VectorXd::LinSpaced(out.samples, time_s(0), time_s(out.samples - 1));
  const double off_s = (time_s - line).cwiseAbs().maxCoeff();
  out.rate_error = std::max(out.rate_error, 2.0 * off_s / span_s);
  out.begin_s = time_s(0);
  out.begin_error_s = off_s;
  return out;
}

void require_one_rate(const std::vector<Record>& parts, const std::vector<Extent>& extents) {
  for (std::size_t i = 1; i < parts.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Extent &a = extents[j], &b = extents[i];
      if (!(a.rate_hz > 0.0 && b.rate_hz > 0.0)) continue;
      if (std::abs(b.rate_hz / a.rate_hz - 1.0) <= a.rate_error + b.rate_error) continue;
      throw InvalidInput(
          parts[i].file.string(),
          fmt::format("was sampled at {:.6g} Hz, and {} at {:.6g} Hz", b.rate_hz, file_name(parts[j]), a.rate_hz),
          "Columns of one measurement are recorded together, at one rate; do the files belong together?");
    }
  }
}

/// The rate that is known best; its place.
std::optional<std::size_t> best_rate(const std::vector<Extent>& extents) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < extents.size(); ++i) {
    if (extents[i].rate_hz > 0.0 && (!best || extents[i].rate_error < extents[*best].rate_error)) best = i;
  }
  return best;
}

/// One that says no rate goes with another by its length alone.
void take_rate(const std::vector<Record>& parts, const std::vector<Extent>& extents, std::size_t best,
               JoinedRecords& out) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (extents[i].rate_hz > 0.0) continue;
    if (extents[i].samples != extents[best].samples) {
      throw InvalidInput(parts[i].file.string(),
                         fmt::format("states no sample rate and has {} samples, where {} has {}", extents[i].samples,
                                     file_name(parts[best]), extents[best].samples),
                         "Nothing says that they belong together: give the rate, or write a column of time");
    }
    out.notes.push_back(fmt::format("{} states no sample rate: it has that of {}, which is as long",
                                    file_name(parts[i]), file_name(parts[best])));
  }
}

/// How many samples each begins before the last one to begin.
std::vector<Index> lags_of(const std::vector<Record>& parts, const std::vector<Extent>& extents, JoinedRecords& out) {
  constexpr double most_beside = 0.05;  // samples
  std::vector<Index> lags(parts.size(), 0);
  if (!std::ranges::all_of(extents, [](const Extent& extent) { return extent.begin_s.has_value(); })) {
    out.notes.push_back(file_names(parts) +
                        " are taken to begin at the same time: not all of them have a column of time");
    return lags;
  }
  const auto later = [](const Extent& a, const Extent& b) { return *a.begin_s < *b.begin_s; };
  const auto last = static_cast<std::size_t>(std::ranges::max_element(extents, later) - extents.begin());
  out.begin_s = *extents[last].begin_s;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double lag = (out.begin_s - *extents[i].begin_s) * out.sample_rate_hz;
    const double whole = std::min(std::round(lag), static_cast<double>(extents[i].samples));
    lags[i] = static_cast<Index>(whole);
    const double error = (extents[i].begin_error_s + extents[last].begin_error_s) * out.sample_rate_hz;
    if (lags[i] > 0) {
      out.notes.push_back(fmt::format("{} begins {:.6g} s before {}: that part is left out", file_name(parts[i]),
                                      lag / out.sample_rate_hz, file_name(parts[last])));
    }
    if (std::abs(lag - whole) > most_beside + error) {
      out.notes.push_back(fmt::format("{}{} was sampled {:.2f} of a sample beside {}: phases are off by {:.2g}° a kHz",
                                      warning_label, file_name(parts[i]), std::abs(lag - whole), file_name(parts[last]),
                                      360e3 * std::abs(lag - whole) / out.sample_rate_hz));
    }
  }
  return lags;
}

void cut(std::vector<Record>& parts, const std::vector<Index>& lags, JoinedRecords& out) {
  Index length = parts.front().columns.front().size() - lags.front(), longest = length;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const Index left = parts[i].columns.front().size() - lags[i];
    length = std::min(length, left);
    longest = std::max(longest, left);
  }
  if (length < 1) {
    throw InvalidInput(parts.front().file.string(),
                       fmt::format("has no time in common with {}", file_name(parts.back())),
                       "Do the files belong together, and are their times of one clock?");
  }
  if (length < longest) {
    std::string lengths;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      lengths +=
          fmt::format("{}{} in {}", i == 0 ? "" : ", ", parts[i].columns.front().size() - lags[i], file_name(parts[i]));
    }
    out.notes.push_back(fmt::format("of the samples ({}) those count that all files have, {}", lengths, length));
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (Eigen::VectorXd& column : parts[i].columns) {
      if (lags[i] == 0 && column.size() == length) continue;
      column = Eigen::VectorXd(column.segment(lags[i], length));
    }
  }
}

}  // namespace

void read_record_files(TomlFile& file, const std::string& key, std::vector<std::filesystem::path>& out) {
  if (!file.paths(key, out)) return;
  if (out.empty()) throw file.reject(key, "must name a file");
  for (auto path = out.begin(); path != out.end(); ++path) {
    if (!path->has_filename()) throw file.reject(key, "must name a file");
    if (std::find(out.begin(), path, *path) == path) continue;
    throw file.reject(key, "names a file twice", "Several columns of one file need it once");
  }
}

InvalidInput no_column(const std::vector<Record>& parts, std::string_view what) {
  return InvalidInput(file_names(parts), fmt::format("have no column {}", what), columns_of(parts));
}

PartColumn find_column(const std::vector<Record>& parts, const std::string& text, std::optional<std::size_t> own) {
  if (parts.size() == 1) return {.part = 0, .place = parts.front().place(text)};
  std::vector<std::size_t> having;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string prefix = file_name(parts[i]) + ":";
    if (text.starts_with(prefix) && text.size() > prefix.size() && !has_name(parts[i], text)) {
      return {.part = i, .place = parts[i].place(text.substr(prefix.size()))};
    }
    if (has_name(parts[i], text)) having.push_back(i);
  }
  if (having.size() == 1) return {.part = having.front(), .place = parts[having.front()].place(text)};
  if (having.size() > 1) {
    if (!own || !has_name(parts[*own], text)) {
      throw ambiguous(parts, text, fmt::format("has a column {}, as another of its files has", text));
    }
    return {.part = *own, .place = parts[*own].place(text)};
  }
  if (is_number(text)) {
    if (!own) throw ambiguous(parts, text, fmt::format("column {} may be of any of the files", text));
    return {.part = *own, .place = parts[*own].place(text)};
  }
  throw no_column(parts, text);
}

std::string column_name(const std::vector<Record>& parts, const PartColumn& column, std::optional<std::size_t> own) {
  const Record& record = parts[column.part];
  std::string name = column.place < record.names.size() ? record.names[column.place] : std::string();
  // Of columns of one name only the number tells which.
  if (name.empty() || std::ranges::count(record.names, name) > 1) name = std::to_string(column.place + 1);
  if (parts.size() == 1) return name;
  const bool elsewhere = std::ranges::any_of(
      parts, [&](const Record& other) { return &other != &record && (is_number(name) || has_name(other, name)); });
  if (!elsewhere || own == column.part) return name;
  return file_name(record) + ":" + name;
}

std::string time_column_of(const Record& record, const std::string& given) {
  if (given.empty()) {
    // "data.time" and "hit 1/time" of files that have groups, too.
    const auto is_time = [](std::string_view name) {
      const std::size_t end = name.find_last_of("./");
      return is_time_column(name) || (end != std::string_view::npos && is_time_column(name.substr(end + 1)));
    };
    const auto known = std::ranges::find_if(record.names, is_time);
    return known == record.names.end() ? std::string() : *known;
  }
  try {
    static_cast<void>(record.place(given));
    return given;
  } catch (const InvalidInput&) {
    return {};  // another file has it
  }
}

JoinedRecords join_records(std::vector<Record> parts, std::vector<std::string> times) {
  times.resize(parts.size());
  JoinedRecords out;
  for (const Record& part : parts) {
    for (const Eigen::VectorXd& column : part.columns) {
      if (column.size() == part.columns.front().size() || parts.size() == 1) continue;
      throw InvalidInput(part.file.string(), "has columns of several lengths", "It does not go with another file then");
    }
  }
  std::vector<Extent> extents;
  extents.reserve(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) extents.push_back(extent_of(parts[i], times[i]));
  require_one_rate(parts, extents);
  const std::optional<std::size_t> best = best_rate(extents);
  if (best) out.sample_rate_hz = extents[*best].rate_hz;
  if (parts.size() == 1) {
    out.begin_s = extents.front().begin_s.value_or(0.0);
  } else {
    if (best) take_rate(parts, extents, *best, out);
    cut(parts, lags_of(parts, extents, out), out);
  }
  out.parts = std::move(parts);
  return out;
}

}  // namespace robomill::io
