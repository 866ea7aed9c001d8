#include "robomill/path/published/fir_corner.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "robomill/program/program.hpp"

namespace robomill::path {

using Eigen::Vector3d;

double corner_speed(const Vector3d& velocity, const Vector3d& next_velocity, bool as_printed) {
  if (!as_printed) return (next_velocity - velocity).norm();
  return std::sqrt(velocity.squaredNorm() + next_velocity.squaredNorm() - velocity.dot(next_velocity));
}

Vector3d end_tangent(const Vector3d& from, const Vector3d& to) {
  const double angle = program::angle_between(from, to);
  const Vector3d aside = to * to.dot(from) - from;
  const double length = aside.norm();
  return length > 0.0 ? Vector3d(aside * (angle / length)) : Vector3d(Vector3d::Zero());
}

double corner_error(const Boxes& filters, double speed, double overlap_s) {
  return speed * tail_s(filters, 0.5 * overlap_s);
}

double largest_overlap_s_of(const Boxes& block, const Boxes& next, double speed, double tolerance) {
  Boxes shorter;
  double room = 0.0, next_room = 0.0;
  for (int i = 1; i < std::min(block.count, next.count); ++i) {
    shorter.add(std::min(block.width_s[i], next.width_s[i]));
    room += block.width_s[i];
    next_room += next.width_s[i];
  }
  const double most = std::min(room, next_room);
  const double half = speed > 0.0 ? tail_time_s(shorter, tolerance / speed) : 0.5 * most;
  return std::min(most, 2.0 * half);
}

}  // namespace robomill::path
