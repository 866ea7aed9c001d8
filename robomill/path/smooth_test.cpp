#include "robomill/path/smooth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/path/posture.hpp"
#include "robomill/path/speed/planner.hpp"
#include "robomill/robot/hybrid.hpp"
#include "robomill/robot/serial_kinematics.hpp"
#include "testing/path/random_program.hpp"
#include "testing/path/s_path.hpp"
#include "testing/robot/arms.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace smooth_test {

/// A KR210-like arm over a part in front of it; the accelerations and jerks of its joints are chosen.
robot::Cell kr210_cell() {
  robot::Cell cell;
  cell.arm = robot::testing::with_limits(robot::testing::kr210());
  cell.tool_length_m = 0.25;
  cell.workpiece = Eigen::Translation3d(1.5, 0.2, 0.9);
  const double velocity[] = {2.1, 2.0, 1.9, 3.1, 3.0, 3.8}, acceleration[] = {3, 3, 3, 8, 8, 10},
               jerk[] = {60, 60, 60, 200, 200, 250};
  for (std::size_t i = 0; i < 6; ++i) {
    cell.arm.joints[i].max_velocity = velocity[i];
    cell.arm.joints[i].max_acceleration = acceleration[i];
    cell.arm.joints[i].max_jerk = jerk[i];
  }
  return cell;
}

struct Smoothed {
  Summary summary;
  std::vector<Sample> samples;
};

Smoothed smoothed(const program::Program& program, const robot::Kinematics& kinematics, const SmoothingOptions& options,
                  const Posture& posture = {}) {
  program::ProgramSource source(program);
  Smoothed out;
  out.summary = smooth(
      source, kinematics, posture, options,
      [&](std::span<const Sample> some) { out.samples.insert(out.samples.end(), some.begin(), some.end()); },
      [&] { out.samples.clear(); }, Progress::none());
  return out;
}

Posture posture_for(const program::Program& program, const robot::Kinematics& kinematics) {
  program::ProgramSource source(program);
  return choose_posture(source, kinematics).posture;
}

/// The largest share of any joint's jerk limit.
double joint_jerk(const CheckResult& check) {
  double out = 0.0;
  for (const CheckResult::Joint& joint : check.joints) out = std::max(out, joint.jerk.max / joint.jerk.limit);
  return out;
}

/// A random program of 10 to 300 blocks of 0.05 to 50 mm with corners of any angle, reversals, pure rotations, blocks
/// that do not move, and dwells.
program::Program program_of(std::uint64_t seed, double max_lean_rad) {
  Random random(seed);
  const int blocks = static_cast<int>(random.uniform(10.0, 300.0));
  program::Program out = test::random_program(
      random, {.blocks = blocks, .max_lean_rad = max_lean_rad, .feed_m_per_s = random.uniform(0.01, 0.08)});
  for (int i = 0; i < blocks / 20; ++i) {
    const auto at = static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(out.blocks.size())));
    program::Block still = out.blocks[at];
    still.kind = i % 2 == 0 ? program::Block::Kind::dwell : program::Block::Kind::feed;
    still.duration_s = random.uniform(0.0, 0.3);
    out.blocks.insert(out.blocks.begin() + static_cast<std::ptrdiff_t>(at) + 1, still);
  }
  return out;
}

class RandomPrograms : public ::testing::TestWithParam<int> {};

