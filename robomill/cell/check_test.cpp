#include "robomill/cell/check.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/check/placement.hpp"
#include "robomill/cell/check/shown.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/cell/files/check_json.hpp"
#include "robomill/cell/files/known_arms.hpp"
#include "robomill/robot/euler.hpp"
#include "robomill/robot/kinematics/choose.hpp"
#include "testing/robot/arms.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::cell {
namespace check_test {

using robomill::test::Folder;
using robomill::test::rejection;
using test_support::replaced;
namespace arms = robot::testing;

/// A KR 210 before a table.
std::string kr210(const std::string& workpiece = "origin_mm = [1800, 0, 700]\n", const std::string& robot = "") {
  return "[robot]\nmodel = \"kuka-kr210-r2700\"\n" + robot + "[workpiece]\n" + workpiece + "[tool]\nlength_mm = 350\n";
}

CellCheck checked(const Folder& folder, const std::string& cell, const std::string& program = "",
                  std::vector<double> joints = {}) {
  CellCheckJob job{.cell = folder.file("cell.toml", cell), .joints = std::move(joints)};
  if (!program.empty()) job.program = folder.file("part.ngc", program);
  return run_cell_check(job);
}

const CellStand& named(const CellCheck& check, const std::string& name) {
  const auto found = std::ranges::find(check.stands, name, &CellStand::name);
  EXPECT_NE(found, check.stands.end()) << name;
  return *found;
}

// R is made again of its angles, also where the second one is a right angle.
TEST(CellCheck, NamesRotationsByThreeAngles) {
  Random random(1);
  const auto turned = [](const robot::Euler& angles) {
    return Eigen::Matrix3d(Eigen::AngleAxisd(angles.a_rad, Eigen::Vector3d::UnitZ()) *
                           Eigen::AngleAxisd(angles.b_rad, Eigen::Vector3d::UnitY()) *
                           Eigen::AngleAxisd(angles.c_rad, Eigen::Vector3d::UnitX()));
  };
  for (int k = 0; k < 300; ++k) {
    robot::Euler angles{.a_rad = random.uniform(-arms::pi, arms::pi), .c_rad = random.uniform(-arms::pi, arms::pi)};
    angles.b_rad = k % 3 == 0 ? (k % 2 == 0 ? 0.5 : -0.5) * arms::pi : random.uniform(-1.5, 1.5);
    const Eigen::Matrix3d turn = turned(angles);
    EXPECT_LT((turned(robot::euler_of(turn)) - turn).norm(), 1e-8) << k;
  }
}

// Flange and tip by the arm's own kinematics, in both frames; the spindle bolted on across does not move the flange.
TEST(CellCheck, ShowsWhereTheJointsPutTheTool) {
  const Folder folder;
  const std::vector<double> joints = {0.3, -1.2, 1.7, 0.5, 0.9, -0.4};
  const std::string mount = "mount_origin_mm = [0, 80, 150]\nmount_rotation_deg = [0, -90, 0]\n";
  for (const std::string& tool : {std::string(), mount}) {
    const CellCheck check =
        checked(folder, kr210("origin_mm = [1800, 0, 700]\nrotation_deg = [0, 0, 90]\n") + tool, "", joints);
    const Cell plain = read_cell(folder.file("plain.toml", "[robot]\nmodel = \"kuka-kr210-r2700\"\n"));
    const Eigen::Isometry3d flange =
        robot::forward(plain.robot.arm, Eigen::Map<const Eigen::VectorXd>(joints.data(), 6));
    const CellStand& stand = named(check, "as asked for");
    EXPECT_LT((stand.flange.matrix() - flange.matrix()).cwiseAbs().maxCoeff(), 1e-12);
    const Eigen::Vector3d tip =
        tool.empty() ? flange * Eigen::Vector3d(0.0, 0.0, 0.35) : flange * Eigen::Vector3d(-0.35, 0.08, 0.15);
    EXPECT_LT((stand.tip_m - tip).norm(), 1e-12);
    const Eigen::Vector3d axis = tool.empty() ? Eigen::Vector3d(-flange.linear().col(2)) : flange.linear().col(0);
    EXPECT_LT((stand.axis - axis).norm(), 1e-12);
    EXPECT_LT((stand.tool.tip_m - Eigen::Vector3d(tip.y(), 1.8 - tip.x(), tip.z() - 0.7)).norm(), 1e-12);
  }
}

TEST(CellCheck, SaysHowFarAPositionIsFromItsLimits) {
  const Folder folder;
  const CellCheck check = checked(folder, kr210());
  const CellStand& home = named(check, "home");
  const double expected_deg[] = {185, 60, 47, 350, 63, 350};
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(home.to_limit(i) / units::deg, expected_deg[i], 1e-9) << i;
  EXPECT_EQ(home.nearest_joint, 2) << "47° of 137.5°";
  ASSERT_EQ(check.at_limits.size(), 12U);
  for (const CellStand& stand : check.at_limits) EXPECT_NEAR(stand.to_limit.minCoeff(), 0.0, 1e-15) << stand.name;
  EXPECT_EQ(check.at_limits[3].name, "joint 2 at its upper limit");
  EXPECT_NEAR(check.at_limits[3].position(1) / units::deg, -5.0, 1e-12);
  const CellCheck beyond = checked(folder, kr210(), "", {0.0, 0.1, 1.7, 0.0, 0.9, 0.0});
  EXPECT_NEAR(named(beyond, "as asked for").to_limit(1), -0.1 - 5.0 * units::deg, 1e-12);
  EXPECT_NE(summary(beyond).find("joint 2 is 10.73° beyond its limit"), std::string::npos) << summary(beyond);
}

// 20 that failed and 60 all along it, of any length.
TEST(CellCheck, LooksAtEightyPosesAtMost) {
  Placement failed;
  for (std::size_t i = 0; i < 30; ++i) failed.misses.push_back({.block = i});
  for (std::size_t poses = 1; poses < 1500; ++poses) {
    const std::vector<std::size_t> looks = poses_to_look_at(failed, poses);
    EXPECT_LE(looks.size(), 80U) << poses;
    EXPECT_GT(looks.size(), 20U);
    EXPECT_LT(looks.back(), poses);
    EXPECT_GE(looks.back() + 1 + poses / 30, poses) << "up to its end";
  }
  EXPECT_EQ(poses_to_look_at({}, 119).size(), 60U);
}

TEST(CellCheck, FindsTheShippedCellsInOrder) {
  for (const KnownArm& arm : known_arms()) {
    const CellCheck check = run_cell_check({.cell = ROBOMILL_SOURCE_DIR "/data/cells/" + arm.name + ".toml"});
    EXPECT_TRUE(check.placement.works()) << summary(check);
    EXPECT_GT(check.placement.choice.margin.least, 0.02) << arm.name;
    const CellStand& there = named(check, "workpiece's origin");
    EXPECT_LT(there.tool.tip_m.norm(), 1e-9) << arm.name;
    EXPECT_LT((there.tool.axis - Eigen::Vector3d::UnitZ()).norm(), 1e-9) << arm.name;
    EXPECT_GT(there.to_limit.minCoeff(), 0.0) << arm.name;
    EXPECT_TRUE(check.proposals.empty());
    EXPECT_EQ(check.drawing.figures.size(), 2U);
    EXPECT_FALSE(check.drawing.reach_side_m.empty()) << arm.name;
    EXPECT_FALSE(check.drawing.reach_top_m.empty()) << arm.name;
  }
}

// A stretched arm: what is missing grows as the workpiece goes away, and a step back by it is just enough.
TEST(CellCheck, SaysByHowMuchAWorkpieceIsOutOfReach) {
  const Folder folder;
  const auto check_at = [&](double x_mm) {
    return checked(folder, kr210(fmt::format("origin_mm = [{}, 0, 675]\nrotation_deg = [0, -90, 0]\n", x_mm)));
  };
  const CellCheck far = check_at(4000.0);
  ASSERT_EQ(far.placement.misses.size(), 1U);
  const Miss& miss = far.placement.misses[0];
  EXPECT_EQ(miss.status, robot::Reach::Status::out_of_reach);
  // The tool points along x: its wrist is 565 mm before the tip, and reaches 1150 + |(1200, 41)| from (350, 675).
  const double reach_mm = 350.0 + 1150.0 + std::hypot(1200.0, 41.0) + 565.0;
  EXPECT_NEAR(miss.out_of_reach_m / units::mm, 4000.0 - reach_mm, 1e-6);
  EXPECT_EQ(what_misses(miss, far.prismatic), fmt::format("out of reach by {:.4g} mm", 4000.0 - reach_mm));
  EXPECT_TRUE(std::ranges::none_of(check_at(reach_mm - 1.0).placement.misses,
                                   [](const Miss& near) { return near.status == robot::Reach::Status::out_of_reach; }));
}

// With one turn about the tool alone the joints are known: those beyond their limits, each with its side and amount.
TEST(CellCheck, NamesEveryJointBeyondItsLimit) {
  const Folder folder;
  const std::string narrow =
      "gamma_deg = 0\njoint_min_position_deg = [-185, -140, -120, -350, -20, -350]\n"
      "joint_max_position_deg = [185, -5, 100, 350, 20, 350]\n";
  const CellCheck check = checked(folder, kr210("origin_mm = [1800, 0, 700]\n", narrow));
  ASSERT_EQ(check.placement.misses.size(), 1U);
  const Miss& miss = check.placement.misses[0];
  ASSERT_EQ(miss.status, robot::Reach::Status::outside_limits);
  ASSERT_FALSE(miss.beyond.empty());
  // The same pose of an arm without such limits.
  const CellCheck free = checked(folder, kr210("origin_mm = [1800, 0, 700]\n", "gamma_deg = 0\n"));
  const robot::Position6& there = named(free, "workpiece's origin").position;
  for (const BeyondLimit& beyond : miss.beyond) {
    EXPECT_GT(std::abs(beyond.position - beyond.limit), 0.0);
    EXPECT_EQ(beyond.above(), beyond.position > 0.0) << beyond.joint;
  }
  const auto wrist = std::ranges::find(miss.beyond, 4, &BeyondLimit::joint);
  ASSERT_NE(wrist, miss.beyond.end());
  EXPECT_NEAR(std::abs(wrist->position), std::abs(there(4)), 1e-9);
  EXPECT_NEAR(std::abs(wrist->limit), 20.0 * units::deg, 1e-12);
  const std::string said = what_misses(miss, check.prismatic);
  EXPECT_NE(said.find(fmt::format("joint 5 is {:.4g}° {} limit of {}20°",
                                  (std::abs(wrist->position) - std::abs(wrist->limit)) / units::deg,
                                  wrist->above() ? "above its upper" : "below its lower", wrist->above() ? "" : "-")),
            std::string::npos)
      << said;
}

TEST(CellCheck, TellsWhereATurnAboutTheToolWouldDo) {
  const Folder folder;
  const std::string narrow =
      "joint_min_position_deg = [-185, -140, -120, -350, -125, -20]\n"
      "joint_max_position_deg = [185, -5, 155, 350, 125, 20]\n";
  const CellCheck fixed = checked(folder, kr210("origin_mm = [1800, 0, 700]\n", "gamma_deg = 90\n" + narrow));
  EXPECT_FALSE(fixed.placement.works());
  EXPECT_TRUE(std::ranges::any_of(fixed.notes, [](const std::string& note) {
    return note.find("Without robot.gamma_deg the workpiece can stay where it is") != std::string::npos;
  })) << summary(fixed);
  EXPECT_TRUE(checked(folder, kr210("origin_mm = [1800, 0, 700]\n", narrow)).placement.works());
}

/// The cell with the workpiece where a proposal puts it, as it is printed.
std::string moved(const Proposal& proposal, const std::string& robot = "") {
  const robot::Euler turn = robot::euler_of(proposal.placement.workpiece.linear());
  const Eigen::Vector3d origin = proposal.placement.workpiece.translation() / units::mm;
  return kr210(
      fmt::format("origin_mm = [{:.3f}, {:.3f}, {:.3f}]\nrotation_deg = [{:.4f}, {:.4f}, {:.4f}]\n", origin.x(),
                  origin.y(), origin.z(), turn.c_rad / units::deg, turn.b_rad / units::deg, turn.a_rad / units::deg),
      robot);
}

double size_of(const Proposal& proposal) {
  return std::hypot(proposal.shift_m.norm() / 0.1, proposal.turn_rad / (10.0 * units::deg));
}

// The margin of a summary can be computed from its line.
TEST(CellCheck, SaysWhatItsMarginIsAShareOf) {
  CellCheck check;
  check.limits.min_position(5) = -350.0 * units::deg;
  check.limits.max_position(5) = 350.0 * units::deg;
  check.placement.poses = 1;
  path::Margin& margin = check.placement.choice.margin;
  margin = {.least = 50.0 / 180.0, .block = 0, .joint = 5, .position = robot::Position6::Zero()};
  margin.position(5) = 300.0 * units::deg;
  const std::string joint = summary(check);
  EXPECT_NE(joint.find("margin 0.278, of joint 6: 50.00° to its limit of 350°, of 180.00°"), std::string::npos)
      << joint;
  margin = {.least = 0.215, .block = 0, .joint = -1, .position = robot::Position6::Zero()};
  const std::string singular = summary(check);
  EXPECT_NE(singular.find("margin 0.215, to a singularity: 1 / 4.65, the condition number"), std::string::npos)
      << singular;
}

// Each proposal, typed into the cell, passes; the nearest place that could pass is not much nearer than the first.
TEST(CellCheck, ProposesWorkpiecePosesThatWork) {
  const Folder folder;
  for (const auto* origin :
       {"origin_mm = [3300, 0, 700]\n", "origin_mm = [2400, 1500, -900]\n", "origin_mm = [500, 0, 900]\n"}) {
    const CellCheck check = checked(folder, kr210(origin));
    ASSERT_FALSE(check.placement.works()) << origin;
    ASSERT_FALSE(check.proposals.empty()) << summary(check);
    EXPECT_LE(check.proposals.size(), 3U);
    for (const Proposal& proposal : check.proposals) {
      const CellCheck again = checked(folder, moved(proposal));
      EXPECT_TRUE(again.placement.works()) << origin << summary(again);
      EXPECT_GE(again.placement.choice.margin.least, 0.019) << origin;
      // In a straight line a quarter of the way less does not do: it is the edge that was looked for.
      Proposal less = proposal;
      less.placement.workpiece.translation() -= 0.25 * proposal.shift_m;
      if (proposal.turn_rad != 0.0) continue;
      const CellCheck nearer = checked(folder, moved(less));
      EXPECT_TRUE(!nearer.placement.works() || nearer.placement.choice.margin.least < 0.15) << origin;
    }
    EXPECT_NE(summary(check).find("proposal   shift "), std::string::npos);
  }
}

TEST(CellCheck, ProposesNothingWhereNothingNearbyServes) {
  const Folder folder;
  const CellCheck far = checked(folder, kr210("origin_mm = [9000, 0, 700]\n"));
  EXPECT_FALSE(far.placement.works());
  EXPECT_TRUE(far.proposals.empty());
  EXPECT_NE(summary(far).find("No workpiece pose was found nearby that serves."), std::string::npos);
}

const std::string square = "G21 G90 G94\nG0 X0 Y0 Z50\nG1 Z0 F1200\nG1 X100\nG1 Y100\nG1 X0\nG1 Y0\nM30\n";

TEST(CellCheck, FollowsAProgram) {
  const Folder folder;
  const CellCheck check = checked(folder, kr210(), square);
  EXPECT_TRUE(check.placement.works()) << summary(check);
  EXPECT_EQ(check.placement.poses, 6U);
  EXPECT_EQ(check.program, "part.ngc");
  EXPECT_EQ(check.drawing.program_m.size(), 6U);
  const CellStand& start = named(check, "program's start");
  EXPECT_LT((start.tool.tip_m - Eigen::Vector3d(0.0, 0.0, 0.05)).norm(), 1e-9);
}

TEST(CellCheck, SaysThatTheBeginAloneOfALongProgramIsJudged) {
  const Folder folder;
  std::string text = "G21 G90 G94\nG0 X0 Y0 Z50\nG1 Z0 F1200\n";
  for (int i = 0; i < 100'010; ++i) text += "X1\nX0\n";
  const CellCheck check = checked(folder, kr210(), text + "X999999\nM30\n");
  EXPECT_FALSE(check.whole);
  EXPECT_NE(summary(check).find("the begin of part.ngc is reached"), std::string::npos);
  ASSERT_FALSE(check.notes.empty());
  EXPECT_EQ(check.notes.back().substr(0, 49), "part.ngc goes on after its first 200000 moves, wh");
}

// Two of the blocks go too far; the places proposed serve for all of the program.
TEST(CellCheck, NamesTheBlocksThatCannotBeReached) {
  const Folder folder;
  const std::string long_reach = replaced(square, "G1 X100\n", "G1 X1200\n");
  const CellCheck check = checked(folder, kr210(), long_reach);
  EXPECT_FALSE(check.placement.works());
  ASSERT_EQ(check.placement.misses.size(), 2U) << summary(check);
  EXPECT_EQ(check.placement.misses[0].block, 2U);
  EXPECT_EQ(check.placement.misses[0].line, 4U);
  EXPECT_EQ(check.placement.misses[1].line, 5U);
  EXPECT_NE(summary(check).find("block 2 (line 4): "), std::string::npos) << summary(check);
  ASSERT_FALSE(check.proposals.empty()) << summary(check);
  double before = 0.0;
  for (const Proposal& proposal : check.proposals) {
    EXPECT_TRUE(checked(folder, moved(proposal), long_reach).placement.works());
    EXPECT_EQ(proposal.placement.poses, 6U);
    EXPECT_GE(size_of(proposal) * 1.5, before);
    before = size_of(proposal);
  }
}

// With joint 6 between -170° and 10° and the turn about the tool fixed, one end of the move needs the wrist one way
// round, the other end the other way: each can be reached, but not one after the other.
TEST(CellCheck, SaysWhereAProgramCannotBeFollowed) {
  const Folder folder;
  const std::string one_sided =
      "gamma_deg = 0\njoint_min_position_deg = [-185, -140, -120, -350, -125, -170]\n"
      "joint_max_position_deg = [185, -5, 155, 350, 125, 10]\n";
  const CellCheck check = checked(folder, kr210("origin_mm = [1800, 0, 700]\n", one_sided),
                                  "G21 G90 G94\nG0 X0 Y-800 Z0\nG1 Y800 F1000\nM30\n");
  EXPECT_FALSE(check.placement.works());
  EXPECT_EQ(check.placement.misses.size(), 0U) << summary(check);
  EXPECT_NE(check.placement.no_way.find("block 1 (line 3)"), std::string::npos) << check.placement.no_way;
  EXPECT_NE(summary(check).find("every block of part.ngc can be reached for itself, but block 1 (line 3)"),
            std::string::npos)
      << summary(check);
}

const std::string hybrid = R"([robot]
kind = "hybrid-2upr-rpu"
joint_min_position = [0.4, 0.4, 0.4, -0.8, -0.8]
joint_max_position = [1.4, 1.4, 1.4, 0.8, 0.8]
[workpiece]
origin_mm = [0, 0, 900]
rotation_deg = [180, 0, 0]
[tool]
length_mm = 100
)";

TEST(CellCheck, LooksAtTheHybridMachine) {
  const Folder folder;
  const CellCheck check = checked(folder, hybrid);
  EXPECT_TRUE(check.placement.works()) << summary(check);
  EXPECT_EQ(check.joints, 5);
  const CellStand& there = named(check, "workpiece's origin");
  EXPECT_LT((there.tip_m - Eigen::Vector3d(0.0, 0.0, 0.9)).norm(), 1e-12);
  EXPECT_LT((there.flange.translation() - Eigen::Vector3d(0.0, 0.0, 0.8)).norm(), 1e-12);
  EXPECT_LT((there.flange.linear().col(2) - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  ASSERT_EQ(check.drawing.figures.back().links_m.size(), 4U);
  for (std::size_t leg = 0; leg < 3; ++leg) {
    const auto& line = check.drawing.figures.back().links_m[leg];
    EXPECT_NEAR((line[1] - line[0]).norm(), there.position(static_cast<Eigen::Index>(leg)), 1e-12) << "a leg";
  }
  const CellCheck low = checked(folder, replaced(hybrid, "[0, 0, 900]", "[0, 0, 350]"));
  EXPECT_FALSE(low.placement.works());
  EXPECT_NE(what_misses(low.placement.misses.at(0), low.prismatic).find("below its lower limit of 400 mm"),
            std::string::npos)
      << summary(low);
  ASSERT_FALSE(low.proposals.empty()) << summary(low);
  EXPECT_GT(low.proposals[0].shift_m.z(), 0.0);
}

TEST(CellCheck, IsOneDocument) {
  const Folder folder;
  const CellCheck check = checked(folder, kr210("origin_mm = [3300, 0, 700]\n"), "", {0.1, -1.0, 1.0, 0.0, 1.0, 0.0});
  const auto json = nlohmann::json::parse(cell_check_json(check));
  EXPECT_EQ(json["robot"]["model"], "kuka-kr210-r2700");
  EXPECT_EQ(json["joints"].size(), 6U);
  EXPECT_EQ(json["joints"][1]["unit"], "deg");
  EXPECT_NEAR(json["joints"][1]["max_position"].get<double>(), -5.0, 1e-12);
  EXPECT_EQ(json["joints"][1]["assumed"], (nlohmann::json{"max_acceleration_per_s2", "max_jerk_per_s3"}));
  EXPECT_EQ(json["postures"][0]["name"], "as asked for");
  EXPECT_NEAR(json["postures"][0]["joints"][0].get<double>(), 0.1 / units::deg, 1e-9);
  EXPECT_EQ(json["postures"][0]["flange"]["quaternion"].size(), 4U);
  EXPECT_EQ(json["at_limits"].size(), 12U);
  EXPECT_FALSE(json["placement"]["works"].get<bool>());
  EXPECT_EQ(json["placement"]["misses"][0]["text"], what_misses(check.placement.misses[0], check.prismatic));
  EXPECT_EQ(json["proposals"].size(), check.proposals.size());
  const auto& proposal = json["proposals"][0];
  EXPECT_NEAR(proposal["origin_mm"][0].get<double>(),
              check.proposals[0].placement.workpiece.translation().x() / units::mm, 1e-9);
  EXPECT_EQ(json["drawing"]["figures"].size(), check.stands.size());
  EXPECT_EQ(json["assumed"].size(), check.cell.assumed.size());
}

TEST(CellCheck, SaysWhatTheCellLeavesOpen) {
  const Folder folder;
  const auto cell =
      folder.file("open.toml",
                  "[robot]\ndh = [{ alpha_deg = 90, d_mm = 162.5 }, { a_mm = -425 }, { a_mm = -392.2 }, "
                  "{ alpha_deg = 90, d_mm = 133.3 }, { alpha_deg = -90, d_mm = 99.7 }, { d_mm = 99.6 }]\n");
  const std::string said = summary(run_cell_check({.cell = cell, .most_proposals = 0}));
  for (const char* open : {"no workpiece.origin_mm", "no tool.length_mm", "no robot.start_joints_deg"}) {
    EXPECT_NE(said.find(open), std::string::npos) << said;
  }
  EXPECT_NE(rejection([&] {
              (void)checked(folder, kr210(), "", {0.0, 1.0});
            }).find("joints: must hold one value a joint, 6; it holds 2"),
            std::string::npos);
  EXPECT_NE(rejection([&] { (void)checked(folder, kr210(), "M30\n"); }).find("part.ngc"), std::string::npos);
}

}  // namespace check_test
}  // namespace robomill::cell
