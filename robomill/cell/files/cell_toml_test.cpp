#include "robomill/cell/files/cell_toml.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/robot/files/stiffness_files.hpp"
#include "robomill/robot/pose.hpp"
#include "testing/robot/arms.hpp"
#include "testing/robot/cells.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::cell {
namespace cell_toml_test {

using robomill::test::Folder;
using robomill::test::rejection;
using robomill::test::seeds;
namespace arms = robot::testing;

const std::string good = R"([robot]
kind = "serial"
dh = [{ a_mm = 350, alpha_deg = -90, d_mm = 449.4, theta_offset_deg = 0 },
      { a_mm = 1150, theta_offset_deg = -90 },
      { a_mm = 41, alpha_deg = -90, theta_offset_deg = 180 },
      { alpha_deg = 90, d_mm = -1200 },
      { alpha_deg = -90 },
      { alpha_deg = 180, d_mm = -420, theta_offset_deg = 180 }]
base_origin_mm = [0, 0, 225.6]
base_rotation_deg = [0, 0, 0]
joint_min_position = [-3, -2, -2, -6, -2, -6]
joint_max_position = [3, 1, 3, 6, 2, 6]
joint_max_velocity = [2, 2, 2, 3, 3, 4]
joint_max_acceleration = [5, 5, 5, 6, 6, 7]
joint_max_jerk = [50, 50, 50, 60, 60, 70]
joint_stiffness_n_m_per_rad = [2.2072e6, 3.37672e6, 2.77569e6, 2.35016e6, 2.15746e6, 0.467056e6]
joint_damping_n_m_s_per_rad = [100, 90, 80, 70, 60, 50]
joint_rotor_inertia_kg_m2 = [6, 5, 4, 3, 2, 1]
links = [{ mass_kg = 300, center_mm = [-100, 50, 0], inertia_kg_m2 = [10, 20, 30, 1, 2, 3] },
         { mass_kg = 200 }, { mass_kg = 150 }, { mass_kg = 50 }, { mass_kg = 30 }, { mass_kg = 20 }]
gamma_deg = 30
start_joints_deg = [-10.09, 9.36, 17.81, 21.30, -28.85, -18.86]
[workpiece]
origin_mm = [1270, 0, 776]
rotation_deg = [10, 20, 90]
[tool]
length_mm = 100
[program]
machine = "xyzac-trt"
[smoothing]
tip_tolerance_mm = 0.02
)";

std::string with(const std::string& old_text, const std::string& new_text) {
  return test_support::replaced(good, old_text, new_text);
}

// What `robomill stiffness -o` writes goes into a cell as it is.
TEST(CellToml, TakesIdentifiedStiffness) {
  const Folder folder;
  const robot::Arm arm = arms::kr210();
  robot::IdentifiedStiffness found;
  for (const robot::Joint& joint : arm.joints)
    found.joints.push_back({.stiffness = joint.stiffness, .identifiable = true});
  const CellFile cell = read_cell(
      folder.file("cell.toml", robot::stiffness_toml(found, arm) + "dh = [{ a_mm = 1 }, {}, {}, {}, {}, {}]\n"));
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(cell.robot.arm.joints[i].stiffness, arm.joints[i].stiffness, 1e-5 * arm.joints[i].stiffness);
  }
}

TEST(CellToml, ReadsADhArmWithAllItsLists) {
  const Folder folder;
  const CellFile file = read_cell(folder.file("cell.toml", good));
  const robot::Arm& arm = file.robot.arm;
  const robot::Arm expected = arms::kr210();
  ASSERT_EQ(arm.joints.size(), 6U);
  const Eigen::VectorXd at = arms::kr210_posture();
  EXPECT_LT((forward(arm, at).matrix() - forward(expected, at).matrix()).cwiseAbs().maxCoeff(), 1e-12);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_DOUBLE_EQ(arm.joints[i].stiffness, expected.joints[i].stiffness);
    EXPECT_EQ(arm.joints[i].damping, 100.0 - 10.0 * static_cast<double>(i));
    EXPECT_EQ(arm.joints[i].rotor_inertia, 6.0 - static_cast<double>(i));
  }
  EXPECT_EQ(arm.joints[1].min_position, -2.0);
  EXPECT_EQ(arm.joints[1].max_position, 1.0);
  EXPECT_EQ(arm.joints[5].max_velocity, 4.0);
  EXPECT_EQ(arm.joints[5].max_acceleration, 7.0);
  EXPECT_EQ(arm.joints[5].max_jerk, 70.0);
  EXPECT_EQ(file.machine, "xyzac-trt");
  EXPECT_DOUBLE_EQ(file.redundant_gamma_rad, arms::pi / 6.0);
  EXPECT_DOUBLE_EQ(file.robot.tool_length_m, 0.1);
  ASSERT_EQ(file.start_joints.size(), 6U);
  for (Eigen::Index i = 0; i < 6; ++i) EXPECT_NEAR(file.start_joints[static_cast<std::size_t>(i)], at(i), 1e-15);
  EXPECT_TRUE(file.notes.empty());
}

