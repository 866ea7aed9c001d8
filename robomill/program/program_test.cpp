#include "robomill/program/program.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "robomill/base/random.hpp"

namespace robomill::program {
namespace program_test {

using Eigen::Vector3d;

Vector3d direction(Random& random) {
  return Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}

// acos of the dot product loses half the digits at both ends; the angle that made the vectors does not.
TEST(AngleBetween, IsAccurateFromNothingToHalfATurn) {
  Random random(1);
  for (const double angle : {0.0, 1e-12, 1e-8, 1e-3, 1.0, 3.0, std::numbers::pi - 1e-8}) {
    const Vector3d a = direction(random);
    const Vector3d turn_about = a.unitOrthogonal();
    const Vector3d b = std::cos(angle) * a + std::sin(angle) * turn_about;
    EXPECT_NEAR(angle_between(a, b), angle, 1e-15 + 1e-15 * angle + (angle > 3.1 ? 4e-16 : 0.0)) << angle;
  }
}

TEST(Between, TipRunsOnALineAndAxisEvenlyOnAGreatCircle) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Pose from = {.tip_m = {random.normal(), random.normal(), random.normal()}, .axis = direction(random)};
    const Pose to = {.tip_m = {random.normal(), random.normal(), random.normal()}, .axis = direction(random)};
    const double share = random.uniform();
    const Pose pose = between(from, to, share);
    EXPECT_LT((pose.tip_m - ((1.0 - share) * from.tip_m + share * to.tip_m)).norm(), 1e-15 * 8.0);
    EXPECT_NEAR(pose.axis.norm(), 1.0, 1e-15);
    const double whole = angle_between(from.axis, to.axis);
    EXPECT_NEAR(angle_between(from.axis, pose.axis), share * whole, 1e-12);
    EXPECT_NEAR(angle_between(pose.axis, to.axis), (1.0 - share) * whole, 1e-12);
  }
}

TEST(Between, MeetsItsEnds) {
  Random random(3);
  for (const double angle : {0.0, 1e-10, 0.9e-9, 1.1e-9, 1e-3, 2.0}) {
    const Vector3d axis = direction(random);
    const Pose from = {.tip_m = {1.0, 2.0, 3.0}, .axis = axis};
    const Pose to = {.tip_m = {-1.0, 0.5, 9.0},
                     .axis = std::cos(angle) * axis + std::sin(angle) * axis.unitOrthogonal()};
    EXPECT_LT((between(from, to, 0.0).axis - from.axis).norm(), 1e-15);
    EXPECT_LT((between(from, to, 1.0).axis - to.axis).norm(), 1e-15);
    EXPECT_EQ(between(from, to, 0.0).tip_m, from.tip_m);
    EXPECT_LT((between(from, to, 1.0).tip_m - to.tip_m).norm(), 1e-14);
    EXPECT_NEAR(angle_between(from.axis, between(from, to, 0.25).axis), 0.25 * angle, 1e-15);
  }
}

TEST(Program, ABlockBeginsWhereTheLastOneEnded) {
  Program program;
  program.start.tip_m = {1.0, 0.0, 0.0};
  program.blocks.resize(2);
  program.blocks[0].end.tip_m = {2.0, 0.0, 0.0};
  EXPECT_EQ(program.begin_of(0).tip_m.x(), 1.0);
  EXPECT_EQ(program.begin_of(1).tip_m.x(), 2.0);
}

}  // namespace program_test
}  // namespace robomill::program
