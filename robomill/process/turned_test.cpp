#include "robomill/process/turned.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/process/files/turned_json.hpp"
#include "robomill/robot/pose.hpp"
#include "robomill/robot/stiffness.hpp"
#include "testing/process/programs.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::process {
namespace turned_test {

/// A program that was judged, and decided where that was asked for.
struct Judging {
  ForcesResult forces;
  ProgramBlocks blocks;
  BlocksJudging judging = {};
  Decision decision = {};
  [[nodiscard]] JudgedProgram program() const {
    return {.forces = forces,
            .blocks = blocks,
            .judging = judging,
            .gamma_offset_rad = decision.gamma_offset_rad,
            .map_blocks = decision.gamma_map ? decision.gamma_map->block : std::vector<std::size_t>()};
  }
};

class Turned : public testing::ThreePasses {
 protected:
  void SetUp() override {
    ThreePasses::SetUp();
    // The tool leans from the flange's axis, so that every joint moves with γ.
    cell_ = test_support::replaced(cell_, "length_mm = 250\n", "length_mm = 250\nmount_rotation_deg = [0, 40, 0]\n");
  }
  /// Softer where the last joint stands as programmed.
  [[nodiscard]] DynamicsAt turning() const {
    const double programmed = forces().program->blocks[10].joints(5);
    return [programmed](const Eigen::VectorXd& joints) {
      const double away = std::sin(0.5 * (joints(5) - programmed));
      return PostureDynamics{.modes = modes(0.2 + 20.0 * away * away)};
    };
  }
  [[nodiscard]] Judging judged_with(const DynamicsAt& dynamics) const {
    Judged judged = judge(dynamics);
    return {.forces = std::move(judged.forces),
            .blocks = std::move(judged.blocks),
            .judging = {.dynamics = dynamics, .options = {.scan_points = 0}}};
  }
  static Judging decided(Judging judging, const DecideOptions& options) {
    const Judged programmed = {.forces = judging.forces, .blocks = judging.blocks};
    DecideProblem asked = problem(programmed, judging.judging.dynamics);
    asked.options = options;
    DecideResult found = decide(asked);
    if (found.forces) {
      judging.forces = *std::move(found.forces);
      judging.blocks = *std::move(found.blocks);
    }
    judging.decision = static_cast<Decision&&>(found);
    return judging;
  }
  static std::vector<double> ways(const Judging& judging) {
    const program::Program& program = judging.forces.program->program;
    std::vector<double> out = {0.0};
    for (std::size_t i = 0; i < program.blocks.size(); ++i) {
      out.push_back(out.back() + (program.blocks[i].end.tip_m - program.begin_of(i).tip_m).norm());
    }
    return out;
  }
};

/// Every number of the blocks, without how long they took.
std::string numbers_of(const ForcesResult& forces, const ProgramBlocks& blocks) {
  return blocks_csv(forces, blocks);
}

TEST_F(Turned, AsProgrammedItIsThePlan) {
  const Judging plan = judged_with(constant_dynamics(modes()));
  const TurnedProgram same = judge_turned(plan.program(), {{.path_m = 0.0, .gamma_rad = 0.0}});
  EXPECT_EQ(numbers_of(same.forces, same.blocks), numbers_of(plan.forces, plan.blocks));
  EXPECT_EQ(same.blocks.worst, plan.blocks.worst);
  EXPECT_EQ(same.blocks.evaluations, plan.blocks.evaluations);
  EXPECT_TRUE(same.blocks.scans.empty());
  EXPECT_TRUE(same.lost.empty());
  // There is no map: every block that cuts is shown.
  EXPECT_EQ(same.shown.size(), plan.blocks.cutting);
}

// γ counts from the program as programmed, also where the plan has turned it.
TEST_F(Turned, AtTheChosenGammaItIsThePlan) {
  const Judging plan =
      decided(judged_with(turning()), {.free = {Free::feed, Free::gamma}, .gamma_step_rad = 15.0 * units::deg});
  ASSERT_EQ(plan.decision.status, DecideResult::Status::found) << plan.decision.reason;
  const std::vector<double>& chosen = plan.decision.gamma_offset_rad;
  ASSERT_TRUE(std::ranges::any_of(chosen, [](double g) { return g != 0.0; }));
  const std::vector<double> way = ways(plan);
  std::vector<GammaKnot> knots;
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (knots.empty() || way[i] > knots.back().path_m) knots.push_back({.path_m = way[i], .gamma_rad = chosen[i]});
  }
  const TurnedProgram same = judge_turned(plan.program(), knots);
  EXPECT_EQ(numbers_of(same.forces, same.blocks), numbers_of(plan.forces, plan.blocks));
  EXPECT_NEAR(same.least_stability_margin, plan.decision.decided->least_stability_margin, 1e-12);
  ASSERT_EQ(same.shown, plan.decision.gamma_map->block);
  for (std::size_t k = 0; k < same.shown.size(); ++k) {
    EXPECT_NEAR(same.gamma_rad[k], plan.decision.gamma_map->chosen_rad[k], 1e-12);
    EXPECT_NEAR(same.path_m[k], plan.decision.gamma_map->path_m[k], 1e-12);
  }
}