// 0 and no list: no limit.
TEST(CellToml, ReadsTheTorqueThatDrivesCanGive) {
  const Folder folder;
  const auto read = [&](const std::string& row) {
    return read_cell(folder.file("cell.toml", with("joint_rotor_inertia_kg_m2 = [6, 5, 4, 3, 2, 1]", row)))
        .robot.arm.joints;
  };
  const std::vector<robot::Joint> joints = read("joint_max_torque_n_m = [9000, 8000, 6000, 1500, 1200, 0]");
  EXPECT_EQ(joints[0].max_torque, 9000.0);
  EXPECT_EQ(joints[4].max_torque, 1200.0);
  EXPECT_EQ(joints[5].max_torque, 0.0);
  for (const robot::Joint& joint : read("")) EXPECT_EQ(joint.max_torque, 0.0);
  const auto said = [&](const std::string& row) { return rejection([&] { (void)read(row); }); };
  EXPECT_NE(said("joint_max_torque_n_m = [9000, 8000]")
                .find("cell.toml:18: robot.joint_max_torque_n_m: must hold one number a joint, 6; it holds 2"),
            std::string::npos);
  EXPECT_NE(said("joint_max_torque_n_m = [9000, 8000, -6000, 1500, 1200, 0]")
                .find("cell.toml:18: robot.joint_max_torque_n_m[3] = -6000 N m; must be >= 0"),
            std::string::npos);
}

TEST(CellToml, ReadsLinksInTheFrameOfTheirRow) {
  const Folder folder;
  const robot::Link link = read_cell(folder.file("cell.toml", good)).robot.arm.joints[0].link;
  EXPECT_EQ(link.mass_kg, 300.0);
  // Row 1: Tz(0.4494) Tx(0.35) Rx(-90 deg), which takes (x, y, z) to (x + 0.35, z, 0.4494 - y).
  EXPECT_LT((link.center_m - Eigen::Vector3d(0.25, 0.0, 0.3994)).norm(), 1e-14);
  Eigen::Matrix3d expected;
  expected << 10.0, 2.0, -1.0, 2.0, 30.0, -3.0, -1.0, -3.0, 20.0;
  EXPECT_LT((link.inertia_kg_m2 - expected).norm(), 1e-13);
}

TEST(CellToml, TurnsTheWorkpieceAboutXThenYThenZ) {
  const Folder folder;
  const Eigen::Isometry3d workpiece = read_cell(folder.file("cell.toml", good)).robot.workpiece;
  EXPECT_LT((workpiece.translation() - Eigen::Vector3d(1.27, 0.0, 0.776)).norm(), 1e-15);
  const double x = arms::pi / 18.0, y = arms::pi / 9.0;
  Eigen::Matrix3d rx, ry, rz;
  rx << 1, 0, 0, 0, std::cos(x), -std::sin(x), 0, std::sin(x), std::cos(x);
  ry << std::cos(y), 0, std::sin(y), 0, 1, 0, -std::sin(y), 0, std::cos(y);
  rz << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_LT((workpiece.linear() - rz * ry * rx).norm(), 1e-15);
}

const std::string urdf = R"(<robot name="one"><link name="base"/><link name="arm"/><link name="tool0"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="2"/></joint>
<joint name="f" type="fixed"><parent link="arm"/><child link="tool0"/><origin xyz="1 0 0"/></joint></robot>
)";

// The tool's axis is -z of the spindle frame: bolted on sideways it lies across the flange's z.
TEST(CellToml, BoltsTheSpindleToTheFlange) {
  const Folder folder;
  const robot::Cell plain = read_cell(folder.file("plain.toml", good)).robot;
  const robot::Cell bolted =
      read_cell(folder.file("bolted.toml", with("length_mm = 100",
                                                "length_mm = 100\nmount_origin_mm = [0, 80, 150]\n"
                                                "mount_rotation_deg = [0, -90, 0]")))
          .robot;
  const Eigen::VectorXd q = arms::kr210_posture();
  const Eigen::Isometry3d flange = robot::forward(plain.arm, q);
  const Eigen::Isometry3d spindle = robot::forward(bolted.arm, q);
  EXPECT_LE((flange.inverse() * spindle.translation() - Eigen::Vector3d(0.0, 0.08, 0.15)).norm(), 1e-12);
  EXPECT_LE((flange.linear().transpose() * spindle.linear().col(2) + Eigen::Vector3d::UnitX()).norm(), 1e-12);
}

