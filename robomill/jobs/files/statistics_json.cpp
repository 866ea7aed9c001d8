#include "robomill/jobs/files/statistics_json.hpp"

#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"

namespace robomill::jobs {
namespace {

using io::key;
using io::Use;

constexpr const char* at_meaning = "the keys that are not sampled and what they are set to, as TOML writes it";

const io::Schema<BoundaryStatistics>& boundary_table() {
  static const io::Schema<BoundaryStatistics> table(
      "boundary_result", "where a value crosses a level; its points stand in boundary.csv and boundary.h5",
      {io::of(&BoundaryStatistics::task, key("value", &BoundaryTask::value, "of the study")),
       io::of(&BoundaryStatistics::task, key("level", &BoundaryTask::level, "that it crosses")),
       key(
           "steps", [](const BoundaryStatistics& one) { return one.steps; },
           "of each key between neighbours of the finest grid reached"),
       key("points", &BoundaryStatistics::points, "of the boundary"),
       key("evaluations", &BoundaryStatistics::evaluations, "points of the study"),
       key("interpolated", &BoundaryStatistics::interpolated, "further points, whose side the values around them tell"),
       key("compared", &BoundaryStatistics::compared, "evaluations at points that could be interpolated, too"),
       key("beyond_error", &BoundaryStatistics::beyond_error, "of them, further from it than its estimated error"),
       key("grid_points", &BoundaryStatistics::grid_points, "that a grid of these steps has"),
       key("unknown", &BoundaryStatistics::unknown, "points of the study without a value: the boundary ends there"),
       key("lost_cubes", &BoundaryStatistics::lost_cubes,
           "cubes of the grid that it crossed before a halving and, since values are missing, in no part after it"),
       key("middle_points", &BoundaryStatistics::middle_points,
           "points in the middle of a step, since one of its ends is infinite"),
       key("complete", &BoundaryStatistics::complete, "all halvings are done; false: most_points was reached")},
      Use::written);
  return table;
}

const io::Schema<Estimate>& estimate_table() {
  static const io::Schema<Estimate> table("estimate", "an estimate with its 95 % interval",
                                          {key("value", &Estimate::value, "the estimate").nullable(),
                                           key("low", &Estimate::low, "end of the interval").nullable(),
                                           key("high", &Estimate::high, "end of the interval").nullable()},
                                          Use::written);
  return table;
}

const io::Schema<SobolIndex>& index_table() {
  static const io::Schema<SobolIndex> table(
      "sobol_index", "what one key does to a value",
      {key("first", &SobolIndex::first, estimate_table(), "share of the variance that goes if this key is known"),
       key("total", &SobolIndex::total, estimate_table(),
           "share that remains if all others are known: with its interactions")},
      Use::written);
  return table;
}

const io::Schema<SensitivityRow>& sensitivity_row_table() {
  static const io::Schema<SensitivityRow> table(
      "sensitivity_row", "Sobol' indices of a value",
      {key(
           "at", [](const SensitivityRow& row) { return row.at; }, at_meaning),
       key("value", &SensitivityRow::value, "that is collected"),
       io::of(&SensitivityRow::indices, key("status", &SobolIndices::status, sobol_status_names,
                                            "constant: it does not vary; too_few: fewer than 8 samples have a value")),
       io::of(&SensitivityRow::indices, key("samples", &SobolIndices::samples, "that count")),
       io::of(&SensitivityRow::indices, key("left_out", &SobolIndices::left_out,
                                            "samples with a point whose value is missing or infinite, as a whole")),
       io::of(&SensitivityRow::indices, key("mean", &SobolIndices::mean, "of the value")).nullable(),
       io::of(&SensitivityRow::indices, key("variance", &SobolIndices::variance, "of the value")).nullable(),
       key("keys", &SensitivityRow::keys, "the inputs"),
       io::of(&SensitivityRow::indices, key("indices", &SobolIndices::inputs, index_table(), "one a key"))},
      Use::written);
  return table;
}

const io::Schema<ProbabilityRow>& probability_row_table() {
  static const io::Schema<ProbabilityRow> table(
      "probability_row", "how often a value keeps the condition",
      {key(
           "at", [](const ProbabilityRow& row) { return row.at; }, at_meaning),
       key("value", &ProbabilityRow::value, "that is collected"),
       io::of(&ProbabilityRow::share, key("probability", &ConditionShare::share, estimate_table(),
                                          "share of the points that keep it, with Wilson's interval")),
       io::of(&ProbabilityRow::share, key("points", &ConditionShare::points, "samples with a value")),
       io::of(&ProbabilityRow::share, key("holding", &ConditionShare::holding, "of these, those that keep it")),
       io::of(&ProbabilityRow::share,
              key("infinite", &ConditionShare::infinite,
                  "of these, those whose value is infinite: a limit beyond the depths searched")),
       io::of(&ProbabilityRow::share, key("left_out", &ConditionShare::left_out, "samples without a value")),
       io::of(&ProbabilityRow::share,
              key("worst", &ConditionShare::worst,
                  "at most the share worst_share of the points is worse; null: infinite, or no point has a value"))
           .nullable()},
      Use::written);
  return table;
}

const io::Schema<ProbabilityStatistics>& probability_table() {
  static const io::Schema<ProbabilityStatistics> table(
      "probability_result", "how often values keep a condition, and where their worst case is best",
      {io::of(&ProbabilityStatistics::task, key("at_least", &ProbabilityTask::at_least, "the condition")).nullable(),
       io::of(&ProbabilityStatistics::task, key("at_most", &ProbabilityTask::at_most, "or this")).nullable(),
       io::of(&ProbabilityStatistics::task, key("worst_share", &ProbabilityTask::worst_share, "of `worst`")),
       key("rows", &ProbabilityStatistics::rows, probability_row_table(), "one a combination and a value"),
       key("optimum", &ProbabilityStatistics::optimum, probability_row_table(),
           "the robust optimum: the row with the best `worst`; null: no point has a value")
           .nullable(),
       key("equal", &ProbabilityStatistics::equal, "other rows with the same `worst`")},
      Use::written);
  return table;
}

}  // namespace

const io::Schema<Statistics>& statistics_table() {
  static const io::Schema<Statistics> table(
      "statistics", "what the points of a study say together",
      {key("boundary", &Statistics::boundary, boundary_table(), "of [boundary]").optional(),
       key("sensitivity", &Statistics::sensitivity, sensitivity_row_table(), "of [sensitivity]").optional(),
       key("probability", &Statistics::probability, probability_table(), "of [probability]").optional()},
      Use::written, 1);
  return table;
}

void write_statistics(const std::filesystem::path& path, const Statistics& statistics) {
  io::write_file(path, io::dump(statistics_table().write(statistics)));
}

}  // namespace robomill::jobs
