#pragma once
// Cutters and cuts that the tests of this stage share.
#include <algorithm>
#include <numbers>

#include "robomill/base/random.hpp"
#include "robomill/cutting/cutter.hpp"
#include "robomill/cutting/engagement.hpp"

namespace robomill::cutting::testing {

inline constexpr double degree = std::numbers::pi / 180.0;
inline constexpr double mm = 1e-3;

inline Cutter ball_end(double radius_m, int teeth = 2, double helix_rad = 0.0) {
  Cutter cutter;
  cutter.kind = CutterKind::ball_end;
  cutter.mill = {.teeth = teeth, .diameter_m = 2.0 * radius_m, .helix_rad = helix_rad};
  return cutter;
}

inline Cutter flat_end(double diameter_m, int teeth = 4, double helix_rad = 0.0) {
  Cutter cutter;
  cutter.mill = {.teeth = teeth, .diameter_m = diameter_m, .helix_rad = helix_rad};
  return cutter;
}

inline Cutter bull_nose(double diameter_m, double corner_m, int teeth = 4) {
  Cutter cutter = flat_end(diameter_m, teeth);
  cutter.kind = CutterKind::bull_nose;
  cutter.corner_radius_m = corner_m;
  return cutter;
}

/// A ball of radius R whose side is tangent to it and rises at an angle from the axis.
inline Cutter tapered_ball(double radius_m, double side_rad, double height_m) {
  Cutter cutter;
  cutter.kind = CutterKind::general;
  const double foot = radius_m * (1.0 - std::sin(side_rad)) / std::cos(side_rad);
  cutter.mill = {.teeth = 2, .diameter_m = 2.0 * foot};
  cutter.corner_radius_m = cutter.corner_center_height_m = radius_m;
  cutter.side_angle_rad = side_rad;
  cutter.cutting_height_m = height_m;
  return cutter;
}

/// Any kind, 1 to 6 teeth, unequal pitch in every third.
inline Cutter random_cutter(Random& random, CutterKind kind) {
  Cutter cutter;
  cutter.kind = kind;
  FlatEndMill& mill = cutter.mill;
  mill.diameter_m = random.uniform(2.0 * mm, 25.0 * mm);
  mill.teeth = 1 + static_cast<int>(random.index(6));
  mill.helix_rad = random.uniform(-10.0, 50.0) * degree;
  const double half = 0.5 * mill.diameter_m;
  if (kind == CutterKind::bull_nose) cutter.corner_radius_m = random.uniform(0.05, 0.9) * half;
  if (kind == CutterKind::general) {
    cutter.bottom_angle_rad = random.uniform(0.0, 15.0) * degree;
    cutter.side_angle_rad = random.uniform(-10.0, 15.0) * degree;
    const double corner = random.uniform(0.05, 0.4) * half;  // tangent to both lines
    const double bottom = cutter.bottom_angle_rad;
    const double side = cutter.side_angle_rad;
    const double reach = corner * std::tan(0.5 * (0.5 * std::numbers::pi - side - bottom));  // from where they meet
    cutter.corner_radius_m = corner;
    cutter.corner_center_radius_m = half - reach * std::cos(bottom) - corner * std::sin(bottom);
    cutter.corner_center_height_m = (half - reach * std::cos(bottom)) * std::tan(bottom) + corner * std::cos(bottom);
  }
  if (random.index(3) == 0) {
    double sum = 0.0;
    for (int j = 0; j < mill.teeth; ++j) {
      mill.pitch_rad.push_back(random.uniform(0.7, 1.3));
      sum += mill.pitch_rad.back();
    }
    for (double& pitch : mill.pitch_rad) pitch *= 2.0 * std::numbers::pi / sum;
  }
  return cutter;
}

/// A cut with lead and tilt that stays off the shank for most cutters of random_cutter.
inline Cut random_cut(Random& random, const Cutter& cutter) {
  Cut cut;
  const double half = 0.5 * cutter.mill.diameter_m;
  cut.axial_depth_m = random.uniform(0.05, 0.4) * half;
  cut.radial_depth_m = random.uniform(0.05, 1.2) * half;
  const auto direction = random.index(5);
  cut.direction =
      direction == 0 ? MillingDirection::slot : (direction < 3 ? MillingDirection::up : MillingDirection::down);
  cut.lead_rad = random.uniform(-30.0, 30.0) * degree;
  cut.tilt_rad = random.uniform(-30.0, 30.0) * degree;
  return cut;
}

}  // namespace robomill::cutting::testing
