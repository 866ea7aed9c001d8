#include "robomill/robot/kinematics/images.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "robomill/base/units.hpp"

namespace robomill::robot {
Image nearest_image(const Joint& joint, double angle, double previous) noexcept {
  const bool inside = angle >= joint.min_position && angle <= joint.max_position;
  if (inside && std::abs(angle - previous) < std::numbers::pi) return {.position = angle};
  const double lowest = std::ceil((joint.min_position - angle) / units::revolution);
  const double highest = std::floor((joint.max_position - angle) / units::revolution);
  const double wanted = std::round((previous - angle) / units::revolution);
  if (lowest <= highest) return {.position = angle + units::revolution * std::clamp(wanted, lowest, highest)};
  // The range holds no image: highest is just below it, lowest = highest + 1 just above.
  const double below = joint.min_position - (angle + units::revolution * highest);
  const double above = angle + units::revolution * lowest - joint.max_position;
  return below <= above ? Image{.position = angle + units::revolution * highest, .beyond = below}
                        : Image{.position = angle + units::revolution * lowest, .beyond = above};
}

Placed place(const Arm& arm, const Position6& solution, const Position6& previous, const Position6& weight) noexcept {
  Placed out;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const Image image = nearest_image(arm.joints[static_cast<std::size_t>(i)], solution(i), previous(i));
    out.position_rad(i) = image.position;
    if (image.beyond > out.beyond_rad) {
      out.beyond_rad = image.beyond;
      out.joint = i;
    }
    const double travel = weight(i) * (image.position - previous(i));
    out.cost += travel * travel;
  }
  return out;
}

Picked pick(const Arm& arm, const InverseSolutions& solutions, const Position6& previous,
            const Position6& weight) noexcept {
  Picked out;
  for (int k = 0; k < solutions.count; ++k) {
    const Placed placed = place(arm, solutions.solution[static_cast<std::size_t>(k)].position_rad, previous, weight);
    const Placed& best = out.placed;
    const bool better =
        placed.beyond_rad < best.beyond_rad || (placed.beyond_rad == best.beyond_rad && placed.cost < best.cost);
    if (out.solution >= 0 && !better) continue;
    out = {.placed = placed, .solution = k};
  }
  return out;
}

}  // namespace robomill::robot
