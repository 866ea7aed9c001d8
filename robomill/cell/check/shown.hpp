#pragma once
#include <array>
#include <cmath>
#include <cstddef>

#include "robomill/base/units.hpp"

namespace robomill::cell {

/// What a joint's numbers are shown in.
struct JointUnit {
  double size = units::deg;
  const char* text = "°";
};
/// @param prismatic  of each joint
[[nodiscard]] inline JointUnit joint_unit(const std::array<bool, 6>& prismatic, int joint) {
  return prismatic.at(static_cast<std::size_t>(joint)) ? JointUnit{units::mm, " mm"} : JointUnit{};
}

/// Limits, and distances to them, that are there: robot::Joint has 1e300 where there is none.
[[nodiscard]] inline bool is_limit(double value) {
  return std::abs(value) < 1e299;
}

}  // namespace robomill::cell
