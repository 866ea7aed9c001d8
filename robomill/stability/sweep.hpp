#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "robomill/stability/lobes.hpp"

// Method: robomill/stability/README.md, "Three directions (`spatial.hpp`, `collocation/spatial_model.hpp`)"

namespace robomill::stability {

/// A chart over the spindle speed and one parameter of a cut in three directions.
struct ROBOMILL_API SweepOptions {
  SweptParameter parameter = SweptParameter::lead;
  std::array<double, 2> range = {0.0, 0.0};                    ///< of the parameter [m] or [rad], increasing; required
  std::array<double, 2> spindle_speed_rad_per_s = {0.0, 0.0};  ///< lowest and highest [rad/s], > 0; required
  std::array<int, 2> grid = {60, 40};                          ///< speeds and values, each at least 2
  double tolerance = 1e-6;                                     ///< as of LobesOptions
  /// Evaluated beside the grid; what stands for the axial depth is the parameter's value.
  std::vector<OperatingPoint> points = {};
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Where a cut is stable at one speed: from one value of the parameter to another.
struct StableInterval {
  double from = 0.0, to = 0.0;
};

struct SweepResult {
  SweptParameter parameter = SweptParameter::lead;
  Eigen::VectorXd spindle_speed_rad_per_s;          ///< length grid[0]
  Eigen::VectorXd value;                            ///< length grid[1] [m] or [rad]
  Eigen::MatrixXd spectral_radius;                  ///< grid[1] x grid[0]: a row a value
  std::vector<BoundaryPoint> boundary;              ///< curve by curve; axial_depth_m is the parameter's value
  std::vector<std::vector<StableInterval>> stable;  ///< of each grid speed, increasing; none where nothing is stable
  std::vector<PointResult> points;                  ///< axial_depth_m is the parameter's value
  Period period = Period::tooth;
  long long evaluations = 0, unsettled = 0, uncertain = 0;  ///< as of LobesResult
  double seconds = 0.0;
};

/// The spectral radius over speed and parameter, where it is 1, and where each grid speed is stable. An interval
/// narrower than two neighbouring values is not seen.
/// @throws InvalidInput if the problem is not one of SpatialMilling, a value of the range cannot be cut, or an option
/// is out of range; Interrupted
[[nodiscard]] ROBOMILL_API SweepResult compute_sweep(const LobesProblem& problem, const SweepOptions& options,
                                                     Progress& progress = Progress::none());

/// The smallest factor on the cutting stiffness that brings a cut to the border of stability.
struct GainMargin {
  /// found: the other members hold. unconditionally_stable: no factor up to 1,000 does. below_range: even 0.001 is
  /// unstable.
  enum class Status { found, unconditionally_stable, below_range };
  Status status = Status::unconditionally_stable;
  double gain = 0.0;  ///< > 1: stable as it is; 0.001 where below_range
};

/// At one point, by collocation; the engagement stays what it is. Every fourth of factors a tenth apart is looked at,
/// those between where the radius comes near 1; the first that is unstable is refined to the tolerance.
/// @throws InvalidInput as evaluate_point
[[nodiscard]] ROBOMILL_API GainMargin gain_margin(const LobesProblem& problem, const OperatingPoint& point,
                                                  double tolerance = 1e-6);

}  // namespace robomill::stability
