#include "robomill/robot/kinematics.hpp"

#include <cmath>
#include <string>

#include "robomill/base/error.hpp"

namespace robomill::robot {

void JointLimits::validate(int joints) const {
  const auto name = [](std::string member, int i) {
    return member.append("[").append(std::to_string(i + 1)).append("]");
  };
  for (int i = 0; i < joints; ++i) {
    if (!(min_position(i) < max_position(i))) {
      throw InvalidInput(name("min_position", i), min_position(i), "", "must be below max_position",
                         "Are the two lists exchanged?");
    }
    require_positive(name("max_velocity", i).c_str(), max_velocity(i), "");
    require_positive(name("max_acceleration", i).c_str(), max_acceleration(i), "");
    require_positive(name("max_jerk", i).c_str(), max_jerk(i), "");
  }
}

}  // namespace robomill::robot