TEST(CellToml, ReadsWhatAControllerMustKnowOfTheSpindle) {
  const Folder folder;
  const auto read = [&](const std::string& tool, const std::string& more = "") {
    std::string text = good;
    const std::size_t at = text.find("[tool]\n");
    text.insert(at + 7, tool);
    return read_cell(folder.file("cell.toml", text + more));
  };
  EXPECT_FALSE(read("").end_effector.mass_kg.has_value());
  EXPECT_FALSE(read("").end_effector.spindle.given());
  const path::EndEffector end =
      read("number = 3\nload_number = 4\nname = \"tSpindle\"\nmass_kg = 12.5\ncenter_mm = [0, 10, 90]\n",
           "[spindle]\noutput = 7\ncoolant_output = \"doCoolant\"\nspin_up_s = 2\n")
          .end_effector;
  EXPECT_EQ(end.tool_number, 3);
  EXPECT_EQ(end.load_number, 4);
  EXPECT_EQ(end.tool_name, "tSpindle");
  EXPECT_EQ(end.mass_kg, 12.5);
  EXPECT_NEAR(end.center().z(), 0.09, 1e-15);
  EXPECT_EQ(end.spindle.number, 7);
  EXPECT_EQ(end.coolant.signal, "doCoolant");
  EXPECT_EQ(end.spin_up_s, 2.0);
  const auto said = [&](const std::string& tool, const std::string& more = "") {
    return rejection([&] { static_cast<void>(read(tool, more)); });
  };
  EXPECT_NE(said("mass_kg = 0\n").find("tool.mass_kg = 0 kg; must be > 0"), std::string::npos) << said("mass_kg = 0\n");
  EXPECT_NE(said("number = 0\n").find("tool.number"), std::string::npos);
  EXPECT_NE(said("name = \"1 tool\"\n").find("tool.name"), std::string::npos);
  EXPECT_NE(said("center_mm = [0, 0, 1]\n").find("goes with tool.mass_kg"), std::string::npos);
  EXPECT_NE(said("", "[spindle]\noutput = \"do;Spindle\"\n").find("spindle.output"), std::string::npos);
  EXPECT_NE(said("", "[spindle]\nspin_up_s = -1\n").find("spindle.spin_up_s"), std::string::npos);
  EXPECT_NE(said("", "[spindle]\noutputs = 1\n").find("spindle.outputs"), std::string::npos);
}

TEST(CellToml, ReadsAUrdfBesideItAndItsListsStandFirst) {
  const Folder folder;
  folder.file("one.urdf", urdf);
  const CellFile file = read_cell(folder.file("cell.toml",
                                              "[robot]\nurdf = \"one.urdf\"\nurdf_tip = \"tool0\"\n"
                                              "urdf_base = \"base\"\njoint_max_velocity = 1.5\n"
                                              "base_origin_mm = [0, 0, 500]\nbase_rotation_deg = [0, 0, 90]\n"));
  ASSERT_EQ(file.robot.arm.joints.size(), 1U);
  EXPECT_EQ(file.robot.arm.joints[0].max_position, 1.0);
  EXPECT_EQ(file.robot.arm.joints[0].max_velocity, 1.5);
  EXPECT_LT((forward(file.robot.arm, Eigen::VectorXd::Zero(1)).translation() - Eigen::Vector3d(0.0, 1.0, 0.5)).norm(),
            1e-15);
  EXPECT_EQ(file.machine, "");
  EXPECT_TRUE(file.start_joints.empty());
  EXPECT_TRUE(file.robot.workpiece.isApprox(Eigen::Isometry3d::Identity()));
}

TEST(CellToml, SaysHowProgramsAreRead) {
  const Folder folder;
  const program::ProgramReading given = program_reading(read_cell(folder.file("cell.toml", good)));
  EXPECT_EQ(given.machine, program::Machine::xyzac_trt);
  EXPECT_EQ(given.rotary, program::Rotary::machine);
  EXPECT_FALSE(given.tool.given());
  const std::string of_tool = with("length_mm = 100", "length_mm = 100\nnumber = 3");
  EXPECT_FALSE(program_reading(read_cell(folder.file("cell.toml", of_tool))).tool.given())
      << "the robot controller's number of the tool is not the program's";
  const std::string with_tool = with("machine = \"xyzac-trt\"", "machine = \"xyzac-trt\"\ntool = 4");
  EXPECT_EQ(program_reading(read_cell(folder.file("cell.toml", with_tool))).tool.number, 4);
  const std::string with_part = with("machine = \"xyzac-trt\"", "tool_name = \"MILL\"\ntool_part = 2");
  const program::ToolChoice part = program_reading(read_cell(folder.file("cell.toml", with_part))).tool;
  EXPECT_EQ(part.name, "MILL");
  EXPECT_EQ(part.part, 2);
  const std::string chosen = with("machine = \"xyzac-trt\"", "rotary = \"great-circle\"");
  const program::ProgramReading shortest = program_reading(read_cell(folder.file("cell.toml", chosen)));
  EXPECT_FALSE(shortest.machine.has_value());
  EXPECT_EQ(shortest.rotary, program::Rotary::great_circle);
}

