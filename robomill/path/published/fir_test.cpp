#include "robomill/path/published/fir.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/path/check.hpp"
#include "robomill/robot/hybrid.hpp"
#include "testing/path/machine.hpp"
#include "testing/path/s_path.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace fir_test {

using Eigen::Vector3d;
using program::Block;
using program::Program;
using test::degree;
using test::published_options;

constexpr double s_acceleration = 0.4, s_jerk = 8.0;  // of the joints on the S-shaped path

struct Smoothed {
  FirPlan plan;
  CheckResult check;
  std::vector<Sample> samples;
};

Smoothed run(const Program& program, const robot::Kinematics& machine, const SmoothingOptions& options,
             const Posture& posture = {}) {
  Smoothed out;
  out.plan = plan_fir(program, machine, posture, options);
  program::ProgramSource source(program);
  Checker checker(source, machine, options);
  const std::size_t sent =
      sample_fir(out.plan, program, machine, posture, options.sample_period_s, [&](std::span<const Sample> samples) {
        checker.add(samples);
        out.samples.insert(out.samples.end(), samples.begin(), samples.end());
      });
  EXPECT_EQ(sent, out.samples.size());
  out.check = checker.finish();
  return out;
}

Posture start_of(const Program& program, const robot::Kinematics& machine) {
  Posture posture;
  EXPECT_EQ(machine
                .follow(robot::ToolPose{.tip_m = program.start.tip_m, .axis = program.start.axis},
                        robot::Position6::Zero(), posture.start)
                .status,
            robot::Reach::Status::found);
  return posture;
}

Smoothed run_s(Method method) {
  const robot::HybridKinematics machine(test::s_machine(s_acceleration, s_jerk));
  const Program program = test::s_path();
  return run(program, machine, published_options(method), start_of(program, machine));
}

double joint_jerk_share(const CheckResult& check) {
  double most = 0.0;
  for (const CheckResult::Joint& joint : check.joints) most = std::max(most, joint.jerk.max / joint.jerk.limit);
  return most;
}

double joint_acceleration_share(const CheckResult& check) {
  double most = 0.0;
  for (const CheckResult::Joint& joint : check.joints) {
    most = std::max(most, joint.acceleration.max / joint.acceleration.limit);
  }
  return most;
}

/// A machine whose joints object to nothing.
test::TiltHead free_machine() {
  robot::JointLimits limits = test::tilt_head_limits();
  limits.max_velocity.setConstant(1e3);
  limits.max_acceleration.setConstant(1e4);
  limits.max_jerk.setConstant(1e6);
  return test::TiltHead(limits);
}

Program straight(double length_m, int blocks = 1) {
  Program program;
  for (int i = 1; i <= blocks; ++i)
    program.blocks.push_back({.line = static_cast<std::size_t>(i),
                              .end = {.tip_m = {length_m * i, 0.0, 0.0}},
                              .duration_s = length_m / 0.05});
  return program;
}

TEST(Fir, OneBlockTakesItsConstants) {
  const test::TiltHead machine = free_machine();
  for (int filters = 1; filters <= 3; ++filters) {
    SmoothingOptions options = published_options(Method::paper);
    options.filters = filters;
    const Smoothed r = run(straight(0.03), machine, options);
    const double expected = 0.6 + 0.1 + (filters > 1 ? 0.05 : 0.0) + (filters > 2 ? 0.025 : 0.0);
    EXPECT_NEAR(r.plan.duration_s, expected, 1e-12);
    EXPECT_NEAR(r.plan.sum_t2_s, 0.1, 1e-15);
    EXPECT_NEAR(r.check.tip_velocity.max, 0.05, 1e-12);
    EXPECT_NEAR(r.check.tip_acceleration.max, 0.5, 1e-9);
    if (filters > 1) {
      EXPECT_NEAR(r.check.tip_jerk.max, 10.0, 1e-4);
    }
    EXPECT_EQ(r.check.violations(), filters > 1 ? 0U : r.check.tip_jerk.violations);
  }
}