// 1,000 seeds in ten parts, two thirds on the hybrid machine and one third on the arm; every twentieth optimal.
TEST_P(RandomPrograms, BreakNoLimit) {
  const robot::HybridKinematics hybrid(test::s_machine(0.4, 8.0));
  const robot::SerialKinematics arm(kr210_cell());
  const int count = robomill::test::seeds(100);
  for (int i = 0; i < count; ++i) {
    const int seed = 100 * GetParam() + i;
    const bool on_arm = seed % 3 == 0;
    const robot::Kinematics& kinematics = on_arm ? static_cast<const robot::Kinematics&>(arm) : hybrid;
    const program::Program program = program_of(static_cast<std::uint64_t>(seed), on_arm ? 0.5 : 0.4);
    const SmoothingOptions options =
        test::published_options(i % 20 == 0 && program.blocks.size() < 150 ? Method::optimal : Method::verified);
    const Smoothed run = smoothed(program, kinematics, options, posture_for(program, kinematics));
    EXPECT_EQ(run.summary.check.violations(), 0U) << "seed " << seed;
    EXPECT_GT(run.summary.lower_bound_s, 0.0) << "seed " << seed;
    EXPECT_GE(run.summary.duration_s, run.summary.lower_bound_s) << "seed " << seed;
    EXPECT_LT((run.samples.back().tip_m - program.blocks.back().end.tip_m).norm(), 1e-9) << "seed " << seed;
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, RandomPrograms, ::testing::Range(0, 10));

// Under the published limits and tolerances, joints of 0.4 m/s² and 12.8 m/s³ (test_s_path.hpp).
TEST(SPath, PaperCostsLittleVerifiedLessAndNeitherBreaksTheJointsJerk) {
  const robot::HybridKinematics machine(test::s_machine(0.4, 12.8));
  const auto by = [&](Method method) {
    return smoothed(test::s_path(), machine, test::published_options(method)).summary;
  };
  const Summary earlier = by(Method::no_joint_jerk), paper = by(Method::paper), verified = by(Method::verified),
                optimal = by(Method::optimal);
  EXPECT_GT(joint_jerk(earlier.check), 1.2);
  EXPECT_LE(joint_jerk(paper.check), 1.0);
  EXPECT_LT(paper.duration_s, 1.05 * earlier.duration_s);
  EXPECT_EQ(verified.check.violations(), 0U);
  EXPECT_EQ(optimal.check.violations(), 0U);
  EXPECT_LT(verified.duration_s, paper.duration_s);
  EXPECT_LT(optimal.duration_s, verified.duration_s);
  // 9 % here; 7 % with joints of 20 m/s³: the bound knows no jerk, and fifteen corners ask for it.
  EXPECT_LT(optimal.duration_s, 1.10 * optimal.lower_bound_s);
}

// What a block leaves of the curve that it stands for is not used a second time: the samples stay nearer to the blocks.
TEST(SPath, LeavesRoomForWhatBlocksLeaveOfTheirCurves) {
  const robot::HybridKinematics machine(test::s_machine(0.4, 12.8));
  const program::Program plain = test::s_path();
  program::Program curved = plain;
  const SmoothingOptions any = test::published_options(Method::verified);
  for (program::Block& block : curved.blocks) {
    block.tip_deviation_m = 0.4 * any.tip_tolerance_m;
    block.axis_deviation_rad = 0.3 * any.axis_tolerance_rad;
  }
  for (const Method method : {Method::verified, Method::paper}) {
    const SmoothingOptions options = test::published_options(method);
    const Smoothed run = smoothed(curved, machine, options);
    EXPECT_EQ(run.summary.check.tip_error_m.violations + run.summary.check.axis_error_rad.violations, 0U);
    EXPECT_GT(run.summary.duration_s, smoothed(plain, machine, options).summary.duration_s);
    program::ProgramSource source(plain);
    Checker checker(source, machine, options);
    checker.add(run.samples);
    const CheckResult check = checker.finish();
    EXPECT_LE(check.tip_error_m.max, 0.6001 * options.tip_tolerance_m);
    EXPECT_LE(check.axis_error_rad.max, 0.7001 * options.axis_tolerance_rad);
  }
}

// A stop for the operator is a dwell of no time: the tool is at rest there, where it would have run through.
TEST(Smooth, ComesToRestAtADwellOfNoTime) {
  const robot::HybridKinematics machine(test::s_machine(0.4, 12.8));
  const auto slowest_at_the_middle = [&](bool stop) {
    program::Program program = test::s_path();
    program.start = {.tip_m = Eigen::Vector3d::Zero(), .axis = program.start.axis};
    program.blocks.clear();
    for (const double x_m : {0.02, 0.04}) {
      if (stop && x_m > 0.03) {
        program.blocks.push_back({.kind = program::Block::Kind::dwell, .line = 2, .end = program.blocks.back().end});
      }
      program.blocks.push_back(
          {.line = 1, .end = {.tip_m = Eigen::Vector3d(x_m, 0.0, 0.0), .axis = program.start.axis}, .duration_s = 0.5});
    }
    const Smoothed run = smoothed(program, machine, test::published_options(Method::verified));
    EXPECT_EQ(run.summary.check.violations(), 0U);
    double step_m = 1.0;
    for (std::size_t i = 1; i < run.samples.size(); ++i) {
      const double middle_m = 0.5 * (run.samples[i].tip_m.x() + run.samples[i - 1].tip_m.x());
      if (std::abs(middle_m - 0.02) > 1e-4) continue;
      step_m = std::min(step_m, (run.samples[i].tip_m - run.samples[i - 1].tip_m).norm());
    }
    return step_m / test::published_options(Method::verified).sample_period_s;
  };
  EXPECT_GT(slowest_at_the_middle(false), 0.02);
  EXPECT_LT(slowest_at_the_middle(true), 1e-3);
}

TEST(SPath, OptimalIsNearTheBoundWhereJointJerkIsLoose) {
  const robot::HybridKinematics machine(test::s_machine(0.4, 20.0));
  const Summary optimal = smoothed(test::s_path(), machine, test::published_options(Method::optimal)).summary;
  EXPECT_EQ(optimal.check.violations(), 0U);
  EXPECT_LT(optimal.duration_s, 1.08 * optimal.lower_bound_s);
}

/// 3,000 blocks of 0.1 to 1 mm along a smooth curve.
program::Program dense_program() {
  Random random(7);
  program::Program out;
  program::Pose at;
  out.start = at;
  double heading = 0.0, way_m = 0.0;
  for (std::size_t i = 0; i < 3000; ++i) {
    const double length_m = 1e-4 * std::pow(10.0, random.uniform());
    way_m += length_m;
    heading += length_m / 0.02 * std::sin(25.0 * way_m);
    at.tip_m += length_m * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.1 * std::sin(50.0 * way_m));
    at.axis = Eigen::Vector3d(0.2 * std::sin(10.0 * way_m), 0.2 * (std::cos(8.0 * way_m) - 1.0), 1.0).normalized();
    out.blocks.push_back({.line = i + 1, .end = at, .duration_s = length_m / 0.05});
  }
  return out;
}

