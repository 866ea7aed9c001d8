#include "robomill/formats/joint_programs.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "robomill/base/test_support.hpp"
#include "robomill/formats/file.hpp"
#include "robomill/formats/test_trajectories.hpp"
#include "robomill/formats/units.hpp"

namespace robomill::formats {
namespace {

using robomill::test::Folder;

/// A point of a program and when it is reached.
struct Point {
  double time_s = 0.0;
  std::array<double, 6> joints = {};
};

/// A program as a controller would take it; `trouble` is the first line that it would not.
struct Parsed {
  std::vector<Point> points = {};
  std::string trouble = {};
  double time_s = 0.0;

  void move(const std::smatch& match, std::size_t first, double seconds) {
    time_s += seconds;
    Point point{.time_s = time_s};
    for (std::size_t i = 0; i < 6; ++i) point.joints[i] = std::stod(match[first + i]);
    points.push_back(point);
  }
  void refuse(const std::string& line) {
    if (trouble.empty()) trouble = line;
  }
};

const std::string real = R"((-?\d+\.?\d*))";

/// KRL: a DEF … END with PTP, PTP_SPLINE blocks of SPTP and TIME_BLOCK, and WAIT SEC.
Parsed parse_krl(const std::string& text) {
  std::string target = R"(\{A1 )" + real;
  for (int i = 2; i <= 6; ++i) target += ",A" + std::to_string(i) + " " + real;
  target += R"(\})";
  const std::regex ptp("PTP " + target);
  const std::regex segment(" SPTP " + target);
  const std::regex part(R"( TIME_BLOCK PART=(\d+\.\d+))");
  const std::regex end(R"( TIME_BLOCK END=(\d+\.\d+))");
  const std::regex wait(R"(WAIT SEC (\d+\.\d+))");
  const std::regex setting(R"(&[A-Z]+ \w+|; .*|BAS\(#\w+,\d+\)|\$[\w.]+=[\d.]+)");
  Parsed out;
  std::istringstream lines(text);
  std::optional<std::smatch> pending;
  std::string pending_line;
  int defined = 0, ended = 0, segments = 0;
  bool in_block = false;
  double parts = 0.0;
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, setting)) continue;
    if (std::regex_match(line, std::regex(R"(DEF [A-Za-z]\w{0,23}\(\))"))) {
      ++defined;
    } else if (line == "END") {
      ++ended;
    } else if (std::regex_match(line, match, ptp)) {
      out.move(match, 1, 0.0);
    } else if (line == "PTP_SPLINE") {
      if (in_block) out.refuse(line);
      in_block = true;
      segments = 0;
      parts = 0.0;
    } else if (line == " TIME_BLOCK START") {
      if (!in_block || segments > 0) out.refuse(line);
    } else if (std::regex_match(line, match, segment)) {
      if (!in_block || pending) out.refuse(line);
      pending_line = line;
      std::smatch kept;
      std::regex_match(pending_line, kept, segment);
      pending = kept;
      ++segments;
    } else if (std::regex_match(line, match, part)) {
      if (!pending) {
        out.refuse(line);
        continue;
      }
      parts += std::stod(match[1]);
      out.move(*pending, 1, std::stod(match[1]));
      pending.reset();
    } else if (std::regex_match(line, match, end)) {
      if (std::abs(std::stod(match[1]) - parts) > 1e-5) out.refuse(line);
    } else if (line == "ENDSPLINE" || line == "ENDSPLINE C_SPL") {
      if (!in_block || segments == 0) out.refuse(line);
      in_block = false;
    } else if (std::regex_match(line, match, wait)) {
      if (in_block) out.refuse(line);
      out.time_s += std::stod(match[1]);
    } else {
      out.refuse(line);
    }
  }
  if (defined != 1 || ended != 1 || in_block) out.refuse("the whole");
  return out;
}

