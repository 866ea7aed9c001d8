#include "robomill/coupling/files/tools_csv.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/coupling/files/assembly_schema.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/table.hpp"
#include "robomill/io/text.hpp"

namespace robomill::coupling {
namespace {

constexpr std::array<std::string_view, 4> other_columns = {"tool", "flutes", "beam", "teeth"};

/// One row of the table while it is read.
class TableRow {
 public:
  TableRow(const io::TextTable& table, const io::TextTable::Row& row) : table_(table), row_(row) {}

  [[nodiscard]] std::string_view text(std::string_view key) const { return table_.text(row_, key); }
  bool number(std::string_view key, double factor, double& out) const {
    const std::string_view field = text(key);
    if (field.empty()) return false;
    const std::optional<double> number = io::parse_cell(field);
    if (!number || !std::isfinite(*number)) throw reject(key, "must be a finite number");
    out = *number * factor;
    return true;
  }
  bool integer(std::string_view key, int& out) const {
    double number = 0.0;
    if (!this->number(key, 1.0, number)) return false;
    if (number != std::floor(number) || number < 0.0 || number > 1000.0) {
      throw reject(key, "must be a whole number from 0 to 1000");
    }
    out = static_cast<int>(number);
    return true;
  }
  [[nodiscard]] InvalidInput reject(std::string_view key, std::string rule, std::string hint = {}) const {
    return table_.reject(row_, key, std::move(rule), std::move(hint));
  }
  /// An error about a member of the segment, reported in the column's name and unit.
  [[nodiscard]] InvalidInput located(const InvalidInput& error) const {
    InvalidInput::Parts parts = error.parts();
    parts.where = fmt::format("{}:{}", table_.where, row_.line);
    for (const SegmentNumber& number : segment_numbers()) {
      const io::Row<Segment>& column = number.row;
      if (parts.field != column.member) continue;
      parts.field = column.key.name;
      if (text(column.key.name).empty()) {
        parts.rule = "is missing; " + parts.rule;
        parts.number.reset();
        parts.unit.clear();
      } else if (parts.number) {
        parts.number = io::round_15(*parts.number / column.factor);
        parts.unit = column.key.unit();
      }
    }
    return InvalidInput(std::move(parts));
  }

 private:
  const io::TextTable& table_;
  const io::TextTable::Row& row_;
};

void check_columns(const io::TextTable& table) {
  std::vector<std::string> known(other_columns.begin(), other_columns.end());
  for (const SegmentNumber& column : segment_numbers()) known.push_back(column.row.key.name);
  table.require_known(known);
  for (const char* needed : {"tool", "length_mm", "diameter_mm"}) {
    if (!table.column(needed)) throw InvalidInput(table.where, fmt::format("has no column {}", needed));
  }
}

Segment read_segment(const TableRow& row, const Segment& like) {
  Segment segment = like;
  segment.length_m = segment.diameter_m = segment.inner_diameter_m = segment.mass_kg = 0.0;
  segment.flutes = 0;
  for (const SegmentNumber& column : segment_numbers()) {
    row.number(column.row.key.name, column.row.factor, segment.*column.value);
  }
  row.integer("flutes", segment.flutes);
  if (const std::string_view beam = row.text("beam"); !beam.empty()) {
    const std::optional<Beam> known = value_in(beam_names, beam);
    if (!known) throw row.reject("beam", one_of(beam_names));
    segment.beam = *known;
  }
  try {
    segment.validate();
  } catch (const InvalidInput& error) {
    throw row.located(error);
  }
  return segment;
}

}  // namespace

std::vector<ListedTool> read_tools(const std::filesystem::path& path, const Segment& like,
                                   std::vector<std::string>& notes) {
  const io::TextTable table = io::parse_text_table(io::read_file(path), path.string(), notes);
  check_columns(table);
  std::vector<ListedTool> out;
  std::set<std::string, std::less<>> seen;
  for (const io::TextTable::Row& fields : table.rows) {
    const TableRow row(table, fields);
    const std::string name(row.text("tool"));
    if (name.empty()) throw row.reject("tool", "is empty", "Every row names its tool");
    const bool next = out.empty() || out.back().name != name;
    if (next && !seen.insert(name).second) {
      throw row.reject("tool", "comes a second time",
                       "The rows of one tool follow each other, from the tip to the joint");
    }
    if (next) out.push_back({.name = name, .segments = {}});
    ListedTool& tool = out.back();
    tool.segments.push_back(read_segment(row, like));
    int teeth = 0;
    if (row.integer("teeth", teeth)) {
      if (teeth < 1) throw row.reject("teeth", "must be at least 1");
      if (tool.teeth != 0 && tool.teeth != teeth) throw row.reject("teeth", "differs from the rows of this tool above");
      tool.teeth = teeth;
    }
  }
  for (ListedTool& tool : out) {
    if (tool.teeth == 0) tool.teeth = tool.segments.front().flutes;
  }
  return out;
}

}  // namespace robomill::coupling
