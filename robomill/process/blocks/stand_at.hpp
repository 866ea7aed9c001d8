#pragma once
#include <Eigen/Core>
#include <optional>

#include "robomill/robot/inverse.hpp"
#include "robomill/robot/pose.hpp"

namespace robomill::process {

/// Joints at which the arm holds the tool so, the way nearest to `near`; none where it cannot stand there.
/// @param inverse  of an arm with a spherical wrist
[[nodiscard]] std::optional<Eigen::VectorXd> stand_at(const robot::Cell& cell,
                                                      const std::optional<robot::SphericalWristInverse>& inverse,
                                                      const robot::ToolPose& pose, const Eigen::VectorXd& near);

}  // namespace robomill::process