// A straight line in blocks flows: the pulses stand in a row.
TEST(Fir, GoingStraightOnDoesNotSlowDown) {
  const Smoothed r = run(straight(0.005, 8), free_machine(), published_options(Method::paper));
  EXPECT_NEAR(r.plan.duration_s, 0.04 / 0.05 + 0.15, 1e-9);
  EXPECT_EQ(r.check.violations(), 0U);
  EXPECT_NEAR(r.check.synchrony_rad.max, 0.0, 1e-15);
}

TEST(Fir, TheTrajectoryIsExactlyDifferentiable) {
  const Program program = test::s_path();
  const robot::HybridKinematics machine(test::s_machine(s_acceleration, s_jerk));
  SmoothingOptions options = published_options(Method::paper);
  options.filters = 3;
  options.tip_tolerance_m = options.axis_tolerance_rad = 1e-3;  // long overlaps
  Posture posture;
  for (int i = 0; i <= 16; ++i) posture.gamma_rad.push_back(0.1 * std::sin(i));
  const FirPlan plan = plan_fir(program, machine, posture, options);
  Random random(11);
  for (int round = 0; round < 300; ++round) {
    const double t = random.uniform(0.0, plan.duration_s), e = 1e-4;
    const robot::ToolJet before = plan.trajectory.at(t - e), here = plan.trajectory.at(t),
                         after = plan.trajectory.at(t + e);
    EXPECT_NEAR(here.axis.col(0).norm(), 1.0, 1e-14);
    for (int k = 0; k < 3; ++k) {
      // The fourth derivative is at most the jerk over its shortest filter.
      const double near = 1e-3 * std::pow(10.0, k);
      EXPECT_LT(((after.tip_m.col(k) - before.tip_m.col(k)) / (2.0 * e) - here.tip_m.col(k + 1)).norm(), near) << k;
      EXPECT_LT(((after.axis.col(k) - before.axis.col(k)) / (2.0 * e) - here.axis.col(k + 1)).norm(), 5.0 * near) << k;
      EXPECT_LT(std::abs((after.gamma_rad[k] - before.gamma_rad[k]) / (2.0 * e) - here.gamma_rad[k + 1]), 5.0 * near)
          << k;
    }
  }
  EXPECT_EQ(plan.trajectory.at(-1.0).tip_m.col(0), program.start.tip_m);
  EXPECT_EQ(plan.trajectory.at(-1.0).tip_m.rightCols<3>().norm(), 0.0);
  EXPECT_LT((plan.trajectory.at(plan.duration_s).axis.col(0) - program.blocks.back().end.axis).norm(), 1e-15);
  EXPECT_LT((plan.trajectory.at(plan.duration_s - 1e-9).axis.col(0) - program.blocks.back().end.axis).norm(), 1e-13);
  EXPECT_NEAR(plan.trajectory.at(plan.duration_s - 1e-9).gamma_rad[0], posture.gamma_rad.back(), 1e-13);
}

