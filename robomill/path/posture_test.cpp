#include "robomill/path/posture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/robot/hybrid.hpp"
#include "robomill/robot/serial_kinematics.hpp"
#include "testing/robot/arms.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace posture_test {

using robomill::test::field_of;
using robomill::test::rejection;
namespace arms = robot::testing;

program::Program program_of(const program::Pose& start, const std::vector<program::Pose>& ends) {
  program::Program out{.start = start, .blocks = {}};
  for (const program::Pose& end : ends) {
    out.blocks.push_back({.line = 10 * (out.blocks.size() + 1), .end = end, .duration_s = 1.0});
  }
  return out;
}

program::Pose pose_of(double x_m, double y_m, double z_m, const Eigen::Vector3d& axis) {
  return {.tip_m = {x_m, y_m, z_m}, .axis = axis.normalized()};
}

/// The part 1.6 m in front of the arm, its z towards the arm's base.
robot::Cell facing_cell() {
  robot::Cell out{.arm = arms::with_limits(arms::kr210()), .tool_length_m = 0.25};
  out.workpiece = Eigen::Translation3d(1.6, 0.0, 1.6) * Eigen::AngleAxisd(-arms::pi / 2.0, Eigen::Vector3d::UnitY());
  return out;
}

/// Follows a posture finely, block by block, with nothing of choose_posture's.
void expect_followed(const robot::Kinematics& machine, const program::Program& program, const Posture& posture,
                     double step) {
  robot::Position6 position = posture.start;
  for (std::size_t block = 0; block < program.blocks.size(); ++block) {
    const double from = posture.gamma_rad.size() == 1 ? posture.gamma_rad[0] : posture.gamma_rad.at(block);
    const double to = posture.gamma_rad.size() == 1 ? posture.gamma_rad[0] : posture.gamma_rad.at(block + 1);
    for (int k = 0; k <= 200; ++k) {
      const double share = k / 200.0;
      const program::Pose at = program::between(program.begin_of(block), program.blocks[block].end, share);
      const robot::Position6 before = position;
      const robot::Reach reach =
          machine.follow(robot::ToolPose{.tip_m = at.tip_m, .axis = at.axis, .gamma_rad = from + share * (to - from)},
                         before, position);
      ASSERT_EQ(reach.status, robot::Reach::Status::found) << block << ' ' << share;
      ASSERT_LT((position - before).cwiseAbs().maxCoeff(), step) << block << ' ' << share;
    }
  }
}

program::Program cone_of_axes() {
  std::vector<program::Pose> ends;
  for (int k = 1; k <= 24; ++k) {
    const double at = 2.0 * arms::pi * k / 24.0;
    ends.push_back(pose_of(0.05 * std::cos(at), 0.05 * std::sin(at), 0.01,
                           {std::sin(0.5) * std::cos(at), std::sin(0.5) * std::sin(at), std::cos(0.5)}));
  }
  return program_of(pose_of(0.05, 0.0, 0.01, {std::sin(0.5), 0.0, std::cos(0.5)}), ends);
}

TEST(Posture, FindsAConstantGammaThatGoesThrough) {
  const robot::SerialKinematics machine(facing_cell());
  const program::Program program = cone_of_axes();
  program::ProgramSource source(program);
  const PostureChoice choice = choose_posture(source, machine);
  ASSERT_EQ(choice.posture.gamma_rad.size(), 1U);
  EXPECT_GT(choice.margin.least, 0.02);
  EXPECT_EQ(choice.blocks, 24U);
  EXPECT_TRUE(choice.whole);
  expect_followed(machine, program, choice.posture, 0.1);
  program::Block block;
  ASSERT_TRUE(source.next(block));
  EXPECT_EQ(block.line, 10U);
}

