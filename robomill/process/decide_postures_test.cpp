// Decisions in which the robot stands, or the tool leans, otherwise than in the program.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/cell/arm_modes.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/cutting/workpiece.hpp"
#include "robomill/process/blocks/joint_torques.hpp"
#include "robomill/process/decide.hpp"
#include "robomill/process/decide/motion_loads.hpp"
#include "robomill/robot/pose.hpp"
#include "testing/process/programs.hpp"
#include "testing/support.hpp"

namespace robomill::process {
namespace decide_postures_test {

class DecidePostures : public testing::ThreePasses {
 protected:
  /// The cell with a tool of 30 mm below its holder, and what else stands there.
  void add_geometry(const std::string& keys) {
    cell_ +=
        "\n[geometry]\nstickout_mm = 30\nclearance_mm = 1\nholder = [{ length_mm = 20, diameter_mm = 30 }]\n" + keys;
  }
  /// Masses of the links and torques of the drives.
  void add_links() {
    std::string links = "joint_max_torque_n_m = [9000, 20000, 9000, 2000, 2000, 1000]\nlinks = [\n";
    for (const double mass_kg : {300.0, 250.0, 150.0, 60.0, 30.0, 20.0}) {
      links +=
          fmt::format("  {{ mass_kg = {0}, center_mm = [{0}, 20, -{0}], inertia_kg_m2 = [{1}, {1}, {1}, 0, 0, 0] }},\n",
                      mass_kg, 0.02 * mass_kg);
    }
    cell_.insert(cell_.find("joint_stiffness"), links + "]\n");
  }
  static constexpr const char* far_box = "fixtures = [{ box_from_mm = [500, 500, 0], box_to_mm = [520, 520, 20] }]\n";
};

// A structure that is stiffer where the last joint stands elsewhere: as programmed it chatters at its speed.
TEST_F(DecidePostures, TurnsGammaWhereThatAloneHelps) {
  const double programmed = forces().program->blocks[10].joints(5);
  const DynamicsAt turning = [programmed](const Eigen::VectorXd& joints) {
    const double away = std::sin(joints(5) - programmed);
    return PostureDynamics{.modes = modes(0.05 + 20.0 * away * away)};
  };
  const Judged judged = judge(turning);
  EXPECT_GT(judged.blocks.unstable, 0U);
  DecideProblem asked = problem(judged, turning);
  asked.options.free = {Free::feed};
  EXPECT_EQ(decide(asked).status, DecideResult::Status::infeasible);
  asked.options.free = {Free::feed, Free::gamma};
  asked.options.gamma_step_rad = 15.0 * units::deg;
  const DecideResult turned = decide(asked);
  ASSERT_EQ(turned.status, DecideResult::Status::found) << turned.reason;
  EXPECT_TRUE(std::ranges::any_of(turned.gamma_offset_rad, [](double g) { return g != 0.0; }));
  EXPECT_GE(turned.decided->least_stability_margin, 0.2 * 0.995);
  ASSERT_TRUE(turned.gamma_map.has_value());
  EXPECT_EQ(turned.gamma_map->margin.cols(), std::ssize(turned.gamma_map->block));
  EXPECT_EQ(turned.gamma_map->margin.rows(), std::ssize(turned.gamma_map->gamma_rad));
  // By forward kinematics: the tip is where the program has it, turned by what was decided.
  const robot::Cell& cell = judged.forces.cell->robot;
  for (std::size_t i = 0; i < turned.forces->program->program.blocks.size(); ++i) {
    const robot::ToolPose pose =
        robot::tool_pose(cell, robot::forward(cell.arm, turned.forces->program->blocks[i].joints));
    EXPECT_LT((pose.tip_m - turned.forces->program->program.blocks[i].end.tip_m).norm(), 1e-9) << i;
  }
}

// Obstacles around the tool count as soon as a posture differs from the program's.
TEST_F(DecidePostures, TurnedPosturesAreCheckedForCollisions) {
  const DynamicsAt dynamics = constant_dynamics(modes(20.0));
  const auto with_box = [&](const std::string& fixtures) {
    SetUp();
    add_geometry(fixtures);
    const Judged judged = judge(dynamics);
    DecideProblem asked = problem(judged, dynamics);
    asked.options.free = {Free::feed, Free::gamma};
    asked.options.gamma_step_rad = 45.0 * units::deg;
    return decide(asked);
  };
  const DecideResult clear = with_box(far_box);
  ASSERT_EQ(clear.status, DecideResult::Status::found) << clear.reason;
  EXPECT_TRUE(clear.collisions_checked);
  const DecideResult blocked = with_box("fixtures = [{ box_from_mm = [-30, -30, 35], box_to_mm = [30, 30, 45] }]\n");
  EXPECT_EQ(blocked.status, DecideResult::Status::infeasible);
  EXPECT_NE(blocked.reason.find("cannot stand"), std::string::npos) << blocked.reason;
}

// What sticks out of the spindle meets a pin at the end of the passes alone, where no look is taken.
TEST_F(DecidePostures, ANearMissOnTheWayTurnsTheFlangeAside) {
  const DynamicsAt dynamics = constant_dynamics(modes(20.0));
  add_geometry(far_box);
  const Judged still = judge(dynamics);
  const robot::Cell& cell = still.forces.cell->robot;
  // Along x of the flange, 60 mm out, above the holder.
  const Eigen::Isometry3d flange = robot::forward(cell.arm, still.forces.program->blocks[7].joints);
  const Eigen::Vector3d out =
      (cell.workpiece.linear().transpose() * flange.linear() * Eigen::Vector3d::UnitX()).normalized();
  const Eigen::Vector3d pin = 1e3 * still.forces.program->program.blocks[7].end.tip_m + 58.0 * out;
  SetUp();
  add_geometry(
      fmt::format("spindle = [{{ box_from_mm = [0, -5, 150], box_to_mm = [60, 5, 190] }}]\n"
                  "fixtures = [{{ box_from_mm = [{}, {}, 60], box_to_mm = [{}, {}, 100] }}]\n",
                  pin.x() - 1.5, pin.y() - 1.5, pin.x() + 1.5, pin.y() + 1.5));
  const Judged judged = judge(dynamics);
  DecideProblem asked = problem(judged, dynamics);
  asked.options.free = {Free::feed, Free::gamma};
  asked.options.gamma_step_rad = 30.0 * units::deg;
  const DecideResult result = decide(asked);
  ASSERT_EQ(result.status, DecideResult::Status::found) << result.reason;
  EXPECT_TRUE(result.collision.empty()) << result.collision;
  EXPECT_TRUE(std::ranges::any_of(result.gamma_offset_rad, [](double g) { return g != 0.0; }));
  // Where nothing but the feed is free the program keeps its way, and the near miss is said.
  asked.options.free = {Free::feed};
  const DecideResult as_it_is = decide(asked);
  ASSERT_EQ(as_it_is.status, DecideResult::Status::found) << as_it_is.reason;
  EXPECT_NE(as_it_is.collision.find("spindle"), std::string::npos) << as_it_is.collision;
}

/// Modes that are stiff where the tool leans, and chatter where it stands upright.
DynamicsAt stiff_where_it_leans(const robot::Cell& cell, const std::function<modal::ModalModel(double)>& modes) {
  return [&cell, modes](const Eigen::VectorXd& joints) {
    const Eigen::Vector3d axis = robot::tool_pose(cell, robot::forward(cell.arm, joints)).axis;
    return PostureDynamics{.modes = modes(0.05 + 20.0 * (1.0 - axis.z() * axis.z()))};
  };
}

/// What is left of the stock.
cutting::Workpiece finished(const ForcesResult& forces, const program::Program& program) {
  cutting::Workpiece out(forces.program->stock->stock, 0.2e-3);
  const cutting::Profile profile(forces.cut.cutter);
  for (std::size_t i = 0; i < program.blocks.size(); ++i)
    out.remove(profile, program.begin_of(i), program.blocks[i].end);
  return out;
}

TEST_F(DecidePostures, LeansAboutTheBallWhereThatAloneHelps) {
  add_geometry(far_box);
  const ForcesResult forces = this->forces();
  const robot::Cell& cell = forces.cell->robot;
  const DynamicsAt leaning = stiff_where_it_leans(cell, [](double mass) { return modes(mass); });
  const ProgramBlocks blocks = judge_blocks(forces, leaning, {.scan_points = 0});
  const Judged judged = {.forces = forces, .blocks = blocks};
  DecideProblem asked = problem(judged, leaning);
  EXPECT_EQ(decide(asked).status, DecideResult::Status::infeasible);
  asked.options.free = {Free::spindle_speed, Free::feed, Free::lead};
  asked.options.cone_step_rad = 15.0 * units::deg;
  const DecideResult result = decide(asked);
  ASSERT_EQ(result.status, DecideResult::Status::found) << result.reason;
  EXPECT_TRUE(result.collisions_checked);
  EXPECT_EQ(result.decided->unstable_blocks, 0U);
  for (const DecidedLines& lines : result.stretches) {
    EXPECT_NEAR(std::abs(lines.lead_rad), 15.0 * units::deg, 1e-12);
    EXPECT_EQ(lines.tilt_rad, 0.0);
  }
  const double radius_m = 0.5 * forces.cut.cutter.mill.diameter_m;
  const program::Program& before = forces.program->program;
  for (std::size_t i = 0; i < before.blocks.size(); ++i) {
    const program::Pose& was = before.blocks[i].end;
    const program::Pose& is = result.forces->program->program.blocks[i].end;
    EXPECT_LT((is.tip_m + radius_m * is.axis - was.tip_m - radius_m * was.axis).norm(), 1e-12) << i;
    EXPECT_NEAR(program::angle_between(was.axis, is.axis), 15.0 * units::deg, 1e-9) << i;
    // By forward kinematics the robot holds it so.
    const robot::ToolPose pose =
        robot::tool_pose(cell, robot::forward(cell.arm, result.forces->program->blocks[i].joints));
    EXPECT_LT((pose.tip_m - is.tip_m).norm(), 1e-9) << i;
    EXPECT_LT((pose.axis - is.axis).norm(), 1e-9) << i;
  }
  // The surface is the same.
  const cutting::Workpiece programmed = finished(forces, before);
  const cutting::Workpiece leant = finished(forces, result.forces->program->program);
  const double removed_m3 = 40e-3 * 16e-3 * 8e-3 - programmed.volumes_m3().mean();
  EXPECT_LT((programmed.volumes_m3() - leant.volumes_m3()).cwiseAbs().maxCoeff(), 0.01 * removed_m3);
  for (int pass = 0; pass < 3; ++pass) {
    for (const double x_mm : {-8.0, 0.0, 8.0}) {
      const Eigen::Vector3d bottom = Eigen::Vector3d(x_mm, pass, -0.6 - 0.2 * pass) * 1e-3;
      EXPECT_NEAR(programmed.depth_m(bottom), leant.depth_m(bottom), 0.02e-3) << pass << " " << x_mm;
    }
  }
}

TEST_F(DecidePostures, LeansThatCollideAreLeftOut) {
  // Beside the end of the passes, 4 mm from the holder of an upright tool.
  add_geometry("fixtures = [{ box_from_mm = [31, -20, 25], box_to_mm = [45, 20, 60] }]\n");
  const ForcesResult forces = this->forces();
  const DynamicsAt leaning = stiff_where_it_leans(forces.cell->robot, [](double mass) { return modes(mass); });
  const ProgramBlocks blocks = judge_blocks(forces, leaning, {.scan_points = 0});
  const Judged judged = {.forces = forces, .blocks = blocks};
  DecideProblem asked = problem(judged, leaning);
  asked.options.free = {Free::spindle_speed, Free::feed, Free::lead};
  asked.options.cone_step_rad = 15.0 * units::deg;
  const DecideResult result = decide(asked);
  ASSERT_EQ(result.status, DecideResult::Status::found) << result.reason;
  for (const DecidedLines& lines : result.stretches) EXPECT_NEAR(lines.lead_rad, -15.0 * units::deg, 1e-12);
  EXPECT_TRUE(std::ranges::any_of(result.notes, [](const std::string& note) {
    return note.find("leans") != std::string::npos && note.find("holder") != std::string::npos;
  }));
}

TEST_F(DecidePostures, LeansNeedAGeometryAndABall) {
  const DynamicsAt dynamics = constant_dynamics(modes(20.0));
  {
    const Judged judged = judge(dynamics);
    DecideProblem asked = problem(judged, dynamics);
    asked.options.free = {Free::spindle_speed, Free::feed, Free::lead, Free::tilt};
    const DecideResult result = decide(asked);
    ASSERT_EQ(result.status, DecideResult::Status::found) << result.reason;
    EXPECT_TRUE(std::ranges::any_of(
        result.notes, [](const std::string& note) { return note.find("stay as programmed") != std::string::npos; }));
    for (std::size_t i = 0; i < result.forces->program->program.blocks.size(); ++i) {
      EXPECT_EQ(result.forces->program->program.blocks[i].end.axis, judged.forces.program->program.blocks[i].end.axis);
    }
  }
  cut_ = testing::cut_of({.kind = "flat-end", .dexel_mm = 0.25});
  add_geometry(far_box);
  const Judged flat = judge(dynamics);
  DecideProblem asked = problem(flat, dynamics);
  asked.options.free = {Free::spindle_speed, Free::feed, Free::tilt};
  const std::string text = test::rejection([&] { static_cast<void>(decide(asked)); });
  EXPECT_NE(text.find("ball end"), std::string::npos) << text;
}

// What the drives give while the robot moves is a limit of the feed.
TEST_F(DecidePostures, AMotionThatTheDrivesCannotGiveIsFedSlower) {
  const DynamicsAt dynamics = constant_dynamics(modes(20.0));
  const Judged judged = judge(dynamics);
  DecideProblem asked = problem(judged, dynamics);
  const DecideResult free = decide(asked);
  ASSERT_EQ(free.status, DecideResult::Status::found) << free.reason;
  const double most_m_per_s = 0.8 * free.stretches.front().lowest_feed_m_per_s;
  asked.robot_run = [&](const ForcesResult& run, const ProgramBlocks&, const std::vector<double>&) {
    RobotRun out;
    for (std::size_t i = 0; i < run.program->program.blocks.size(); ++i) {
      const program::Block& block = run.program->program.blocks[i];
      const double way_m = (block.end.tip_m - run.program->program.begin_of(i).tip_m).norm();
      out.torque_shares.push_back(block.duration_s > 0.0 ? way_m / block.duration_s / most_m_per_s : 0.0);
    }
    return out;
  };
  const DecideResult result = decide(asked);
  ASSERT_EQ(result.status, DecideResult::Status::found) << result.reason;
  EXPECT_LE(result.decided->greatest_torque_share, 1.0);
  EXPECT_GE(result.decided->greatest_torque_share, 0.9);
  EXPECT_GT(result.as_programmed.greatest_torque_share, 0.0);
  for (const DecidedLines& lines : result.stretches) EXPECT_LE(lines.highest_feed_m_per_s, most_m_per_s);
}

// Two ways to the same: Jacobian and forces of the cut, and what is left of the loads without the weight.
TEST_F(DecidePostures, LoadsOfJointsAreWeightAndCut) {
  add_links();
  const Judged judged = judge(constant_dynamics(modes(20.0)));
  const cell::Cell& file = *judged.forces.cell;
  const robot::Arm& arm = file.robot.arm;
  ASSERT_EQ(judged.blocks.joint_loads.size(), judged.blocks.rows.size());
  for (std::size_t i = 0; i < judged.blocks.rows.size(); ++i) {
    const BlockRow& row = judged.blocks.rows[i];
    if (!row.cuts) continue;
    const std::vector<robot::JointLoad> at_rest = robot::joint_loads(
        cell::loaded_arm(file), judged.forces.program->blocks[i].joints, robot::tip_point(file.robot));
    double cut = 0.0, share = 0.0;
    for (std::size_t k = 0; k < at_rest.size(); ++k) {
      const robot::JointLoadRange& load = judged.blocks.joint_loads[i].joints[k];
      cut = std::max({cut, std::abs(load.min - at_rest[k].gravity), std::abs(load.max - at_rest[k].gravity)});
      share = std::max(share, std::max(std::abs(load.min), std::abs(load.max)) / arm.joints[k].max_torque);
    }
    EXPECT_GT(cut, 0.0);
    EXPECT_NEAR(row.cut_joint_torque_n_m, cut, 1e-9 * (cut + std::abs(at_rest[1].gravity))) << i;
    EXPECT_NEAR(row.joint_torque_share, share, 1e-12) << i;
  }
}

// Against the equation of motion at speeds and accelerations in closed form.
TEST_F(DecidePostures, LoadsOfAMotionAreThoseOfItsDerivatives) {
  add_links();
  const ForcesResult forces = this->forces();
  const cell::Cell& file = *forces.cell;
  ASSERT_TRUE(knows_torques(file));
  const Eigen::VectorXd middle = forces.program->blocks[5].joints;
  const Eigen::VectorXd swing = Eigen::VectorXd::LinSpaced(6, 0.05, 0.3);
  const double rate = 7.0, period_s = 0.002;
  const std::size_t blocks = forces.program->blocks.size();
  std::vector<std::size_t> each(blocks);
  std::iota(each.begin(), each.end(), std::size_t{0});
  MotionLoads loads(file, period_s, each);
  std::vector<double> expected(blocks, 0.0);
  for (int i = 0; i <= 1500; ++i) {
    const double time_s = i * period_s;
    path::Sample sample;
    sample.time_s = time_s;
    sample.joints = middle + swing * std::sin(rate * time_s);
    sample.block = static_cast<std::size_t>(i) * (blocks - 1) / 1500;
    loads.add(std::span(&sample, 1));
    if (i == 0 || i == 1500) continue;
    robot::JointLoadOptions moving;
    moving.velocity = swing * rate * std::cos(rate * time_s);
    moving.acceleration = -swing * rate * rate * std::sin(rate * time_s);
    const std::vector<robot::JointLoad> exact = robot::joint_loads(
        cell::loaded_arm(file), Eigen::VectorXd(sample.joints), robot::tip_point(file.robot), {}, moving);
    for (std::size_t k = 0; k < exact.size(); ++k) {
      expected[sample.block] =
          std::max(expected[sample.block], std::abs(*exact[k].torque()) / file.robot.arm.joints[k].max_torque);
    }
  }
  // No block cuts: what each bears beside its weight is nothing.
  ProgramBlocks none;
  none.rows.resize(blocks);
  add_joint_torques(forces, none);
  const std::vector<double> found = loads.shares(forces, none.joint_loads);
  double greatest = 0.0;
  for (std::size_t i = 0; i < blocks; ++i) {
    EXPECT_NEAR(found[i], expected[i], 2e-3 * expected[i]) << i;
    greatest = std::max(greatest, expected[i]);
  }
  EXPECT_GT(greatest, 0.2);
}

}  // namespace decide_postures_test
}  // namespace robomill::process
