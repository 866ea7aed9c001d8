// Drilling cycles, coordinate systems and retracts as CAM systems write them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/program/files/apt_reader.hpp"
#include "testing/program/reading.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace apt_cycles_test {

using Eigen::Vector3d;

constexpr double mm = 1e-3;

Program read(const std::string& text) {
  return test_support::read_text<AptReader>(text);
}

void expect_rejected(const std::string& text, const std::string& words) {
  const std::string said = test::rejection([&] { static_cast<void>(read(text)); });
  EXPECT_NE(said.find(words), std::string::npos) << text << "\n" << said;
}

struct Want {
  Block::Kind kind;
  Vector3d end_mm;
  double seconds = 0.0;
};
constexpr auto rapid = Block::Kind::rapid;
constexpr auto feed = Block::Kind::feed;
constexpr auto pause = Block::Kind::dwell;

void expect_blocks(const Program& program, const std::vector<Want>& wanted) {
  ASSERT_EQ(program.blocks.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const Block& block = program.blocks[i];
    EXPECT_EQ(block.kind, wanted[i].kind) << i;
    EXPECT_LT((block.end.tip_m - mm * wanted[i].end_mm).norm(), 1e-9) << i << "\n" << block.end.tip_m / mm;
    EXPECT_NEAR(block.duration_s, wanted[i].seconds, 1e-9) << i;
  }
}

const std::string head =
    "PARTNO/1\nUNIT/MM\nINSERT/12MM DRILL\nCUTTER/12.,0,6.,3.605164,31.,0,149.\nLOAD/TOOL,11\nSELECT/TOOL,1\n"
    "SPINDL/3000,RPM,CLW\nTRNTYP/WORLD,0,0,0\nCSYS/1.,0,0,0,0,1.,0,0,0,0,1.,0\nRAPID/\nGOTO/10.,20.,25.\nCYCLE/INIT\n";

TEST(AptCycles, SolidWorksCamDrill) {
  const Program program = read(head +
                               "CYCLE/DRILL,FEDTO,5.,MMPM,300.,RAPTO,3.,RTRCTO,27.,DWELL,.5\nGOTO/10.,20.,-2.\n"
                               "GOTO/40.,20.,-2.\nCYCLE/OFF\nFINI\n");
  expect_blocks(program, {{rapid, {10.0, 20.0, 1.0}},
                          {feed, {10.0, 20.0, -7.0}, 1.6},
                          {pause, {10.0, 20.0, -7.0}, 0.5},
                          {rapid, {10.0, 20.0, 25.0}},
                          {rapid, {40.0, 20.0, 25.0}},
                          {rapid, {40.0, 20.0, 1.0}},
                          {feed, {40.0, 20.0, -7.0}, 1.6},
                          {pause, {40.0, 20.0, -7.0}, 0.5},
                          {rapid, {40.0, 20.0, 25.0}}});
  EXPECT_TRUE(program.assumed.empty());
  EXPECT_EQ(program.blocks[1].line, 14U);
}

