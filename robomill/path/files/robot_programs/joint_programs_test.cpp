#include "robomill/path/files/robot_programs/joint_programs.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/robot/serial_kinematics.hpp"
#include "testing/path/joint_parsers.hpp"
#include "testing/path/trajectories.hpp"
#include "testing/robot/arms.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace joint_programs_test {

using robomill::test::Folder;
using test::parse;
using test::Parsed;
using test::Point;

struct Case {
  const char* ending;
  double period_s;    // from point to point, where not said
  double unit;        // of a joint
  double resolution;  // of its digits
};

class Program : public ::testing::TestWithParam<Case> {
 protected:
  std::string written(const std::vector<Sample>& samples, TrajectoryInfo info = test::arm_info()) {
    const auto path = folder_.at(std::string("1 – part") + GetParam().ending);
    const auto file = open_sample_file(path, info);
    file->add(samples);
    file->commit();
    return io::read_file(path);
  }
  Folder folder_;
};

// Every point of the program is a sample of the trajectory: the joints at its time.
TEST_P(Program, PointsLieOnTheTrajectoryAtTheirTimes) {
  const Case with = GetParam();
  for (const std::size_t pause : {std::size_t{0}, std::size_t{730}}) {
    const auto samples = test::sines(9001, pause);
    const Parsed program = parse(with.ending, written(samples), with.period_s);
    ASSERT_EQ(program.trouble, "");
    EXPECT_NEAR(program.time_s, samples.back().time_s, 1e-4);
    ASSERT_GT(program.points.size(), 8000 * test::period_s / with.period_s);
    for (const Point& point : program.points) {
      const auto at = static_cast<std::size_t>(std::lround(point.time_s / test::period_s));
      ASSERT_LT(at, samples.size());
      for (int joint = 0; joint < 6; ++joint) {
        ASSERT_NEAR(point.joints[static_cast<std::size_t>(joint)] * with.unit, samples[at].joints[joint],
                    0.51 * with.resolution * with.unit + 2e-9)
            << "at " << point.time_s;
      }
    }
    const auto& last = program.points.back().joints;
    for (std::size_t joint = 0; joint < 6; ++joint) {
      EXPECT_NEAR(last[joint] * with.unit, samples.back().joints[static_cast<int>(joint)], with.resolution * with.unit);
    }
  }
}

TEST_P(Program, TakesThePeriodGiven) {
  const Case with = GetParam();
  TrajectoryInfo info = test::arm_info();
  info.program_period_s = 0.008;
  const Parsed program = parse(with.ending, written(test::sines(801), info), 0.008);
  EXPECT_EQ(program.trouble, "");
  EXPECT_EQ(program.points.size(), 101U);
}

// The last step is shorter where the period does not go into the duration.
TEST_P(Program, EndsWhereTheTrajectoryEnds) {
  const auto samples = test::sines(1238);
  const Parsed program = parse(GetParam().ending, written(samples), GetParam().period_s);
  EXPECT_EQ(program.trouble, "");
  for (std::size_t joint = 0; joint < 6; ++joint) {
    EXPECT_NEAR(program.points.back().joints[joint] * GetParam().unit, samples.back().joints[static_cast<int>(joint)],
                2e-8);
  }
}

TEST_P(Program, SurvivesATrajectoryThatStandsStill) {
  const Parsed program = parse(GetParam().ending, written(test::sines(1)), GetParam().period_s);
  EXPECT_EQ(program.trouble, "");
  EXPECT_EQ(program.points.size(), 1U);
}

TEST_P(Program, ReportsItsDurationAndThatNobodyCheckedIt) {
  const std::string text = written(test::sines(2001));
  EXPECT_NE(text.find("duration 2.000000 s"), std::string::npos);
  EXPECT_NE(text.find("cell cell.toml, program part.ngc"), std::string::npos);
  EXPECT_NE(text.find("ms; what the controller makes of them was not checked"), std::string::npos);
}

TEST_P(Program, HasNoRoomForTextsThatAreCode) {
  TrajectoryInfo info = test::arm_info();
  info.program = "part.ngc\nEND\nPTP {A1 0}";
  EXPECT_EQ(parse(GetParam().ending, written(test::sines(101), info), GetParam().period_s).trouble, "");
}

