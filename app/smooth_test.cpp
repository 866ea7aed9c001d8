// robomill smooth as a user runs it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "test_program.hpp"

namespace robomill::app {
namespace smooth_test {

class SmoothVerb : public ProgramTest {
 protected:
  void SetUp() override {
    std::filesystem::copy_file(ROBOMILL_SOURCE_DIR "/examples/smooth-impeller-like/cell.toml", folder_.at("cell.toml"));
    folder_.file("part.ngc",
                 "G21 G90 G94\nG64\nG0 X0 Y0 Z40 A-20 C0\nG1 X4 F1800\nG1 X4 Y3 A-22\nG1 X0 Y3\nG1 X0 Y0 C2\nM30\n");
  }
  [[nodiscard]] bool there(const char* name) const { return std::filesystem::exists(folder_.at(name)); }
};

TEST_F(SmoothVerb, WritesATrajectoryAndReportsTheLimits) {
  const Ended run = robomill("smooth part.ngc --cell cell.toml -o t.csv --report smooth.json");
  ASSERT_EQ(run.exit, 0) << run.out << run.err;
  EXPECT_TRUE(run.out.starts_with("verified  "));
  EXPECT_NE(run.out.find("joint 6"), std::string::npos);
  EXPECT_NE(run.out.find("0 violations of limits"), std::string::npos);
  EXPECT_NE(run.out.find("skipped    line 2"), std::string::npos);
  const auto json = nlohmann::json::parse(slurp(folder_.at("smooth.json")));
  const std::string rows = slurp(folder_.at("t.csv"));
  EXPECT_EQ(static_cast<std::size_t>(std::count(rows.begin(), rows.end(), '\n')),
            json["samples"].get<std::size_t>() + 1);
  EXPECT_EQ(json["method"], "verified");
}

TEST_F(SmoothVerb, WritesProgramsAndPages) {
  ASSERT_EQ(robomill("smooth part.ngc --cell cell.toml -o part.src --report page.html --quiet").exit, 0);
  EXPECT_NE(slurp(folder_.at("part.src")).find("PTP_SPLINE"), std::string::npos);
  EXPECT_NE(slurp(folder_.at("page.html")).find("\"smooth\":{"), std::string::npos);
  EXPECT_EQ(slurp(folder_.at("out.txt")), "");
  ASSERT_EQ(robomill("smooth part.ngc --cell cell.toml -o part.servoj --program-period-ms 4").exit, 0);
  EXPECT_NE(slurp(folder_.at("part.servoj")).find(" points, one every 4 ms"), std::string::npos);
}

// A cycle so long that the joints cut the corners between its points: no file, and what would do.
TEST_F(SmoothVerb, ARobotProgramBeyondItsTolerancesExitsWithThree) {
  const Ended run =
      robomill("smooth part.ngc --cell cell.toml -o part.servoj --program-period-ms 64 --report smooth.json");
  EXPECT_EQ(run.exit, 3) << run.out << run.err;
  EXPECT_FALSE(there("part.servoj"));
  EXPECT_NE(run.err.find("the robot program leaves its tolerances"), std::string::npos) << run.err;
  const auto json = nlohmann::json::parse(slurp(folder_.at("smooth.json")));
  EXPECT_EQ(json["violations"], 0);
  EXPECT_FALSE(json["robot_program"]["holds"].get<bool>());
  EXPECT_GT(json["robot_program"]["max_tip_error_mm"].get<double>(), 0.02);
  const std::size_t at = run.out.find("--program-period-ms ");
  ASSERT_NE(at, std::string::npos) << run.out;
  const std::string cycle = run.out.substr(at + 20, run.out.find(' ', at + 20) - at - 20);
  EXPECT_EQ(robomill("smooth part.ngc --cell cell.toml -o part.servoj --program-period-ms " + cycle).exit, 0) << cycle;
  EXPECT_TRUE(there("part.servoj"));
  // Controllers that take points at any time get more of them instead.
  const Ended kuka = robomill("smooth part.ngc --cell cell.toml -o part.src --program-period-ms 64 --report kuka.json");
  EXPECT_EQ(kuka.exit, 0) << kuka.out << kuka.err;
  const auto robot_program = nlohmann::json::parse(slurp(folder_.at("kuka.json")))["robot_program"];
  EXPECT_TRUE(robot_program["holds"].get<bool>());
  EXPECT_LE(robot_program["max_tip_error_mm"].get<double>(), 0.02 * (1.0 + 1e-6));
  EXPECT_LT(robot_program["shortest_step_ms"].get<double>(), robot_program["longest_step_ms"].get<double>());
}

TEST_F(SmoothVerb, RobotProgramsKnowToolLoadAndSpindle) {
  folder_.file("spin.ngc", "G21 G90 G94\nS9000 M3\nG0 X0 Y0 Z40 A-20 C0\nG1 X4 F1800\nS7000\nG1 X0\nM5\nM30\n");
  // One output carries out one speed: such a program is written only where that is asked for.
  EXPECT_EQ(robomill("smooth spin.ngc --cell cell.toml -o bare.src").exit, 3);
  EXPECT_FALSE(there("bare.src"));
  EXPECT_EQ(robomill("smooth spin.ngc --cell cell.toml -o bare.src --keep-violations").exit, 3);
  ASSERT_TRUE(there("bare.src"));
  const std::string bare = slurp(folder_.at("bare.src"));
  EXPECT_NE(bare.find("\n; NOT SET: the tool"), std::string::npos);
  EXPECT_NE(bare.find("NOT CARRIED OUT: before line 6, spindle M3, 7000 rpm"), std::string::npos)
      << bare.substr(0, 2000);
  std::string cell = slurp(folder_.at("cell.toml"));
  cell.replace(cell.find("[tool]\n"), 7, "[spindle]\noutput = 7\n[tool]\nnumber = 3\n");
  folder_.file("known.toml", cell);
  folder_.file("spin.ngc", "G21 G90 G94\nS9000 M3\nG0 X0 Y0 Z40 A-20 C0\nG1 X4 F1800\nG1 X0\nM5\nM30\n");
  ASSERT_EQ(robomill("smooth spin.ngc --cell known.toml -o known.src").exit, 0);
  const std::string known = slurp(folder_.at("known.src"));
  EXPECT_EQ(known.find("NOT SET"), std::string::npos);
  EXPECT_NE(known.find("spindle M3, 9000 rpm"), std::string::npos);
  EXPECT_NE(known.find("BAS(#TOOL,3)\n$LOAD=LOAD_DATA[3]\n"), std::string::npos);
  EXPECT_NE(known.find("$OUT[7]=TRUE\n"), std::string::npos);
}

TEST_F(SmoothVerb, DashWritesJsonAndNothingElse) {
  const Ended run = robomill("smooth part.ngc --cell cell.toml --method paper -o -");
  const auto json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["method"], "paper");
  EXPECT_EQ(run.exit, json["violations"] == 0 ? 0 : 3);
}

// Where a limit is violated, the report says so and no trajectory is written.
TEST_F(SmoothVerb, AViolationExitsWithThreeAndLeavesOnlyTheReport) {
  std::string cell = slurp(folder_.at("cell.toml"));
  const std::string jerk = "joint_max_jerk = [60, 60, 60, 200, 200, 250]";
  cell.replace(cell.find(jerk), jerk.size(), "joint_max_jerk = [0.5, 0.5, 0.5, 1, 1, 1]");
  folder_.file("tight.toml", cell);
  const Ended run = robomill("smooth part.ngc --cell tight.toml --method no-joint-jerk -o t.csv --report smooth.json");
  EXPECT_EQ(run.exit, 3) << run.err;
  EXPECT_FALSE(there("t.csv"));
  EXPECT_NE(run.err.find("was not written"), std::string::npos);
  const auto json = nlohmann::json::parse(slurp(folder_.at("smooth.json")));
  EXPECT_GT(json["violations"].get<int>(), 0);
  EXPECT_FALSE(json["written"].get<bool>());
  EXPECT_EQ(run.err.find("earlier"), std::string::npos) << run.err;
  EXPECT_EQ(robomill("smooth part.ngc --cell tight.toml --method no-joint-jerk -o t.csv --keep-violations").exit, 3);
  EXPECT_TRUE(there("t.csv"));
  // That one must not stay looking like the next run's.
  for (const char* name : {"t.csv", "t.h5", "t.src"}) {
    folder_.file(name, "older");
    const std::string output = std::string(" -o ") + name;
    const Ended again = robomill("smooth part.ngc --cell tight.toml --method no-joint-jerk --quiet" + output);
    EXPECT_EQ(again.exit, 3) << again.err;
    EXPECT_FALSE(there(name));
    EXPECT_NE(again.err.find(std::string("and the ") + name + " of an earlier run was removed"), std::string::npos)
        << again.err;
  }
}

TEST_F(SmoothVerb, SetsMethodsSideBySide) {
  const Ended run = robomill("smooth part.ngc --cell cell.toml --compare");
  EXPECT_EQ(run.exit, 0) << run.err;
  for (const char* method : {"optimal", "paper", "paper-as-printed", "no-joint-jerk"}) {
    EXPECT_NE(run.out.find(std::string("\n") + method + " "), std::string::npos) << method;
  }
}

TEST_F(SmoothVerb, RejectsBadInput) {
  EXPECT_EQ(robomill("smooth part.ngc").exit, 2);
  EXPECT_EQ(robomill("smooth part.ngc --cell cell.toml --method fast").exit, 2);
  const auto rejected = [&](const std::string& arguments, const char* part) {
    const Ended run = robomill("smooth " + arguments);
    EXPECT_EQ(run.exit, 1) << arguments;
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  };
  rejected("none.ngc --cell cell.toml", "none.ngc");
  rejected("part.ngc --cell none.toml", "none.toml");
  rejected("part.ngc --cell cell.toml -o t.step", "t.step");
  rejected("part.ngc --cell cell.toml --report t.pdf", "t.pdf");
  rejected("part.ngc --cell cell.toml -o t.src --program-period-ms 12.5",
           "--program-period-ms = 12.5 ms; must be a multiple");
  rejected("part.ngc --cell cell.toml -o t.csv --program-period-ms 20",
           "--program-period-ms = 20 ms; is of joint programs");
  rejected("part.ngc --cell cell.toml -o t.src --program-period-ms 20000",
           "--program-period-ms = 20000 ms; must be at most 10 s");
  rejected("part.ngc --cell cell.toml -o t.src --program-period-ms 0", "--program-period-ms = 0 ms; must be > 0");
  rejected("part.ngc --cell cell.toml -o t.src --program-period-ms=-4", "--program-period-ms = -4 ms; must be > 0");
  std::string one = slurp(folder_.at("cell.toml"));
  one.replace(one.find("[smoothing]"), 11, "[smoothing]\nmethod = \"paper\"\nfilters = 1");
  folder_.file("one.toml", one);
  rejected("part.ngc --cell one.toml --method verified", "smoothing.filters = 1; must be at least 2");
  folder_.file("far.ngc", "G21 G90 G94\nG0 X0 Y0 Z40\nG1 X9000 F1800\n");
  rejected("far.ngc --cell cell.toml -o t.csv", "line 3");
  EXPECT_FALSE(there("t.csv"));
  // What was never smoothed takes nothing away.
  folder_.file("t.csv", "older");
  rejected("far.ngc --cell cell.toml -o t.csv", "line 3");
  EXPECT_TRUE(there("t.csv"));
}

}  // namespace smooth_test
}  // namespace robomill::app
