// Compensated programs, judged by walls that a deflecting tool cuts tooth by tooth
// (testing/cutting/deflected_wall.hpp).
#include "robomill/process/compensate.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/robot/pose.hpp"
#include "robomill/robot/stiffness.hpp"
#include "robomill/stability/surface_error.hpp"
#include "testing/cutting/deflected_wall.hpp"
#include "testing/process/programs.hpp"
#include "testing/stability/spatial_cases.hpp"
#include "testing/support.hpp"

namespace robomill::process {
namespace compensate_test {

using cutting::testing::Swing;
using Eigen::Vector3d;
using State = CompensatedBlock::State;

constexpr double mm = 1e-3;

/// A flat end of 12 mm with four teeth runs along +x at y = 0 beside a wall; lengths in mm.
struct WallJob {
  double side = -1.0;  ///< +1: the wall stands at +y, up-milling; -1: down-milling
  double radial = 1.0, depth = 8.0, feed_per_tooth = 0.08, length = 50.0, block = 2.0;
  double roughed = 0.0;  ///< > 0: a pass before it takes that much more
  bool slot = false;     ///< material on both sides
  int teeth = 4;
  static constexpr double radius = 6.0, speed_rpm = 6000.0;
};

/// An arm's first modes, askew to the axes.
std::vector<Swing> arm_swings() {
  return {{.frequency_hz = 14.0,
           .damping_ratio = 0.04,
           .stiffness_n_per_m = 1.2e6,
           .direction = Vector3d(0.2, 1.0, 0.1).normalized()},
          {.frequency_hz = 19.0,
           .damping_ratio = 0.04,
           .stiffness_n_per_m = 1.6e6,
           .direction = Vector3d(1.0, -0.2, 0.2).normalized()},
          {.frequency_hz = 24.0,
           .damping_ratio = 0.04,
           .stiffness_n_per_m = 2e6,
           .direction = Vector3d(0.1, 0.15, -1.0).normalized()}};
}

/// The same with a tool that bends.
std::vector<Swing> arm_and_tool() {
  std::vector<Swing> out = arm_swings();
  out.push_back(
      {.frequency_hz = 850.0, .damping_ratio = 0.03, .stiffness_n_per_m = 2.5e7, .direction = Vector3d::UnitX()});
  out.push_back(
      {.frequency_hz = 900.0, .damping_ratio = 0.03, .stiffness_n_per_m = 2.5e7, .direction = Vector3d::UnitY()});
  return out;
}

DynamicsAt dynamics_of(const std::vector<Swing>& swings) {
  std::vector<stability::testing::RealMode> modes;
  for (const Swing& swing : swings) {
    const double omega = 2.0 * std::numbers::pi * swing.frequency_hz;
    modes.push_back(
        {swing.frequency_hz, swing.damping_ratio, swing.stiffness_n_per_m / (omega * omega), swing.direction});
  }
  return constant_dynamics(stability::testing::spatial_model(modes));
}

class Compensate : public ::testing::Test {
 protected:
  /// Forces along the program of a job; in the cell W's axes are those of B.
  ForcesResult forces_of(const WallJob& job) {
    const double skin = job.side * (WallJob::radius - job.radial - job.roughed);
    double low = std::min(skin, job.side * (WallJob::radius + 4.0));
    double high = std::max(skin, job.side * (WallJob::radius + 4.0));
    if (job.slot) high = -(low = -(WallJob::radius + 4.0));
    const test_support::CutFile cut = {.kind = "flat-end",
                                       .diameter_mm = 12.0,
                                       .teeth = job.teeth,
                                       .helix_deg = 40.0,
                                       .tangential_n_per_mm2 = 800.0,
                                       .radial_n_per_mm2 = 300.0,
                                       .tangential_edge_n_per_mm = 10.0,
                                       .radial_edge_n_per_mm = 15.0,
                                       .min_mm = {0.0, low, 0.0},
                                       .max_mm = {job.length, high, job.depth},
                                       .dexel_mm = 0.25};
    return forces_along(cut, wall_program(job));
  }
  static ForcesResult forces_along(const test_support::CutFile& cut, const std::string& program) {
    return testing::forces_along(testing::cut_of(cut), testing::cell_of(test_support::arm_cell(ROBOMILL_SOURCE_DIR)),
                                 program, {.keep_cuts = true});
  }
  static std::string pass(const WallJob& job, double y) {
    const double feed = job.feed_per_tooth * job.teeth * WallJob::speed_rpm;
    std::string text = fmt::format("G0 X-10 Y{} Z30\nG0 Z-0.5\n", y);
    for (double x = -10.0 + job.block; x <= job.length + 8.0; x += job.block) {
      text += fmt::format("G1 X{:.3f} F{}\n", x, feed);
    }
    return text + "G0 Z30\n";
  }
  static std::string wall_program(const WallJob& job) {
    std::string text = fmt::format("G21 G90 G94\nS{} M3\n", WallJob::speed_rpm);
    if (job.roughed > 0.0) text += pass(job, -job.side * job.radial);
    return text + pass(job, 0.0) + "M2\n";
  }
  /// The wall that a program cuts, over the last half of the material: where the arm has come to rest, and before the
  /// tool leaves.
  static cutting::testing::Wall::Summary judged(const WallJob& job, const ForcesResult& forces,
                                                const program::Program& program, const std::vector<Swing>& structure,
                                                double coefficients = 1.0) {
    cutting::testing::WallCut cut;
    cut.cutter = forces.cut.cutter;
    cut.coefficients = forces.cut.coefficients;
    for (auto* polynomial : {&cut.coefficients.tangential_n_per_m2, &cut.coefficients.radial_n_per_m2,
                             &cut.coefficients.axial_n_per_m2, &cut.coefficients.tangential_edge_n_per_m,
                             &cut.coefficients.radial_edge_n_per_m, &cut.coefficients.axial_edge_n_per_m}) {
      for (double& value : *polynomial) value *= coefficients;
    }
    cut.spindle_speed_rad_per_s = WallJob::speed_rpm * units::rpm;
    cut.side = job.side;
    cut.wall_y_m = job.side * WallJob::radius * mm;
    cut.stock_y_m = job.side * (WallJob::radius - job.radial) * mm;
    cut.to_x_m = job.length * mm;
    cut.top_m = job.depth * mm;
    cut.structure = structure;
    cut.slices = 12;
    cut.steps_per_revolution = 1000;
    cut.ray_m = 8e-6;
    const Eigen::Vector2d window(0.5 * job.length * mm, (job.length - 8.0) * mm);
    return cut_wall(program, cut, window).between(window(0), window(1));
  }
  static int count(const Compensation& result, State state) {
    return static_cast<int>(
        std::ranges::count_if(result.blocks, [&](const CompensatedBlock& block) { return block.state == state; }));
  }
  static bool says(const std::vector<std::string>& texts, const std::string& what) {
    return std::ranges::any_of(texts, [&](const std::string& text) { return text.find(what) != std::string::npos; });
  }
};

/// By how much the judged error falls.
double gain(const cutting::testing::Wall::Summary& before, const cutting::testing::Wall::Summary& after) {
  return 1.0 - after.rms_m / before.rms_m;
}

// Down-milling pushes the tool away from the wall and so does up-milling of a thin skin: material is left standing, and
// the path moves into it. What moves is what the judge's tool was displaced by.
TEST_F(Compensate, TheWallLandsWhereItWasAskedFor) {
  for (const double side : {-1.0, 1.0}) {
    const WallJob job = {.side = side, .radial = side < 0.0 ? 1.0 : 0.3, .depth = 4.0};
    const ForcesResult forces = forces_of(job);
    const Compensation result = compensate(forces, dynamics_of(arm_and_tool()));
    EXPECT_EQ(result.status, Compensation::Status::settled);
    EXPECT_LE(result.passes, 3);
    EXPECT_GE(count(result, State::compensated), 20);
    const auto before = judged(job, forces, forces.program->program, arm_and_tool());
    const auto after = judged(job, forces, result.program, arm_and_tool());
    EXPECT_GT(before.mean_m, 5e-6);
    EXPECT_GT(gain(before, after), 0.8) << side << ": " << before.rms_m << " -> " << after.rms_m;
    // The predicted errors are those of the judge.
    EXPECT_NEAR(result.rms_before_m, before.rms_m, 0.1 * before.rms_m) << side;
    EXPECT_NEAR(result.rms_after_m, after.rms_m, 0.05 * before.rms_m) << side;
    const CompensatedBlock& amid = result.blocks[20];
    ASSERT_EQ(amid.state, State::compensated);
    EXPECT_NEAR(side * amid.offset_m.y(), before.mean_m, 0.1 * before.mean_m) << side;
    EXPECT_LT(std::abs(amid.offset_m.x()) + std::abs(amid.offset_m.z()), 1e-9);
    // No steps along the pass.
    for (std::size_t i = 10; i < 27; ++i) {  // before the force falls as the tool leaves the material
      EXPECT_LT((result.blocks[i].offset_m - result.blocks[i - 1].offset_m).norm(), 0.06 * before.mean_m) << i;
    }
    RecordProperty(fmt::format("wall_um_side_{}", side), fmt::format("{:.1f} -> {:.2f} ({:.0f} %)", before.rms_m * 1e6,
                                                                     after.rms_m * 1e6, 100.0 * gain(before, after)));
  }
}

// Two ways to what a ball end leaves between its neighbours: the places that still stand on the rays at the program's
// end, and the analytic cut, which knows its step-over.
TEST_F(Compensate, ABallEndIsMovedByWhatRemainsBetweenItsPasses) {
  std::string text = "G21 G90 G94\nS9000 M3\n";
  for (int k = 0; k < 7; ++k) {
    text += fmt::format("G0 X-6 Y{:.2f} Z10\nG0 Z-0.4\n", -1.8 + 0.6 * k);
    for (int i = 1; i <= 16; ++i) text += fmt::format("G1 X{} F1800\n", -6 + 2 * i);
    text += "G0 Z10\n";
  }
  const ForcesResult forces =
      forces_along({.diameter_mm = 8.0, .min_mm = {0.0, -8.0, -4.0}, .max_mm = {20.0, 8.0, 0.0}}, text + "M2\n");
  const DynamicsAt dynamics = dynamics_of(arm_swings());
  const Compensation result = compensate(forces, dynamics);
  EXPECT_EQ(result.status, Compensation::Status::settled);
  stability::LobesProblem problem;
  problem.spatial.emplace();
  problem.spatial->cutter = forces.cut.cutter;
  problem.spatial->coefficients = forces.cut.coefficients;
  problem.spatial->cut = {
      .axial_depth_m = 0.4 * mm, .radial_depth_m = 0.6 * mm, .direction = cutting::MillingDirection::up};
  problem.spatial->feed_per_tooth_m = 0.1 * mm;
  problem.dynamics = dynamics(Eigen::VectorXd::Zero(6)).modes;  // F is B
  double mean_m = 0.0;
  const std::vector<stability::SurfacePlace> places =
      stability::surface_profile(problem, {9000.0 * units::rpm, 0.4 * mm});
  ASSERT_FALSE(places.empty());
  for (const stability::SurfacePlace& place : places) mean_m += place.error_m / static_cast<double>(places.size());
  int compared = 0;
  for (std::size_t i = 0; i < result.blocks.size(); ++i) {
    const Eigen::Vector3d& end = forces.program->program.blocks[i].end.tip_m;
    const bool amid = std::abs(end.y()) < 0.7 * mm && end.x() > 5.0 * mm && end.x() < 15.0 * mm;
    if (!amid || forces.program->program.blocks[i].kind != program::Block::Kind::feed) continue;
    ++compared;
    EXPECT_EQ(result.blocks[i].state, State::compensated) << i;
    EXPECT_NEAR(result.blocks[i].before.width_m, 0.6 * mm, 0.25 * mm) << i;
    EXPECT_NEAR(std::abs(result.blocks[i].before.rms_m), std::abs(mean_m), 0.1 * std::abs(mean_m)) << i;
    EXPECT_NEAR(-result.blocks[i].offset_m.z(), mean_m, 0.1 * std::abs(mean_m)) << i;
    EXPECT_LT(result.blocks[i].after.rms_m, 0.2 * result.blocks[i].before.rms_m) << i;
  }
  EXPECT_GE(compared, 10);
}

// The plan is made with nominal numbers, the wall is cut with others.
TEST_F(Compensate, HalfTheErrorGoesWithWrongStiffnessOrCoefficientsOrBacklash) {
  const WallJob job = {.depth = 4.0};
  const ForcesResult forces = forces_of(job);
  const Compensation result = compensate(forces, dynamics_of(arm_and_tool()));
  const auto gain_with = [&](double stiffness, double coefficients, double backlash_m) {
    std::vector<Swing> structure = arm_and_tool();
    for (Swing& swing : structure) {
      swing.stiffness_n_per_m *= stiffness;
      swing.frequency_hz *= std::sqrt(stiffness);
    }
    structure.front().backlash_m = backlash_m;  // of the arm's softest direction, nearly across the wall
    const auto before = judged(job, forces, forces.program->program, structure, coefficients);
    const auto after = judged(job, forces, result.program, structure, coefficients);
    RecordProperty(fmt::format("stiffness_{}_coefficients_{}_backlash_{}", stiffness, coefficients, backlash_m),
                   fmt::format("{:.1f} -> {:.1f} um", before.rms_m * 1e6, after.rms_m * 1e6));
    return gain(before, after);
  };
  EXPECT_GT(gain_with(0.8, 1.0, 0.0), 0.5);
  EXPECT_GT(gain_with(1.2, 1.0, 0.0), 0.5);
  EXPECT_GT(gain_with(1.0, 0.8, 0.0), 0.5);
  EXPECT_GT(gain_with(1.0, 1.2, 0.0), 0.5);
  EXPECT_GT(gain_with(1.0, 1.0, 20e-6), 0.5);
}

// A structure that follows the force within a revolution errs by another amount at each height, which one offset cannot
// take back: what is left is predicted. Where a tooth begins as the one before it ends the force is even, and nothing
// is.
TEST_F(Compensate, WhatOneOffsetCannotTakeBackIsPredicted) {
  std::vector<Swing> quick = arm_swings();
  for (Swing& swing : quick) swing = {4000.0, 0.9, 8.0 * swing.stiffness_n_per_m, swing.direction, 0.0};
  const double even = std::numbers::pi * 12.0 / 4.0 / std::tan(40.0 * units::deg);
  for (const double depth : {4.0, even}) {
    const WallJob job = {.radial = 1.0, .depth = depth, .length = 30.0};
    const ForcesResult forces = forces_of(job);
    const Compensation result = compensate(forces, dynamics_of(quick));
    const auto before = judged(job, forces, forces.program->program, quick);
    const auto after = judged(job, forces, result.program, quick);
    EXPECT_NEAR(result.rms_before_m, before.rms_m, 0.1 * before.rms_m) << depth;
    EXPECT_NEAR(result.rms_after_m, after.rms_m, 0.05 * before.rms_m) << depth;
    EXPECT_GT(gain(before, after), depth == even ? 0.8 : 0.35) << depth;
  }
}

TEST_F(Compensate, RoughingIsLeftAlone) {
  const WallJob job = {.radial = 0.5, .depth = 4.0, .length = 24.0, .roughed = 0.5};
  const ForcesResult forces = forces_of(job);
  const Compensation result = compensate(forces, dynamics_of(arm_swings()));
  const program::Program& before = forces.program->program;
  int rough = 0;
  int finished = 0;
  for (std::size_t i = 0; i < result.blocks.size(); ++i) {
    const bool roughing = std::abs(before.blocks[i].end.tip_m.y() - 0.5 * mm) < 1e-9;
    if (roughing && forces.program->blocks[i].force.cuts()) {
      ++rough;
      EXPECT_EQ(result.blocks[i].state, State::untouched) << i;
      EXPECT_EQ(result.blocks[i].before.state, SurfaceLeft::State::nothing) << i;
      EXPECT_TRUE(result.program.blocks[i].end.tip_m == before.blocks[i].end.tip_m) << i;
    } else if (result.blocks[i].state == State::compensated) {
      ++finished;
      EXPECT_NEAR(result.blocks[i].before.width_m, 4.0 * mm, 1.0 * mm) << i;
    }
    // All but the ends stays.
    EXPECT_EQ(result.program.blocks[i].line, before.blocks[i].line);
    EXPECT_EQ(result.program.blocks[i].duration_s, before.blocks[i].duration_s);
    EXPECT_TRUE(result.program.blocks[i].end.axis == before.blocks[i].end.axis);
  }
  EXPECT_GE(rough, 10);
  EXPECT_GE(finished, 10);
}

// What a block is judged to leave of the finished surface is what the wall's judge finds there, of the pass that leaves
// it; a roughing pass before it leaves nothing, whatever its own error.
TEST_F(Compensate, BlocksAreJudgedByTheWallThatTheyLeave) {
  const WallJob job = {.depth = 4.0, .roughed = 0.5};
  const ForcesResult forces = forces_of(job);
  const ProgramBlocks blocks = judge_blocks(forces, dynamics_of(arm_and_tool()), {.scan_points = 0});
  const auto wall = judged(job, forces, forces.program->program, arm_and_tool());
  int rough = 0;
  int compared = 0;
  for (std::size_t i = 0; i < blocks.rows.size(); ++i) {
    const BlockRow& row = blocks.rows[i];
    if (!row.cuts) continue;
    const Vector3d end_mm = forces.program->program.blocks[i].end.tip_m / mm;
    if (end_mm.y() > 0.25) {
      ++rough;
      EXPECT_TRUE(std::isnan(row.surface_left_m)) << i;
      EXPECT_TRUE(std::isfinite(row.steady.surface_error_m)) << i;
    } else if (end_mm.x() > 0.5 * job.length && end_mm.x() < job.length - 8.0) {
      ++compared;
      EXPECT_NEAR(row.surface_left_m, wall.worst_m, 0.1 * std::abs(wall.worst_m)) << i;
    }
  }
  EXPECT_GE(rough, 20);
  EXPECT_GE(compared, 6);
}

// At resonance the tool swings between the walls, and stands off one as a tooth passes it, and half a tooth later off
// the other: no offset suits both.
TEST_F(Compensate, BothWallsOfASlotAreNotCompensated) {
  const WallJob job = {.depth = 2.0, .feed_per_tooth = 0.05, .length = 30.0, .slot = true, .teeth = 3};
  const ForcesResult forces = forces_of(job);
  const std::vector<Swing> resonant = {{.frequency_hz = 305.0, .damping_ratio = 0.02, .stiffness_n_per_m = 3e7}};
  const Compensation result = compensate(forces, dynamics_of(resonant));
  EXPECT_EQ(result.status, Compensation::Status::nothing_to_do);
  EXPECT_GE(count(result, State::opposite_walls), 10);
  EXPECT_EQ(count(result, State::compensated), 0);
  EXPECT_TRUE(says(result.warnings, "leave both walls of a slot"));
  EXPECT_TRUE(says(result.warnings, "the first in line"));
  for (std::size_t i = 0; i < result.blocks.size(); ++i) {
    EXPECT_TRUE(result.program.blocks[i].end.tip_m == forces.program->program.blocks[i].end.tip_m);
  }
}

// A soft arm puts the whole slot aside: one offset suits both walls.
TEST_F(Compensate, ASlotThatStandsAsideIsMovedBack) {
  const WallJob job = {.depth = 1.0, .feed_per_tooth = 0.04, .length = 30.0, .slot = true};
  const ForcesResult forces = forces_of(job);
  const std::vector<Swing> soft = {{.frequency_hz = 14.0, .damping_ratio = 0.05, .stiffness_n_per_m = 1.2e6}};
  const Compensation result = compensate(forces, dynamics_of(soft));
  ASSERT_GE(count(result, State::compensated), 8) << (result.warnings.empty() ? "" : result.warnings.front());
  EXPECT_LT(result.rms_after_m, 0.2 * result.rms_before_m);
}

TEST_F(Compensate, ChatterIsNotCompensated) {
  const WallJob job = {.radial = 1.0, .depth = 8.0, .length = 24.0};
  const Compensation result = compensate(forces_of(job), dynamics_of(arm_swings()));
  EXPECT_GE(count(result, State::unstable), 5);
  EXPECT_TRUE(says(result.warnings, "chatter"));
  for (const CompensatedBlock& block : result.blocks) {
    EXPECT_EQ(block.state == State::unstable, block.before.state == SurfaceLeft::State::unstable);
    EXPECT_NE(std::isfinite(block.before.error_m),
              block.before.state == SurfaceLeft::State::unstable || block.before.state == SurfaceLeft::State::nothing);
  }
}

TEST_F(Compensate, TheBoundBinds) {
  const WallJob job = {.depth = 4.0, .length = 24.0};
  const Compensation result =
      compensate(forces_of(job), dynamics_of(arm_swings()), {.offsets = {.max_offset_m = 10e-6}});
  EXPECT_GE(count(result, State::bounded), 8);
  EXPECT_TRUE(says(result.warnings, "the most that is allowed, 0.01 mm"));
  EXPECT_LE(result.largest_offset_m, 10e-6 * (1.0 + 1e-12));
  for (const CompensatedBlock& block : result.blocks) {
    EXPECT_LE(block.offset_m.norm(), 10e-6 * (1.0 + 1e-12));
    if (block.state != State::bounded) continue;
    EXPECT_NEAR(block.before.rms_m - block.after.rms_m, 10e-6, 3e-6);
  }
}

TEST_F(Compensate, TheJointsFollowToTheMovedEnds) {
  const WallJob job = {.depth = 4.0, .length = 24.0};
  ForcesResult forces = forces_of(job);
  robot::Joint& first = forces.cell->robot.arm.joints.front();
  first.min_position = 1e300;
  first.max_position = -1e300;
  for (const BlockResult& block : forces.program->blocks) {
    first.min_position = std::min(first.min_position, block.joints(0) - 1e-6);
    first.max_position = std::max(first.max_position, block.joints(0) + 1e-6);
  }
  const std::string said = test::rejection([&] { static_cast<void>(compensate(forces, dynamics_of(arm_swings()))); });
  EXPECT_NE(said.find("takes joint 1"), std::string::npos) << said;
  EXPECT_NE(said.find("(line "), std::string::npos) << said;
}

TEST_F(Compensate, AControllerThatCompensatesIsLeftToIt) {
  const WallJob job = {.depth = 4.0, .length = 24.0};
  const ForcesResult forces = forces_of(job);
  const Compensation result =
      compensate(forces, dynamics_of(arm_swings()), {.offsets = {.controller_compensates = true}});
  EXPECT_EQ(result.status, Compensation::Status::left_to_controller);
  EXPECT_TRUE(says(result.notes, "controller"));
  for (std::size_t i = 0; i < result.blocks.size(); ++i) {
    EXPECT_TRUE(result.program.blocks[i].end.tip_m == forces.program->program.blocks[i].end.tip_m);
  }
}

// Static compliance alone: the modes hold it, and a tool under it is compensated without any mass being known.
TEST_F(Compensate, JointStiffnessAloneIsEnough) {
  const WallJob job = {.depth = 4.0, .length = 24.0};
  const ForcesResult forces = forces_of(job);
  const robot::Cell& cell = forces.cell->robot;
  const Eigen::VectorXd& joints = forces.program->blocks[12].joints;
  const modal::ModalModel modes = static_dynamics(*forces.cell)(joints).modes;
  const Eigen::Matrix3d compliance =
      robot::stiffness(cell.arm, joints, robot::tip_point(cell)).compliance.topLeftCorner<3, 3>();
  Eigen::Matrix3d held = Eigen::Matrix3d::Zero();
  for (const modal::Mode& mode : modes.modes) {
    held += 2.0 * (mode.right * mode.left.transpose() / -modal::pole(mode)).real();
  }
  EXPECT_LT((held - compliance).norm(), 1e-9 * compliance.norm());
  const Compensation result = compensate(forces, {});
  EXPECT_GE(count(result, State::compensated), 8);
  EXPECT_LT(result.rms_after_m, 0.7 * result.rms_before_m);
}

TEST_F(Compensate, BadInputIsRejected) {
  const WallJob job = {.depth = 4.0, .length = 10.0};
  ForcesResult forces = forces_of(job);
  const DynamicsAt dynamics = dynamics_of(arm_swings());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto field = [&](const CompensateOptions& options) {
    return test::field_of([&] { static_cast<void>(compensate(forces, dynamics, options)); });
  };
  EXPECT_EQ(field({.offsets = {.max_offset_m = 0.0}}), "max_offset_m");
  EXPECT_EQ(field({.offsets = {.max_offset_m = nan}}), "max_offset_m");
  EXPECT_EQ(field({.blend_m = -1.0}), "blend_m");
  EXPECT_EQ(field({.tolerance_m = 0.0}), "tolerance_m");
  EXPECT_EQ(field({.tolerance_share = nan}), "tolerance_share");
  EXPECT_EQ(field({.most_passes = 0}), "most_passes");
  EXPECT_EQ(field({.most_passes = 21}), "most_passes");
  EXPECT_EQ(field({.alike = {.joint_rad = -1.0}}), "joint_rad");
  EXPECT_EQ(field({.alike = {.cut_share = nan}}), "cut_share");
  const DynamicsAt nothing = [](const Eigen::VectorXd&) { return PostureDynamics{}; };
  EXPECT_NE(test::rejection([&] { static_cast<void>(compensate(forces, nothing)); }).find("block "), std::string::npos);
  forces.program->stock.reset();
  EXPECT_EQ(field({}), "forces");
  forces.program.reset();
  EXPECT_EQ(field({}), "forces");
}

}  // namespace compensate_test
}  // namespace robomill::process