TEST_P(Program, RejectsMachinesThatAreNoSuchArm) {
  const auto path = folder_.at(std::string("p") + GetParam().ending);
  TrajectoryInfo five = test::arm_info();
  five.joints = 5;
  TrajectoryInfo slide = test::arm_info();
  slide.prismatic[0] = true;
  for (const TrajectoryInfo& info : {five, slide}) {
    EXPECT_NE(
        robomill::test::rejection([&] { static_cast<void>(open_sample_file(path, info)); }).find("six revolute joints"),
        std::string::npos);
  }
  TrajectoryInfo odd = test::arm_info();
  odd.program_period_s = 0.0125;
  EXPECT_EQ(robomill::test::field_of([&] { static_cast<void>(open_sample_file(path, odd)); }), "program_period_s");
}

/// A file whose program commands 8,000 rpm and coolant where that is asked for, then 6,000 rpm and a stop.
std::string with_spindle(const std::filesystem::path& path, const EndEffector& end, bool coolant = false) {
  TrajectoryInfo info = test::arm_info();
  info.end_effector = end;
  const auto file = open_sample_file(path, info);
  file->add(test::sines(101));
  program::Program program;
  program::Block block;
  block.line = 4;
  block.duration_s = 1.0;
  block.spindle = program::Spindle::clockwise;
  block.spindle_speed_rad_per_s = 8000.0 * units::rpm;
  block.coolant.flood = coolant;
  program.blocks.push_back(block);
  block.line = 9;
  block.spindle_speed_rad_per_s = 6000.0 * units::rpm;
  block.operator_stop = program::OperatorStop::always;
  program.blocks.push_back(block);
  robot::Cell cell;
  cell.arm = robot::testing::with_limits(robot::testing::kr210());
  SmoothingOptions options;
  options.tip_tolerance_m = options.axis_tolerance_rad = 1.0;
  options.max_velocity_m_per_s = options.max_acceleration_m_per_s2 = options.max_jerk_m_per_s3 = 1.0;
  options.max_angular_velocity_rad_per_s = options.max_angular_acceleration_rad_per_s2 = 1.0;
  options.max_angular_jerk_rad_per_s3 = 1.0;
  program::ProgramSource source(program);
  static_cast<void>(file->verify(source, robot::SerialKinematics(cell), options, false, robomill::Progress::none()));
  file->commit();
  return io::read_file(path);
}

/// The first comment of a program.
std::string first_comment(const std::string& text, const std::string& mark) {
  const std::size_t from = text.find(mark);
  return text.substr(from + mark.size(), text.find('\n', from) - from - mark.size());
}

// Without tool and load the controller's dynamics are those of another arm: the file begins with that.
TEST(ProgramSetup, BeginsWithWhatTheCellDoesNotGive) {
  const Folder folder;
  const std::array<std::pair<const char*, const char*>, 4> languages = {
      {{".src", "\n; "}, {".mod", "\n! "}, {".script", "  # "}, {".servoj", "# "}}};
  for (const auto& [ending, mark] : languages) {
    const std::string text = with_spindle(folder.at(std::string("part") + ending), {});
    EXPECT_TRUE(first_comment(text, mark).starts_with("NOT SET: ")) << ending;
    EXPECT_NE(text.find("With a wrong load the arm sags"), std::string::npos) << ending;
    EXPECT_NE(text.find("NOT SET: the spindle"), std::string::npos) << ending;
    EXPECT_NE(text.find("spindle M3, 8000 rpm, before line 4"), std::string::npos) << ending;
    EXPECT_NE(text.find("NOT CARRIED OUT: before line 9, spindle M3, 6000 rpm"), std::string::npos) << ending;
    EXPECT_NE(text.find("NOT CARRIED OUT: before line 9, stop for the operator (M0)"), std::string::npos) << ending;
    EXPECT_EQ(parse(ending, text, 0.02).trouble, "");
  }
}