TEST(Posture, KeepsTheGammaAndTheStartThatAreGiven) {
  const robot::SerialKinematics machine(facing_cell());
  const program::Program program = cone_of_axes();
  program::ProgramSource source(program);
  const PostureChoice free = choose_posture(source, machine);
  const double gamma_rad = free.posture.gamma_rad[0] + 0.1;
  PostureOptions options{.gamma_rad = gamma_rad};
  const PostureChoice fixed = choose_posture(source, machine, options);
  EXPECT_EQ(fixed.posture.gamma_rad, std::vector<double>{gamma_rad});
  EXPECT_LE(fixed.margin.least, free.margin.least + 0.01);
  options.start = fixed.posture.start.array() + 0.05;
  EXPECT_LT((choose_posture(source, machine, options).posture.start - fixed.posture.start).norm(), 1e-9);
}

// Independent of the library's flags: an arm like the KUKA bends its elbow by joint 3 and its wrist by joint 5 alone.
const double stretched = std::atan2(1.2, 0.041) - arms::pi;  // joint 3 where upper arm and forearm are in line
bool bends_alike(const robot::Position6& a, const robot::Position6& b) {
  return std::sin(a(2) - stretched) * std::sin(b(2) - stretched) > 0.0 && std::sin(a(4)) * std::sin(b(4)) > 0.0;
}

/// A short move from where a position has the tool.
program::Program move_from(const robot::SerialKinematics& machine, const robot::Position6& position) {
  const robot::ToolPose tool = machine.forward(position);
  const program::Pose start{.tip_m = tool.tip_m, .axis = tool.axis};
  return program_of(start, {{.tip_m = start.tip_m + Eigen::Vector3d(0.0, 0.01, 0.0), .axis = start.axis}});
}

TEST(Posture, StandsAsAtHomeWithoutWholeTurns) {
  const robot::SerialKinematics machine(facing_cell());
  for (const double wrist_rad : {-0.7, 0.7}) {
    robot::Position6 home = arms::kr210_posture();
    home(4) = wrist_rad;
    const program::Program program = move_from(machine, home);
    program::ProgramSource source(program);
    const PostureChoice choice = choose_posture(source, machine, {.home = home});
    EXPECT_TRUE(bends_alike(choice.posture.start, home)) << wrist_rad;
    EXPECT_EQ(choice.resemblance->turns, 0);
    EXPECT_LT((choice.posture.start - home).cwiseAbs().maxCoeff(), arms::pi);
  }
}

// The same pose by (141°, -60°) and, a turn on, (-219°, 300°): limits of +-350° allow both. Nearer to a singularity
// than a margin of 0.05 another way may be taken.
TEST(Posture, UnwindsWhatLimitsWouldLetWind) {
  const robot::SerialKinematics machine(facing_cell());
  Random random(7);
  int followed = 0;
  for (int k = 0; k < robomill::test::seeds(40); ++k) {
    robot::Position6 home = arms::kr210_posture();
    for (double& angle : home) angle += random.uniform(-0.3, 0.3);
    robot::Position6 start = home;
    for (double& angle : start) angle += random.uniform(-0.2, 0.2);
    if (machine.regularity(start) < 0.06) continue;
    ++followed;
    const robot::ToolPose tool = machine.forward(start);
    const program::Program program =
        program_of({.tip_m = tool.tip_m, .axis = tool.axis},
                   {{.tip_m = tool.tip_m + Eigen::Vector3d(0.0, 0.01, 0.0), .axis = tool.axis}});
    program::ProgramSource source(program);
    const PostureChoice choice =
        choose_posture(source, machine, {.gamma_rad = tool.gamma_rad, .home = home, .margin_for_home = 1.0});
    EXPECT_LT((choice.posture.start - start).cwiseAbs().maxCoeff(), 1e-8) << k;
  }
  EXPECT_GT(followed, 0);
}

