#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "robomill/base/cost.hpp"
#include "robomill/base/export.hpp"
#include "robomill/base/progress.hpp"
#include "robomill/stability/lobes.hpp"

// Method: robomill/stability/README.md, "The chart"

namespace robomill::stability {

/// How well a problem is known. All errors are independent and normal; shares are of the value itself.
struct ROBOMILL_API Uncertainty {
  int samples = 0;                       ///< how many problems are drawn, 20 to 1,000,000; required
  std::array<int, 2> grid = {60, 60};    ///< speeds and depths, 2 to 20,000 each
  std::uint64_t seed = 1;                ///< the same seed draws the same problems
  double tangential_std_n_per_m2 = 0.0;  ///< of Kt [N/m^2], >= 0
  double radial_std_n_per_m2 = 0.0;      ///< of Kr [N/m^2], >= 0
  double coefficient_std_ratio = 0.0;    ///< of one factor on all cutting coefficients, [0, 1]: harder or softer
  double frequency_std_ratio = 0.0;      ///< of the frequency of modes that do not know their own, [0, 0.5]
  double damping_std_ratio = 0.0;        ///< of the damping ratio of modes that do not know their own, [0, 1]
  double residue_std_ratio = 0.0;  ///< of the size of residue matrices, of modes that do not know their own, [0, 1]
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// What limits become when the problem is not known exactly.
struct UncertainLimits {
  Eigen::VectorXd spindle_speed_rad_per_s;  ///< length n
  Eigen::VectorXd axial_depth_m;            ///< length m
  /// At each speed the depths below which 5, 50 and 95 % of the samples have their limit [m]; where that share has no
  /// limit in the range, infinity.
  Eigen::VectorXd limit_5_percent_m, limit_50_percent_m, limit_95_percent_m;
  /// m x n, a row a depth: share of the samples whose lowest unstable depth is at most this one.
  Eigen::MatrixXd chatter_probability;
  int samples = 0;
  double seconds = 0.0;
};

/// What uncertain_limits is about to take, known before it runs.
/// @throws InvalidInput if the problem has no modes to compute with
[[nodiscard]] ROBOMILL_API Cost cost_of_uncertain_limits(const LobesProblem& problem, const LobesOptions& options,
                                                         const Uncertainty& uncertainty);

/// Draws problems around this one and finds the limit curve of each, over the options' ranges on the uncertainty's own
/// grid. Same bits at any number of threads.
/// @throws InvalidInput if the problem, an option or the uncertainty is out of range
/// @throws Interrupted  when progress asks to stop
[[nodiscard]] ROBOMILL_API UncertainLimits uncertain_limits(const LobesProblem& problem, const LobesOptions& options,
                                                            const Uncertainty& uncertainty,
                                                            Progress& progress = Progress::none());

}  // namespace robomill::stability
