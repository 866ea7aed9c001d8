#include "robomill/program/files/program_arc.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "robomill/base/units.hpp"

namespace robomill::program {

Eigen::Vector3d Arc::at(double share) const {
  const double angle = share * sweep_rad;
  const double radius_m = begin_radius_m + share * (end_radius_m - begin_radius_m);
  return center_m + radius_m * (std::cos(angle) * towards + std::sin(angle) * ahead) + share * rise_m;
}

double Arc::length_m() const {
  return std::hypot(0.5 * (begin_radius_m + end_radius_m) * sweep_rad, rise_m.norm());
}

double Arc::bend_m() const {
  return std::max(begin_radius_m, end_radius_m) + 2.0 * std::abs(end_radius_m - begin_radius_m) / sweep_rad;
}

double Arc::chords(double tolerance_m) const {
  const double longest_rad = std::min(std::sqrt(8.0 * tolerance_m / bend_m()), 0.5 * std::numbers::pi);
  return std::max(std::ceil(sweep_rad / longest_rad), 1.0);
}

double Arc::deviation_m(double chords) const {
  const double each_rad = sweep_rad / chords;
  return bend_m() * each_rad * each_rad / 8.0;
}

double arc_radius_error_m(double radius_m, bool inches) {
  const double digits_m = inches ? 0.0005 * units::inch : 0.005 * units::mm;
  return std::min(0.5 * units::mm, std::max(digits_m, 1e-3 * radius_m));
}

Arc arc_about(const Eigen::Vector3d& center_m, const Eigen::Vector3d& normal, const Eigen::Vector3d& begin_m,
              const Eigen::Vector3d& end_m) {
  constexpr double same_place_m = 1e-10;
  const auto across = [&](const Eigen::Vector3d& way) { return Eigen::Vector3d(way - way.dot(normal) * normal); };
  const Eigen::Vector3d a = across(begin_m - center_m);
  const Eigen::Vector3d b = across(end_m - center_m);
  Arc arc;
  arc.center_m = begin_m - a;
  arc.begin_radius_m = a.norm();
  arc.end_radius_m = b.norm();
  arc.rise_m = (end_m - begin_m).dot(normal) * normal;
  const bool whole = across(end_m - begin_m).norm() <= same_place_m;
  const double sweep_rad = whole ? 0.0 : std::atan2(normal.dot(a.cross(b)), a.dot(b));
  arc.sweep_rad = sweep_rad > 0.0 ? sweep_rad : sweep_rad + 2.0 * std::numbers::pi;
  if (arc.begin_radius_m > 0.0) {
    arc.towards = a / arc.begin_radius_m;
    arc.ahead = normal.cross(arc.towards);
  }
  return arc;
}

}  // namespace robomill::program
