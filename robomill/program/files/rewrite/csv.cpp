#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/io/table.hpp"
#include "robomill/program/files/program_csv.hpp"
#include "robomill/program/files/rewrite/rewriter.hpp"

namespace robomill::program {
namespace {

/// Rewrites programs of columns.
class CsvRewriter final : public Rewriter {
 public:
  explicit CsvRewriter(const RewriteJob& job)
      : Rewriter(job), in_(job.file, job.reading, remarks_), out_(job.file, job.reading, remarks_) {}

 private:
  struct Field {
    std::size_t begin = 0, end = 0;  ///< of the program's text, without blanks and quotes
  };

  ProgramReader& in() override { return in_; }
  ProgramReader& out() override { return out_; }
  void note(Statement& statement) override;
  Composed compose(std::size_t index) override;
  [[nodiscard]] std::string comment(std::string_view text) const override { return fmt::format("# {}", text); }

  void split(const Statement& statement);
  [[nodiscard]] std::string_view text_of(const Field& field) const {
    return job().text.substr(field.begin, field.end - field.begin);
  }
  void set_field(const Field& field, std::string number, Composed& composed) const;
  /// The tip's way then [m].
  double set_ends(const Statement& statement, Composed& composed) const;
  /// By how much it turns then [deg].
  double set_axis(const Statement& statement, Composed& composed);

  ProgramRemarks remarks_{0};
  CsvReader in_, out_;
  std::vector<bool> rows_;                           ///< of each statement, whether it is a row of numbers
  std::vector<Field> fields_;                        ///< of the row split last, by column of the file
  bool decimal_commas_ = false;                      ///< the program writes some
  Eigen::Vector3d axis_ = Eigen::Vector3d::UnitZ();  ///< i, j, k of the row composed last
};

void CsvRewriter::split(const Statement& statement) {
  fields_.clear();
  const std::string_view text = job().text;
  std::size_t end = statement.end;
  while (end > statement.begin && (text[end - 1] == '\n' || text[end - 1] == '\r')) --end;
  for (std::size_t at = statement.begin; at <= end;) {
    std::size_t stop = at;
    for (bool quoted = false; stop < end && (quoted || text[stop] != in_.separator()); ++stop) {
      if (text[stop] == '"') quoted = !quoted;
    }
    Field field = {.begin = at, .end = stop};
    const auto trim = [&](std::string_view letters) {
      while (field.begin < field.end && letters.find(text[field.begin]) != std::string_view::npos) ++field.begin;
      while (field.end > field.begin && letters.find(text[field.end - 1]) != std::string_view::npos) --field.end;
    };
    trim(" \t\r\n\f\v");
    trim("\" \t\r\n\f\v");
    fields_.push_back(field);
    at = stop + 1;
  }
  fields_.resize(std::min(fields_.size(), in_.columns().size()));  // a separator may end the row
}

void CsvRewriter::note(Statement& statement) {
  const std::string_view line = join(statement);
  // The header is known behind itself.
  const bool row = statement.after_start || in_.start().has_value();
  rows_.push_back(row && !io::is_table_comment(line));
  if (!rows_.back()) return;
  split(statement);
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const std::string_view field = text_of(fields_[i]);
    if (field.find(',') != std::string_view::npos) decimal_commas_ = true;
    if (in_.columns()[i] > 2 || field.find_first_of("eEdD") != std::string_view::npos) continue;
    std::string number(field);
    std::ranges::replace(number, ',', '.');
    note_position(number);
  }
  points_.position = false;  // a column of numbers needs none
  const Move move = move_of(statement);
  if (move.count == 0) return;
  statement.moves_at_feed = true;
  const double turned = move.read_way_m > 0.0 ? 0.0 : turn_deg(statements().size() - 1);
  statement.per_minute = (move.read_way_m / units::mm + turned) / (move.read_time_s / units::minute);
}

void CsvRewriter::set_field(const Field& field, std::string number, Composed& composed) const {
  const bool comma = text_of(field).find(',') != std::string_view::npos || (decimal_commas_ && in_.separator() != ',');
  if (comma) std::ranges::replace(number, '.', ',');
  composed.edits.push_back({.begin = field.begin, .end = field.end, .text = std::move(number)});
}

double CsvRewriter::set_ends(const Statement& statement, Composed& composed) const {
  const Move move = move_of(statement);
  const bool stays = !statement.starts && (move.count == 0 || move.still());
  const Eigen::Vector3d from_m = out_.pose().tip_m;
  Eigen::Vector3d end_m = from_m;
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    if (in_.columns()[i] > 2) continue;
    const auto axis = static_cast<Eigen::Index>(in_.columns()[i]);
    const double target_m = stays ? from_m[axis] : statement.starts ? job().wanted.start.tip_m[axis] : move.end_m[axis];
    const Coordinate to = coordinate(io::parse_cell(text_of(fields_[i])), target_m, from_m[axis], false,
                                     position_digits(units::mm), stays);
    if (to.act != Coordinate::Act::keep) set_field(fields_[i], to.text, composed);
    end_m[axis] = to.end;
  }
  return (end_m - from_m).norm();
}

double CsvRewriter::set_axis(const Statement& statement, Composed& composed) {
  constexpr std::size_t first = 3;  // of the known columns
  std::array<const Field*, 3> components = {};
  Eigen::Vector3d numbers;
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const std::size_t component = in_.columns()[i] - first;
    if (component > 2) continue;
    components[component] = &fields_[i];
    numbers[static_cast<Eigen::Index>(component)] = io::parse_cell(text_of(fields_[i])).value();
  }
  const Move move = move_of(statement);
  const Eigen::Vector3d from = out_.pose().axis;
  AxisNumbers to = axis_numbers(numbers, wanted_axis(statement, move));
  // A row that moves nothing says the very axis of the row before it.
  if (!statement.starts && move.count == 0 && to.axis != from) {
    to = {.keep = false, .texts = exact_texts(axis_), .written = axis_, .axis = from};
  }
  axis_ = to.written;
  for (std::size_t i = 0; i < 3 && !to.keep; ++i) set_field(*components[i], to.texts[i], composed);
  return angle_between(from, to.axis) / units::deg;
}

Rewriter::Composed CsvRewriter::compose(std::size_t index) {
  const Statement& statement = statements()[index];
  for (std::size_t i = statement.first_block; i < statement.first_block + statement.blocks; ++i) {
    if (same_rate(job().wanted.blocks[i].spindle_speed_rad_per_s, job().as_read.blocks[i].spindle_speed_rad_per_s)) {
      continue;
    }
    reject(statement.line, "spindle speed", "cannot be said by a program of columns, which has a feed alone",
           "Set the speed on the machine, or write the program as G-code or APT");
  }
  if (!rows_[index]) return {};
  split(statement);
  Composed composed;
  Motions motions = {.way_m = set_ends(statement, composed)};
  motions.turn_deg = set_axis(statement, composed);
  if (!statement.moves_at_feed) return composed;
  const double needed = needed_feed(index, motions).per_minute;
  if (same_rate(needed, statement.per_minute)) return composed;
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    if (in_.columns()[i] == 6) set_field(fields_[i], significant_text(needed, false), composed);
  }
  return composed;
}

}  // namespace

std::unique_ptr<Rewriter> make_csv_rewriter(const RewriteJob& job) {
  return std::make_unique<CsvRewriter>(job);
}

}  // namespace robomill::program