// The published limits and tolerances on a path of our own, with joint limits of our own: test_s_path.hpp. On its path
// the source has 13.215 s with the joint jerk step against 13.169 s without, and T2 (its sum, as we read it) of 2.355 s
// against 2.370 s.
TEST(Fir, ComparesMethodsOnTheSShapedPath) {
  const Smoothed earlier = run_s(Method::no_joint_jerk), paper = run_s(Method::paper),
                 printed = run_s(Method::paper_as_printed);
  for (const Smoothed* r : {&earlier, &paper, &printed}) {
    RecordProperty("duration_s", std::to_string(r->plan.duration_s));
    EXPECT_EQ(r->check.feed.violations, 0U);
    EXPECT_EQ(r->check.tip_velocity.violations, 0U);
    EXPECT_EQ(r->check.pose_error.violations, 0U);
  }
  EXPECT_NEAR(earlier.plan.duration_s, 12.224, 0.001);
  EXPECT_NEAR(paper.plan.duration_s, 12.671, 0.001);
  EXPECT_LT(paper.plan.duration_s, 1.05 * earlier.plan.duration_s);
  // The signed step needs shorter filters than |q''|.
  EXPECT_NEAR(earlier.plan.sum_t2_s, 2.346, 0.001);
  EXPECT_NEAR(paper.plan.sum_t2_s, 2.335, 0.001);
  // Without the joint jerk step neighbours double their jerk; with half the limit they are within it.
  EXPECT_NEAR(joint_jerk_share(earlier.check), 1.996, 0.01);
  EXPECT_NEAR(joint_jerk_share(paper.check), 0.996, 0.01);
  for (const CheckResult::Joint& joint : paper.check.joints) {
    EXPECT_EQ(joint.velocity.violations + joint.acceleration.violations + joint.jerk.violations, 0U);
  }
  for (const Smoothed* r : {&earlier, &paper}) {
    EXPECT_EQ(r->check.tip_error_m.violations + r->check.axis_error_rad.violations, 0U);
    // What tip and axis share keeps them together.
    EXPECT_LT(r->check.synchrony_rad.max, 0.01 * degree);
  }
  // As printed the axis keeps its own short filters: the joints' step bounds nothing, and tip and axis drift apart.
  EXPECT_NEAR(joint_jerk_share(printed.check), 3.95, 0.05);
  EXPECT_NEAR(joint_acceleration_share(printed.check), 2.20, 0.02);
  EXPECT_NEAR(printed.check.synchrony_rad.max, 0.586 * degree, 0.01 * degree);
  EXPECT_GT(printed.plan.duration_s, paper.plan.duration_s);
  // Where neighbours overlap the tool's own jerk nearly doubles, in each of them.
  for (const Smoothed* r : {&earlier, &paper, &printed})
    EXPECT_GT(r->check.tip_jerk.max, 1.6 * r->check.tip_jerk.limit);
}

// Tolerance 0.02 mm: 0.0231 mm as printed, on a reversal.
TEST(Fir, AsPrintedAReversalIsCutBeyondItsTolerance) {
  Program program = straight(0.03);
  program.blocks.push_back({.line = 2, .end = {}, .duration_s = 0.6});
  const test::TiltHead machine = free_machine();
  EXPECT_NEAR(run(program, machine, published_options(Method::paper_as_printed)).check.tip_error_m.max, 0.0231e-3,
              1e-7);
  const CheckResult paper = run(program, machine, published_options(Method::paper)).check;
  EXPECT_LE(paper.tip_error_m.max, 2e-5);
  EXPECT_GT(paper.tip_error_m.max, 1.95e-5);
}

// Half the joints' limit is for two neighbours; the tool's own limits have no such half. At a slight corner the end of
// one block and the beginning of the next one jerk the same way, and on a reversal one brakes as the other speeds up.
TEST(Fir, AnOverlapDoublesJerkAndAcceleration) {
  const test::TiltHead machine = free_machine();
  SmoothingOptions options = published_options(Method::paper);
  Program slight = straight(0.03);
  slight.blocks.push_back(
      {.line = 2, .end = {.tip_m = {0.03 + 0.03 * std::cos(0.2), 0.03 * std::sin(0.2), 0.0}}, .duration_s = 0.6});
  const CheckResult jerk = run(slight, machine, options).check;
  EXPECT_NEAR(jerk.tip_jerk.max, 20.0, 0.2);
  EXPECT_LT(jerk.tip_acceleration.max, 0.5001);
  Program reversal = straight(0.03);
  reversal.blocks.push_back({.line = 2, .end = {}, .duration_s = 0.6});
  options.tip_tolerance_m = 2e-3;
  const CheckResult acceleration = run(reversal, machine, options).check;
  EXPECT_NEAR(acceleration.joints[0].acceleration.max, 1.0, 0.01);
  EXPECT_NEAR(acceleration.tip_acceleration.max, 1.0, 0.01);
}

// T1 is taken for the longest constant: where it is not, by T3, braking begins while speeding up ends.
TEST(Fir, AShortPulseDoublesTheJerk) {
  const CheckResult check = run(straight(0.006), free_machine(), published_options(Method::paper)).check;
  EXPECT_NEAR(check.tip_jerk.max, 20.0, 1e-3);
  EXPECT_LE(check.tip_acceleration.max, 0.5 + 1e-9);
}

