#include "robomill/program/machine.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/random.hpp"
#include "robomill/program/program.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace machine_test {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

Vector3d turned(double first_rad, const Vector3d& first, double second_rad) {
  return AngleAxisd(second_rad, Vector3d::UnitZ()) * (AngleAxisd(first_rad, first) * Vector3d::UnitZ());
}

// A head turns the tool by A or B, then by C. On tables that turn the other way round the part sees the inverse:
// LinuxCNC's tables turn the part by Rx(A) Rz(C), so that the tool stands at Rz(-C) Rx(-A) e_z in the part.
TEST(Machine, AxisIsTheRotationsOfItsJoints) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const double a = random.uniform(-4.0, 4.0);
    const double b = random.uniform(-4.0, 4.0);
    const double c = random.uniform(-8.0, 8.0);
    EXPECT_LT((tool_axis(Machine::xyzac_head, a, b, c) - turned(a, Vector3d::UnitX(), c)).norm(), 1e-15);
    EXPECT_LT((tool_axis(Machine::xyzbc_head, a, b, c) - turned(b, Vector3d::UnitY(), c)).norm(), 1e-15);
    EXPECT_LT((tool_axis(Machine::xyzac_trt, a, b, c) - turned(-a, Vector3d::UnitX(), -c)).norm(), 1e-15);
    EXPECT_LT((tool_axis(Machine::xyzbc_trt, a, b, c) - turned(-b, Vector3d::UnitY(), -c)).norm(), 1e-15);
  }
}