TEST(DenseProgram, FlowsNearTheBound) {
  const program::Program program = dense_program();
  for (const double jerk : {8.0, 20.0}) {  // the second: fifty times the acceleration a second
    const robot::HybridKinematics machine(test::s_machine(0.4, jerk));
    const Summary verified = smoothed(program, machine, test::published_options(Method::verified)).summary;
    const Summary optimal = smoothed(program, machine, test::published_options(Method::optimal)).summary;
    EXPECT_EQ(verified.check.violations(), 0U);
    EXPECT_EQ(optimal.check.violations(), 0U);
    EXPECT_LT(verified.duration_s, 1.4 * optimal.duration_s);
    EXPECT_LT(optimal.duration_s, 1.1 * optimal.lower_bound_s);
  }
}

/// The whole program through a planner; `take` gets what is planned.
template <class Take>
void feed(Planner& planner, const program::Program& program, const Take& take) {
  const auto go = [&](const Planner::Status& status) {
    take(status);
    while (planner.busy()) take(planner.resume());
  };
  go(planner.begin(program.start, 0.0, robot::Position6::Zero()));
  for (std::size_t i = 0; i < program.blocks.size(); ++i) go(planner.push(program.blocks[i], i, 0.0));
  go(planner.finish());
}

/// The planner's own time, without check and rounds.
double planned_s(const program::Program& program, const robot::Kinematics& kinematics, const PlannerOptions& how) {
  Planner planner(kinematics, test::published_options(Method::optimal), how);
  double sum_s = 0.0;
  const auto take = [&](const Planner::Status& status) {
    EXPECT_TRUE(status.ok());
    for (const Segment& segment : planner.motion()) sum_s += duration_s(segment);
    planner.motion().clear();
    planner.path().clear();
  };
  feed(planner, program, take);
  return sum_s;
}