// The map looks at one block a class (2° of a joint, 5 % of depth and stiffness), here each block is judged.
TEST_F(Turned, AgreesWithTheMapAtEveryGammaOfIt) {
  const Judging plan =
      decided(judged_with(turning()), {.free = {Free::feed, Free::gamma}, .gamma_step_rad = 30.0 * units::deg});
  ASSERT_EQ(plan.decision.status, DecideResult::Status::found) << plan.decision.reason;
  const GammaMap& map = *plan.decision.gamma_map;
  int compared = 0;
  for (std::size_t g = 0; g < map.gamma_rad.size(); ++g) {
    const TurnedProgram turned = judge_turned(plan.program(), {{.path_m = 0.0, .gamma_rad = map.gamma_rad[g]}});
    for (std::size_t k = 0; k < map.block.size(); ++k) {
      const double of_map = map.margin(static_cast<Eigen::Index>(g), static_cast<Eigen::Index>(k));
      const double found = turned.blocks.rows[map.block[k]].stability_margin;
      ASSERT_EQ(std::isnan(of_map), std::isnan(found)) << map.gamma_rad[g] / units::deg << "° " << map.block[k];
      if (std::isnan(of_map)) continue;
      ++compared;
      // Depth over limit.
      EXPECT_NEAR(1.0 - found, 1.0 - of_map, 0.1 * (1.0 - of_map))
          << map.gamma_rad[g] / units::deg << "° " << map.block[k];
    }
  }
  EXPECT_GT(compared, 50);
}

// By forward kinematics, and by the compliance there.
TEST_F(Turned, TheRobotHoldsTheToolSoAndBendsAsItDoesThere) {
  const Judging plan = judged_with(constant_dynamics(modes()));
  const double end_m = ways(plan).back();
  const std::vector<GammaKnot> knots = {{.path_m = 0.2 * end_m, .gamma_rad = -20.0 * units::deg},
                                        {.path_m = 0.7 * end_m, .gamma_rad = 40.0 * units::deg}};
  const TurnedProgram turned = judge_turned(plan.program(), knots);
  ASSERT_TRUE(turned.lost.empty());
  const robot::Cell& cell = plan.forces.cell->robot;
  const std::vector<double> way = ways(plan);
  bool other = false;
  for (std::size_t i = 0; i < plan.blocks.rows.size(); ++i) {
    const BlockResult& was = plan.forces.program->blocks[i];
    const BlockResult& is = turned.forces.program->blocks[i];
    const robot::ToolPose from = robot::tool_pose(cell, robot::forward(cell.arm, was.joints));
    const robot::ToolPose to = robot::tool_pose(cell, robot::forward(cell.arm, is.joints));
    EXPECT_LT((to.tip_m - from.tip_m).norm(), 1e-9) << i;
    EXPECT_LT((to.axis - from.axis).norm(), 1e-9) << i;
    const double share = std::clamp((way[i + 1] / end_m - 0.2) / 0.5, 0.0, 1.0);
    EXPECT_NEAR(to.gamma_rad - from.gamma_rad, (-20.0 + 60.0 * share) * units::deg, 1e-9) << i;
    const Eigen::Matrix3d base_from_work = cell.workpiece.linear();
    const Eigen::Vector3d force_n = base_from_work * was.force.mean_force_n;
    const robot::Stiffness there = robot::stiffness(cell.arm, is.joints, robot::tip_point(cell), {.force_n = force_n});
    const Eigen::Vector3d bent_m = base_from_work.transpose() * (there.compliance.topLeftCorner<3, 3>() * force_n);
    EXPECT_LT((is.deflection_m - bent_m).norm(), 1e-12) << i;
    EXPECT_EQ(is.condition_number, there.condition_number) << i;
    other = other || (is.deflection_m - was.deflection_m).norm() > 0.01 * was.deflection_m.norm();
    EXPECT_EQ(is.force.peak_force_n, was.force.peak_force_n);
  }
  EXPECT_TRUE(other);
}

