#include "robomill/path/check/check_window.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace robomill::path {

using Eigen::Vector3d;
using program::Block;

namespace {

constexpr double stands_m = 1e-12, stands_rad = 1e-12;

CheckedBlock checked_block(const program::Pose& from, const Block& block) {
  CheckedBlock s;
  s.kind = block.kind;
  s.tip_begin_m = s.tip_end_m = from.tip_m;
  s.axis_begin = s.axis_end = from.axis;
  if (block.kind == Block::Kind::dwell) {
    s.dwell_s = block.duration_s;
    return s;
  }
  s.tip_end_m = block.end.tip_m;
  s.axis_end = block.end.axis;
  s.tip_deviation_m = block.tip_deviation_m;
  s.axis_deviation_rad = block.axis_deviation_rad;
  const Vector3d way = s.tip_end_m - s.tip_begin_m;
  if (const double length = way.norm(); length > stands_m) {
    s.length_m = length;
    s.tip_direction = way / length;
  }
  const double angle = program::angle_between(s.axis_begin, s.axis_end);
  if (angle > stands_rad) {
    Vector3d across = s.axis_end - s.axis_end.dot(s.axis_begin) * s.axis_begin;
    if (across.norm() < 1e-14) across = s.axis_begin.unitOrthogonal();  // half a turn: any great circle is as good
    s.angle_rad = angle;
    s.across = across.normalized();
    s.normal = s.axis_begin.cross(s.across);
    s.end_tangent = s.normal.cross(s.axis_end);
  }
  const bool rapid = block.kind == Block::Kind::rapid || !(block.duration_s > 0.0);
  const double rate = rapid ? std::numeric_limits<double>::infinity() : 1.0 / block.duration_s;
  if (s.length_m > 0.0) s.tip_feed_m_per_s = s.length_m * rate;
  if (s.angle_rad > 0.0) s.axis_feed_rad_per_s = s.angle_rad * rate;
  return s;
}

}  // namespace

double angle_of_chord(double chord) {
  if (chord < 1e-3) return chord * (1.0 + chord * chord / 24.0);
  return 2.0 * std::asin(std::min(1.0, 0.5 * chord));
}

double chord_distance(const Vector3d& point, const Vector3d& from, const Vector3d& to) {
  const Vector3d way = to - from, offset = point - from;
  const double square = way.squaredNorm();
  const double share = square > 0.0 ? std::clamp(offset.dot(way) / square, 0.0, 1.0) : 0.0;
  return (offset - share * way).norm();
}

double CheckedBlock::tip_distance_m(const Vector3d& tip_m) const {
  const Vector3d offset = tip_m - tip_begin_m;
  const double along = std::clamp(offset.dot(tip_direction), 0.0, length_m);
  return (offset - along * tip_direction).norm() + tip_deviation_m;
}

double CheckedBlock::axis_distance_rad(const Vector3d& axis) const {
  // The nearest point of the great circle lies on the arc if it is past the beginning and before the end.
  if (angle_rad > 0.0 && axis.dot(across) >= 0.0 && axis.dot(end_tangent) <= 0.0) {
    return std::asin(std::min(1.0, std::abs(axis.dot(normal)))) + axis_deviation_rad;
  }
  // Its ends lie on the curve.
  return angle_of_chord(std::sqrt(std::min((axis - axis_begin).squaredNorm(), (axis - axis_end).squaredNorm())));
}

Vector3d CheckedBlock::axis_beside(const Vector3d& tip_m) const {
  const double share = std::clamp((tip_m - tip_begin_m).dot(tip_direction) / length_m, 0.0, 1.0);
  return std::cos(share * angle_rad) * axis_begin + std::sin(share * angle_rad) * across;
}

BlockWindow::BlockWindow(program::Source& source) : source_(source), slots_(room) {
  source_.rewind();
  start_ = end_ = source_.start();
}

bool BlockWindow::read() {
  Block block;
  if (!source_.next(block)) return false;
  Slot& slot = slots_[high_ % room];
  slot.segment = checked_block(end_, block);
  slot.corner = Corner();
  end_ = {.tip_m = slot.segment.tip_end_m, .axis = slot.segment.axis_end};
  ++high_;
  return true;
}

}  // namespace robomill::path