// Of eight ways to a pose, and their turns within ±360°, that with home's shoulder, elbow and wrist.
TEST(Posture, OfParallelAxesStandsAsAtHomeToo) {
  robot::Cell cell{.arm = arms::ur5e(), .tool_length_m = 0.2};
  for (robot::Joint& joint : cell.arm.joints) {
    joint.min_position = -2.0 * arms::pi;
    joint.max_position = 2.0 * arms::pi;
    joint.max_velocity = joint.max_acceleration = joint.max_jerk = 10.0;
  }
  const robot::SerialKinematics machine(cell);
  const robot::Position6 home{0.0, -1.05, 1.57, -2.09, -1.57, 0.0};
  const robot::Configuration at_home = machine.configuration(home);
  ASSERT_TRUE(at_home.known);
  Random random(8);
  for (int k = 0; k < robomill::test::seeds(40); ++k) {
    robot::Position6 near = home;
    for (double& angle : near) angle += random.uniform(-0.4, 0.4);
    const program::Program program = move_from(machine, near);
    program::ProgramSource source(program);
    const PostureChoice choice = choose_posture(source, machine, {.home = home});
    const robot::Configuration at_start = machine.configuration(choice.posture.start);
    EXPECT_EQ(at_start.shoulder_back, at_home.shoulder_back) << k;
    EXPECT_EQ(at_start.elbow_down, at_home.elbow_down) << k;
    EXPECT_EQ(at_start.wrist_flipped, at_home.wrist_flipped) << k;
    EXPECT_EQ(choice.resemblance->turns, 0) << k;
  }
}

TEST(Posture, TakesAnotherConfigurationOnlyWhereHomesDoesNotGoThrough) {
  robot::Cell cell = facing_cell();
  const robot::Position6 home = arms::kr210_posture();
  ASSERT_GT(home(2), stretched);
  robot::Position6 bent = home;
  bent(2) = stretched - 0.6;
  const auto choose = [&] {
    const robot::SerialKinematics machine(cell);
    const program::Program program = move_from(machine, bent);
    program::ProgramSource source(program);
    return choose_posture(source, machine, {.home = home});
  };
  EXPECT_GT(choose().posture.start(2), stretched);
  cell.arm.joints[2].max_position = stretched;  // it may not bend as at home
  const PostureChoice other = choose();
  EXPECT_LT(other.posture.start(2), stretched);
  EXPECT_FALSE(other.resemblance->elbow);
}

TEST(Posture, NamesTheSingularityThatItPasses) {
  // The spindle's axis is axis 6; the tip goes past the plane in which axes 4 and 6 could be one line.
  const robot::SerialKinematics machine(facing_cell());
  robot::Position6 there = arms::kr210_posture();
  const auto pose = [&](double angle_5, double angle_1) {
    there(0) = angle_1;
    there(3) = 0.0;
    there(4) = angle_5;
    const robot::ToolPose tool = machine.forward(there);
    return program::Pose{.tip_m = tool.tip_m, .axis = tool.axis};
  };
  const program::Pose from = pose(0.05, 0.0);
  const program::Program program = program_of(from, {pose(-0.05, 0.0)});
  program::ProgramSource source(program);
  (void)pose(0.05, 0.0);
  const std::string said = rejection([&] { (void)choose_posture(source, machine, {.start = there, .home = there}); });
  EXPECT_NE(said.find("block 1 (line 10): leads "), std::string::npos) << said;
  EXPECT_NE(said.find("axes 4 and 6 stand "), std::string::npos) << said;
  EXPECT_NE(said.find("° from one line"), std::string::npos) << said;
}

TEST(Posture, SaysWhatAPositionStandsNextTo) {
  robot::Configuration at{.known = true, .shoulder_m = 1.0, .elbow_rad = 1.0, .wrist_rad = 0.31 * units::deg};
  EXPECT_EQ(singularity_text(at), "axes 4 and 6 stand 0.31° from one line");
  at.wrist_rad = 0.1;
  EXPECT_EQ(singularity_text(at), "");
  at.elbow_rad = 2.0 * units::deg;
  EXPECT_EQ(singularity_text(at), "the arm stands 2° from stretched or folded");
  at.elbow_rad = 1.0;
  at.shoulder_m = 0.012;
  EXPECT_EQ(singularity_text(at), "the wrist's centre stands 12 mm from axis 1");
  EXPECT_EQ(singularity_text({}), "");
}