TEST(CellToml, GivesTheOffsetsOfWorkFrames) {
  const Folder folder;
  const std::string frames = "[[program.frames]]\ncode = \"G54\"\norigin_mm = [100, 200, 300]\n";
  const auto read = [&](const std::string& more) {
    return read_cell(folder.file("cell.toml", with("[smoothing]", frames + more + "[smoothing]")));
  };
  const CellFile cell = read(
      "[[program.frames]]\ncode = \"G54.1 P3\"\norigin_mm = [-150, 190, 305]\n[[program.frames]]\ncode = \"G58\"\n"
      "origin_mm = [1000, 0, 0]\n");
  const std::vector<program::WorkFrame> given = program_reading(cell).frames;
  ASSERT_EQ(given.size(), 3U);
  EXPECT_EQ(given[1].code, "G54.1 P3");
  EXPECT_LT((given[1].origin_m - Eigen::Vector3d(-0.15, 0.19, 0.305)).norm(), 1e-15);
  const program::Program program =
      program::read_program_text("G54 G0 X0 Y0 Z0\nG1 X1 F60\nG54.1 P3 X0 Y0 Z0\n", "part.nc", program_reading(cell));
  EXPECT_LT((program.blocks.back().end.tip_m - Eigen::Vector3d(-0.25, -0.01, 0.005)).norm(), 1e-12);
  const auto expect = [&](const std::string& row, const std::string& message) {
    const std::string said = rejection([&] { (void)read("[[program.frames]]\n" + row); });
    EXPECT_NE(said.find(message), std::string::npos) << said;
  };
  const std::string file = (folder.path() / "cell.toml").string();
  expect("code = \"G54\"\norigin_mm = [1, 2, 3]\n",
         file + ":34: program.frames[2].code = \"G54\"; is given before, as \"G54\" in " + file + ":31");
  expect("code = \"G54.1 P1\"\norigin_mm = [1, 2, 3]\n[[program.frames]]\ncode = \"G110\"\norigin_mm = [1, 2, 3]\n",
         file + ":37: program.frames[3].code = \"G110\"; is given before, as \"G54.1 P1\" in " + file + ":34");
  expect("code = \"G53\"\norigin_mm = [1, 2, 3]\n",
         file + ":34: program.frames[2].code = \"G53\"; must be a work frame of G-code: G54 to G59, G59.1 to G59.3");
  expect("code = \"G55\"\n", ":33: program.frames[2].origin_mm: is missing. The offsets of the control's table");
  expect("origin_mm = [1, 2, 3]\n", ":33: program.frames[2].code: is missing. The frame's G code");
  expect("code = \"G55\"\norigin_mm = [1, 2]\n", ":35: program.frames[2].origin_mm: must hold 3 entries; it holds 2");
  expect("code = \"G55\"\norigin_mm = [1, 2e6, 3]\n",
         ":35: program.frames[2].origin_mm[2] = 2e+06 mm; must lie within 1 km");
  expect("code = 55\norigin_mm = [1, 2, 3]\n", ":34: program.frames[2].code = 55; must be text in quotes");
}