/// The bound on a planner's grid.
double bound_s(const program::Program& program, const robot::Kinematics& kinematics, double spacing) {
  PlannerOptions how;
  how.share = 1.0;
  how.spacing = spacing;
  Planner planner(kinematics, test::published_options(Method::verified), how, nullptr, Planner::Task::points);
  std::vector<BoundPoint> points;
  double dwells_s = 0.0;
  const auto take = [&](const Planner::Status& status) {
    EXPECT_TRUE(status.ok());
    for (const Segment& segment : planner.motion()) dwells_s += segment.dwell_s;
    points.insert(points.end(), planner.points().begin(), planner.points().end());
    planner.motion().clear();
    planner.points().clear();
    planner.path().clear();
  };
  feed(planner, program, take);
  return dwells_s + least_time_s(points, planner.limits());
}

// A grid four times as fine moves the bound by less than one percent (0.6 % where corners of any angle follow each
// other), and nothing reaches either.
TEST(LowerBound, HardlyDependsOnTheGrid) {
  const robot::HybridKinematics machine(test::s_machine(0.4, 20.0));
  for (const program::Program& program : {test::s_path(), dense_program(), program_of(11, 0.4)}) {
    const double bound = bound_s(program, machine, 0.5), finer = bound_s(program, machine, 0.125);
    EXPECT_NEAR(bound, finer, 1e-2 * finer);
    for (const Method method : {Method::verified, Method::optimal}) {
      const Summary made = smoothed(program, machine, test::published_options(method)).summary;
      EXPECT_LT(bound, made.duration_s);
      EXPECT_LT(finer, made.duration_s);
    }
  }
}

// The same problem on a grid four times as fine, run to a hundredth of the gap.
TEST(Optimal, IsNearAMuchFinerSolution) {
  const robot::HybridKinematics machine(test::s_machine(0.4, 8.0));
  PlannerOptions finer = PlannerOptions::optimal();
  finer.spacing /= 4.0;
  finer.speed = {.relative_gap = 1e-6, .max_iterations = 400};
  for (const program::Program& program : {test::s_path(), program_of(11, 0.4)}) {
    const double fast_s = planned_s(program, machine, PlannerOptions::optimal());
    const double fine_s = planned_s(program, machine, finer);
    EXPECT_LT(fast_s, 1.05 * fine_s);
    EXPECT_GT(fast_s, 0.98 * fine_s);
  }
}

TEST(Smooth, ThreeFiltersKeepTheLimitsToo) {
  const robot::HybridKinematics machine(test::s_machine(0.4, 8.0));
  SmoothingOptions options = test::published_options(Method::verified);
  options.filters = 3;
  EXPECT_EQ(smoothed(test::s_path(), machine, options).summary.check.violations(), 0U);
}

TEST(Smooth, SendsWholeTrajectoriesFromRestToRest) {
  const robot::HybridKinematics machine(test::s_machine(0.4, 8.0));
  const program::Program program = test::s_path();
  const Smoothed run = smoothed(program, machine, test::published_options(Method::verified));
  ASSERT_EQ(run.samples.size(), run.summary.samples);
  EXPECT_EQ(run.samples.front().tip_m, program.start.tip_m);
  EXPECT_LT((run.samples.back().tip_m - program.blocks.back().end.tip_m).norm(), 1e-12);
  for (std::size_t i = 0; i < run.samples.size(); ++i) {
    EXPECT_DOUBLE_EQ(run.samples[i].time_s, 1e-3 * static_cast<double>(i));
  }
  EXPECT_GT(run.summary.duration_s, run.summary.lower_bound_s);
}

