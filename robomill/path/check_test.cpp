#include "robomill/path/check.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "testing/path/machine.hpp"
#include "testing/path/trajectory.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace check_test {

using Eigen::Vector3d;
using program::Block;
using program::Pose;
using test::Fixture;
using test::options;

// v(T/2) = j T²/16, a = j T/4: closed form of the four quarters.
TEST(Checker, ReportsTheClosedFormOfAStraightMove) {
  Fixture f;
  const double length = 0.01, seconds = 0.4, jerk = 32.0 * length / std::pow(seconds, 3);
  f.move({0.0, length, 0.0}, {0.0, 0.0, 1.0}, length / 0.06);
  const CheckResult r = f.check(f.stop_and_go({seconds}));
  EXPECT_EQ(r.violations(), 0U);
  EXPECT_EQ(r.samples, 401U);
  EXPECT_NEAR(r.duration_s, 0.4, 1e-12);
  EXPECT_NEAR(r.tip_velocity.max, jerk * seconds * seconds / 16.0, 1e-3 * r.tip_velocity.max);
  EXPECT_NEAR(r.tip_velocity.at_s, 0.2, 0.001);
  EXPECT_NEAR(r.tip_acceleration.max, jerk * seconds / 4.0, 0.01 * r.tip_acceleration.max);
  EXPECT_NEAR(r.tip_jerk.max, jerk, 1e-6 * jerk);
  EXPECT_NEAR(r.joints[1].jerk.max, jerk, 1e-6 * jerk);
  EXPECT_EQ(r.joints[0].jerk.max, 0.0);
  EXPECT_NEAR(r.feed.max, r.tip_velocity.max / 0.06, 1e-12);
  EXPECT_LT(r.tip_error_m.max, 1e-16);
  EXPECT_EQ(r.axis_velocity.max, 0.0);
  EXPECT_NEAR(r.joints[1].position.max, length - 1.0, 1e-15);
  EXPECT_LT(r.pose_error.max, 1e-15);
  EXPECT_TRUE(r.worst_violations.empty());
}