TEST(CellToml, SaysWhatIsWrongAndWhere) {
  const Folder folder;
  folder.file("one.urdf", urdf);
  const auto said = [&](const std::string& text) {
    const auto path = folder.file("cell.toml", text);
    return rejection([&] { (void)read_cell(path); }).substr(folder.path().string().size() + 1);
  };
  const auto expect = [&](const std::string& old_text, const std::string& new_text, const std::string& message) {
    EXPECT_EQ(said(with(old_text, new_text)).substr(0, message.size()), message);
  };
  expect("\"serial\"", "\"parallel\"", "cell.toml:2: robot.kind = \"parallel\"; must be one of \"serial\"");
  expect("\"serial\"", "\"hybrid-2upr-rpu\"",
         "cell.toml:2: robot.kind = \"hybrid-2upr-rpu\"; is a hybrid machine; this needs a serial arm");
  expect("kind = \"serial\"", "urdf = \"one.urdf\"",
         "cell.toml:2: robot.urdf = \"one.urdf\"; must not stand beside dh");
  expect("kind = \"serial\"", "urdf_tip = \"x\"", "cell.toml:2: robot.urdf_tip = \"x\"; goes with robot.urdf");
  expect("[-3, -2, -2, -6, -2, -6]", "[-3, -2, 9, -6, -2, -6]",
         "cell.toml:11: robot.joint_min_position[3] = 9 rad; must be below max_position");
  expect("[-3, -2, -2, -6, -2, -6]", "[-3, -2, -2]",
         "cell.toml:11: robot.joint_min_position: must hold one number a joint, 6; it holds 3");
  expect("[2, 2, 2, 3, 3, 4]", "[2, -2, 2, 3, 3, 4]",
         "cell.toml:13: robot.joint_max_velocity[2] = -2 rad/s; must be >= 0");
  expect("{ mass_kg = 30 }, ", "", "cell.toml:19: robot.links: must hold one table a joint, 6; it holds 5");
  expect("{ mass_kg = 30 }", "{ center_mm = [0, 0, 0] }", "cell.toml:20: robot.links[5].mass_kg: is missing");
  expect("{ mass_kg = 30 }", "{ mass_kg = -30 }", "cell.toml:20: robot.links[5].mass_kg = -30 kg; must be >= 0");
  expect("[10, 20, 30, 1, 2, 3]", "[10, 20, 30]",
         "cell.toml:19: robot.links[1].inertia_kg_m2: must hold 6 entries; it holds 3. [xx, yy, zz, xy, xz, yz]");
  expect("[10, 20, 30, 1, 2, 3]", "[10, 20, -30, 1, 2, 3]",
         "cell.toml:19: robot.links[1].inertia_kg_m2: must be positive");
  expect("length_mm = 100", "length_mm = -100", "cell.toml:27: tool.length_mm = -100 mm; must be >= 0");
  expect("[1270, 0, 776]", "[1270, 0]", "cell.toml:24: workpiece.origin_mm: must hold 3 entries; it holds 2");
  expect("machine = \"xyzac-trt\"", "rotary = \"straight\"",
         "cell.toml:29: program.rotary = \"straight\"; must be one of \"machine\", \"great-circle\"");
  expect("machine = \"xyzac-trt\"", "tool = -4", "cell.toml:29: program.tool = -4; must be >= 0");
  expect("machine = \"xyzac-trt\"", "tool = 4.5", "cell.toml:29: program.tool");
  expect("machine = \"xyzac-trt\"", "tool = 4\ntool_part = 0", "cell.toml:30: program.tool_part = 0; must be >= 1");
  expect("machine = \"xyzac-trt\"", "tool_part = 2",
         "cell.toml:29: program.tool_part = 2; is one of a tool's, and no tool is chosen");
  expect("machine = \"xyzac-trt\"", "tool = 4\ntool_name = \"MILL\"",
         "cell.toml:29: program.tool: is given beside the tool's name, \"MILL\": give one of the two");
  expect("xyzac-trt", "xyzac", "cell.toml:29: program.machine = \"xyzac\"; must be one of \"xyzac-trt\"");
  expect("[-10.09, 9.36", "[-1000, 9.36",
         "cell.toml:22: robot.start_joints_deg: must lie within the limits; joint 1 has");
  expect("a_mm = 1150", "a_m = 1150",
         "cell.toml:4: robot.dh[2].a_m: is not known here. Did you mean robot.dh[2].a_mm?");
  EXPECT_EQ(said("[tool]\nlength_mm = 1\n").substr(0, 27), "cell.toml: robot: is missin");
  EXPECT_NE(said("[robot]\nkind = \"serial\"\n").find("robot.model: is missing"), std::string::npos);
  EXPECT_NE(said("[robot]\nurdf = \"one.urdf\"\n").find("robot.urdf_tip: is missing"), std::string::npos);
  EXPECT_NE(said("[robot]\nurdf = \"one.urdf\"\nurdf_tip = \"tol0\"\n").find("Did you mean tool0?"), std::string::npos);
  EXPECT_NE(said("[robot]\nurdf = \"two.urdf\"\nurdf_tip = \"tool0\"\n").find("two.urdf"), std::string::npos);
}