TEST(Smooth, StandsStillForADwell) {
  const robot::HybridKinematics machine(test::s_machine(0.4, 8.0));
  program::Program program = test::s_path();
  const double without_s = smoothed(program, machine, test::published_options(Method::verified)).summary.duration_s;
  program::Block dwell = program.blocks[7];
  dwell.kind = program::Block::Kind::dwell;
  dwell.duration_s = 0.5;
  program::Block motionless = program.blocks[7];
  motionless.duration_s = 0.01;
  program.blocks.insert(program.blocks.begin() + 8, {motionless, dwell});
  const Smoothed run = smoothed(program, machine, test::published_options(Method::verified));
  EXPECT_EQ(run.summary.check.violations(), 0U);
  std::size_t still = 0;
  for (std::size_t i = 1; i < run.samples.size(); ++i) still += run.samples[i].tip_m == run.samples[i - 1].tip_m;
  EXPECT_NEAR(static_cast<double>(still), 500.0, 2.0);
  EXPECT_GT(run.summary.duration_s, without_s + 0.5);
}

/// A machine whose forward kinematics contradict its inverse.
class Crooked final : public robot::Kinematics {
 public:
  explicit Crooked(const robot::Kinematics& straight) : straight_(straight) {}
  [[nodiscard]] int joints() const noexcept override { return straight_.joints(); }
  [[nodiscard]] const robot::JointLimits& limits() const noexcept override { return straight_.limits(); }
  [[nodiscard]] bool turns_about_axis() const noexcept override { return straight_.turns_about_axis(); }
  [[nodiscard]] int all(const robot::ToolPose& pose, robot::Position6* out, int room) const noexcept override {
    return straight_.all(pose, out, room);
  }
  [[nodiscard]] robot::Reach follow(const robot::ToolPose& pose, const robot::Position6& near,
                                    robot::Position6& position) const noexcept override {
    return straight_.follow(pose, near, position);
  }
  [[nodiscard]] robot::Reach follow(const robot::ToolJet& jet, const robot::Position6& near,
                                    robot::JointJet& joints) const noexcept override {
    return straight_.follow(jet, near, joints);
  }
  [[nodiscard]] robot::ToolPose forward(const robot::Position6& position) const noexcept override {
    robot::ToolPose out = straight_.forward(position);
    out.tip_m.x() += 1e-4;
    return out;
  }
  [[nodiscard]] double regularity(const robot::Position6& position) const noexcept override {
    return straight_.regularity(position);
  }

 private:
  const robot::Kinematics& straight_;
};

TEST(Smooth, StopsWhereNoSlowerAndNoNarrowerPathHelps) {
  const robot::HybridKinematics straight(test::s_machine(0.4, 8.0));
  const Summary summary =
      smoothed(test::s_path(), Crooked(straight), test::published_options(Method::verified)).summary;
  EXPECT_EQ(summary.rounds, 1);
  EXPECT_EQ(summary.check.violations(), summary.samples);
}

TEST(Smooth, RejectsWhatCannotBeReachedByBlockAndLine) {
  const robot::HybridKinematics machine(test::s_machine(0.4, 8.0));
  program::Program program = test::s_path();
  program.blocks[5].end.tip_m.x() += 5.0;
  const std::string far =
      robomill::test::rejection([&] { smoothed(program, machine, test::published_options(Method::verified)); });
  EXPECT_NE(far.find("block 6 (line 6)"), std::string::npos) << far;
  program = test::s_path();
  program.blocks[2].end.axis = -program.blocks[1].end.axis;
  const std::string turned =
      robomill::test::rejection([&] { smoothed(program, machine, test::published_options(Method::verified)); });
  EXPECT_NE(turned.find("half a circle (line 3)"), std::string::npos) << turned;
  // A posture that cannot be the start's is not of block 1.
  program = test::s_path();
  program.start.tip_m.x() += 5.0;
  const std::string start =
      robomill::test::rejection([&] { smoothed(program, machine, test::published_options(Method::verified)); });
  EXPECT_TRUE(start.starts_with("the program's start: takes joint 4 ")) << start;
}

}  // namespace smooth_test
}  // namespace robomill::path
