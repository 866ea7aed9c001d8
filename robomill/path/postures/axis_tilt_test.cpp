#include "robomill/path/postures/axis_tilt.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/path/posture.hpp"
#include "robomill/robot/serial_kinematics.hpp"
#include "testing/robot/arms.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace axis_tilt_test {

using robomill::test::rejection;
namespace arms = robot::testing;

constexpr double way_m = 0.15, aside_m = 0.02;

/// The tool in line with the flange, drives as a large arm has them.
robot::Cell in_line_cell() {
  robot::Cell out{.arm = arms::with_limits(arms::kr210()), .tool_length_m = 0.25};
  out.workpiece = Eigen::Translation3d(1.6, 0.0, 1.6) * Eigen::AngleAxisd(-arms::pi / 2.0, Eigen::Vector3d::UnitY());
  for (robot::Joint& joint : out.arm.joints) {
    joint.max_velocity = 2.0;
    joint.max_acceleration = 8.0;
    joint.max_jerk = 80.0;
  }
  return out;
}

SmoothingOptions smoothing() {
  SmoothingOptions out;
  out.tip_tolerance_m = 5e-5;
  out.axis_tolerance_rad = 0.1 * units::deg;
  out.max_velocity_m_per_s = 0.08;
  out.max_acceleration_m_per_s2 = 0.5;
  out.max_jerk_m_per_s3 = 10.0;
  out.max_angular_velocity_rad_per_s = 1.0;
  out.max_angular_acceleration_rad_per_s2 = 10.0;
  out.max_angular_jerk_rad_per_s3 = 200.0;
  out.sample_period_s = 4e-3;
  return out;
}

/// A machine before a straight move across the line of axis 4, `beside_m` from it.
struct Crossed {
  robot::SerialKinematics machine{in_line_cell()};
  robot::SerialKinematics beside{in_line_cell(), {.singularity = {.max_condition_number = 1e5}}};
  robot::Position6 middle = arms::kr210_posture();
  program::Program program = {};
  PostureOptions options = {};

  explicit Crossed(double beside_m = 0.0) {
    middle(0) = middle(3) = middle(4) = middle(5) = 0.0;
    const robot::ToolPose at = machine.forward(middle);
    const Eigen::Matrix3d to_w = machine.cell().workpiece.linear().transpose();
    const Eigen::Vector3d across = to_w * Eigen::Vector3d::UnitY();
    const Eigen::Vector3d up = beside_m * (to_w * Eigen::Vector3d::UnitZ());
    const auto pose = [&](double share) {
      return program::Pose{.tip_m = at.tip_m + up + share * way_m * across, .axis = at.axis};
    };
    program.start = pose(-1.0);
    program.blocks = {{.line = 3, .end = pose(0.2), .duration_s = 1.2 * way_m / 0.03},
                      {.line = 4, .end = pose(1.0), .duration_s = 0.8 * way_m / 0.03}};
    options = {.gamma_rad = at.gamma_rad, .start = middle};
  }
  [[nodiscard]] PostureChoice choose(double tilt_rad) {
    program::ProgramSource source(program);
    if (tilt_rad > 0.0) options.beside = &beside;
    options.max_axis_tilt_rad = tilt_rad;
    return choose_posture(source, machine, options);
  }
};

