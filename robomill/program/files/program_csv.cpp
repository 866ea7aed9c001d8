#include "robomill/program/files/program_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include "robomill/base/units.hpp"
#include "robomill/io/table.hpp"
#include "robomill/io/text.hpp"

namespace robomill::program {
namespace {

constexpr std::array<const char*, 7> names = {"x_mm", "y_mm", "z_mm", "i", "j", "k", "feed_mm_per_min"};
constexpr std::size_t feed_column = 6;

}  // namespace

void CsvReader::take_header(std::string_view line) {
  separator_ = io::separator_of(line) == ' ' ? ',' : io::separator_of(line);
  std::array<bool, known_columns> found = {};
  for (const std::string& name : io::split_texts(line, separator_)) {
    const auto* const known = std::ranges::find(names, std::string_view(name));
    if (known == names.end()) {
      const std::string near = io::nearest_word(name, names);
      reject_text("header", name, "is no column known here",
                  near.empty() ? "The columns are x_mm, y_mm, z_mm, i, j, k, feed_mm_per_min"
                               : fmt::format("Did you mean {}?", near));
    }
    const auto column = static_cast<std::size_t>(known - names.begin());
    if (found[column]) reject_text("header", name, "names a column twice");
    found[column] = true;
    column_.push_back(column);
  }
  std::string missing;
  for (std::size_t i = 0; i < known_columns; ++i) {
    if (!found[i]) missing += (missing.empty() ? "" : ", ") + std::string(names[i]);
  }
  if (!missing.empty()) reject({}, std::nullopt, "", fmt::format("has no column {}", missing));
}

bool CsvReader::take_plain_numbers(std::string_view line) {
  const char* at = line.data();
  const char* const end = at + line.size();
  for (std::size_t i = 0; i < known_columns; ++i) {
    while (at != end && *at == ' ') ++at;
    const std::from_chars_result read = std::from_chars(at, end, row_[column_[i]]);
    if (read.ec != std::errc() || !std::isfinite(row_[column_[i]])) return false;
    at = read.ptr;
    while (at != end && *at == ' ') ++at;
    if (i + 1 < known_columns && (at == end || *at++ != separator_)) return false;
  }
  return at == end;
}

void CsvReader::take_numbers(std::string_view line) {
  if (take_plain_numbers(line)) return;
  const std::vector<std::string> fields = io::split_texts(line, separator_);
  if (fields.size() > known_columns) {
    reject({}, std::nullopt, "", fmt::format("has {} fields where there are {} columns", fields.size(), known_columns),
           separator_ == ',' ? "Decimal commas need semicolons between the columns" : "");
  }
  for (std::size_t i = 0; i < known_columns; ++i) {
    const std::string field = i < fields.size() ? fields[i] : std::string();
    const std::size_t column = column_[i];
    if (field.empty() && column == feed_column && !start_) {
      row_[column] = 0.0;
      continue;
    }
    const std::optional<double> number = io::parse_cell(field);
    if (field.empty()) reject(names[column], std::nullopt, "", "is empty");
    if (!number || !std::isfinite(*number)) reject_text(names[column], field, "must be a finite number");
    row_[column] = *number;
  }
}

void CsvReader::read(std::string_view statement) {
  if (io::is_table_comment(statement)) return;
  if (separator_ == 0) {
    take_header(statement);
    return;
  }
  take_numbers(statement);
  Pose end;
  for (std::size_t i = 0; i < 3; ++i) {
    end.tip_m[static_cast<Eigen::Index>(i)] = row_[i] * units::mm;
    check_coordinate(names[i], row_[i] * units::mm, row_[i], "mm");
  }
  end.axis = unit_axis("i, j, k", {row_[3], row_[4], row_[5]});
  const double feed = row_[feed_column];
  check_feed(names[feed_column], feed);
  if (!start_) {
    begin_at(end);
    return;
  }
  if (!moves_to(end)) return;
  const double turn_rad = turn_to(end.axis);
  if (!(feed > 0.0)) reject(names[feed_column], feed, "mm/min", "must be > 0");
  const double way = (end.tip_m - pose_.tip_m).norm() / units::mm;
  move(Block::Kind::feed, end, units::minute * (way > 0.0 ? way : turn_rad / units::deg) / feed);
}

}  // namespace robomill::program