// From 3 mm above the hole to 10 mm below: pecks of 5, 4, 4.
TEST(AptCycles, SolidWorksCamPecks) {
  const double clear = 0.254;
  const Program deep = read(
      head + "CYCLE/DEEP2,FEDTO,10.,1STPECK,5.,SUBPECK,4.,MMPM,60.,RAPTO,3.,RTRCTO,25.\nGOTO/10.,20.,0\nCYCLE/OFF\n");
  expect_blocks(deep, {{rapid, {10.0, 20.0, 3.0}},
                       {feed, {10.0, 20.0, -2.0}, 5.0},
                       {rapid, {10.0, 20.0, 3.0}},
                       {rapid, {10.0, 20.0, -2.0 + clear}},
                       {feed, {10.0, 20.0, -6.0}, 4.0 + clear},
                       {rapid, {10.0, 20.0, 3.0}},
                       {rapid, {10.0, 20.0, -6.0 + clear}},
                       {feed, {10.0, 20.0, -10.0}, 4.0 + clear},
                       {rapid, {10.0, 20.0, 25.0}}});
  ASSERT_EQ(deep.assumed.size(), 1U);
  // Between holes to RAPTO's height, at the end to RTRCTO's.
  const Program low = read(head +
                           "CYCLE/CLEAR\nCYCLE/BRKCHP,FEDTO,3.,INCR,4.,MMPM,60.,RAPTO,4.,RTRCTO,25.\nGOTO/10.,20.,0\n"
                           "GOTO/40.,20.,0\nCYCLE/OFF\n");
  expect_blocks(low, {{rapid, {10.0, 20.0, 4.0}},
                      {feed, {10.0, 20.0, 0.0}, 4.0},
                      {rapid, {10.0, 20.0, clear}},
                      {feed, {10.0, 20.0, -3.0}, 3.0 + clear},
                      {rapid, {10.0, 20.0, 4.0}},
                      {rapid, {40.0, 20.0, 4.0}},
                      {feed, {40.0, 20.0, 0.0}, 4.0},
                      {rapid, {40.0, 20.0, clear}},
                      {feed, {40.0, 20.0, -3.0}, 3.0 + clear},
                      {rapid, {40.0, 20.0, 4.0}},
                      {rapid, {40.0, 20.0, 25.0}}});
}

TEST(AptCycles, AlongAnyAxis) {
  const Program program = read(
      "UNIT/MM\nTRNTYP/WORLD,0,0,0\nCSYS/0,0,-1.,0,-1.,0,0,0,0,1.,0,0\nRAPID/\nGOTO/-25.,70.,-30.,-1.,0,0\nCYCLE/INIT\n"
      "CYCLE/DRILL,FEDTO,6.,MMPM,180.,RAPTO,3.,RTRCTO,25.\nGOTO/0,70.,-30.,-1.,0,0\nGOTO/0,50.,-30.,-1.,0,0\nCYCLE/"
      "OFF\n"
      "TRNTYP/WORLD,0,0,0\nCSYS/1.,0,0,0,0,1.,0,0,0,0,1.,0\nRAPID/\nGOTO/5.,5.,25.\n");
  expect_blocks(program, {{rapid, {-3.0, 70.0, -30.0}},
                          {feed, {6.0, 70.0, -30.0}, 3.0},
                          {rapid, {-25.0, 70.0, -30.0}},
                          {rapid, {-25.0, 50.0, -30.0}},
                          {rapid, {-3.0, 50.0, -30.0}},
                          {feed, {6.0, 50.0, -30.0}, 3.0},
                          {rapid, {-25.0, 50.0, -30.0}},
                          {rapid, {5.0, 5.0, 25.0}}});
  EXPECT_EQ(program.blocks[6].end.axis, -Vector3d::UnitX());
  // A position without an axis has that of its setup.
  EXPECT_EQ(program.blocks[7].end.axis, Vector3d::UnitZ());
}

// The same hole as Creo, NX and Autodesk write it.
TEST(AptCycles, OtherWriters) {
  const std::vector<Want> wanted = {{rapid, {0.0, 0.0, 2.0}}, {feed, {0.0, 0.0, -8.0}, 2.0}, {rapid, {0.0, 0.0, 10.0}}};
  const std::string at = "UNITS / MM\nSPINDL / RPM, 1500, CLW\nRAPID\nGOTO / 0.0, 0.0, 10.0\n";
  const std::string hole = "GOTO / 0.0, 0.0, 0.0\nCYCLE / OFF\n";
  expect_blocks(read(at + "CYCLE / DRILL, DEPTH, 8.0, MMPM, 300.0, CLEAR, 2.0, RETURN, 10.0\n" + hole), wanted);
  expect_blocks(read(at + "CYCLE / DRILL, DEPTH, 8.0, $\nMMPM, 300.0, CLEAR, 5.0, RAPTO, 3.0\n" + hole), wanted);
  expect_blocks(read(at + "CYCLE/DRILL,RAPTO,2.0000,FEDTO,-8.0000,RTRCTO,10.0000,MANUAL,MMPM,300.0000\n" + hole),
                wanted);
  expect_blocks(read(at + "CYCLE/DRILL, 8, MMPM, 300, 5, RAPTO, 3\nFEDRAT/300, MMPM\n" + hole), wanted);
  expect_blocks(read(at + "CYCLE/DRILL,8.0,300.0,MMPM,2.0\n" + hole), wanted);
  expect_blocks(read(at + "FEDRAT/300,MMPM\nCYCLE/DRILL,DEPTH,8,CLEAR,2\n" + hole), wanted);
  expect_blocks(read(at + "CYCLE/DRILL,DEPTH,8,MMPR,.2,CLEAR,2\n" + hole), wanted);
  const Program automatic = read(at + "CYCLE/DRILL,RAPTO,2.0000,FEDTO,-8.0000,RTRCTO,AUTO,MMPM,300.0000\n" + hole);
  expect_blocks(automatic, {wanted[0], wanted[1], {rapid, {0.0, 0.0, 2.0}}});
  const Program assumed = read(at + "CYCLE/DRILL,DEPTH,8,MMPM,300,CLEAR,2\n" + hole);
  ASSERT_EQ(assumed.assumed.size(), 1U);
  EXPECT_EQ(assumed.assumed[0].what, "Height that CYCLE/DRILL goes back to (line 5)");
}

