#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/stability/compare.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/surface_error.hpp"
#include "robomill/stability/uncertainty.hpp"

// Method: robomill/jobs/README.md, "Lobes (`lobes.hpp`)"

namespace robomill::jobs {

/// lobes.toml and what else to make of it.
struct LobesJob {
  io::TomlSource lobes;  ///< lobes.toml
  /// Evaluated beside the chart. Where the file sweeps another parameter the second number is its value: in m, or 1e-3
  /// a degree.
  std::vector<stability::OperatingPoint> points = {};
  bool compare = false;    ///< the limits by every method, in place of the chart
  std::uint64_t seed = 1;  ///< of the uncertainty's samples
};

/// The chart with what the file asks for beside it, or the methods compared. What was not asked for is empty.
struct LobesJobResult {
  LobesFile cut;                                ///< with its dynamics and the job's points; its notes are for the user
  stability::LobesResult lobes;                 ///< empty where methods are compared or another parameter is swept
  std::optional<stability::SweepResult> sweep;  ///< where lobes.sweep asks for it
  stability::UncertainLimits uncertain;         ///< samples: 0 unless the file has [uncertainty]
  stability::SurfaceMap surface;                ///< empty unless the file has [surface_error]
  std::optional<stability::MethodComparison> comparison;
};

/// The stability lobes of lobes.toml, with their uncertainty and the surface that stable cuts leave; or the limits by
/// every method, at the grid's speeds or 60 of their range, whichever is less.
/// @throws InvalidInput with file, line, key and value; Interrupted
[[nodiscard]] ROBOMILL_API LobesJobResult run_lobes(const LobesJob& job, Progress& progress = Progress::none());

/// lobes.json: the chart, the sweep or the comparison, and the posture that the modes are of.
[[nodiscard]] ROBOMILL_API std::string lobes_document(const LobesJobResult& result);
/// The same as a table: the sweep, the comparison, the points where the job has some, else the limit.
[[nodiscard]] ROBOMILL_API std::string lobes_table(const LobesJobResult& result);

}  // namespace robomill::jobs
