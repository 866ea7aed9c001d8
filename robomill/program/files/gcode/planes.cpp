// Planes of a GcodeReader that are turned (G68) or tilted (G68.2), and the tool's axis along their normal (G53.1).
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <string>

#include "robomill/base/units.hpp"
#include "robomill/program/files/gcode/reader.hpp"

namespace robomill::program {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double apart = 1e-12;  ///< components below are none

/// Whole multiples of a quarter turn are exact.
Matrix3d turned_by(double angle_deg, const Vector3d& about) {
  constexpr double quarter_deg = 90.0;
  const double quarters = angle_deg / quarter_deg;
  Matrix3d out = AngleAxisd(angle_deg * units::deg, about).toRotationMatrix();
  if (quarters == std::round(quarters)) out = out.array().round().matrix();
  return out;
}

}  // namespace

void GcodeReader::check_may_tilt(const Line& line) const {
  const double code = line.special_code->number;
  if (tilted_) {
    reject("G", code, "", fmt::format("comes while {} (line {}) is on", tilted_->code, tilted_->line),
           "Write G69 before it");
  }
  if (incremental_)
    reject("G", code, "", "is not read with steps (G91): controls count its words both ways", "Write G90");
  if (line.p || line.q || line.l) {
    reject("G", code, "", "is read without P, Q and L: they give its angles another meaning",
           "Let the CAM system write Euler angles: G68.2 X Y Z I J K");
  }
  for (const std::optional<double>& angle : line.rotary) {
    if (angle) reject("G", code, "", "is not read with A, B and C", "Let the CAM system write G68.2 X Y Z I J K");
  }
}

void GcodeReader::check_frame_stays(const Line& line) const {
  const bool changes = line.system || line.special == Special::local || line.special == Special::shift ||
                       line.special == Special::shift_reset || line.special == Special::table;
  if (!tilted_ || !changes) return;
  reject("G", (line.system ? *line.system : *line.special_code).number, "",
         fmt::format("changes the work frame while {} (line {}) is on", tilted_->code, tilted_->line),
         "Write G69 before it");
}

// Euler angles about Z, the new X, and the new Z.
void GcodeReader::tilt(const Line& line) {
  special_ = true;
  check_may_tilt(line);
  for (std::size_t i = 0; i < 3; ++i) {
    if (line.position[i] && line.vector[i]) continue;
    reject("G", line.special_code->number, "", "needs X, Y, Z, its origin, and I, J, K, its Euler angles in degrees",
           "Controls read missing ones in several ways");
  }
  if (line.radius) reject("R", *line.radius, "", "is not read with G68.2", "Its angles are I, J and K");
  static constexpr std::array<const char*, 3> names = {"X", "Y", "Z"};
  Tilted tilted = {.line = line_, .code = "G68.2", .plane = true};
  tilted.axes = turned_by(*line.vector[0], Vector3d::UnitZ()) * turned_by(*line.vector[1], Vector3d::UnitX()) *
                turned_by(*line.vector[2], Vector3d::UnitZ());
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    tilted.origin_m[axis] = *line.position[i] * unit_m();
    check_coordinate(names[i], tilted.origin_m[axis], *line.position[i], unit_name());
  }
  change_axes(tilted);
}

// About a point of the plane, counterclockwise.
void GcodeReader::turn_plane(const Line& line) {
  special_ = true;
  check_may_tilt(line);
  const double code = line.special_code->number;
  const auto of = [&](Eigen::Index axis) { return line.position[static_cast<std::size_t>(axis)]; };
  const std::optional<double> first = of(plane_.first);
  const std::optional<double> second = of(plane_.second);
  if (!first || !second || !line.radius) {
    reject("G", code, "", fmt::format("needs its centre in the plane {} and R, its angle in degrees", plane_.name),
           "Controls read missing ones in several ways");
  }
  if (of(plane_.normal) || line.vector[0] || line.vector[1] || line.vector[2]) {
    reject("G", code, "", "turns in space with I, J, K or a third position, which is not read",
           "Let the CAM system write G68.2 X Y Z I J K");
  }
  Tilted tilted = {.line = line_, .code = "G68"};
  tilted.axes = turned_by(*line.radius, Vector3d::Unit(plane_.normal));
  Vector3d center_m = Vector3d::Zero();
  center_m[plane_.first] = *first * unit_m();
  center_m[plane_.second] = *second * unit_m();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    check_coordinate("X, Y, Z", center_m[axis], center_m[axis] / unit_m(), unit_name());
  }
  tilted.origin_m = center_m - tilted.axes * center_m;
  change_axes(tilted);
}

void GcodeReader::end_tilt() {
  if (tilted_) change_axes({});
}

// An axis is known where all the axes are that it was made of.
void GcodeReader::change_axes(const std::optional<Tilted>& to) {
  const Matrix3d before = tilted_ ? tilted_->axes : Matrix3d::Identity();
  const Matrix3d mixed = (to ? to->axes : Matrix3d::Identity()).transpose() * before;
  const std::array<bool, 3> known = known_;
  for (std::size_t i = 0; i < 3; ++i) {
    known_[i] = true;
    for (std::size_t j = 0; j < 3; ++j) {
      const bool takes = std::abs(mixed(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j))) > apart;
      known_[i] = known_[i] && (known[j] || !takes);
    }
  }
  tilted_ = to;
}

void GcodeReader::lose_machine_axis(std::size_t axis) {
  for (std::size_t i = 0; i < 3; ++i) {
    const auto own = static_cast<Eigen::Index>(i);
    const double share = tilted_ ? tilted_->axes(static_cast<Eigen::Index>(axis), own) : axis == i ? 1.0 : 0.0;
    if (std::abs(share) > apart) known_[i] = false;
  }
}

// The machine turns its rotary axes; where the tip is then in the part depends on how it is built.
void GcodeReader::turn_to_plane(const Line& line) {
  special_ = true;
  if (!tilted_ || !tilted_->plane) {
    reject("G", line.special_code->number, "", "turns the tool to a tilted plane, and none is on",
           "Write G68.2 before it");
  }
  if (line.moves()) reject("G", line.special_code->number, "", "is read on a line without other words");
  const Vector3d axis = tilted_->axes.col(2);
  if (reading_.machine) {
    rotary_deg_ = nearest_rotary(*reading_.machine, axis, rotary_deg_ * units::deg) / units::deg;
    lost_rotary_ = {};
  } else {
    remarks_.assume({.what = "The tool's axis after G53.1",
                     .taken = "the normal of the plane; how the machine's rotary axes stand is not known",
                     .key = "program.machine"});
  }
  if (passes() || !start_) {
    (pending_ ? *pending_ : pose_).axis = axis;
    known_ = {};
    return;
  }
  for (std::size_t i = 0; i < 3; ++i) lose(i, "G53.1");
  pending_->axis = axis;
}

Vector3d GcodeReader::in_program(const Vector3d& point_m) const {
  if (!tilted_) return point_m;
  return tilted_->axes.transpose() * (point_m - tilted_->origin_m - origin_m().value_or(Vector3d::Zero()));
}

Vector3d GcodeReader::out_of_program(const Vector3d& point_m) const {
  if (!tilted_) return point_m;
  return origin_m().value_or(Vector3d::Zero()) + tilted_->origin_m + tilted_->axes * point_m;
}

Vector3d GcodeReader::turned(const Vector3d& vector) const {
  return tilted_ ? Vector3d(tilted_->axes * vector) : vector;
}

}  // namespace robomill::program
