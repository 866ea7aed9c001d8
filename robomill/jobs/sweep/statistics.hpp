#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/jobs/sweep/boundary.hpp"
#include "robomill/jobs/sweep/probability.hpp"
#include "robomill/jobs/sweep/sensitivity.hpp"
#include "robomill/jobs/sweep/study.hpp"

// Method: robomill/jobs/README.md, "Studies (`sweep.hpp`)"

namespace robomill::jobs {

/// Keys and what they are set to, as TOML writes it.
using Settled = std::vector<std::pair<std::string, std::string>>;

/// A boundary that was traced; its points are in tables of their own.
struct BoundaryStatistics {
  BoundaryTask task = {};
  std::vector<std::pair<std::string, double>> steps = {};          ///< of each key, in its unit: how fine it is
  std::uint64_t points = 0;                                        ///< of the boundary
  std::uint64_t evaluations = 0;                                   ///< points of the study
  std::uint64_t interpolated = 0, compared = 0, beyond_error = 0;  ///< as Boundary
  double grid_points = 0.0;                                        ///< that a grid of these steps has
  std::uint64_t unknown = 0, lost_cubes = 0, middle_points = 0;    ///< as Boundary
  bool complete = true;                                            ///< as Boundary
};

/// Indices of one value, at one combination of the keys that are not sampled.
struct SensitivityRow {
  Settled at = {};
  std::string value = {};
  std::vector<std::string> keys = {};  ///< the inputs
  SobolIndices indices = {};
};

/// How often a value keeps the condition, at one combination of the keys that are not sampled.
struct ProbabilityRow {
  Settled at = {};
  std::string value = {};
  ConditionShare share = {};
};

struct ProbabilityStatistics {
  ProbabilityTask task = {};
  std::vector<ProbabilityRow> rows = {};
  /// The row whose `worst` is best; of equal ones that with the greatest share, then the first. None where no point has
  /// a value.
  std::optional<ProbabilityRow> optimum = {};
  std::size_t equal = 0;  ///< other rows with the same `worst`
};

/// What the points of a study say together.
struct Statistics {
  std::optional<BoundaryStatistics> boundary = {};
  std::vector<SensitivityRow> sensitivity = {};
  std::optional<ProbabilityStatistics> probability = {};
};

/// The grid of a study with [boundary].
[[nodiscard]] BoundaryOptions boundary_options(const Study& study);

[[nodiscard]] BoundaryStatistics summary_of_boundary(const Study& study, const Boundary& boundary);

/// Indices and probabilities.
/// @param columns  of each value that is collected one number a point; NaN where the point has none
[[nodiscard]] Statistics statistics_of(const Study& study, const StudyPoints& points,
                                       const std::vector<std::vector<double>>& columns);

/// For a summary: a line a finding, with what it was found from.
[[nodiscard]] std::vector<std::string> lines_of(const Statistics& statistics);

}  // namespace robomill::jobs
