#include "robomill/jobs/files/study_points_json.hpp"

namespace robomill::jobs {
namespace {

using io::key;

const io::Schema<StudyColumn>& study_column_table() {
  static const io::Schema<StudyColumn> table(
      "study_column", "a key or a value at each point that is shown",
      {key("name", &StudyColumn::name, "as study.toml has it"),
       key("unit", &StudyColumn::unit, "of the numbers; empty: none is known"),
       key("numbers", &StudyColumn::numbers, "one a point; none: without a value, or infinite").nullable(),
       key("texts", &StudyColumn::texts, "in place of numbers, where one is none"),
       key("infinite", &StudyColumn::infinite, "of the numbers that are none, those that are infinite")},
      io::Use::written);
  return table;
}

}  // namespace

const io::Schema<ShownPoints>& study_points_table() {
  static const io::Schema<ShownPoints> table(
      "study_points", "points of a study for its page: all of them, or at most 5000, evenly chosen",
      {key("points", &ShownPoints::points, "of the study"),
       key("rejected", &ShownPoints::rejected, "of these, those whose document is not valid"),
       key("keys", &ShownPoints::keys, study_column_table(), "that vary"),
       key("values", &ShownPoints::values, study_column_table(), "that are collected"),
       key("boundary_points", &ShownPoints::boundary_points, "of [boundary]"),
       key("boundary_keys", &ShownPoints::boundary_keys, study_column_table(),
           "of points of the boundary: all of them, or at most 5000, evenly chosen")},
      io::Use::written, 1);
  return table;
}

}  // namespace robomill::jobs
