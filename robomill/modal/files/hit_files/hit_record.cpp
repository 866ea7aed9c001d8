#include "robomill/modal/files/hit_files/hit_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/joined_records.hpp"
#include "robomill/modal/files/hit_guess.hpp"

namespace robomill::modal {
namespace {

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

std::optional<std::size_t> own_part(const std::vector<io::Record>& parts, bool is_force) {
  if (is_force) return 0;
  return parts.size() == 2 ? std::optional<std::size_t>(1) : std::nullopt;
}

RecordOfHits::Column RecordOfHits::column(const std::string& text, bool is_force) const {
  const io::PartColumn found = io::find_column(parts, text, own_part(parts, is_force));
  return {.part = &parts[found.part], .place = found.place};
}

RecordOfHits read_hit_record(const std::vector<std::filesystem::path>& files, const HitRecordOptions& options) {
  RecordOfHits out;
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
  if (!has_time) throw io::no_column(parts, options.time + " of time");
  io::JoinedRecords joined = io::join_records(std::move(parts), std::move(times));
  std::ranges::copy(joined.notes, std::back_inserter(out.notes));
  out.parts = std::move(joined.parts);
  out.sample_rate_hz = joined.sample_rate_hz;
  out.begin_s = joined.begin_s;
  return out;
}

}  // namespace robomill::modal