// The same limits with their unit in the key.
TEST(CellToml, TakesJointLimitsWithTheirUnit) {
  const Folder folder;
  const auto joints = [&](const std::string& text) {
    return read_cell(folder.file("cell.toml", text)).robot.arm.joints;
  };
  const std::vector<robot::Joint> plain = joints(good);
  std::string degrees = good;
  const auto in_degrees = [&](const char* bare, const char* key, double robot::Joint::*value) {
    const std::size_t from = degrees.find(bare);
    std::string list = std::string(key) + " = [";
    for (const robot::Joint& joint : plain) list += fmt::format("{}, ", joint.*value / (arms::pi / 180.0));
    degrees.replace(from, degrees.find('\n', from) - from, list + "]");
  };
  in_degrees("joint_min_position", "joint_min_position_deg", &robot::Joint::min_position);
  in_degrees("joint_max_position", "joint_max_position_deg", &robot::Joint::max_position);
  in_degrees("joint_max_velocity", "joint_max_velocity_deg_per_s", &robot::Joint::max_velocity);
  in_degrees("joint_max_acceleration", "joint_max_acceleration_deg_per_s2", &robot::Joint::max_acceleration);
  in_degrees("joint_max_jerk", "joint_max_jerk_deg_per_s3", &robot::Joint::max_jerk);
  for (const std::string& text : {degrees, with("joint_max_velocity", "joint_max_velocity_rad_per_s")}) {
    const std::vector<robot::Joint> read = joints(text);
    for (std::size_t i = 0; i < plain.size(); ++i) {
      EXPECT_NEAR(read[i].min_position, plain[i].min_position, 1e-14);
      EXPECT_NEAR(read[i].max_position, plain[i].max_position, 1e-14);
      EXPECT_NEAR(read[i].max_velocity, plain[i].max_velocity, 1e-14);
      EXPECT_NEAR(read[i].max_acceleration, plain[i].max_acceleration, 1e-14);
      EXPECT_NEAR(read[i].max_jerk, plain[i].max_jerk, 1e-12);
    }
  }
  const auto said = [&](const std::string& row) {
    return rejection([&] { (void)joints(with("joint_max_velocity = [2, 2, 2, 3, 3, 4]", row)); });
  };
  EXPECT_NE(said("joint_max_velocity_deg_per_s = [120, 115, 112, 179, -172, 219]")
                .find("cell.toml:13: robot.joint_max_velocity_deg_per_s[5] = -172 deg/s; must be >= 0"),
            std::string::npos);
  EXPECT_NE(said("joint_max_velocity_deg_per_s = [120]").find("one number for each revolute joint, 6; it holds 1"),
            std::string::npos);
  EXPECT_NE(said("joint_max_velocity_mm_per_s = [120]").find("one number for each prismatic joint, 0; it holds 1"),
            std::string::npos);
  EXPECT_NE(said("joint_max_velocity = [2, 2, 2, 3, 3, 4]\njoint_max_velocity_deg_per_s = [1, 2, 3, 4, 5, 6]")
                .find("robot.joint_max_velocity_deg_per_s: must not stand beside robot.joint_max_velocity"),
            std::string::npos);
}

// A slide, a turn, a slide: each list holds the joints of its kind.
TEST(CellToml, MixedMachinesGiveAListForEachKindOfJoint) {
  const Folder folder;
  folder.file("mixed.urdf", R"(<robot name="mixed"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
<joint name="1" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
<joint name="2" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
<joint name="3" type="prismatic"><parent link="c"/><child link="d"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" velocity="1" effort="1"/></joint></robot>)");
  const auto read = [&](const std::string& rows) {
    return read_cell(folder.file("cell.toml", "[robot]\nurdf = \"mixed.urdf\"\nurdf_tip = \"d\"\n" + rows))
        .robot.arm.joints;
  };
  const std::vector<robot::Joint> joints = read(
      "joint_max_velocity_mm_per_s = [500, 250]\njoint_max_velocity_deg_per_s = [180]\n"
      "joint_max_position_mm = [400, 300]\n");
  EXPECT_DOUBLE_EQ(joints[0].max_velocity, 0.5);
  EXPECT_DOUBLE_EQ(joints[1].max_velocity, arms::pi);
  EXPECT_DOUBLE_EQ(joints[2].max_velocity, 0.25);
  EXPECT_DOUBLE_EQ(joints[2].max_position, 0.3);
  EXPECT_EQ(joints[1].max_position, 1.0) << "of the URDF";
  EXPECT_EQ(read("joint_max_velocity = [0.5, 3, 0.25]\n")[1].max_velocity, 3.0);
  const std::string said = rejection([&] { (void)read("joint_max_velocity_mm_per_s = [500, -250]\n"); });
  EXPECT_NE(said.find("cell.toml:4: robot.joint_max_velocity_mm_per_s[2] = -250 mm/s"), std::string::npos) << said;
}