TEST(Machine, LeansTheToolAsTheTableTips) {
  const double quarter = 0.5 * std::numbers::pi;
  EXPECT_LT((tool_axis(Machine::xyzac_trt, quarter, 0.0, 0.0) - Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_LT((tool_axis(Machine::xyzac_head, quarter, 0.0, 0.0) + Vector3d::UnitY()).norm(), 1e-15);
  EXPECT_LT((tool_axis(Machine::xyzbc_trt, 0.0, quarter, 0.0) + Vector3d::UnitX()).norm(), 1e-15);
  EXPECT_LT((tool_axis(Machine::xyzbc_head, 0.0, quarter, 0.0) - Vector3d::UnitX()).norm(), 1e-15);
}

constexpr Machine machines[] = {Machine::xyzac_trt, Machine::xyzbc_trt, Machine::xyzac_head, Machine::xyzbc_head};

Vector3d axis_at(Machine machine, const Vector3d& rotary_rad) {
  return tool_axis(machine, rotary_rad.x(), rotary_rad.y(), rotary_rad.z());
}

/// Anywhere, and often at or near a pole or the equator.
Vector3d random_axis(Random& random) {
  const double near = std::pow(10.0, -random.uniform(0.0, 17.0));
  switch (random.index(5)) {
    case 0:
      return {0.0, 0.0, random.index(2) == 0 ? 1.0 : -1.0};
    case 1:
      return Vector3d(near * random.normal(), near * random.normal(), random.index(2) == 0 ? 1.0 : -1.0).normalized();
    case 2:
      return Vector3d(random.normal(), random.normal(), near * random.normal()).normalized();
    default:
      return Vector3d(random.normal(), random.normal(), random.normal()).normalized();
  }
}

TEST(Machine, BothSolutionsGiveTheAxis) {
  Random random(7);
  for (int i = 0; i < test::seeds(100000); ++i) {
    const Machine machine = machines[random.index(4)];
    const Vector3d axis = random_axis(random);
    const double free = random.uniform(-9.0, 9.0);
    const auto [first, second] = rotary_of_axis(machine, axis, free);
    ASSERT_LT((axis_at(machine, first) - axis).norm(), 1e-12) << i;
    ASSERT_LT((axis_at(machine, second) - axis).norm(), 1e-12) << i;
    const Eigen::Index tilt = tilt_index(machine);
    ASSERT_GE(first[tilt], 0.0);
    ASSERT_EQ(second[tilt], -first[tilt]);
    ASSERT_EQ(first[1 - tilt], 0.0);
    const bool pole = axis.head<2>().norm() <= 1e-13;
    ASSERT_EQ(second.z(), pole ? first.z() : first.z() + std::numbers::pi);
    if (pole) {
      ASSERT_EQ(first.z(), free) << "C is free";
    }
  }
}

// The solutions are all there are: angles that are known come back, up to whole turns or as the other one.
TEST(Machine, NearestRotaryIsTheNearestOfAllThatGiveTheAxis) {
  Random random(8);
  for (int i = 0; i < test::seeds(20000); ++i) {
    const Machine machine = machines[random.index(4)];
    const Eigen::Index tilt = tilt_index(machine);
    Vector3d from = Vector3d::Zero();
    from[tilt] = random.uniform(-7.0, 7.0);
    from.z() = random.uniform(-30.0, 30.0);
    const Vector3d axis = random_axis(random);
    const Vector3d nearest = nearest_rotary(machine, axis, from);
    ASSERT_LT((axis_at(machine, nearest) - axis).norm(), 1e-12) << i;
    ASSERT_EQ(nearest[1 - tilt], 0.0);
    if (axis.head<2>().norm() <= 1e-13) {
      ASSERT_NEAR(nearest.z(), from.z(), 1e-14) << "C stays";
      continue;
    }
    for (const Vector3d& solution : rotary_of_axis(machine, axis, 0.0)) {
      for (int k = -12; k < 12; ++k) {
        Vector3d other = solution;
        other.z() += 2.0 * std::numbers::pi * k;
        other[tilt] += 2.0 * std::numbers::pi * static_cast<double>(static_cast<int>(random.index(5)) - 2);
        ASSERT_LE((nearest - from).norm(), (other - from).norm() + 2e-9) << i;
      }
    }
    // What stands stays, and what moves a little moves on.
    ASSERT_LT((nearest_rotary(machine, axis_at(machine, nearest), nearest) - nearest).norm(),
              1e-12 + 1e-15 / axis.head<2>().norm());
  }
  // Through the pole C stands still and the tilt goes on to the other side.
  const Vector3d over =
      nearest_rotary(Machine::xyzac_trt, {0.0, -std::sin(0.1), std::cos(0.1)}, {0.1, 0.0, 6.0 * std::numbers::pi});
  EXPECT_LT((over - Vector3d(-0.1, 0.0, 6.0 * std::numbers::pi)).norm(), 1e-14);
}

RotaryMove random_move(Random& random) {
  const double size = std::exp(random.uniform(std::log(1e-3), std::log(10.0)));
  RotaryMove move = {.machine = machines[random.index(4)]};
  for (Eigen::Index i = 0; i < 3; ++i) {
    move.begin_rad[i] = random.uniform(-4.0, 4.0);
    move.end_rad[i] = move.begin_rad[i] + (random.index(4) == 0 ? 0.0 : random.uniform(-size, size));
  }
  if (random.index(4) == 0) move.begin_rad.x() = move.begin_rad.y() = 0.0;  // out of the pole
  return move;
}

// Great circles through the parts' ends, compared with the curve at the same share of time.
TEST(RotaryMove, PartsLeaveTheCurveByNoMoreThanTheirBound) {
  Random random(6);
  double closest = 0.0;
  for (int i = 0; i < test::seeds(4000); ++i) {
    const RotaryMove move = random_move(random);
    const double tolerance = std::exp(random.uniform(std::log(1e-6), std::log(1e-2)));
    const double parts = move.parts(tolerance);
    const double bound = move.deviation_rad(parts);
    ASSERT_EQ(move.axis_at(1.0), axis_at(move.machine, move.end_rad)) << "to the bit";
    ASSERT_LE(bound, tolerance * (1.0 + 1e-9));
    for (int k = 0; k < 20; ++k) {
      const double part = std::floor(random.uniform(0.0, parts));
      const Pose from = {.axis = move.axis_at(part / parts)}, to = {.axis = move.axis_at((part + 1.0) / parts)};
      const double within = random.uniform();
      const double off = angle_between(between(from, to, within).axis, move.axis_at((part + within) / parts));
      ASSERT_LE(off, bound + 1e-12) << i;
      ASSERT_LE(angle_between(from.axis, to.axis), 0.5 + 1e-9);
      if (bound > 1e-9) closest = std::max(closest, off / bound);
    }
  }
  EXPECT_GT(closest, 0.9) << "the bound is met";
}

// At constant tilt the axis runs round a small circle: M = sin A cos A C², and the great circle of a part misses its
// middle by the sagitta of that circle.
TEST(RotaryMove, ConesNeedAsManyPartsAsTheirSagittaSays) {
  constexpr double deg = std::numbers::pi / 180.0;
  const RotaryMove cone = {.begin_rad = {30.0 * deg, 0.0, 0.0}, .end_rad = {30.0 * deg, 0.0, 360.0 * deg}};
  const double parts = cone.parts(1e-3 * deg);
  EXPECT_NEAR(parts, 2.0 * std::numbers::pi * std::sqrt(0.5 * std::sqrt(0.75) / (7.5 * 1e-3 * deg)), 1.0);
  const Pose from = {.axis = cone.axis_at(0.0)}, to = {.axis = cone.axis_at(1.0 / parts)};
  const double sagitta = angle_between(between(from, to, 0.5).axis, cone.axis_at(0.5 / parts));
  EXPECT_NEAR(sagitta / cone.deviation_rad(parts), 7.5 / 8.0, 1e-4);
  // A meridian is a great circle, and about the pole nothing moves.
  const RotaryMove meridian = {.begin_rad = {-1.2, 0.0, 0.3}, .end_rad = {1.3, 0.0, 0.3}};
  EXPECT_EQ(meridian.parts(1e-9), 5.0);
  EXPECT_EQ(meridian.deviation_rad(5.0), 0.0);
  const RotaryMove still = {.begin_rad = {0.0, 0.0, 0.0}, .end_rad = {0.0, 0.0, 30.0}};
  EXPECT_EQ(still.parts(1e-9), 1.0);
}

}  // namespace machine_test
}  // namespace robomill::program
