#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/force.hpp"

// Derived in docs/theory/three-directions.md
namespace robomill::stability::detail {

/// Force over a stretch of rotation: F(θ) = mean + Re(first e^{iθ} + second e^{2iθ}) [N].
struct ForceStretch {
  double from_rad = 0.0, to_rad = 0.0;  ///< within one period
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Vector3cd first = Eigen::Vector3cd::Zero(), second = Eigen::Vector3cd::Zero();
};

/// What a rigid cutter feels: chips of feed and runout, and edges.
struct SteadyForce {
  std::vector<ForceStretch> stretches;  ///< of each edge in the cut; they overlap
  double period_rad = 0.0;              ///< of a tooth where all are equal, else a revolution
  bool equal_teeth = true;
};

/// The force of cutting::cutting_force, exactly and not as means over steps.
/// @param axes_from_tool  the force's axes are those of F' = R F, F in T
[[nodiscard]] SteadyForce steady_force(const cutting::Cutter& cutter, const cutting::Engagement& engagement,
                                       const cutting::MillingCoefficients& coefficients, double feed_per_tooth_m,
                                       const Eigen::Matrix3d& axes_from_tool);

}  // namespace robomill::stability::detail
