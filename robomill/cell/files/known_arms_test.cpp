#include "robomill/cell/files/known_arms.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/dynamics.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/smooth.hpp"
#include "robomill/robot/joint_load.hpp"
#include "robomill/robot/pose.hpp"
#include "testing/robot/arms.hpp"
#include "testing/robot/maker_arms.hpp"
#include "testing/support.hpp"

namespace robomill::cell {
namespace known_arms_test {

using robomill::test::Folder;
using robomill::test::rejection;
namespace arms = robot::testing;

const std::filesystem::path cells = ROBOMILL_SOURCE_DIR "/data/cells";

std::filesystem::path cell_of(const std::string& name) {
  return cells / (name + ".toml");
}

CellFile by_name(const Folder& folder, const std::string& name, const std::string& more = "") {
  return read_cell(folder.file("cell.toml", "[robot]\nmodel = \"" + name + "\"\n" + more));
}

TEST(KnownArms, AreTheCellsOfTheData) {
  std::vector<std::string> files, names;
  for (const auto& entry : std::filesystem::directory_iterator(cells)) files.push_back(entry.path().stem().string());
  std::ranges::sort(files);
  for (const KnownArm& arm : known_arms()) {
    names.push_back(arm.name);
    EXPECT_FALSE(arm.description.empty()) << arm.name;
    EXPECT_EQ(known_arm_cell(arm.name), io::read_file(cell_of(arm.name))) << arm.name;
  }
  EXPECT_EQ(names, files);
  EXPECT_TRUE(known_arm_cell("kuka").empty());
}

/// What cells take otherwise than the URDF has it; the reasons stand in the cells.
arms::MakerArm as_taken(arms::MakerArm maker) {
  if (maker.name == "kuka-kr120-r2500") {
    const std::vector<arms::MakerArm> all = arms::maker_arms();
    const arms::MakerArm& sibling = *std::ranges::find(all, std::string("kuka-kr210-r2700"), &arms::MakerArm::name);
    maker.low = sibling.low;
    maker.high = sibling.high;
    maker.velocity = sibling.velocity;
  }
  if (maker.name.starts_with("fanuc")) {
    // J3 = q3 - q2 of the pendant, which the URDF has for q3, keeps to its range at each q2.
    maker.low[2] += maker.high[1];
    maker.high[2] += maker.low[1];
  }
  if (maker.name == "yaskawa-gp25") maker.low[4] = -maker.high[4];
  if (maker.name.starts_with("staubli")) maker.torque[1] = 0.0;
  return maker;
}

// The rows of the cells against the chain of joints that the maker's URDF has: the flange is its tool0, in the frame of
// the controller, without a mount between them.
TEST(KnownArms, AreTheirMakersUrdfs) {
  Random random(7);
  std::vector<std::string> names;
  for (const arms::MakerArm& urdf : arms::maker_arms()) {
    const arms::MakerArm maker = as_taken(urdf);
    names.push_back(maker.name);
    const CellFile file = read_cell(cell_of(maker.name));
    const robot::Arm& arm = file.robot.arm;
    ASSERT_EQ(arm.size(), 6) << maker.name;
    double worst = 0.0;
    for (int k = 0; k < 200; ++k) {
      Eigen::VectorXd position(6);
      for (Eigen::Index i = 0; i < 6; ++i) {
        const robot::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
        position(i) = random.uniform(joint.min_position, joint.max_position);
      }
      const Eigen::Isometry3d pose = robot::forward(arm, position), expected = maker.forward(position);
      worst = std::max(worst, (pose.matrix() - expected.matrix()).cwiseAbs().maxCoeff());
    }
    EXPECT_LT(worst, 1e-9) << maker.name;
    for (std::size_t i = 0; i < 6; ++i) {
      const robot::Joint& joint = arm.joints[i];
      EXPECT_NEAR(joint.min_position, maker.unit * maker.low.at(i), 1e-12) << maker.name << i;
      EXPECT_NEAR(joint.max_position, maker.unit * maker.high.at(i), 1e-12) << maker.name << i;
      EXPECT_NEAR(joint.max_velocity, maker.unit * maker.velocity.at(i), 1e-12) << maker.name << i;
      EXPECT_EQ(joint.max_torque, maker.torque.at(i)) << maker.name << i;
    }
  }
  std::ranges::sort(names);
  for (const KnownArm& arm : known_arms()) EXPECT_TRUE(std::ranges::binary_search(names, arm.name)) << arm.name;
  EXPECT_EQ(names.size(), known_arms().size());
}

/// "KUKA KR 210 R2700 extra: 210 kg, 2.7 m"
struct Rated {
  double load_kg = 0.0, reach_m = 0.0;
};
Rated rated(const KnownArm& arm) {
  Rated out;
  const std::string numbers = arm.description.substr(arm.description.find(": "));
  EXPECT_EQ(std::sscanf(numbers.c_str(), ": %lf kg, %lf m", &out.load_kg, &out.reach_m), 2) << arm.description;
  return out;
}

bool assumes(const CellFile& file, const std::string& key) {
  return std::ranges::count(file.assumed, key, &Assumption::key) > 0;
}

// What holds of any arm, whatever the file that its limits were typed from: no elbow and no wrist turns more than once
// about itself, and no arm has another's limits, unless it says so.
TEST(KnownArms, HaveLimitsOfTheirOwn) {
  std::vector<std::pair<std::string, std::vector<double>>> limits;
  for (const KnownArm& known : known_arms()) {
    const CellFile file = read_cell(cell_of(known.name));
    const std::vector<robot::Joint>& joints = file.robot.arm.joints;
    const bool collaborative = known.name.starts_with("ur-");  // turns twice about each joint but the elbow
    for (const std::size_t k : {1U, 2U, 4U}) {
      const double turn = collaborative && k != 2 ? 720.0 : 360.0;
      EXPECT_LE(joints[k].max_position - joints[k].min_position, turn * units::deg + 1e-12) << known.name << k;
    }
    if (assumes(file, "robot.joint_max_velocity")) continue;
    std::vector<double> own;
    for (const robot::Joint& joint : joints) {
      own.insert(own.end(), {joint.min_position, joint.max_position, joint.max_velocity});
    }
    limits.emplace_back(known.name, own);
  }
  // Also of arms that are not among them: those of the KR 16-2, which the URDF of the KR 120 has.
  constexpr std::array<double, 18> kr16_deg = {-185, 185, 156, -155, 35,  156, -130, 154, 156,
                                               -350, 350, 330, -130, 130, 330, -350, 350, 615};
  std::vector<double> kr16;
  for (const double value : kr16_deg) kr16.push_back(value * units::deg);
  limits.emplace_back("KR 16-2", kr16);
  for (std::size_t i = 0; i < limits.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const auto as = [](const std::vector<double>& list) {
        return Eigen::Map<const Eigen::VectorXd>(list.data(), 18);
      };
      EXPECT_GT((as(limits[i].second) - as(limits[k].second)).cwiseAbs().maxCoeff(), 1e-3)
          << limits[i].first << " and " << limits[k].first;
    }
  }
}

// An arm that stands holds its own weight in any posture, and half its rated load where it begins.
TEST(KnownArms, HoldTheirOwnWeight) {
  Random random(10);
  for (const KnownArm& known : known_arms()) {
    const CellFile file = read_cell(cell_of(known.name));
    const robot::Arm& arm = file.robot.arm;
    const auto expect_held = [&](const robot::Arm& loaded, const Eigen::VectorXd& at) {
      const std::vector<robot::JointLoad> loads = robot::joint_loads(loaded, at, robot::tip_point(file.robot));
      for (std::size_t k = 0; k < loads.size(); ++k) {
        if (arm.joints[k].max_torque > 0.0) {
          EXPECT_LE(std::abs(loads[k].gravity), arm.joints[k].max_torque) << known.name << k;
        }
      }
    };
    for (int i = 0; i < 200; ++i) {
      Eigen::VectorXd at(6);
      for (Eigen::Index k = 0; k < 6; ++k) {
        const robot::Joint& joint = arm.joints[static_cast<std::size_t>(k)];
        at(k) = random.uniform(joint.min_position, joint.max_position);
      }
      expect_held(arm, at);
    }
    robot::Link load;
    load.mass_kg = 0.5 * rated(known).load_kg;
    load.center_m = arm.flange.translation();
    expect_held(robot::with_payload(arm, load), Eigen::Map<const Eigen::VectorXd>(file.home.data(), 6));
  }
}

// The inertias that cells assume are those that they say: 5 % of the reach as radius of gyration, to two digits.
TEST(KnownArms, HaveTheInertiasThatTheySay) {
  for (const KnownArm& known : known_arms()) {
    const CellFile file = read_cell(cell_of(known.name));
    if (!assumes(file, "robot.links")) continue;
    const double radius_m = 0.05 * rated(known).reach_m;
    for (const robot::Joint& joint : file.robot.arm.joints) {
      const double expected = joint.link.mass_kg * radius_m * radius_m;
      EXPECT_NEAR(joint.link.inertia_kg_m2.trace() / 3.0, expected, 0.05 * expected) << known.name;
    }
  }
}

// The tool's axis is -z of the flange: spindles along it cut away from the arm.
TEST(KnownArms, PointTheirToolOutOfTheFlange) {
  for (const KnownArm& known : known_arms()) {
    const CellFile file = read_cell(cell_of(known.name));
    const Eigen::VectorXd home = Eigen::Map<const Eigen::VectorXd>(file.home.data(), 6);
    const Eigen::Isometry3d flange = robot::forward(file.robot.arm, home);
    EXPECT_LT((flange.linear().col(2) + Eigen::Vector3d::UnitZ()).norm(), 1e-9) << known.name << ": home points down";
    const robot::ToolPose tool = robot::tool_pose(file.robot, flange);
    EXPECT_LT((tool.axis - Eigen::Vector3d::UnitZ()).norm(), 1e-9) << known.name;
  }
}

// What nobody publishes has a reason, and is in use only where the cell does not give it itself.
TEST(KnownArms, SayWhatIsAssumed) {
  const Folder folder;
  const auto keys = [](const CellFile& file) {
    std::vector<std::string> out;
    for (const Assumption& one : file.assumed) out.push_back(one.key);
    return out;
  };
  for (const KnownArm& known : known_arms()) {
    const CellFile whole = read_cell(cell_of(known.name)), named = by_name(folder, known.name);
    EXPECT_EQ(keys(whole), keys(named)) << known.name;
    EXPECT_TRUE(std::ranges::count(keys(named), "robot.joint_max_jerk") == 1) << known.name;
    EXPECT_EQ(assumes(named, "robot.joint_max_velocity"), known.name == "kuka-kr120-r2500") << known.name;
    for (const Assumption& one : named.assumed) EXPECT_GT(one.taken.size(), 20U) << known.name;
    const std::string note = named.notes.back();
    EXPECT_NE(note.find("The arm is " + known.name + ", " + known.description), std::string::npos) << note;
    EXPECT_NE(note.find("Its kinematics and limits are those of ros-industrial/"), std::string::npos) << note;
  }
  const CellFile own =
      by_name(folder, "kuka-kr210-r2700",
              "joint_max_jerk_deg_per_s3 = [1, 2, 3, 4, 5, 6]\njoint_max_acceleration = [1, 1, 1, 1, 1, 1]\n");
  EXPECT_EQ(keys(own), (std::vector<std::string>{"robot.links"}));
  EXPECT_NEAR(own.robot.arm.joints[5].max_jerk, 6.0 * units::deg, 1e-15);
  EXPECT_EQ(own.assumed[0].file, "cell.toml");
  const CellFile marked =
      by_name(folder, "kuka-kr210-r2700",
              "joint_max_jerk_deg_per_s3 = [1, 2, 3, 4, 5, 6]\nassumed.joint_max_jerk = \"a guess of ours\"\n");
  EXPECT_EQ(marked.assumed.back().taken, "a guess of ours");
}

TEST(KnownArms, GiveTheirArmToACell) {
  const Folder folder;
  Random random(8);
  for (const KnownArm& known : known_arms()) {
    const CellFile whole = read_cell(cell_of(known.name)), named = by_name(folder, known.name);
    const Eigen::VectorXd at = arms::random_position(random, 6);
    const Eigen::Matrix4d apart =
        robot::forward(whole.robot.arm, at).matrix() - robot::forward(named.robot.arm, at).matrix();
    EXPECT_LT(apart.cwiseAbs().maxCoeff(), 1e-14) << known.name;
    for (std::size_t i = 0; i < 6; ++i) {
      const robot::Joint &ours = named.robot.arm.joints[i], &theirs = whole.robot.arm.joints[i];
      EXPECT_EQ(ours.min_position, theirs.min_position);
      EXPECT_EQ(ours.max_acceleration, theirs.max_acceleration);
      EXPECT_EQ(ours.stiffness, theirs.stiffness);
      EXPECT_EQ(ours.link.mass_kg, theirs.link.mass_kg);
      EXPECT_GT(ours.stiffness, 0.0);
    }
    EXPECT_EQ(named.model, known.name);
    EXPECT_EQ(named.home, whole.start_joints);
    EXPECT_TRUE(named.start_joints.empty()) << "where it begins is the cell's to say";
    EXPECT_TRUE(named.robot.workpiece.isApprox(Eigen::Isometry3d::Identity())) << "as is where the workpiece stands";
  }
}

TEST(KnownArms, StandWhereTheCellPutsThem) {
  const Folder folder;
  Random random(9);
  const Eigen::VectorXd at = arms::random_position(random, 6);
  const Eigen::Isometry3d plain = robot::forward(by_name(folder, "kuka-kr210-r2700").robot.arm, at);
  const CellFile hanging =
      by_name(folder, "kuka-kr210-r2700",
              "base_origin_mm = [0, 0, 3000]\nbase_rotation_deg = [180, 0, 0]\n"
              "joint_stiffness_n_m_per_rad = [1, 2, 3, 4, 5, 6]\nstart_joints_deg = [0, -90, 90, 0, 30, 0]\n");
  const Eigen::Isometry3d turned =
      Eigen::Translation3d(0.0, 0.0, 3.0) * Eigen::AngleAxisd(arms::pi, Eigen::Vector3d::UnitX()) * plain;
  EXPECT_LT((robot::forward(hanging.robot.arm, at).matrix() - turned.matrix()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(hanging.robot.arm.joints[3].stiffness, 4.0);
  EXPECT_EQ(hanging.home, hanging.start_joints);
}

TEST(KnownArms, RejectsWhatIsNoArm) {
  const Folder folder;
  const auto said = [&](const std::string& robot) {
    return rejection([&] { (void)read_cell(folder.file("cell.toml", "[robot]\n" + robot), Robots::any); });
  };
  const std::string unknown = said("model = \"kuka-kr210-2700\"\n");
  EXPECT_NE(unknown.find("cell.toml:2: robot.model = \"kuka-kr210-2700\"; must be one of \"abb-irb4600-60-205\", "),
            std::string::npos)
      << unknown;
  EXPECT_NE(unknown.find("Did you mean \"kuka-kr210-r2700\"?"), std::string::npos) << unknown;
  EXPECT_NE(said("model = \"something else entirely\"\n").find("Or give the arm as dh or urdf"), std::string::npos);
  EXPECT_NE(said("model = \"ur-5e\"\ndh = [{}]\n").find("cell.toml:3: robot.dh: must not stand beside model"),
            std::string::npos);
  EXPECT_NE(said("model = \"ur-5e\"\nurdf = \"a.urdf\"\n").find("must not stand beside model"), std::string::npos);
  EXPECT_NE(said("kind = \"hybrid-2upr-rpu\"\nmodel = \"ur-5e\"\n").find("goes with kind = \"serial\""),
            std::string::npos);
  EXPECT_NE(said("model = \"ur-5e\"\njoint_max_jerk = [1, 2]\n").find("must hold one number a joint, 6; it holds 2"),
            std::string::npos);
  EXPECT_NE(said("model = \"ur-5e\"\nassumed.joint_max_jrk = \"a guess\"\n").find("robot.assumed.joint_max_jerk"),
            std::string::npos);
}

// Each of them runs a program within its limits, and has the masses and springs that modes and deflections need.
TEST(KnownArms, RunInEveryVerb) {
  const Folder folder;
  const auto program = folder.file(
      "part.ngc", "G21 G90 G94\nG0 X0 Y0 Z20\nG1 Z0 F1200\nG1 X30\nG1 Y30\nG2 X0 Y30 I-15 J0\nG1 Y0\nM30\n");
  for (const KnownArm& known : known_arms()) {
    jobs::SmoothJob job{.program = program, .cell = cell_of(known.name), .options = {.record = false}};
    const process::SmoothResult smoothed = jobs::run_smooth(job);
    EXPECT_TRUE(smoothed.holds()) << known.name;
    const CellFile cell = read_cell(job.cell);
    // Joint 6 turns the tool about itself: where its mode moves no other joint there are the other five.
    EXPECT_GE(posture_modes(job.cell, cell.home).prediction.modes.modes.size(), 5U) << known.name;
  }
}

}  // namespace known_arms_test
}  // namespace robomill::cell
