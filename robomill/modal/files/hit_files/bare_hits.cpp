#include "robomill/modal/files/hit_files/bare_hits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <set>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/modal/files/found_hits.hpp"
#include "robomill/modal/files/hit_files/hit_settings.hpp"

namespace robomill::modal {
namespace {

namespace fs = std::filesystem;
using Role = ColumnGuess::Role;

constexpr const char* document_name = "hits.toml";
/// A sensor's voltage stays below it, and few hits do.
constexpr double least_force_n = 10.0;

/// The records as hits.toml has them.
std::string toml_of(const FoundHits& found) {
  std::string text = "[acquisition]\n";
  const auto line = [](const HitSetting& setting) {
    const std::string remark =
        setting.missing.empty() ? std::string() : fmt::format("  # to be given: {}", setting.missing);
    return fmt::format("{} = {}{}\n", setting.key, setting.value, remark);
  };
  for (const HitSetting& setting : acquisition_settings(found.hits.front())) text += line(setting);
  for (const FoundHit& hit : found.hits) {
    text += "[[hits]]\n";
    for (const HitSetting& setting : row_settings(hit)) text += line(setting);
  }
  return text;
}

/// Lines to be filled in, of a record that shows no hit.
std::string blank_toml(const fs::path& record) {
  return fmt::format(
      "[acquisition]\nsample_rate_hz = …  # without a column of time\n[[hits]]\nfile = {}\nforce = …  # column: its "
      "name, "
      "or its number from 1\nforce_direction = \"x\"\nresponses = {{ x = … }}\n",
      io::toml_quoted(record.filename().string()));
}

InvalidInput says_too_little(const std::string& file, const std::string& what, const std::string& lines) {
  std::string indented;
  std::size_t at = 0;
  while (at < lines.size()) {
    const std::size_t end = lines.find('\n', at);
    indented += "\n  " + lines.substr(at, end - at);
    at = end + 1;
  }
  return InvalidInput(
      file, what,
      fmt::format("Write {} with these lines, and run robomill frf {}:{}", document_name, document_name, indented));
}

/// A unit that is stated and not known, which is not to be read as SI.
std::string unknown_unit(const ColumnGuess& column) {
  if (!states_unit(column) || column.volts > 0.0) return {};
  const io::SiFactor si = io::parse_unit(column.unit);
  const bool known = !si.is_ratio && si.quantity != io::Quantity::unknown;
  return known ? std::string() : fmt::format("what \"{}\" of column {} is", column.unit, column.name);
}

/// Directions of the sensors that nothing says, of several.
std::string unknown_directions(const FoundHit& hit) {
  const std::vector<std::size_t> responses = hit.guess.with(Role::response);
  if (responses.size() < 2) return {};
  std::string columns;
  for (const std::size_t i : responses) {
    const ColumnGuess& column = hit.guess.columns[i];
    if (!column.axis_said) columns += (columns.empty() ? "" : ", ") + column.name;
  }
  if (!columns.empty()) return "the direction of " + columns;
  return hit.guess.direction_from.empty() ? "the direction of the hit" : std::string();
}

/// What the records leave open, each once.
std::vector<std::string> open_questions(const FoundHits& found) {
  std::vector<std::string> out;
  const auto ask = [&out](const std::string& text) {
    if (!text.empty() && std::ranges::find(out, text) == out.end()) out.push_back(text);
  };
  for (const HitSetting& setting : acquisition_settings(found.hits.front())) ask(setting.missing);
  for (const FoundHit& hit : found.hits) {
    for (const ColumnGuess& column : hit.guess.columns) {
      if (column.role == Role::force || column.role == Role::response) ask(unknown_unit(column));
    }
    ask(unknown_directions(hit));
  }
  return out;
}

/// What is taken that the records do not say.
void list_assumed(const FoundHits& found, HitsFile& out) {
  std::vector<Assumption> taken;
  const auto add = [&](const std::string& what, const std::string& value, const char* key) {
    taken.push_back({.what = what, .taken = value, .key = key, .file = document_name});
  };
  for (const FoundHit& hit : found.hits) {
    const std::vector<std::size_t> responses = hit.guess.with(Role::response);
    const ColumnGuess &force = *hit.first(Role::force), &first = *hit.first(Role::response);
    if (force.from == "its sharp peak") {
      add("Column of the force in " + hit.name(), fmt::format("{}, by {}", force.name, force.from), "hits.force");
    }
    if (first.from == "what is left") {
      add("Column of the response in " + hit.name(), fmt::format("{}, by {}", first.name, first.from),
          "hits.responses");
    }
    if (hit.guess.direction_from.empty()) {
      add("Direction of the hit in " + hit.name(), hit.guess.force_direction + ", and of the response alike",
          "hits.force_direction");
    } else if (responses.size() == 1 && !first.axis_said) {
      add("Direction of the response in " + hit.name(), std::string(1, first.axis), "hits.responses");
    }
  }
  add_assumed(taken, out.assumed);
  out.assumed = std::move(taken);
}

/// Numbers without a unit that may as well be volts.
void require_newtons(const FoundHits& found, const HitsFile& read, const std::string& lines) {
  if (std::ranges::all_of(found.hits, [](const FoundHit& hit) { return states_unit(*hit.first(Role::force)); })) return;
  double highest_n = 0.0;
  for (const Hit& hit : read.hits) highest_n = std::max(highest_n, hit.force_n.cwiseAbs().maxCoeff());
  if (highest_n >= least_force_n) return;
  throw says_too_little(
      found.hits.front().name(),
      fmt::format("names no unit of its force, whose highest number is {:.3g}: N, or volts of the hammer", highest_n),
      lines);
}

/// Errors about lines that nobody wrote are about the record.
HitsFile read_lines(const fs::path& folder, const FoundHits& found, const std::string& lines) {
  const fs::path document = folder / document_name;
  try {
    return read_hits(io::TomlSource(document, lines));
  } catch (const InvalidInput& error) {
    const InvalidInput::Parts& parts = error.parts();
    if (!parts.where.starts_with(document.string() + ":")) throw;
    throw says_too_little(found.hits.front().name(), parts.rule + (parts.hint.empty() ? "" : ". " + parts.hint), lines);
  }
}

}  // namespace

HitsFile read_bare_hits(const std::vector<fs::path>& records) {
  if (records.empty()) throw InvalidInput("records", "none is given");
  const fs::path parent = records.front().parent_path();
  const fs::path folder = parent.empty() ? fs::path(".") : parent;
  for (const fs::path& record : records) {
    if (std::ranges::count(records, record) > 1) throw InvalidInput(record.string(), "is given twice");
    // No lines of a hits.toml help a file that is not read.
    if (!io::unread_record(record).what.empty()) static_cast<void>(io::read_record(record));
  }
  const FoundHits found = find_hits(records, folder);
  if (!found.left_out.empty()) {
    const std::string& left_out = found.left_out.front();
    const std::size_t at = left_out.find(": ");
    throw says_too_little(left_out.substr(0, at), left_out.substr(at + 2),
                          found.hits.empty() ? blank_toml(records.front()) : toml_of(found));
  }
  const std::string lines = toml_of(found);
  const std::vector<std::string> open = open_questions(found);
  if (!open.empty()) {
    throw says_too_little(found.hits.front().name(), fmt::format("does not say {}", fmt::join(open, "; nor ")), lines);
  }
  HitsFile out = read_lines(folder, found, lines);
  require_newtons(found, out, lines);
  list_assumed(found, out);
  return out;
}

}  // namespace robomill::modal