// What stands before the first and after the last sample: a trajectory cut out of a motion jumps from and to rest.
TEST(Checker, CountsDifferencesAcrossTheEnds) {
  Fixture f;
  f.move({0.01, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.2);
  std::vector<Sample> samples;
  for (int i = 0; i <= 200; ++i)
    samples.push_back(f.sample(i * 1e-3, program::between(f.program.start, f.program.blocks[0].end, i / 200.0), 0));
  const CheckResult r = f.check(samples);
  EXPECT_NEAR(r.tip_acceleration.max, 0.05 / 1e-3, 1e-6);
  EXPECT_EQ(r.tip_acceleration.violations, 2U);
  EXPECT_NEAR(r.tip_jerk.max, 0.05 / 1e-6, 1.0);
  EXPECT_EQ(r.tip_velocity.violations, 0U);
  ASSERT_EQ(r.worst_violations.size(), 2U);  // orders 2 and 3 of block 0
  EXPECT_NEAR(std::max(r.worst_violations[0].ratio, r.worst_violations[1].ratio), 0.05 / 1e-6 / 20.0, 5.0);
}

// Around a circle of radius R at speed v: no rate of the speed but that of running in and out, the jerk's projection is
// v³/R², and the joints feel v²/R.
TEST(Checker, ACircleAtConstantSpeedHasNoTangentialRate) {
  Fixture f;
  const double radius = 0.02, speed = 0.05, pi = std::numbers::pi, ramp = 2.0, turn = 2.0 * pi * radius;
  const std::size_t blocks = 1200;
  const auto at = [&](double way) {
    return Vector3d(radius * std::sin(way / radius), radius - radius * std::cos(way / radius), 0.0);
  };
  const double length = 3.0 * turn, each = length / static_cast<double>(blocks);
  for (std::size_t i = 1; i <= blocks; ++i) {
    f.move(at(each * static_cast<double>(i)), {0.0, 0.0, 1.0}, (at(each) - at(0.0)).norm() / speed);
  }
  const auto ran_in = [&](double t) {  // speed rises as 3 s² − 2 s³
    const double s = std::clamp(t / ramp, 0.0, 1.0);
    return speed * (ramp * (s * s * s - 0.5 * s * s * s * s) + std::max(0.0, t - ramp));
  };
  const double whole = length / speed + ramp;
  std::vector<Sample> samples;
  for (double t = 0.0; t < whole + 1e-3; t += 1e-3) {
    const double way = t < 0.5 * whole ? ran_in(t) : length - ran_in(std::max(0.0, whole - t));
    const auto block = std::min(blocks - 1, static_cast<std::size_t>(way / each));
    samples.push_back(f.sample(static_cast<double>(samples.size()) * 1e-3, {.tip_m = at(way)}, block));
  }
  const CheckResult r = f.check(samples);
  EXPECT_EQ(r.violations(), 0U);
  EXPECT_NEAR(r.tip_velocity.max, speed, 1e-5 * speed);
  EXPECT_NEAR(r.tip_acceleration.max, 1.5 * speed / ramp, 0.01 * speed / ramp);
  EXPECT_NEAR(r.joints[0].acceleration.max, speed * speed / radius, 1e-4);
  const double braking = 6.0 * speed / (ramp * ramp);  // of the speed where the run begins to slow down
  EXPECT_NEAR(r.tip_jerk.max, std::pow(speed, 3) / (radius * radius) + braking, 0.001);
  const double sagitta = each * each / (8.0 * radius);
  EXPECT_NEAR(r.tip_error_m.max, sagitta, 0.02 * sagitta);
}

// On a reversal the speed falls to nothing and rises again: its rate is the acceleration, not twice it.
TEST(Checker, AReversalIsNoJump) {
  Fixture f;
  f.move({0.01, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.2).move({0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0.2);
  const CheckResult r = f.check(f.stop_and_go({0.4, 0.4}));
  const double jerk = 32.0 * 0.01 / std::pow(0.4, 3);
  EXPECT_EQ(r.violations(), 0U);
  EXPECT_NEAR(r.tip_acceleration.max, jerk * 0.1, 0.01 * jerk * 0.1);
  EXPECT_NEAR(r.tip_jerk.max, jerk, 1e-6 * jerk);
  EXPECT_NEAR(r.joints[0].jerk.max, jerk, 1e-6 * jerk);
  EXPECT_LT(r.tip_error_m.max, 1e-15);
}

// Two moves of tip and axis, the second one faster: whatever is too small is broken there and nothing else.
class CheckerLimit : public ::testing::Test {
 protected:
  CheckerLimit() {
    f.move({0.01, 0.002, 0.0}, {0.02, 0.0, 1.0}, 0.45).move({0.0, 0.004, 0.003}, {0.04, -0.03, 1.0}, 0.3);
    samples = f.stop_and_go({1.0, 0.6});
    good = f.check(samples);
  }
  // Lowers one limit to a `1/1.25` of what was met.
  void expect(double& limit, const Usage CheckResult::*usage, int order, SmoothingOptions& o) {
    limit = (good.*usage).max / 1.25;
    const CheckResult r = f.check(samples, o);
    EXPECT_NEAR((r.*usage).max, 1.25 * (r.*usage).limit, 1e-9);
    EXPECT_GT((r.*usage).violations, 0U);
    EXPECT_EQ(r.violations(), (r.*usage).violations);
    EXPECT_EQ((r.*usage).block, 1U);
    ASSERT_EQ(r.worst_violations.size(), 1U);
    EXPECT_EQ(r.worst_violations[0].block, 1U);
    EXPECT_EQ(r.worst_violations[0].order, order);
    EXPECT_NEAR(r.worst_violations[0].ratio, 1.25, 1e-9);
    EXPECT_EQ(r.worst_violations[0].time_s, (r.*usage).at_s);
    EXPECT_GT(r.worst_violations[0].time_s, 0.999);
  }
  Fixture f;
  std::vector<Sample> samples;
  CheckResult good;
};

TEST_F(CheckerLimit, IsKeptByTheMotionItself) {
  EXPECT_EQ(good.violations(), 0U);
}

TEST_F(CheckerLimit, OfTipAndAxisIsWatched) {
  SmoothingOptions o = options();
  expect(o.max_velocity_m_per_s, &CheckResult::tip_velocity, 1, o);
  o = options();
  expect(o.max_acceleration_m_per_s2, &CheckResult::tip_acceleration, 2, o);
  o = options();
  expect(o.max_jerk_m_per_s3, &CheckResult::tip_jerk, 3, o);
  o = options();
  expect(o.max_angular_velocity_rad_per_s, &CheckResult::axis_velocity, 1, o);
  o = options();
  expect(o.max_angular_acceleration_rad_per_s2, &CheckResult::axis_acceleration, 2, o);
  o = options();
  expect(o.max_angular_jerk_rad_per_s3, &CheckResult::axis_jerk, 3, o);
}

TEST_F(CheckerLimit, OfEachJointIsWatched) {
  for (int j = 0; j < 5; ++j) {
    for (int order = 1; order <= 3; ++order) {
      const auto usage = [order](const CheckResult::Joint& joint) {
        return order == 1 ? joint.velocity : order == 2 ? joint.acceleration : joint.jerk;
      };
      const Usage met = usage(good.joints[static_cast<std::size_t>(j)]);
      robot::JointLimits limits = test::tilt_head_limits();
      (order == 1 ? limits.max_velocity : order == 2 ? limits.max_acceleration : limits.max_jerk)[j] = met.max / 1.25;
      const test::TiltHead machine(limits);
      program::ProgramSource source(f.program);
      Checker checker(source, machine, options());
      checker.add(samples);
      const CheckResult r = checker.finish();
      const Usage broken = usage(r.joints[static_cast<std::size_t>(j)]);
      EXPECT_GT(broken.violations, 0U);
      EXPECT_EQ(r.violations(), broken.violations);
      const auto worst = std::max_element(r.worst_violations.begin(), r.worst_violations.end(),
                                          [](const Violation& a, const Violation& b) { return a.ratio < b.ratio; });
      ASSERT_NE(worst, r.worst_violations.end());
      EXPECT_EQ(worst->order, order);
      EXPECT_EQ(worst->block, broken.block);
      EXPECT_EQ(worst->time_s, broken.at_s);
      EXPECT_NEAR(worst->ratio, 1.25, 1e-9);
    }
  }
}

TEST_F(CheckerLimit, OfAJointsPositionIsWatched) {
  robot::JointLimits limits = test::tilt_head_limits();
  limits.max_position[0] = 0.008;
  const test::TiltHead machine(limits);
  program::ProgramSource source(f.program);
  Checker checker(source, machine, options());
  checker.add(samples);
  const CheckResult r = checker.finish();
  double most = 0.0;
  for (const Sample& sample : samples) most = std::max(most, sample.joints[0]);
  EXPECT_NEAR(r.joints[0].position.max, most - 0.008, 1e-15);
  EXPECT_EQ(r.violations(), r.joints[0].position.violations);
  ASSERT_FALSE(r.worst_violations.empty());
  EXPECT_EQ(r.worst_violations[0].order, -1);
}

TEST_F(CheckerLimit, OfTheFeedIsWatched) {
  f.program.blocks[1].duration_s *= 1.25 / good.feed.max;  // block 1 is the faster one against its feed
  const CheckResult r = f.check(samples);
  EXPECT_NEAR(r.feed.max, 1.25, 1e-9);
  EXPECT_EQ(r.violations(), r.feed.violations);
  ASSERT_EQ(r.worst_violations.size(), 1U);
  EXPECT_EQ(r.worst_violations[0].block, 1U);
  EXPECT_EQ(r.worst_violations[0].order, 1);
  EXPECT_NEAR(r.worst_violations[0].ratio, 1.25, 1e-9);
  f.program.blocks[1].kind = Block::Kind::rapid;  // has no feed
  f.program.blocks[1].duration_s = 0.0;
  EXPECT_EQ(f.check(samples).violations(), 0U);
}

// A block that stands for a curve counts as far from it as it may leave it; the corners lie on the curve.
TEST(Checker, CountsWhatABlockLeavesOfItsCurve) {
  Fixture f;
  f.move({0.01, 0.002, 0.0}, {0.02, 0.0, 1.0}, 0.45);
  const std::vector<Sample> samples = f.stop_and_go({1.0});
  Block& block = f.program.blocks[0];
  block.tip_deviation_m = 0.6 * options().tip_tolerance_m;
  block.axis_deviation_rad = 0.7 * options().axis_tolerance_rad;
  const CheckResult good = f.check(samples);
  EXPECT_EQ(good.violations(), 0U);
  EXPECT_NEAR(good.tip_error_m.max, block.tip_deviation_m, 1e-12);
  EXPECT_NEAR(good.axis_error_rad.max, block.axis_deviation_rad, 1e-12);
  block.tip_deviation_m = 1.2 * options().tip_tolerance_m;
  EXPECT_GT(f.check(samples).tip_error_m.violations, 0U);
  block.tip_deviation_m = 0.0;
  block.axis_deviation_rad = 1.2 * options().axis_tolerance_rad;
  EXPECT_GT(f.check(samples).axis_error_rad.violations, 0U);
}

// Where the axis alone moves its programmed angular speed is the feed.
TEST(Checker, HoldsAPureRotationToItsAngularFeed) {
  Fixture f;
  f.move({0.0, 0.0, 0.0}, {0.1, 0.0, 1.0}, 0.5);
  const double angle = std::atan(0.1);
  std::vector<Sample> samples = f.stop_and_go({1.0});
  const CheckResult good = f.check(samples);
  EXPECT_NEAR(good.feed.max, 2.0 * angle / (angle / 0.5), 1e-3);  // the quarters reach twice the mean speed
  EXPECT_EQ(good.feed.violations + 0U, good.violations());
  f.program.blocks[0].duration_s = 0.6;
  EXPECT_NEAR(f.check(samples).feed.max, 1.2 * good.feed.max, 1e-9);
}

TEST(Checker, RejectsOptionsThatMakeNoSense) {
  Fixture f;
  program::ProgramSource source(f.program);
  const auto field = [&](const SmoothingOptions& o, const CheckOptions& c) {
    return robomill::test::field_of([&] { const Checker checker(source, f.machine, o, c); });
  };
  SmoothingOptions o = options();
  o.max_jerk_m_per_s3 = 0.0;
  EXPECT_EQ(field(o, {}), "max_jerk_m_per_s3");
  EXPECT_EQ(field(options(), {.relative_tolerance = -1.0}), "relative_tolerance");
  EXPECT_EQ(field(options(), {.max_pose_error = 0.0}), "max_pose_error");
}

}  // namespace check_test
}  // namespace robomill::path