// 120 °/s are no 120 rad/s: nineteen turns a second.
TEST(CellToml, DoubtsBareNumbersThatAreLikelyInDegreesOrMillimetres) {
  const Folder folder;
  EXPECT_TRUE(read_cell(folder.file("cell.toml", good)).notes.empty());
  const CellFile fast = read_cell(folder.file("cell.toml", with("[2, 2, 2, 3, 3, 4]", "[2, 115, 112, 179, 172, 219]")));
  ASSERT_EQ(fast.notes.size(), 1U);
  EXPECT_NE(fast.notes[0].find("robot.joint_max_velocity holds 115 rad/s for joint 2: if it is in °/s, write "
                               "robot.joint_max_velocity_deg_per_s"),
            std::string::npos)
      << fast.notes[0];
  const CellFile wide = read_cell(folder.file("cell.toml", with("[3, 1, 3, 6, 2, 6]", "[185, 1, 3, 6, 2, 6]")));
  ASSERT_EQ(wide.notes.size(), 1U);
  EXPECT_NE(wide.notes[0].find("write robot.joint_max_position_deg"), std::string::npos) << wide.notes[0];
  const CellFile sure =
      read_cell(folder.file("cell.toml", with("joint_max_velocity = [2, 2, 2, 3, 3, 4]",
                                              "joint_max_velocity_rad_per_s = [30, 30, 30, 30, 30, 30]")));
  EXPECT_TRUE(sure.notes.empty()) << "the unit is said";
}

const std::string hybrid = R"([robot]
kind = "hybrid-2upr-rpu"
platform_offset_mm = 130
joint_min_position = [0.4, 0.4, 0.4, -1, -1]
joint_max_position = [1.2, 1.2, 1.2, 1, 1]
joint_max_velocity = [0.5, 0.5, 0.5, 1, 2]
[workpiece]
origin_mm = [0, 0, 900]
rotation_deg = [180, 0, 0]
[tool]
length_mm = 100
)";

TEST(CellToml, ReadsTheHybridMachine) {
  const Folder folder;
  const CellFile file = read_cell(folder.file("cell.toml", hybrid), Robots::any);
  ASSERT_TRUE(file.hybrid);
  EXPECT_DOUBLE_EQ(file.hybrid->base_half_width_m, 0.3);
  EXPECT_DOUBLE_EQ(file.hybrid->platform_half_width_m, 0.12);
  EXPECT_DOUBLE_EQ(file.hybrid->platform_offset_m, 0.13);
  EXPECT_DOUBLE_EQ(file.hybrid->base_offset_m, 0.3);
  EXPECT_DOUBLE_EQ(file.hybrid->platform_to_flange_m, 0.05);
  EXPECT_DOUBLE_EQ(file.hybrid->tool_offset_m(), 0.15);
  EXPECT_EQ(file.hybrid->limits.min_position(0), 0.4);
  EXPECT_EQ(file.hybrid->limits.max_velocity(4), 2.0);
  EXPECT_EQ(file.hybrid->limits.max_velocity(5), 0.0);
  EXPECT_FALSE(file.gamma_given);
  const auto machine = kinematics(file);
  EXPECT_EQ(machine->joints(), 5);
  robot::Position6 position;
  ASSERT_EQ(machine->follow(robot::ToolPose{}, robot::Position6::Zero(), position).status, robot::Reach::Status::found);
  // The part's zero is 0.9 m below the base's plane, the tool upright: l = 0.9 - 0.15.
  EXPECT_NEAR(position(0), std::hypot(0.3 - 0.12, 0.75), 1e-15);
  EXPECT_NEAR(position(2), std::hypot(0.3 - 0.13, 0.75), 1e-15);
}

TEST(CellToml, SaysWhatIsWrongWithAHybridMachine) {
  const Folder folder;
  const auto expect = [&](const std::string& old_text, const std::string& new_text, const std::string& message) {
    const auto path = folder.file("cell.toml", test_support::replaced(hybrid, old_text, new_text));
    const std::string said = rejection([&] { (void)read_cell(path, Robots::any); });
    EXPECT_EQ(said.substr(folder.path().string().size() + 1).substr(0, message.size()), message);
  };
  expect("platform_offset_mm = 130", "base_half_width_mm = 0",
         "cell.toml:3: robot.base_half_width_mm = 0 mm; must be > 0");
  expect("[0.4, 0.4, 0.4, -1, -1]", "[0.4, 0.4, 0.4]",
         "cell.toml:4: robot.joint_min_position: must hold one number a joint, 5; it holds 3");
  expect("[0.4, 0.4, 0.4, -1, -1]", "[0.4, 0.4, 1.4, -1, -1]",
         "cell.toml:4: robot.joint_min_position[3] = 1.4 m; must be below max_position");
  expect("platform_offset_mm = 130", "dh = [{}]", "cell.toml:3: robot.dh: goes with kind = \"serial\"");
  expect("platform_offset_mm = 130", "gamma_deg = 3", "cell.toml:3: robot.gamma_deg = 3 deg; goes with kind");
  expect("length_mm = 100", "length_mm = -1", "cell.toml:11: tool.length_mm = -1 mm; must be >= 0");
  expect("joint_min_position = [0.4, 0.4, 0.4, -1, -1]", "joint_min_position_mm = [400, 400, 1400, -1000, -1000]",
         "cell.toml:4: robot.joint_min_position_mm[3] = 1400 mm; must be below max_position");
  expect("joint_max_velocity = ", "joint_max_velocity_deg_per_s = ",
         "cell.toml:6: robot.joint_max_velocity_deg_per_s: must hold one number for each revolute joint, 0");
  EXPECT_NE(rejection([&] {
              (void)read_cell(folder.file("cell.toml", with("gamma_deg = 30", "base_offset_mm = 30")), Robots::any);
            }).find("cell.toml:21: robot.base_offset_mm = 30 mm; goes with kind = \"hybrid-2upr-rpu\""),
            std::string::npos);
}