TEST_F(Turned, KeepsTheLeanOfADecision) {
  cell_ +=
      "\n[geometry]\nstickout_mm = 30\nclearance_mm = 1\nholder = [{ length_mm = 20, diameter_mm = 30 }]\n"
      "fixtures = [{ box_from_mm = [500, 500, 0], box_to_mm = [520, 520, 20] }]\n";
  const ForcesResult programmed = this->forces();
  const robot::Cell& cell = programmed.cell->robot;
  const DynamicsAt leaning = [&cell](const Eigen::VectorXd& joints) {
    const Eigen::Vector3d axis = robot::tool_pose(cell, robot::forward(cell.arm, joints)).axis;
    return PostureDynamics{.modes = modes(0.05 + 20.0 * (1.0 - axis.z() * axis.z()))};
  };
  const Judging plan = decided(judged_with(leaning), {.free = {Free::spindle_speed, Free::feed, Free::lead},
                                                      .cone_step_rad = 15.0 * units::deg});
  ASSERT_EQ(plan.decision.status, DecideResult::Status::found) << plan.decision.reason;
  ASSERT_NE(plan.decision.stretches.front().lead_rad, 0.0);
  const TurnedProgram same = judge_turned(plan.program(), {{.path_m = 0.0, .gamma_rad = 0.0}});
  EXPECT_EQ(numbers_of(same.forces, same.blocks), numbers_of(plan.forces, plan.blocks));
  const TurnedProgram turned = judge_turned(plan.program(), {{.path_m = 0.0, .gamma_rad = 10.0 * units::deg}});
  ASSERT_TRUE(turned.lost.empty()) << turned.lost.front().reason;
  for (std::size_t i = 0; i < plan.blocks.rows.size(); ++i) {
    const robot::ToolPose was = robot::tool_pose(cell, robot::forward(cell.arm, programmed.program->blocks[i].joints));
    const robot::ToolPose is =
        robot::tool_pose(cell, robot::forward(cell.arm, turned.forces.program->blocks[i].joints));
    const program::Pose& end = plan.forces.program->program.blocks[i].end;
    EXPECT_LT((is.tip_m - end.tip_m).norm(), 1e-9) << i;
    EXPECT_LT((is.axis - end.axis).norm(), 1e-9) << i;
    EXPECT_NEAR(is.gamma_rad - was.gamma_rad, 10.0 * units::deg, 1e-9) << i;
  }
}

TEST_F(Turned, SaysWhereTheRobotCannotStand) {
  Judging plan = judged_with(turning());
  const std::vector<double> way = ways(plan);
  const std::vector<GammaKnot> ramp = {{.path_m = 0.0, .gamma_rad = 0.0},
                                       {.path_m = way.back(), .gamma_rad = 60.0 * units::deg}};
  const TurnedProgram free = judge_turned(plan.program(), ramp);
  ASSERT_TRUE(free.lost.empty());
  EXPECT_TRUE(free.other_way.empty());
  robot::Joint& last = plan.forces.cell->robot.arm.joints.back();
  const double begin = plan.forces.program->blocks.front().joints(5);
  const double end = free.forces.program->blocks.back().joints(5);
  (end > begin ? last.max_position : last.min_position) = 0.5 * (begin + end);
  // Where the last joint ends halfway it turns back once …
  EXPECT_EQ(judge_turned(plan.program(), ramp).other_way.size(), 1U);
  // … which here it has no room for, nor the others for the wrist to go over.
  (end > begin ? last.min_position : last.max_position) = begin + (end > begin ? -0.3 : 0.3);
  std::vector<robot::Joint>& joints = plan.forces.cell->robot.arm.joints;
  for (std::size_t k = 0; k + 1 < joints.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    const auto [low, high] = std::ranges::minmax(free.forces.program->blocks, {},
                                                 [at](const BlockResult& block) { return block.joints(at); });
    joints[k].min_position = low.joints(at) - 0.3;
    joints[k].max_position = high.joints(at) + 0.3;
  }
  const TurnedProgram turned = judge_turned(plan.program(), ramp);
  ASSERT_FALSE(turned.lost.empty());
  EXPECT_LT(turned.lost.size(), way.size() - 1);
  std::vector<bool> lost(turned.blocks.rows.size(), false);
  for (const LostBlock& block : turned.lost) {
    EXPECT_EQ(block.reason, "the robot cannot stand so");
    lost[block.block] = true;
    EXPECT_FALSE(turned.blocks.rows[block.block].cuts);
  }
  std::size_t cutting = 0;
  for (std::size_t i = 0; i < lost.size(); ++i) {
    const double joint = free.forces.program->blocks[i].joints(5);
    EXPECT_EQ(lost[i], end > begin ? joint > last.max_position : joint < last.min_position) << i;
    if (lost[i] || !free.blocks.rows[i].cuts) continue;
    ++cutting;
    EXPECT_EQ(turned.forces.program->blocks[i].joints, free.forces.program->blocks[i].joints) << i;
    EXPECT_NEAR(turned.blocks.rows[i].stability_margin, free.blocks.rows[i].stability_margin, 0.05) << i;
  }
  EXPECT_EQ(turned.blocks.cutting, cutting);
  const io::Json json = turned_object(turned);
  EXPECT_EQ(json["lost"].size(), turned.lost.size());
  const std::size_t first = turned.lost.front().block;
  EXPECT_EQ(json["lost"][0]["block"], first + 1);
  EXPECT_EQ(json["lost"][0]["line"], plan.forces.program->program.blocks[first].line);
  EXPECT_TRUE(json["blocks"]["blocks"]["q6"][first].is_null());
  EXPECT_TRUE(json["blocks"]["blocks"]["stability_margin"][first].is_null());
  EXPECT_EQ(json["unstable"], turned.blocks.unstable);

  // Nowhere: no block is left, and that is an answer too.
  for (robot::Joint& joint : joints) joint.max_position = joint.min_position + 1e-3;
  const TurnedProgram nowhere = judge_turned(plan.program(), {{.path_m = 0.0, .gamma_rad = 1.0}});
  EXPECT_EQ(nowhere.lost.size(), way.size() - 1);
  EXPECT_TRUE(turned_object(nowhere)["worst_block"].is_null());
  EXPECT_TRUE(turned_object(nowhere)["least_margin"].is_null());
}