TEST(AptCycles, TapsReamsAndBores) {
  const std::string at = "SPINDL/500,RPM,CLW\nGOTO/0,0,10\n";
  const std::string hole = "GOTO/0,0,0\nCYCLE/OFF\n";
  const Program tap = read(at + "CYCLE/TAP,FEDTO,8,MMPR,1.25,RAPTO,2,RTRCTO,10\n" + hole);
  const double in_s = 10.0 / (1.25 * 500.0) * 60.0;
  expect_blocks(tap, {{rapid, {0.0, 0.0, 2.0}},
                      {feed, {0.0, 0.0, -8.0}, in_s},
                      {feed, {0.0, 0.0, 2.0}, in_s},
                      {rapid, {0.0, 0.0, 10.0}}});
  EXPECT_EQ(tap.blocks[1].spindle, Spindle::clockwise);
  EXPECT_EQ(tap.blocks[2].spindle, Spindle::counterclockwise);
  EXPECT_EQ(tap.blocks[3].spindle, Spindle::clockwise);
  const Program threads = read(at + "CYCLE/TAP,DEPTH,8,TPI,20,CLEAR,2,RETURN,10\n" + hole);
  EXPECT_NEAR(threads.blocks[1].duration_s, 10.0 / (1.27 * 500.0) * 60.0, 1e-9);
  const Program ream = read(at + "CYCLE/REAM,DEPTH,8,MMPM,60,CLEAR,2,RETURN,10,DWELL,1\n" + hole);
  expect_blocks(ream, {{rapid, {0.0, 0.0, 2.0}},
                       {feed, {0.0, 0.0, -8.0}, 10.0},
                       {pause, {0.0, 0.0, -8.0}, 1.0},
                       {feed, {0.0, 0.0, 2.0}, 10.0},
                       {rapid, {0.0, 0.0, 10.0}}});
  const Program drag = read(at + "CYCLE/BORE,DRAG,RAPTO,2,FEDTO,-8,RTRCTO,10,MMPM,60\n" + hole);
  ASSERT_EQ(drag.blocks.size(), 3U);
  EXPECT_EQ(drag.blocks[2].spindle, Spindle::off);
  expect_rejected(at + "CYCLE/BORE,NODRAG,RAPTO,2,FEDTO,-8,MMPM,60\n" + hole, "would leave the hole in another way");
}