TEST(ProgramSetup, SetsToolLoadAndSpindleOfKuka) {
  const Folder folder;
  EndEffector end;
  end.tool_number = 3;
  end.spindle.number = 7;
  end.spin_up_s = 2.5;
  std::string text = with_spindle(folder.at("a.src"), end);
  EXPECT_EQ(text.find("NOT SET"), std::string::npos) << text;
  EXPECT_NE(text.find("BAS(#INITMOV,0)\nBAS(#TOOL,3)\n$LOAD=LOAD_DATA[3]\n"), std::string::npos);
  const std::size_t on = text.find("}\n$OUT[7]=TRUE\nWAIT SEC 2.500000\n");
  EXPECT_LT(text.find("PTP {"), on);
  EXPECT_LT(on, text.find("PTP_SPLINE"));
  EXPECT_TRUE(text.ends_with("$OUT[7]=FALSE\nEND\n"));
  EXPECT_EQ(parse(".src", text, 0.02).trouble, "");
  end.load_number = 5;
  EXPECT_NE(with_spindle(folder.at("b.src"), end).find("$LOAD=LOAD_DATA[5]\n"), std::string::npos);
  end.load_number.reset();
  end.mass_kg = 12.5;
  end.center_m = Eigen::Vector3d(0.0, 0.01, 0.12);
  EXPECT_NE(with_spindle(folder.at("c.src"), end)
                .find("$LOAD={M 12.5,CM {X 0,Y 10,Z 120,A 0.0,B 0.0,C 0.0},J {X 0.0,Y 0.0,Z 0.0}}\n"),
            std::string::npos);
}

TEST(ProgramSetup, DeclaresTheToolOfAbb) {
  const Folder folder;
  EndEffector end;
  end.mass_kg = 8.0;
  end.tip.linear() = Eigen::AngleAxisd(robot::testing::pi / 2.0, Eigen::Vector3d::UnitY()).toRotationMatrix();
  end.tip.translation() << 0.25, 0.0, 0.1;
  end.spindle.signal = "doSpindle";
  end.coolant.signal = "doCoolant";
  std::string text = with_spindle(folder.at("a.mod"), end);
  EXPECT_EQ(text.find("NOT SET"), std::string::npos) << text;
  EXPECT_NE(text.find("LOCAL PERS tooldata tool_of_cell:=[TRUE,[[250,0,100],[0.70710678,0.00000000,0.70710678,"
                      "0.00000000]],[8,[125,0,50],[1,0,0,0],0,0,0]];\n"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find(",fine,tool_of_cell;\nSetDO doSpindle,1;\nWaitTime 5.000000;\nENDPROC\n"), std::string::npos);
  EXPECT_NE(text.find("SetDO doSpindle,0;\nENDPROC\nENDMODULE\n"), std::string::npos);
  EXPECT_EQ(text.find("tool0"), std::string::npos);
  EXPECT_NE(text.find("! ASSUMED of the load of 8 kg: its centre half-way to the tip (tool.center_mm), no moments"),
            std::string::npos);
  EXPECT_EQ(text.find("doCoolant"), std::string::npos);  // this program asks for none
  text = with_spindle(folder.at("c.mod"), end, true);
  EXPECT_NE(text.find("SetDO doCoolant,1;\nSetDO doSpindle,1;\n"), std::string::npos);
  EXPECT_NE(text.find("SetDO doSpindle,0;\nSetDO doCoolant,0;\nENDPROC\nENDMODULE\n"), std::string::npos);
  end.tool_name = "tSpindle";
  text = with_spindle(folder.at("b.mod"), end);
  EXPECT_EQ(text.find("tooldata"), std::string::npos);
  EXPECT_NE(text.find("z0,tSpindle;"), std::string::npos);
  EXPECT_EQ(parse(".mod", text, 0.02).trouble, "");
}

TEST(ProgramSetup, SetsTipLoadAndOutputOfUniversalRobots) {
  const Folder folder;
  EndEffector end;
  end.mass_kg = 2.0;
  end.tip.linear() = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()).toRotationMatrix();
  end.tip.translation() << 0.0, 0.0, 0.2;
  end.spindle.number = 0;
  const std::string text = with_spindle(folder.at("a.script"), end);
  EXPECT_EQ(text.find("NOT SET"), std::string::npos) << text;
  EXPECT_NE(text.find("  set_tcp(p[0,0,0.2,0.5,0,0])\n  set_payload(2, [0,0,0.1])\n  movej("), std::string::npos)
      << text;
  EXPECT_NE(text.find("v=0.2)\n  set_standard_digital_out(0, True)\n  sleep(5)\n"), std::string::npos);
  EXPECT_NE(text.find("  stopj(2.0)\n  set_standard_digital_out(0, False)\nend\n"), std::string::npos);
  EXPECT_EQ(parse(".script", text, 0.002).trouble, "");
}