// arccos |O·O'| takes 120° for 60°, so that the axis runs twice as fast as it may.
TEST(Fir, AsPrintedAWideTurnIsTimedByItsSupplement) {
  Program program;
  program.start.axis = {std::sin(-60.0 * degree), 0.0, std::cos(60.0 * degree)};
  program.blocks.push_back(
      {.line = 1, .end = {.axis = {std::sin(60.0 * degree), 0.0, std::cos(60.0 * degree)}}, .duration_s = 1.0});
  const test::TiltHead machine = free_machine();
  const CheckResult printed = run(program, machine, published_options(Method::paper_as_printed)).check;
  EXPECT_NEAR(printed.axis_velocity.max / printed.axis_velocity.limit, 2.0, 1e-6);
  const CheckResult paper = run(program, machine, published_options(Method::paper)).check;
  EXPECT_NEAR(paper.axis_velocity.max / paper.axis_velocity.limit, 1.0, 1e-6);
  EXPECT_EQ(paper.violations(), 0U);
}

// A turn of the head carries its pivot round: r ω² is beyond the slides' acceleration whatever T2 is. The absolute
// value as printed finds a T2 all the same.
TEST(Fir, AsPrintedAnAccelerationThatNoT2CorrectsIsHidden) {
  Program program;
  program.start.axis = {std::sin(0.5), 0.0, std::cos(0.5)};
  program.blocks.push_back(
      {.line = 1, .end = {.tip_m = {0.0, 0.002, 0.0}, .axis = {std::sin(1.0), 0.0, std::cos(1.0)}}, .duration_s = 0.1});
  robot::JointLimits limits = test::tilt_head_limits();
  limits.max_velocity.setConstant(1e3);
  limits.max_jerk.setConstant(1e6);
  limits.max_acceleration << 0.5, 0.5, 0.5, 100.0, 100.0, 0.0;
  const test::TiltHead machine(limits);
  SmoothingOptions options = published_options(Method::paper_as_printed);
  options.max_angular_velocity_rad_per_s = 10.0;
  options.max_angular_acceleration_rad_per_s2 = options.max_angular_jerk_rad_per_s3 = 1e4;
  options.max_velocity_m_per_s = 0.04;
  EXPECT_GT(joint_acceleration_share(run(program, machine, options).check), 1.3);
  for (const Method method : {Method::paper, Method::no_joint_jerk}) {
    options.method = method;
    EXPECT_LE(joint_acceleration_share(run(program, machine, options).check), 1.0 + 1e-9);
  }
}

TEST(Fir, DwellsStandAndBlocksWithoutMotionTakeNoTime) {
  Program program;
  const Vector3d there(0.01, 0.0, 0.0), further(0.01, 0.01, 0.0);
  program.blocks.push_back({.line = 1, .end = {.tip_m = there}, .duration_s = 0.2});
  program.blocks.push_back({.kind = Block::Kind::dwell, .line = 2, .end = {.tip_m = there}, .duration_s = 0.5});
  program.blocks.push_back({.line = 3, .end = {.tip_m = further}, .duration_s = 0.2});
  program.blocks.push_back({.line = 4, .end = {.tip_m = further}, .duration_s = 0.2});
  program.blocks.push_back(
      {.kind = Block::Kind::rapid, .line = 5, .end = {.axis = Vector3d(0.0, 0.1, 1.0).normalized()}});
  const Smoothed r = run(program, free_machine(), published_options(Method::no_joint_jerk));
  EXPECT_EQ(r.check.dwell_s.violations, 0U);
  EXPECT_EQ(r.check.tip_error_m.violations + r.check.axis_error_rad.violations + r.check.feed.violations, 0U);
  EXPECT_EQ(r.check.faulty, 0U);
  const auto& blocks = r.plan.trajectory.blocks();
  EXPECT_NEAR(blocks[1].end_s - blocks[1].start_s, 0.5, 1e-12);
  EXPECT_EQ(blocks[0].overlap_s, 0.0);
  EXPECT_GT(blocks[2].overlap_s, 0.01);  // with the one after the block that does nothing
  EXPECT_EQ(r.plan.trajectory.block_at(blocks[1].start_s + 0.1), 1U);
  for (const Sample& sample : r.samples) EXPECT_NE(sample.block, 3U);
  const Program none;
  EXPECT_EQ(plan_fir(none, free_machine(), {}, published_options(Method::paper)).duration_s, 0.0);
  EXPECT_EQ(run(none, free_machine(), published_options(Method::paper)).samples.size(), 1U);
}