TEST(Posture, IsTheSameOnAnyNumberOfThreads) {
  const robot::SerialKinematics machine(facing_cell());
  const program::Program program = cone_of_axes();
  program::ProgramSource source(program);
  set_thread_count(1);
  const PostureChoice one = choose_posture(source, machine);
  set_thread_count(3);
  const PostureChoice three = choose_posture(source, machine);
  set_thread_count(0);
  EXPECT_EQ(one.posture.start, three.posture.start);
  EXPECT_EQ(one.posture.gamma_rad, three.posture.gamma_rad);
  EXPECT_EQ(one.margin.least, three.margin.least);
}

/// An arm whose last joint may turn a little only.
robot::Cell narrow_cell(double half_rad) {
  robot::Cell out = facing_cell();
  out.arm.joints[5].min_position = -half_rad;
  out.arm.joints[5].max_position = half_rad;
  return out;
}

// The axis goes round a cone: with a constant gamma joint 6 must turn as well, and it may not turn far enough.
TEST(Posture, TurnsGammaAlongTheWayWhereNoConstantOneDoes) {
  const robot::SerialKinematics machine(narrow_cell(0.2));
  const program::Program program = cone_of_axes();
  program::ProgramSource source(program);
  const PostureChoice choice = choose_posture(source, machine);
  ASSERT_EQ(choice.posture.gamma_rad.size(), 25U);
  EXPECT_GT(choice.margin.least, 0.01);
  expect_followed(machine, program, choice.posture, 0.1);
  for (int k = 0; k < 72; ++k) {
    const PostureOptions fixed{.gamma_rad = arms::pi * k / 36.0};
    EXPECT_NE(field_of([&] { (void)choose_posture(source, machine, fixed); }), "accepted") << k;
  }
}

TEST(Posture, TurnsGammaWhereAsked) {
  const robot::SerialKinematics machine(facing_cell());
  const program::Program program = cone_of_axes();
  program::ProgramSource source(program);
  const PostureChoice choice = choose_posture(source, machine, {.free_gamma = true});
  ASSERT_EQ(choice.posture.gamma_rad.size(), 25U);
  expect_followed(machine, program, choice.posture, 0.1);
}

TEST(Posture, NamesTheBlockThatCannotBeReached) {
  const robot::SerialKinematics machine(facing_cell());
  program::Program program = cone_of_axes();
  program.blocks[5].end.tip_m.z() = -3.0;
  program::ProgramSource source(program);
  const std::string said = rejection([&] { (void)choose_posture(source, machine); });
  EXPECT_EQ(said.substr(0, 54), "block 6 (line 60): is out of the machine's reach by 1.") << said;
  program.start.tip_m.x() = 30.0;
  EXPECT_EQ(rejection([&] { (void)choose_posture(source, machine); }).substr(0, 51),
            "the program's start: is out of the machine's reach ");
}

TEST(Posture, NamesTheJointAtItsLimit) {
  robot::Cell cell = facing_cell();
  const program::Program program = cone_of_axes();
  program::ProgramSource source(program);
  const robot::SerialKinematics free(cell);
  const PostureChoice choice = choose_posture(source, free);
  // Joint 2 may go on for a part of the way alone.
  cell.arm.joints[1].min_position = choice.posture.start(1) - 0.005;
  cell.arm.joints[1].max_position = choice.posture.start(1) + 0.005;
  const robot::SerialKinematics machine(cell);
  const std::string said = rejection([&] {
    (void)choose_posture(source, machine, {.gamma_rad = choice.posture.gamma_rad[0], .start = choice.posture.start});
  });
  EXPECT_NE(said.find("takes joint 2 "), std::string::npos) << said;
  EXPECT_NE(said.find(" rad beyond its limit"), std::string::npos) << said;
}

robot::Position6 with_wrist(double angle_4, double angle_5) {
  robot::Position6 position = arms::kr210_posture();
  position(3) = angle_4;
  position(4) = angle_5;
  return position;
}

/// In block 2 axis 6 goes past axis 4 on the other side, at a distance of about 0.2 sin(beside).
program::Program past_the_wrist(const robot::SerialKinematics& machine, double beside_rad) {
  const auto pose = [&](double angle_4, double angle_5) {
    const robot::ToolPose tool = machine.forward(with_wrist(angle_4, angle_5));
    return program::Pose{.tip_m = tool.tip_m, .axis = tool.axis};
  };
  return program_of(pose(beside_rad, -0.3), {pose(beside_rad, -0.2), pose(-beside_rad, 0.2)});
}