// SolidWorks CAM says a cycle once for several tools, and may forget CYCLE/OFF.
TEST(AptCycles, EndsByItsOffOrByAnotherFeed) {
  const std::string cycle = "CYCLE/DRILL,FEDTO,5.,MMPM,300.,RAPTO,3.,RTRCTO,25.\nGOTO/10.,20.,0\n";
  const Program program = read(head + cycle +
                               "SPINDL/3000,RPM,CLW\nGOTO/40.,20.,0\nRAPID/\nGOTO/40.,20.,40.\nFEDRAT/100.,MMPM\n"
                               "GOTO/40.,20.,30.\n");
  const std::size_t count = program.blocks.size();
  EXPECT_LT((program.blocks[count - 3].end.tip_m - mm * Vector3d(40.0, 20.0, 25.0)).norm(), 1e-12);
  EXPECT_EQ(program.blocks[count - 2].kind, rapid);
  EXPECT_NEAR(program.blocks[count - 1].duration_s, 6.0, 1e-9);
  ASSERT_EQ(program.assumed.size(), 2U);
  EXPECT_EQ(program.assumed[1].what, "End of CYCLE/DRILL (line 13) without CYCLE/OFF");
  expect_rejected(head + cycle + "FEDRAT/100.,MMPM\nGOTO/40.,20.,0\nCYCLE/OFF\n", "was taken as ended by the FEDRAT");
  EXPECT_EQ(read(head + cycle + "FEDRAT/300.,MMPM\nGOTO/40.,20.,0\nCYCLE/OFF\n").blocks.size(), 7U);
  expect_rejected(head + cycle + "CIRCLE/0,0,0,0,0,1.\nGOTO/40.,20.,0\n", "comes while CYCLE/DRILL of line 13 is on");
  expect_rejected(head + cycle + "GODLTA/1,0,0\n", "is a step to a hole");
}

TEST(AptCycles, RejectsWhatIsNotKnown) {
  const auto rejects = [&](const std::string& cycle, const std::string& words) {
    expect_rejected(head + cycle + "\nGOTO/10.,20.,0\n", words);
  };
  rejects("CYCLE/THRU,DEPTH,5,MMPM,100", "part:13: CYCLE");
  rejects("CYCLE/DRILL,MMPM,100", "has no depth");
  rejects("CYCLE/DRILL,5,100,3", "has numbers whose meaning is not known");
  rejects("CYCLE/DRILL,FEDTO,5,MMPM", "has no number behind it");
  rejects("CYCLE/DRILL,FEDTO,5,MMPM,100,SHIFT,3", "\"SHIFT\"; is not read");
  rejects("CYCLE/DEEP,FEDTO,5,MMPM,100,RAPTO,3", "has no depth of a peck");
  rejects("CYCLE/DRILL,FEDTO,5,INCR,1,MMPM,100,RAPTO,3", "does not peck");
  rejects("CYCLE/DEEP,FEDTO,5,INCR,0,MMPM,100,RAPTO,3", "INCR = 0 mm; must be > 0");
  rejects("CYCLE/DEEP,FEDTO,900,INCR,.001,MMPM,100,RAPTO,3", "makes too many pecks");
  rejects("CYCLE/DRILL,FEDTO,5,MMPM,100,RAPTO,-9", "is not above the hole's bottom");
  rejects("CYCLE/DRILL,FEDTO,5,MMPM,100,IPM,3", "is a second feed");
  rejects("CYCLE/DRILL,FEDTO,5,MMPM,0,RAPTO,3", "FEDRAT: must be > 0");
  rejects("CYCLE/ON\nCYCLE/OFF\nCYCLE/", "goes on with a cycle that no line has given");
  expect_rejected("UNIT/MM\nCYCLE/DRILL,FEDTO,5,MMPM,100\nGOTO/0,0,0\n", "has no heights");
}

TEST(AptFrames, SetupsCountInOneSystem) {
  const std::string tilted = "UNIT/MM\nTRNTYP/WORLD,0,0,0\nCSYS/0,1.,0,0,-1.,0,0,0,0,0,1.,19.\nRAPID/\nGOTO/1.,2.,3.\n";
  EXPECT_EQ(read(tilted + "RAPID/\nGOTO/1.,2.,4.\n").blocks[0].end.tip_m, mm * Vector3d(1.0, 2.0, 4.0));
  expect_rejected(tilted + "CSYS/0,1.,0,0,-1.,0,0,0,0,0,1.,18.\n", "moves the origin within the program");
  expect_rejected(tilted + "TRNTYP/LOCAL,0,0,0\n", "changes the coordinate system");
  expect_rejected("CSYS/1,0,0,0,0,1,0,0,0,0,1,0\nGOTO/0,0,0\nCSYS/1,0,0,5,0,1,0,0,0,0,1,0\n", "changes the system");
  expect_rejected("CSYS/1,0,0,0,0,1,0,0,0,0,-1,0\n", "is a mirrored system");
  expect_rejected("CSYS/2,0,0,0,0,1,0,0,0,0,1,0\n", "not perpendicular unit vectors");
  expect_rejected("TRNTYP/WORLD,0,0,0\nCSYS/0,0,1.,0,1.,0,0,0,0,1.,0,0\nGOTO/0,0,0\n", "gives no tool axis where CSYS");
  EXPECT_EQ(read("ROTABL/0\nTRANS/0,0,0\nORIGIN/0,0,0\nGOTO/0,0,0\n").skipped.size(), 3U);
  expect_rejected("GOTO/0,0,0\nROTABL/90\n", "It would move the program's frame");
  expect_rejected("MODE/INCR\n", "makes positions steps");
}

