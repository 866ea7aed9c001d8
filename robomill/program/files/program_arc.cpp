#include "robomill/program/files/program_arc.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

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

}  // namespace robomill::program