TEST(AxisTilt, PassesASingularityOfTheWristWithinTheToleranceAndBreaksNoLimit) {
  Crossed crossed;
  const std::string said = rejection([&] { (void)crossed.choose(0.0); });
  EXPECT_EQ(said.substr(0, 40), "block 1 (line 3): leads through a singul") << said;

  const SmoothingOptions options = smoothing();
  const double tilt_rad = 0.6 * options.axis_tolerance_rad;
  const PostureChoice choice = crossed.choose(tilt_rad);
  ASSERT_EQ(choice.posture.tilts.size(), 1U);
  EXPECT_DOUBLE_EQ(choice.posture.tilts.front().angle_rad, tilt_rad);
  program::ProgramSource source(crossed.program);
  std::vector<Sample> samples;
  const Summary summary = smooth(
      source, crossed.beside, choice.posture, options,
      [&](std::span<const Sample> some) { samples.insert(samples.end(), some.begin(), some.end()); },
      [&] { samples.clear(); }, Progress::none());
  EXPECT_EQ(summary.check.violations(), 0U);
  // Independent of planner and check: the positions' own tool, by the forward kinematics.
  double largest = 0.0, low = HUGE_VAL, high = -HUGE_VAL;
  for (const Sample& sample : samples) {
    const robot::ToolPose is = crossed.machine.forward(sample.joints);
    largest = std::max(largest, program::angle_between(is.axis, crossed.program.start.axis));
    low = std::min(low, sample.joints(3));
    high = std::max(high, sample.joints(3));
  }
  EXPECT_GT(largest, 0.9 * tilt_rad);
  EXPECT_LE(largest, options.axis_tolerance_rad);
  // Joint 4 turns by what is left of half a turn at the ends of the move.
  EXPECT_GT(high - low, 150.0 * units::deg);
  EXPECT_LT(high - low, 200.0 * units::deg);
  EXPECT_LT((samples.back().tip_m - crossed.program.blocks.back().end.tip_m).norm(), 1e-9);
  EXPECT_LT(program::angle_between(samples.back().axis, crossed.program.start.axis), 1e-9);
}

// The larger bound alone is enough where the program itself passes far enough beside.
TEST(AxisTilt, TiltsNothingWhereTheProgramPassesBesideByItself) {
  Crossed crossed(aside_m);
  const PostureChoice choice = crossed.choose(1e-3);
  EXPECT_TRUE(choice.posture.tilts.empty());
  EXPECT_EQ(choice.posture.gamma_rad.size(), 1U);
}

TEST(AxisTilt, RejectsWhatBeginsInTheSingularity) {
  Crossed crossed;
  crossed.program.start = program::between(crossed.program.start, crossed.program.blocks.front().end, 1.0 / 1.2);
  EXPECT_NE(rejection([&] { (void)crossed.choose(1e-3); }).find("singular"), std::string::npos);
}

// The parts of a block join, end where the block ends, and are tilted by what the trapezoid says.
TEST(AxisTilt, CutsBlocksWhereTheTiltChanges) {
  const std::vector<AxisTilt> tilts = {{.from = 0.25, .full_from = 0.5, .full_to = 1.5, .to = 1.75, .angle_rad = 0.01}};
  const program::Pose from, to{.tip_m = {1.0, 0.0, 0.0}};
  const std::vector<TiltedPart> first = tilted_parts(tilts, 0, from, to), second = tilted_parts(tilts, 1, from, to),
                                third = tilted_parts(tilts, 2, from, to);
  const auto tilts_of = [&](const std::vector<TiltedPart>& parts) {
    std::vector<double> out;
    for (const TiltedPart& part : parts) out.push_back(program::angle_between(part.end.axis, from.axis));
    return out;
  };
  ASSERT_EQ(first.size(), 3U);
  ASSERT_EQ(second.size(), 3U);
  ASSERT_EQ(third.size(), 1U);
  const std::vector<double> of_first = tilts_of(first), of_second = tilts_of(second);
  const double expected[] = {0.0, 0.01, 0.01, 0.01, 0.0, 0.0};
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(of_first[k], expected[k], 1e-15);
    EXPECT_NEAR(of_second[k], expected[k + 3], 1e-15);
    EXPECT_NEAR(first[k].end.tip_m.x(), first[k].share, 1e-15);
  }
  EXPECT_EQ(tilt_within(tilts, 0), 0.01);
  EXPECT_EQ(tilt_within(tilts, 2), 0.0);
}

}  // namespace axis_tilt_test
}  // namespace robomill::path