TEST(CellToml, MakesTheMachineOfTheCell) {
  const Folder folder;
  const CellFile file = read_cell(folder.file("cell.toml", good));
  EXPECT_TRUE(file.gamma_given);
  const auto machine = kinematics(file);
  EXPECT_EQ(machine->joints(), 6);
  EXPECT_EQ(machine->limits().max_jerk(5), 70.0);
  folder.file("one.urdf", urdf);
  const auto one = folder.file("one.toml", "[robot]\nurdf = \"one.urdf\"\nurdf_tip = \"tool0\"\n");
  const std::string said = rejection([&] { (void)kinematics(read_cell(one)); });
  EXPECT_NE(said.find("one.toml: robot = 1 joints; must be six"), std::string::npos) << said;
}

const std::string geometry = R"([geometry]
part = "part.stl"
arm = [{ link = 0, box_from_mm = [-200, -200, 0], box_to_mm = [200, 200, 200] },
       { link = 2, from_mm = [-1150, 0, 0], to_mm = [0, 0, 0], diameter_mm = 300 }]
stickout_mm = 50
holder = [{ length_mm = 50, diameter_mm = 40 }]
clearance_mm = 2
gouge_tolerance_mm = 0.05
)";

// A capsule from joint 2 to joint 3 stands there in every posture, and the base's box on the base.
TEST(CellToml, PlacesTheLinksOfItsGeometry) {
  const Folder folder;
  folder.file("part.stl", arms::binary_stl(arms::box({0, 0, 0}, {0.1, 0.1, 0.05})));
  EXPECT_FALSE(read_cell(folder.file("plain.toml", good)).geometry);
  const CellFile file = read_cell(folder.file("cell.toml", good + geometry));
  ASSERT_TRUE(file.geometry);
  EXPECT_TRUE(file.geometry->tool.edges.empty());
  EXPECT_NEAR(file.geometry->arm[0].pose.translation().z(), 0.2256, 1e-12);
  const robot::LinkBody& upper_arm = file.geometry->arm[1];
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    const Eigen::VectorXd position = arms::random_position(random, 6);
    const Eigen::Isometry3d pose = arms::link_frame(file.robot.arm, 2, position) * upper_arm.pose;
    robot::Posture posture;
    posture.update(file.robot.arm, position);
    EXPECT_LT((pose * upper_arm.capsule->from_m - posture.origin_m.col(1)).norm(), 1e-12);
    EXPECT_LT((pose * upper_arm.capsule->to_m - posture.origin_m.col(2)).norm(), 1e-12);
  }
}

TEST(CellToml, RejectsAGeometryThatCannotBe) {
  const Folder folder;
  const auto said = [&](const std::string& text) {
    return rejection([&] { (void)read_cell(folder.file("cell.toml", text), Robots::any); });
  };
  EXPECT_NE(said(good + geometry).find("part.stl"), std::string::npos);  // no such file
  EXPECT_NE(said(good + "[geometry]\nstickout_mm = 50\n").find("geometry.holder: is missing"), std::string::npos);
  const std::string machine = "[robot]\nkind = \"hybrid-2upr-rpu\"\n";
  EXPECT_NE(said(machine + geometry).find("geometry: goes with kind = \"serial\""), std::string::npos)
      << said(machine + geometry);
}

TEST(CellToml, DamagedFilesAreReadOrRejected) {
  const Folder folder;
  Random random(53);
  int read = 0;
  for (int k = 0; k < seeds(2000); ++k) {
    const auto path = folder.file("cell.toml", test_support::damaged(good, k, random));
    try {
      read_cell(path).robot.validate();
      ++read;
    } catch (const InvalidInput&) {
      continue;
    }
  }
  EXPECT_GT(read, 10);
}

}  // namespace cell_toml_test
}  // namespace robomill::cell
