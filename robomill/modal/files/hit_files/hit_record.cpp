#include "robomill/modal/files/hit_files/hit_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/joined_records.hpp"
#include "robomill/modal/files/hit_guess.hpp"

namespace robomill::modal {
namespace {

bool is_number(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

bool has_name(const io::Record& record, std::string_view name) {
  return !name.empty() && std::ranges::find(record.names, name) != record.names.end();
}

std::string files_of(const std::vector<io::Record>& parts, std::string_view between) {
  std::string out;
  for (const io::Record& part : parts) {
    out += fmt::format("{}{}", out.empty() ? "" : between, part.file.filename().string());
  }
  return out;
}

/// "force.txt has Time, Hammer; accel.txt has 2 columns"
std::string columns_of(const std::vector<io::Record>& parts) {
  std::string out;
  for (const io::Record& part : parts) {
    std::string names;
    for (const std::string& name : part.names) {
      if (!name.empty()) names += (names.empty() ? "" : ", ") + name;
    }
    if (names.empty()) names = fmt::format("{} columns", part.columns.size());
    out += fmt::format("{}{} has {}", out.empty() ? "" : "; ", part.file.filename().string(), names);
  }
  return out;
}

/// The only file in which a column is looked for that several have, or that has no name; none: it is not determined.
const io::Record* own_part(const std::vector<io::Record>& parts, bool is_force) {
  if (is_force) return &parts.front();
  return parts.size() == 2 ? &parts.back() : nullptr;
}

InvalidInput ambiguous(const std::vector<io::Record>& parts, const std::string& text, const std::string& rule) {
  return InvalidInput(parts.front().file.string(), rule,
                      fmt::format("Write the file before it: \"{}:{}\"", parts.back().file.filename().string(), text));
}

/// The column of the time as it is meant for one of several files: "force.txt:1" is of that one alone.
std::string time_of(const std::filesystem::path& file, const std::vector<std::filesystem::path>& files,
                    const std::string& time) {
  for (const std::filesystem::path& one : files) {
    const std::string prefix = one.filename().string() + ":";
    if (files.size() > 1 && time.starts_with(prefix)) return one == file ? time.substr(prefix.size()) : std::string();
  }
  return time;
}

/// A file whose time has too few digits for its steps runs as the line through all of it.
io::Record read_part(const std::filesystem::path& file, const io::RecordOptions& options, bool alone) {
  try {
    return io::read_record(file, options);
  } catch (const InvalidInput&) {
    if (options.time.empty()) throw;
    io::Record record = io::read_record(file, {.time = {}, .scale = options.scale});
    const std::string time = io::time_column_of(record, options.time);
    if (time.empty() && !alone) return record;  // another file has it
    const double rate_hz = time.empty() ? 0.0 : io::rounded_sample_rate_of(record.column(time));
    if (!(rate_hz > 0.0)) throw;
    record.sample_rate_hz = rate_hz;
    record.rate_is_stated = false;
    record.notes.push_back(
        fmt::format("{}: column {} has few digits: the sample rate {:.6g} Hz is that of the line through all of it",
                    file.string(), time, rate_hz));
    return record;
  }
}

/// Times in ms, say, become s.
void take_unit_of_time(io::Record& record, const std::string& given) {
  if (given.empty() || !has_own_units(record)) return;
  const std::string time = io::time_column_of(record, given);
  if (time.empty()) return;
  const std::size_t place = record.place(time);
  const double s = guess_by_name(record, place).si_per_unit;
  record.sample_rate_hz /= s;
  if (s != 1.0) record.columns[place] *= s;
}

}  // namespace

bool has_own_units(const io::Record& record) {
  const io::Format format = io::format_of(record.file);
  return format != io::Format::uff && format != io::Format::wav;
}

HitRecord::Column HitRecord::column(const std::string& text, bool is_force) const {
  if (parts.size() == 1) return {.part = &parts.front(), .place = parts.front().place(text)};
  for (const io::Record& part : parts) {
    const std::string prefix = part.file.filename().string() + ":";
    if (text.starts_with(prefix) && text.size() > prefix.size() && !has_name(part, text)) {
      return {.part = &part, .place = part.place(text.substr(prefix.size()))};
    }
  }
  const io::Record* const own = own_part(parts, is_force);
  const auto having = std::ranges::count_if(parts, [&](const io::Record& part) { return has_name(part, text); });
  if (having == 1) {
    const auto part = std::ranges::find_if(parts, [&](const io::Record& one) { return has_name(one, text); });
    return {.part = &*part, .place = part->place(text)};
  }
  if (having > 1) {
    if (own == nullptr || !has_name(*own, text)) {
      throw ambiguous(parts, text, fmt::format("has a column {}, as another of its files has", text));
    }
    return {.part = own, .place = own->place(text)};
  }
  if (is_number(text)) {
    if (own == nullptr) throw ambiguous(parts, text, fmt::format("column {} may be of any of the files", text));
    return {.part = own, .place = own->place(text)};
  }
  throw InvalidInput(files_of(parts, ", "), "have no column " + text, columns_of(parts));
}

HitRecord read_hit_record(const std::vector<std::filesystem::path>& files, const HitRecordOptions& options) {
  HitRecord out;
  std::vector<io::Record> parts;
  std::vector<std::string> times;
  bool has_time = options.time.empty();
  for (const std::filesystem::path& file : files) {
    times.push_back(time_of(file, files, options.time));
    io::Record part = read_part(file, {.time = times.back(), .scale = options.scale}, files.size() == 1);
    take_unit_of_time(part, times.back());
    times.back() = io::time_column_of(part, times.back());
    has_time = has_time || !times.back().empty();
    std::ranges::copy(part.notes, std::back_inserter(out.notes));
    part.sample_rate_hz = io::rate_of(part, options.given_rate_hz, options.rate_key, out.notes);
    parts.push_back(std::move(part));
  }
  if (!has_time) {
    throw InvalidInput(files_of(parts, ", "), fmt::format("have no column {} of time", options.time),
                       columns_of(parts));
  }
  io::JoinedRecords joined = io::join_records(std::move(parts), std::move(times));
  std::ranges::copy(joined.notes, std::back_inserter(out.notes));
  out.parts = std::move(joined.parts);
  out.sample_rate_hz = joined.sample_rate_hz;
  out.begin_s = joined.begin_s;
  return out;
}

std::string column_name(const std::vector<io::Record>& parts, std::size_t part, std::size_t place, bool is_force) {
  const io::Record& record = parts[part];
  std::string name = place < record.names.size() ? record.names[place] : std::string();
  // Of columns of one name only the number tells which.
  if (name.empty() || std::ranges::count(record.names, name) > 1) name = std::to_string(place + 1);
  if (parts.size() == 1) return name;
  const bool elsewhere = std::ranges::any_of(
      parts, [&](const io::Record& other) { return &other != &record && (is_number(name) || has_name(other, name)); });
  if (!elsewhere || own_part(parts, is_force) == &record) return name;
  return record.file.filename().string() + ":" + name;
}

}  // namespace robomill::modal