TEST(Posture, RejectsTheWayThroughASingularityAndTakesTheOneBesideIt) {
  const robot::SerialKinematics machine(facing_cell());
  const auto choose = [&](double beside_rad) {
    const program::Program program = past_the_wrist(machine, beside_rad);
    program::ProgramSource source(program);
    const robot::Position6 start = with_wrist(beside_rad, -0.3);
    return choose_posture(source, machine, {.gamma_rad = machine.forward(start).gamma_rad, .start = start});
  };
  const std::string said = rejection([&] { (void)choose(0.0); });
  EXPECT_EQ(said.substr(0, 52), "block 2 (line 20): leads through a singularity, wher") << said;
  const PostureChoice beside = choose(0.2);
  EXPECT_EQ(beside.margin.joint, -1);
  EXPECT_EQ(beside.margin.block, 1U);
  EXPECT_LT(beside.margin.least, 0.03);
}

TEST(Posture, TakesTheHybridMachineAsItStands) {
  robot::HybridMachine hybrid;
  hybrid.tool_length_m = 0.1;
  hybrid.workpiece = Eigen::Translation3d(0.0, 0.0, 0.9) * Eigen::AngleAxisd(arms::pi, Eigen::Vector3d::UnitX());
  hybrid.limits.min_position.setConstant(-1.0);
  hybrid.limits.max_position.setConstant(1.2);
  const robot::HybridKinematics machine(hybrid);
  program::Program program = cone_of_axes();
  program::ProgramSource source(program);
  const PostureChoice choice = choose_posture(source, machine, {.free_gamma = true});
  EXPECT_EQ(choice.posture.gamma_rad, std::vector<double>{0.0});
  expect_followed(machine, program, choice.posture, 0.01);
  program.blocks[11].end.axis = Eigen::Vector3d(1.0, 0.0, -0.2).normalized();
  const std::string said = rejection([&] { (void)choose_posture(source, machine); });
  EXPECT_EQ(said.substr(0, 20), "block 12 (line 120):") << said;
}

TEST(Posture, LooksAtTheHeadOfALongProgram) {
  const robot::SerialKinematics machine(facing_cell());
  const program::Program program = cone_of_axes();
  program::ProgramSource source(program);
  const PostureChoice choice = choose_posture(source, machine, {.max_blocks = 7});
  EXPECT_EQ(choice.blocks, 7U);
  EXPECT_FALSE(choice.whole);
}

TEST(Posture, RejectsWhatMakesNoSense) {
  const robot::SerialKinematics machine(facing_cell());
  program::Program program = cone_of_axes();
  program::ProgramSource source(program);
  const auto rejected = [&](const PostureOptions& options) {
    return field_of([&] { (void)choose_posture(source, machine, options); });
  };
  EXPECT_EQ(rejected({.gamma_rad = std::nan("")}), "gamma_rad");
  EXPECT_EQ(rejected({.start = robot::Position6::Constant(HUGE_VAL)}), "start");
  EXPECT_EQ(rejected({.home = robot::Position6::Constant(HUGE_VAL)}), "home");
  EXPECT_EQ(rejected({.margin_for_home = 1.5}), "margin_for_home");
  EXPECT_EQ(rejected({.gammas = 3}), "gammas");
  EXPECT_EQ(rejected({.max_axis_step_rad = 0.0}), "max_axis_step_rad");
  EXPECT_EQ(rejected({.max_tip_step_m = -1.0}), "max_tip_step_m");
  EXPECT_EQ(rejected({.max_blocks = 0}), "max_blocks");
  program.blocks[3].end.axis = -program.blocks[2].end.axis;
  EXPECT_EQ(rejected({}), "block 4 (line 40)");
  program.blocks.clear();
  EXPECT_EQ(rejected({}), "program");
}

}  // namespace posture_test
}  // namespace robomill::path
