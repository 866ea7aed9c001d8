#include "robomill/process/blocks/stand_at.hpp"

#include "robomill/robot/kinematics/choose.hpp"

namespace robomill::process {

std::optional<Eigen::VectorXd> stand_at(const robot::Cell& cell,
                                        const std::optional<robot::SphericalWristInverse>& inverse,
                                        const robot::ToolPose& pose, const Eigen::VectorXd& near) {
  const Eigen::Isometry3d flange = robot::flange_pose(cell, pose);
  if (inverse) {
    const robot::Position6 previous(near);
    const robot::Choice choice =
        robot::choose(cell.arm, inverse->solve(flange, previous), previous, {.point_m = robot::tip_point(cell)});
    if (choice.status != robot::Reach::Status::found) return std::nullopt;
    return choice.position_rad;
  }
  const robot::NearResult found = robot::solve_near(cell.arm, flange, near);
  const bool there =
      found.status == robot::NearResult::Status::converged && robot::within_limits(cell.arm, found.position).inside;
  return there ? std::optional(found.position) : std::nullopt;
}

}  // namespace robomill::process
