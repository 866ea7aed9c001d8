#include "robomill/program/program.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace robomill::program {

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

bool ProgramSource::next(Block& out) {
  if (next_ == program_.blocks.size()) return false;
  out = program_.blocks[next_++];
  return true;
}

Remarks ProgramSource::remarks() const {
  return {.skipped = program_.skipped,
          .skipped_count = program_.skipped.size(),
          .notes = program_.notes,
          .assumed = program_.assumed};
}

Pose between(const Pose& from, const Pose& to, double share) {
  Pose pose;
  pose.tip_m = from.tip_m + share * (to.tip_m - from.tip_m);
  const double angle = angle_between(from.axis, to.axis);
  if (angle < 1e-9) {  // the chord differs from the arc by less than rounding
    pose.axis = (from.axis + share * (to.axis - from.axis)).normalized();
    return pose;
  }
  const Eigen::Vector3d mixed = std::sin((1.0 - share) * angle) * from.axis + std::sin(share * angle) * to.axis;
  pose.axis = mixed.normalized();
  return pose;
}

}  // namespace robomill::program
