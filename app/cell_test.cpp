// robomill cell check as a user runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "test_program.hpp"

namespace robomill::app {
namespace cell_test {

class CellVerb : public ProgramTest {
 protected:
  void write_cell(const std::string& origin = "[1800, 0, 700]") {
    write("cell.toml",
          "[robot]\nmodel = \"kuka-kr210-r2700\"\n[workpiece]\norigin_mm = " + origin + "\n[tool]\nlength_mm = 350\n");
  }
};

TEST_F(CellVerb, PrintsPosesAndLimits) {
  write_cell();
  const Ended run = robomill("cell check cell.toml --joints 0,-90,90,0,90,0 -o check.json");
  ASSERT_EQ(run.exit, 0) << run.out << run.err;
  EXPECT_TRUE(run.out.starts_with("cell.toml: KUKA KR 210 R2700 extra")) << run.out;
  EXPECT_NE(run.out.find("as asked for: joints 0.00, -90.00, 90.00, 0.00, 90.00, 0.00°"), std::string::npos) << run.out;
  // Upper arm up, forearm level, flange down: x = 350 + 1200, z = 675 + 1150 - 41 - 215 - 350.
  EXPECT_NE(run.out.find("tip in the robot's base    1550.000, 0.000, 1219.000 mm, axis 0.00000, 0.00000, 1.00000"),
            std::string::npos)
      << run.out;
  EXPECT_NE(run.out.find("* assumed, see below"), std::string::npos);
  EXPECT_NE(run.out.find("Assumed, because not given:"), std::string::npos) << run.out;
  const auto json = nlohmann::json::parse(slurp(folder_.at("check.json")));
  EXPECT_TRUE(json["placement"]["works"].get<bool>());
  EXPECT_EQ(json["postures"].size(), 3U);
  const Ended piped = robomill("cell check cell.toml -o -");
  EXPECT_EQ(nlohmann::json::parse(piped.out)["cell"], "cell.toml");
}

TEST_F(CellVerb, APlacementThatFailsExitsWithThreeAndProposesOthers) {
  write_cell("[3400, 0, 700]");
  const Ended run = robomill("cell check cell.toml --report cell.html");
  EXPECT_EQ(run.exit, 3) << run.out;
  EXPECT_NE(run.err.find("the tool does not come to the workpiece"), std::string::npos) << run.err;
  EXPECT_NE(run.out.find("the workpiece's origin: "), std::string::npos) << run.out;
  const std::size_t at = run.out.find("  origin_mm = ");
  ASSERT_NE(at, std::string::npos) << run.out;
  EXPECT_NE(slurp(folder_.at("cell.html")).find("\"cell\":{\"document\":\"check/1\",\"cell\":\"cell.toml\""),
            std::string::npos);
  // As it is printed it goes into the cell.
  const std::string line = run.out.substr(at + 14, run.out.find('\n', at) - at - 14);
  write_cell(line);
  EXPECT_EQ(robomill("cell check cell.toml --quiet").exit, 0) << line;
}

TEST_F(CellVerb, ChecksAProgramBlockByBlock) {
  write_cell();
  write("part.ngc", "G21 G90 G94\nG0 X0 Y0 Z50\nG1 Z0 F1200\nG1 X1500\nM30\n");
  const Ended run = robomill("cell check cell.toml --program part.ngc");
  EXPECT_EQ(run.exit, 3);
  EXPECT_NE(run.out.find("block 2 (line 4): "), std::string::npos) << run.out;
}

TEST_F(CellVerb, SaysWhatIsWrong) {
  write_cell();
  const Ended joints = robomill("cell check cell.toml --joints 0,1");
  EXPECT_EQ(joints.exit, 1);
  EXPECT_NE(joints.err.find("--joints: must hold one value a joint, 6; it holds 2"), std::string::npos) << joints.err;
  EXPECT_EQ(robomill("cell check cell.toml -o check.csv").exit, 1);
  EXPECT_EQ(robomill("cell check none.toml").exit, 1);
  EXPECT_EQ(robomill("cell").exit, 2);
  EXPECT_EQ(robomill("cell check").exit, 2);
  EXPECT_EQ(robomill("cell check --help").exit, 0);
}

}  // namespace cell_test
}  // namespace robomill::app