TEST(ProgramSetup, RejectsOutputsOfTheOtherKind) {
  const Folder folder;
  EndEffector numbered, named;
  numbered.spindle.number = 1;
  named.coolant.signal = "doCoolant";
  EXPECT_NE(robomill::test::rejection([&] {
              static_cast<void>(with_spindle(folder.at("a.mod"), numbered));
            }).find("cell.toml: spindle.output: must be a signal's name"),
            std::string::npos);
  for (const char* name : {"a.src", "a.script"}) {
    EXPECT_NE(robomill::test::rejection([&] {
                static_cast<void>(with_spindle(folder.at(name), named));
              }).find("cell.toml: spindle.coolant_output: must be an output's number"),
              std::string::npos);
  }
}

// A name cut off would make one program of two.
TEST(ProgramNames, AreWholeOrRejected) {
  const Folder folder;
  const auto named = [&](std::size_t letters, const char* ending) {
    const auto path = folder.at(std::string(letters - 1, 'a') + "-" + ending);
    const auto file = open_sample_file(path, test::arm_info());
    file->add(test::sines(101));
    file->commit();
    return io::read_file(path);
  };
  const auto written = [](std::size_t letters) { return std::string(letters - 1, 'a') + "_"; };
  EXPECT_NE(named(24, ".src").find("\nDEF " + written(24) + "()\n"), std::string::npos);
  EXPECT_TRUE(named(32, ".mod").starts_with("MODULE " + written(32) + "\n"));
  EXPECT_TRUE(named(80, ".script").starts_with("def " + written(80) + "():\n"));
  EXPECT_NE(robomill::test::rejection([&] {
              static_cast<void>(named(25, ".src"));
            }).find("25 characters; KRL takes at most 24. Give the file a shorter name"),
            std::string::npos);
  EXPECT_NE(robomill::test::rejection([&] {
              static_cast<void>(named(33, ".mod"));
            }).find("33 characters; RAPID takes at most 32"),
            std::string::npos);
}

TEST(ProgramNames, AreNoWordsOfTheLanguage) {
  const Folder folder;
  for (const char* name : {"test.mod", "main.mod", "Loop.src", "end.script"}) {
    EXPECT_NE(robomill::test::rejection([&] {
                static_cast<void>(open_sample_file(folder.at(name), test::arm_info()));
              }).find("a word of the controller's language"),
              std::string::npos)
        << name;
  }
  EXPECT_NO_THROW(static_cast<void>(open_sample_file(folder.at("test.src"), test::arm_info())));
}

INSTANTIATE_TEST_SUITE_P(Joint, Program,
                         testing::Values(Case{".src", 0.020, units::deg, 1e-6}, Case{".mod", 0.020, units::deg, 1e-6},
                                         Case{".script", 0.002, 1.0, 1e-9}, Case{".servoj", 0.002, 1.0, 1e-9}),
                         [](const auto& one) { return std::string(one.param.ending).substr(1); });

// The reader above rejects what is wrong, or it would prove nothing.
TEST(ProgramParsers, RejectWhatIsWrong) {
  EXPECT_NE(test::parse_krl("DEF a()\nPTP_SPLINE\n TIME_BLOCK START\nENDSPLINE\nEND\n").trouble, "");
  EXPECT_NE(test::parse_krl("DEF a()\nPTP {A1 1,A2 2}\nEND\n").trouble, "");
  EXPECT_NE(test::parse_rapid("MODULE a\nPROC main()\npart_1;\nENDPROC\nENDMODULE\n").trouble, "");
  EXPECT_NE(test::parse_urscript("def a():\nend\n").trouble, "");
  EXPECT_NE(test::parse_servoj("1 2 3\n", 0.002).trouble, "");
}

}  // namespace joint_programs_test
}  // namespace robomill::path