// Each block alone, bent ways of the joints included: velocity, acceleration with and without its sign, and half the
// jerk. Half of it no longer where the pulse is not the longest by enough: braking begins while speeding up ends.
TEST(Fir, OneBlockAloneKeepsTheJointsWithinTheirLimits) {
  const int seeds = robomill::test::seeds(200);
  double acceleration = 0.0, jerk = 0.0;
  for (int seed = 0; seed < seeds; ++seed) {
    Random random(2, static_cast<std::uint64_t>(seed));
    const auto axis = [&] { return Vector3d(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), 1.0).normalized(); };
    Program program;
    program.start.axis = axis();
    const Vector3d tip(random.normal(), random.normal(), random.normal());
    program.blocks.push_back({.line = 1, .end = {.tip_m = tip * 0.03, .axis = axis()}, .duration_s = 0.1});
    robot::JointLimits limits = test::tilt_head_limits();
    limits.max_velocity *= 0.1 * std::exp(random.normal());
    limits.max_acceleration *= 0.1 * std::exp(random.normal());
    limits.max_jerk *= 0.1 * std::exp(random.normal());
    const test::TiltHead machine(limits);
    SmoothingOptions options = published_options(Method::paper);
    options.max_angular_velocity_rad_per_s = 3.0;
    options.max_angular_acceleration_rad_per_s2 = 30.0;
    options.max_angular_jerk_rad_per_s3 = 600.0;
    for (const Method method : {Method::paper, Method::no_joint_jerk}) {
      options.method = method;
      const Smoothed smoothed = run(program, machine, options);
      const CheckResult& check = smoothed.check;
      for (const CheckResult::Joint& joint : check.joints) {
        EXPECT_LE(joint.velocity.max, joint.velocity.limit * (1.0 + 1e-3)) << seed;
      }
      EXPECT_LE(joint_acceleration_share(check), 1.0 + 5e-3) << seed;
      acceleration = std::max(acceleration, joint_acceleration_share(check));
      if (method == Method::paper) {
        const Eigen::Vector4d widths = smoothed.plan.trajectory.blocks()[0].tip.width_s;
        const bool longest = widths[0] >= widths[1] + widths[2];
        EXPECT_LE(joint_jerk_share(check), (longest ? 0.5 : 1.0) * (1.0 + 5e-3)) << seed;
        if (longest) jerk = std::max(jerk, joint_jerk_share(check));
      }
    }
  }
  EXPECT_GT(acceleration, 0.9);
  EXPECT_GT(jerk, 0.45);
}

// Along a smooth curve in blocks far shorter than the filters. With V right the pulses flow, but the law counts two
// blocks and many overlap; as printed V takes a straight line for a corner, and the tool all but stops between blocks.
TEST(Fir, DenseProgramsFlowBeyondToleranceOrAllButStop) {
  const auto pose = [](double u) {
    return program::Pose{.tip_m = {0.1 * std::sin(9.0 * u), 0.08 * std::cos(13.0 * u), 0.0},
                         .axis = Vector3d(0.2 * std::sin(1.1 * u), 0.2 * std::cos(0.7 * u), 1.0).normalized()};
  };
  Random random(3);
  Program program;
  program.start = pose(0.0);
  double u = 0.0, length = 0.0;
  for (std::size_t i = 0; i < 3000; ++i) {
    u += 0.75 * random.uniform(1e-4, 1e-3);
    program.blocks.push_back({.line = i + 1, .end = pose(u)});
    const double step = (pose(u).tip_m - program.begin_of(i).tip_m).norm();
    program.blocks.back().duration_s = step / 0.05;
    length += step;
  }
  const robot::HybridKinematics machine(test::s_machine(s_acceleration, s_jerk));
  const Smoothed paper = run(program, machine, published_options(Method::paper), start_of(program, machine));
  EXPECT_NEAR(length / 0.05, 22.65, 0.01);
  EXPECT_NEAR(paper.plan.duration_s, 24.78, 0.01);
  EXPECT_NEAR(paper.check.tip_error_m.max / 2e-5, 7.84, 0.05);
  const FirPlan printed =
      plan_fir(program, machine, start_of(program, machine), published_options(Method::paper_as_printed));
  EXPECT_NEAR(printed.duration_s, 479.3, 0.5);
}