// The part turned over: the tool turns by half a circle at rapid.
TEST(AptFrames, TurnsOverBetweenSetups) {
  const std::string above = "UNIT/MM\nTRNTYP/WORLD,0,0,0\nCSYS/1.,0,0,0,0,1.,0,0,0,0,1.,0\nRAPID/\nGOTO/10.,0,25.\n";
  const std::string below = "CSYS/-1.,0,0,0,0,1.,0,0,0,0,-1.,0\nRAPID/\nGOTO/10.,0,-55.,0,0,-1.\n";
  const Program program = read(above + below);
  expect_blocks(program, {{rapid, {10.0, 0.0, -15.0}}, {rapid, {10.0, 0.0, -55.0}}});
  EXPECT_EQ(program.blocks[0].end.axis, -Vector3d::UnitX());
  EXPECT_EQ(program.blocks[1].end.axis, -Vector3d::UnitZ());
  EXPECT_EQ(program.assumed.size(), 1U);
  expect_rejected(above + "FEDRAT/60.,MMPM\nGOTO/10.,0,-55.,0,0,-1.\n", "turns by half a circle in one move");
}

// A point of the second system, by hand: its X is the first one's Y, its Y the first one's -X.
TEST(AptFrames, MovesIntoTheFirstMsys) {
  const std::string first = "MSYS/10,20,30, 1,0,0, 0,1,0\nFEDRAT/60\nGOTO/0,0,0,0,0,1\n";
  const Program program = read(first + "MSYS/15,20,31, 0,1,0, -1,0,0\nGOTO/2,3,4,1,0,0\nGODLTA/1,0,0\n");
  ASSERT_EQ(program.blocks.size(), 2U);
  EXPECT_LT((program.blocks[0].end.tip_m - mm * Vector3d(2.0, 2.0, 5.0)).norm(), 1e-12);
  EXPECT_LT((program.blocks[0].end.axis - Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_LT((program.blocks[1].end.tip_m - mm * Vector3d(2.0, 3.0, 5.0)).norm(), 1e-12);
  ASSERT_EQ(program.assumed.size(), 1U);
  const Program again = read(first + "MSYS/15,20,31,0,1,0,-1,0,0\nMSYS/10,20,30,1,0,0,0,1,0\nGOTO/1,2,3,0,0,1\n");
  EXPECT_EQ(again.blocks[0].end.tip_m, mm * Vector3d(1.0, 2.0, 3.0));
  // An arc moves with it.
  const Program arc = read(first + "MSYS/15,20,31,0,1,0,-1,0,0\nGOTO/10,0,0\nCIRCLE/0,0,0,0,0,1\nGOTO/0,10,0\n");
  EXPECT_LT((arc.blocks.back().end.tip_m - mm * Vector3d(-5.0, 0.0, 1.0)).norm(), 1e-9);
  // CATIA's stands in comments.
  const std::string matrix = "$$*CATIA0\n$$ Program.1\n$$ 1.0 0.0 0.0 5.0\n$$ 0.0 1.0 0.0 0.0\n$$ 0.0 0.0 1.0 0.0\n";
  const std::string other = "$$*CATIA0\n$$ Program.2\n$$ 1.0 0.0 0.0 6.0\n$$ 0.0 1.0 0.0 0.0\n$$ 0.0 0.0 1.0 0.0\n";
  EXPECT_EQ(read(matrix + "GOTO/0,0,0\n" + matrix + "FEDRAT/9\nGOTO/1,0,0\n").blocks.size(), 1U);
  expect_rejected(matrix + "GOTO/0,0,0\n" + other, "ends a matrix that changes the coordinate system");
}

TEST(AptFrames, RetractsAndTheMachinesHome) {
  const std::string cut = "CLRSRF/(PLANE/0,0,1,50)\nGOTO/0,0,0\nFEDRAT/60\nGOTO/10,0,0\n";
  expect_blocks(read(cut + "RETRCT\nRAPID\nGOTO/20,0,50\n"),
                {{feed, {10.0, 0.0, 0.0}, 10.0}, {rapid, {10.0, 0.0, 50.0}}, {rapid, {20.0, 0.0, 50.0}}});
  EXPECT_EQ(read(cut + "GOHOME\nFINI\n").blocks.size(), 1U);
  expect_blocks(read(cut + "GOHOME\nRAPID\nGOTO/20,0,5\nGOTO/20,0,0\n"), {{feed, {10.0, 0.0, 0.0}, 10.0},
                                                                          {rapid, {10.0, 0.0, 5.0}},
                                                                          {rapid, {20.0, 0.0, 5.0}},
                                                                          {feed, {20.0, 0.0, 0.0}, 5.0}});
  expect_blocks(read(cut + "GOHOME/0,0,90\n"), {{feed, {10.0, 0.0, 0.0}, 10.0}, {rapid, {0.0, 0.0, 90.0}}});
  expect_rejected(cut + "GOHOME\nGOTO/20,0,0\n", "is a move at feed after GOHOME in line 5");
  expect_rejected("GOTO/0,0,0\nRETRCT\nCIRCLE/0,0,0,0,0,1\nGOTO/1,0,0\n", "is an arc after RETRCT in line 2");
}

TEST(AptCycles, AHeightToGoBackToEndsWithItsHoles) {
  const Program program = read(
      "GOTO/0,0,50\nCYCLE/CLEAR\nCYCLE/DRILL,FEDTO,5,MMPM,60,RAPTO,3,RTRCTO,25\nGOTO/0,0,0\nGOHOME\nRAPID\n"
      "GOTO/100,0,5\nCYCLE/OFF\n");
  EXPECT_NEAR(program.blocks.back().end.tip_m.x(), 0.1, 1e-12) << "no move back over the hole";
  expect_rejected("GOTO/0,0,50\nFEDRAT/100\nGOTO/0,0,0\nGOHOME\nRAPID\nGODLTA/10,0,0\n",
                  "is a step after GOHOME in line 4");
}

TEST(AptTools, EachStatementThatNamesOneCounts) {
  const std::string cut = "LOAD/TOOL,5\nSELECT/TOOL,6\nGOTO/0,0,0\nFEDRAT/60\nGOTO/1,0,0\n";
  EXPECT_EQ(read(cut + "LOAD/TOOL,5\nGOTO/2,0,0\n").blocks.size(), 2U);
  expect_rejected(cut + "LOAD/TOOL,6\nRAPID/\nGOTO/2,0,0\n", "part:6: LOAD: mounts another tool");
  expect_rejected("TOOL PATH/A,TOOL,T1\nGOTO/0,0,0\nFEDRAT/60\nGOTO/1,0,0\nTOOL PATH/B,TOOL,T2\nGOTO/2,0,0\n",
                  "part:5: TOOL PATH: mounts another tool");
  EXPECT_EQ(read("UNIT/INCH\nGOTO/0,0,0\nFEDRAT/60\nGOTO/1,0,0\n").blocks[0].end.tip_m.x(), 0.0254);
  const Program normals = read("GOTO/0,0,0\nFEDRAT/60\nGOTO/1,0,0,0,0,1,.6,.8,0\n");
  EXPECT_EQ(normals.blocks.size(), 1U);
  EXPECT_EQ(normals.assumed.size(), 1U);
}

}  // namespace apt_cycles_test
}  // namespace robomill::program
