#include "robomill/robot/kinematics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "testing/support.hpp"

namespace robomill::robot {
namespace kinematics_test {

using robomill::test::field_of;

TEST(JointLimits, NameTheJointThatCannotBe) {
  JointLimits good;
  good.max_velocity.setConstant(1.0);
  good.max_acceleration.setConstant(2.0);
  good.max_jerk.setConstant(3.0);
  EXPECT_EQ(field_of([&] { good.validate(6); }), "accepted");
  const auto rejected = [&](Position6 JointLimits::*member, int joint, double value) {
    JointLimits limits = good;
    (limits.*member)(joint) = value;
    return field_of([&] { limits.validate(5); });
  };
  EXPECT_EQ(rejected(&JointLimits::max_velocity, 0, 0.0), "max_velocity[1]");
  EXPECT_EQ(rejected(&JointLimits::max_acceleration, 3, -1.0), "max_acceleration[4]");
  EXPECT_EQ(rejected(&JointLimits::max_jerk, 2, NAN), "max_jerk[3]");
  EXPECT_EQ(rejected(&JointLimits::min_position, 4, 1e301), "min_position[5]");
  EXPECT_EQ(rejected(&JointLimits::max_jerk, 5, 0.0), "accepted");
}

}  // namespace kinematics_test
}  // namespace robomill::robot