/// RAPID: a MODULE of PROCs that main calls in turn, with MoveAbsJ and WaitTime.
Parsed parse_rapid(const std::string& text) {
  std::string target = R"(\[\[)" + real;
  for (int i = 2; i <= 6; ++i) target += "," + real;
  target += R"(\],ext\])";
  const std::regex move("MoveAbsJ " + target + R"(\\NoEOffs,v1000\\T:=(\d+\.\d+),(z0|fine),tool0;)");
  const std::regex start("MoveAbsJ " + target + R"(\\NoEOffs,v100,fine,tool0;)");
  const std::regex wait(R"(WaitTime (\d+\.\d+);)");
  const std::regex proc(R"((LOCAL )?PROC (\w+)\(\))");
  Parsed out;
  std::istringstream lines(text);
  std::vector<std::string> defined, called;
  std::string open;
  bool standing = true, module = false, ended = false;
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (line.starts_with("! ") || line == "LOCAL CONST extjoint ext:=[9E9,9E9,9E9,9E9,9E9,9E9];") continue;
    if (std::regex_match(line, std::regex(R"(MODULE [A-Za-z]\w{0,31})"))) {
      module = true;
    } else if (line == "ENDMODULE") {
      ended = open.empty();
    } else if (std::regex_match(line, match, proc)) {
      if (!open.empty()) out.refuse(line);
      open = match[2];
      defined.push_back(open);
    } else if (line == "ENDPROC") {
      if (open.empty()) out.refuse(line);
      open.clear();
    } else if (std::regex_match(line, match, start) && open == "go_to_start") {
      out.move(match, 1, 0.0);
    } else if (std::regex_match(line, match, move) && !open.empty()) {
      out.move(match, 1, std::stod(match[7]));
      standing = match[8] == "fine";
    } else if (std::regex_match(line, match, wait) && !open.empty()) {
      if (!standing) out.refuse(line);  // a zone does not stop
      out.time_s += std::stod(match[1]);
    } else if (open == "main" && std::regex_match(line, std::regex(R"(\w+;)"))) {
      called.push_back(line.substr(0, line.size() - 1));
    } else {
      out.refuse(line);
    }
  }
  defined.erase(std::find(defined.begin(), defined.end(), "main"));
  if (!module || !ended || called != defined || !standing) out.refuse("the whole");
  return out;
}

/// URScript: def … end, movej, servoj, stopj, and the call.
Parsed parse_urscript(const std::string& text) {
  std::string target = R"(\[)" + real;
  for (int i = 2; i <= 6; ++i) target += ", " + real;
  target += R"(\])";
  const std::regex servo("  servoj\\(" + target + R"(, 0, 0, ([\d.e-]+), 0\.03, 2000\))");
  const std::regex start("  movej\\(" + target + R"(, a=0\.5, v=0\.2\))");
  Parsed out;
  std::istringstream lines(text);
  std::string name;
  bool inside = false, called = false;
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (line.starts_with("  # ")) continue;
    if (std::regex_match(line, match, std::regex(R"(def ([A-Za-z]\w*)\(\):)"))) {
      name = match[1];
      inside = true;
    } else if (inside && std::regex_match(line, match, start)) {
      out.move(match, 1, 0.0);
    } else if (inside && std::regex_match(line, match, servo)) {
      out.move(match, 1, std::stod(match[7]));
    } else if (line == "end" && inside) {
      inside = false;
    } else if (line == name + "()" && !inside) {
      called = true;
    } else if (line != "  stopj(2.0)") {
      out.refuse(line);
    }
  }
  if (!called) out.refuse("the whole");
  return out;
}

Parsed parse_servoj(const std::string& text, double cycle_s) {
  const std::regex row(real + " " + real + " " + real + " " + real + " " + real + " " + real);
  Parsed out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (line.starts_with("# ")) continue;
    if (std::regex_match(line, match, row)) {
      out.move(match, 1, out.points.empty() ? 0.0 : cycle_s);
    } else {
      out.refuse(line);
    }
  }
  return out;
}

Parsed parse(const std::string& ending, const std::string& text, double cycle_s) {
  if (ending == ".src") return parse_krl(text);
  if (ending == ".mod") return parse_rapid(text);
  if (ending == ".script") return parse_urscript(text);
  return parse_servoj(text, cycle_s);
}

struct Case {
  const char* ending;
  double period_s;    // from point to point, where not said
  double unit;        // of a joint
  double resolution;  // of its digits
};