// Obstacles around the tool count as soon as a posture is not the plan's.
TEST_F(Turned, SaysWhereSomethingIsInTheWay) {
  cell_ +=
      "\n[geometry]\nstickout_mm = 30\nclearance_mm = 1\nholder = [{ length_mm = 20, diameter_mm = 30 }]\n"
      "fixtures = [{ box_from_mm = [-30, -30, 35], box_to_mm = [30, 30, 45] }]\n";
  const Judging plan = judged_with(constant_dynamics(modes(20.0)));
  EXPECT_TRUE(judge_turned(plan.program(), {{.path_m = 0.0, .gamma_rad = 0.0}}).lost.empty());
  const TurnedProgram turned = judge_turned(plan.program(), {{.path_m = 0.0, .gamma_rad = 0.1}});
  ASSERT_FALSE(turned.lost.empty());
  EXPECT_NE(turned.lost.front().reason.find("holder"), std::string::npos) << turned.lost.front().reason;
  EXPECT_NE(turned.notes.back().find("cannot stand"), std::string::npos) << turned.notes.back();
}

// Weight and cut at rest, against what the drives give.
TEST_F(Turned, SaysWhereADriveGivesNoMore) {
  Judging plan = judged_with(constant_dynamics(modes(20.0)));
  const auto noted = [&] {
    const TurnedProgram turned = judge_turned(plan.program(), {{.path_m = 0.0, .gamma_rad = 0.1}});
    const bool says = std::ranges::any_of(turned.notes, [](const std::string& note) {
      return note.find("a drive gives more than its torque") != std::string::npos;
    });
    const bool over =
        std::ranges::any_of(turned.blocks.rows, [](const BlockRow& row) { return row.joint_torque_share > 1.0; });
    EXPECT_EQ(says, over);
    return says;
  };
  EXPECT_FALSE(noted()) << "no drive has a limit";
  for (robot::Joint& joint : plan.forces.cell->robot.arm.joints) {
    joint.link.mass_kg = 50.0;
    joint.max_torque = 1e6;
  }
  EXPECT_FALSE(noted());
  plan.forces.cell->robot.arm.joints[1].max_torque = 1.0;
  EXPECT_TRUE(noted());
}

TEST_F(Turned, RejectsWhatItCannotTurnAndEndsWhenAsked) {
  Judging plan = judged_with(constant_dynamics(modes()));
  const auto said = [&](const std::vector<GammaKnot>& knots) {
    return test::field_of([&] { static_cast<void>(judge_turned(plan.program(), knots)); });
  };
  EXPECT_EQ(said({}), "gamma");
  EXPECT_EQ(said({{.path_m = 0.1}, {.path_m = 0.1}}), "path_m");
  EXPECT_EQ(said({{.path_m = NAN}}), "path_m");
  EXPECT_EQ(said({{.path_m = 0.0, .gamma_rad = HUGE_VAL}}), "gamma_rad");
  const std::atomic<bool> stop = true;
  Progress stopped({}, &stop);
  EXPECT_THROW(static_cast<void>(judge_turned(plan.program(), {{.path_m = 0.0, .gamma_rad = 0.5}}, stopped)),
               Interrupted);
}

}  // namespace turned_test
}  // namespace robomill::process