// Long blocks with corners of any angle, reversals and pure rotations: two overlap at a time, and then the tolerances
// and, with half the limit, the joints' jerk hold.
TEST(Fir, LongBlocksKeepTolerancesAndJointJerk) {
  const int seeds = robomill::test::seeds(200);
  double jerk = 0.0;
  for (int seed = 0; seed < seeds; ++seed) {
    Random random(1, static_cast<std::uint64_t>(seed));
    Program program;
    Vector3d tip(0.0, 0.0, 0.0);
    for (int i = 0; i < 12; ++i) {
      const bool turns_only = random.uniform() < 0.15;
      const Vector3d way =
          Vector3d(random.normal(), random.normal(), random.normal()).normalized() * random.uniform(0.02, 0.05);
      if (!turns_only)
        tip += random.uniform() < 0.15 && i > 0
                   ? Vector3d(program.begin_of(static_cast<std::size_t>(i) - 1).tip_m - tip)
                   : way;
      const Vector3d axis(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 1.0);
      program.blocks.push_back({.line = static_cast<std::size_t>(i + 1),
                                .end = {.tip_m = tip, .axis = axis.normalized()},
                                .duration_s = 1.0});
    }
    robot::JointLimits limits = test::tilt_head_limits();
    limits.max_jerk << 6.0, 6.0, 6.0, 20.0, 20.0, 0.0;
    const test::TiltHead machine(limits);
    const Smoothed r = run(program, machine, published_options(Method::paper));
    EXPECT_EQ(r.check.tip_error_m.violations, 0U) << seed << " " << r.check.tip_error_m.max;
    EXPECT_EQ(r.check.axis_error_rad.violations, 0U) << seed << " " << r.check.axis_error_rad.max / degree;
    EXPECT_EQ(r.check.tip_velocity.violations + r.check.axis_velocity.violations, 0U) << seed;
    jerk = std::max(jerk, joint_jerk_share(r.check));
    EXPECT_LE(joint_jerk_share(r.check), 1.0 + 1e-6) << seed;
  }
  EXPECT_GT(jerk, 0.8);
}

TEST(Fir, RejectsWhatItCannotPlan) {
  const test::TiltHead machine(test::tilt_head_limits());
  const Program program = straight(0.03);
  const auto rejection = [&](const Program& p, const SmoothingOptions& o, const Posture& posture) {
    return robomill::test::rejection([&] { (void)plan_fir(p, machine, posture, o); });
  };
  const SmoothingOptions good = published_options(Method::paper);
  EXPECT_NE(rejection(program, published_options(Method::verified), {}).find("method"), std::string::npos);
  SmoothingOptions bad = good;
  bad.tip_tolerance_m = 0.0;
  EXPECT_NE(rejection(program, bad, {}).find("tip_tolerance_m"), std::string::npos);
  Posture posture;
  posture.gamma_rad = {0.0, 0.0, 0.0};
  EXPECT_NE(rejection(program, good, posture).find("gamma_rad"), std::string::npos);
  Program over = program;
  over.blocks.push_back({.line = 7, .end = {.tip_m = {0.03, 0.0, 0.0}, .axis = -Vector3d::UnitZ()}, .duration_s = 1.0});
  EXPECT_NE(rejection(over, good, {}).find("block 2 (line 7): the axis turns by half a circle"), std::string::npos);
  Program far = program;
  far.blocks.push_back({.line = 9, .end = {.tip_m = {1.5, 0.0, 0.0}}, .duration_s = 60.0});
  const std::string message = rejection(far, good, {});
  EXPECT_NE(message.find("block 2 (line 9)"), std::string::npos) << message;
  EXPECT_NE(message.find("joint 1 beyond its limit"), std::string::npos) << message;
}

}  // namespace fir_test
}  // namespace robomill::path