class Program : public testing::TestWithParam<Case> {
 protected:
  std::string written(const std::vector<path::Sample>& samples, TrajectoryInfo info = test::arm_info()) {
    const auto path = folder_.at(std::string("1 – part") + GetParam().ending);
    const auto file = open_sample_file(path, info);
    file->add(samples);
    file->commit();
    return read_file(path);
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

TEST_P(Program, TellsItsDurationAndHowFarALineWouldLeaveTheTrajectory) {
  const auto samples = test::sines(2001);
  const std::string text = written(samples);
  EXPECT_NE(text.find("duration 2.000000 s"), std::string::npos);
  EXPECT_NE(text.find("cell cell.toml, program part.ngc"), std::string::npos);
  std::smatch match;
  ASSERT_TRUE(std::regex_search(text, match,
                                std::regex(R"(leaves the trajectory by (\d+\.\d+) degrees a joint, (\d+\.\d+) mm)")));
  // A chord of a curve x(t) is off by x'' T²/8. Joint 6 turns most: 0.8 (2.5)² rad/s²; the tip 0.03·9 m/s².
  const double part = GetParam().period_s * GetParam().period_s / 8.0;
  EXPECT_NEAR(std::stod(match[1]), 0.8 * 6.25 * part / units::deg, 0.02 * 0.8 * 6.25 * part / units::deg + 1e-6);
  EXPECT_NEAR(std::stod(match[2]), 0.27 * part / units::mm, 0.03 * 0.27 * part / units::mm + 1e-6);
}

TEST_P(Program, HasNoRoomForTextsThatAreCode) {
  TrajectoryInfo info = test::arm_info();
  info.program = "part.ngc\nEND\nPTP {A1 0}";
  EXPECT_EQ(parse(GetParam().ending, written(test::sines(101), info), GetParam().period_s).trouble, "");
}

TEST_P(Program, RefusesMachinesThatAreNoSuchArm) {
  const auto path = folder_.at(std::string("p") + GetParam().ending);
  TrajectoryInfo five = test::arm_info();
  five.joints = 5;
  TrajectoryInfo slide = test::arm_info();
  slide.slides[0] = true;
  for (const TrajectoryInfo& info : {five, slide}) {
    EXPECT_NE(robomill::test::refusal([&] { static_cast<void>(open_sample_file(path, info)); }).find("six joints"),
              std::string::npos);
  }
  TrajectoryInfo odd = test::arm_info();
  odd.program_period_s = 0.0125;
  EXPECT_EQ(robomill::test::field_of([&] { static_cast<void>(open_sample_file(path, odd)); }), "program_period_s");
}

// A name cut off would make one program of two.
TEST(ProgramNames, AreWholeOrRefused) {
  const Folder folder;
  const auto named = [&](std::size_t letters, const char* ending) {
    const auto path = folder.at(std::string(letters - 1, 'a') + "-" + ending);
    const auto file = open_sample_file(path, test::arm_info());
    file->add(test::sines(101));
    file->commit();
    return read_file(path);
  };
  const auto written = [](std::size_t letters) { return std::string(letters - 1, 'a') + "_"; };
  EXPECT_NE(named(24, ".src").find("\nDEF " + written(24) + "()\n"), std::string::npos);
  EXPECT_TRUE(named(32, ".mod").starts_with("MODULE " + written(32) + "\n"));
  EXPECT_TRUE(named(80, ".script").starts_with("def " + written(80) + "():\n"));
  EXPECT_NE(robomill::test::refusal([&] {
              static_cast<void>(named(25, ".src"));
            }).find("25 characters; KRL takes at most 24. Give the file a shorter name"),
            std::string::npos);
  EXPECT_NE(robomill::test::refusal([&] {
              static_cast<void>(named(33, ".mod"));
            }).find("33 characters; RAPID takes at most 32"),
            std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Joint, Program,
                         testing::Values(Case{".src", 0.020, units::deg, 1e-6}, Case{".mod", 0.020, units::deg, 1e-6},
                                         Case{".script", 0.002, 1.0, 1e-9}, Case{".servoj", 0.002, 1.0, 1e-9}),
                         [](const auto& one) { return std::string(one.param.ending).substr(1); });

// The reader above refuses what is wrong, or it would prove nothing.
TEST(ProgramParsers, RefuseWhatIsWrong) {
  EXPECT_NE(parse_krl("DEF a()\nPTP_SPLINE\n TIME_BLOCK START\nENDSPLINE\nEND\n").trouble, "");
  EXPECT_NE(parse_krl("DEF a()\nPTP {A1 1,A2 2}\nEND\n").trouble, "");
  EXPECT_NE(parse_rapid("MODULE a\nPROC main()\npart_1;\nENDPROC\nENDMODULE\n").trouble, "");
  EXPECT_NE(parse_urscript("def a():\nend\n").trouble, "");
  EXPECT_NE(parse_servoj("1 2 3\n", 0.002).trouble, "");
}

}  // namespace
}  // namespace robomill::formats
