// Arcs and drilling cycles of APT programs, rewritten.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "robomill/program/files/rewrite.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace rewrite_apt_moves_test {

using Eigen::Vector3d;

struct Case {
  std::string text;
  std::string name = "part.apt";
  Program read = read_program_text(text, name);
  Program wanted = read;
  [[nodiscard]] std::string rewrite() const { return rewrite_program_text(text, name, {}, read, wanted, {}).text; }
};

const std::string mill =
    "UNIT/MM\r\nTRNTYP/WORLD,0,0,0\r\nCSYS/1.,0,0,0,0,1.,0,0,0,0,1.,0\r\nSPINDL/8000,RPM,CLW\r\nRAPID/\r\nGOTO/"
    "10.,0,0\r\n"
    "CUTCOM/LEFT\r\nFEDRAT/600.,MMPM\r\nCIRCLE/0,0,0,0,0,1.\r\nGOTO/0,-10.,0\r\nGOTO/0,-20.,0\r\nFINI\r\n";
const std::string drill =
    "UNIT/MM\nSPINDL/3000,RPM,CLW\nRAPID/\nGOTO/0,0,25.\nCYCLE/INIT\n"
    "CYCLE/DEEP2,FEDTO,10.,1STPECK,5.,SUBPECK,4.,MMPM,60.,RAPTO,3.,RTRCTO,25.\nGOTO/0,0,0\nGOTO/30.,0,0\nCYCLE/OFF\n"
    "FEDRAT/100.,MMPM\nGOTO/30.,0,20.\n";

TEST(RewriteAptMoves, NothingWantedIsNothingChanged) {
  for (const std::string& text :
       {mill, drill,
        std::string("GOTO/10,0,5\nFEDRAT/300\nINDIRV/0,1,0\nTLON,GOFWD/(CIRCLE/0,0,5,$\n10),ON,(LINE/0,0,5,0,10,5)\n"),
        std::string("GOTO/10,0,0\nFEDRAT/300\nCIRCLE/0,0,0,0,0,1,10\nGOTO/0,10,0\nGOTO/-10,0,0\nGOTO/-20,0,0\n"),
        std::string("MSYS/0,0,0,1,0,0,0,1,0\nFEDRAT/60\nGOTO/0,0,0\nMSYS/5,0,1,0,1,0,-1,0,0\nGOTO/2,3,4,1,0,0\n"),
        std::string("GOTO/10,0,0\nFEDRAT/300\nCIRCLE/0,0,0,0,0,1\nGOTO/0,10,0\n\n$$ end\n"),
        std::string("CLRSRF/0,0,1,50\nGOTO/0,0,0\nFEDRAT/60\nGOTO/10,0,0\nRETRCT\nGOHOME\nRAPID\nGOTO/0,0,9\n")}) {
    EXPECT_EQ((Case{.text = text}.rewrite()), text);
  }
}

TEST(RewriteAptMoves, AnArcKeepsItsStatements) {
  Case one = {.text = mill};
  const std::size_t chords = one.read.blocks.size() - 1;
  for (std::size_t i = 0; i < chords; ++i) {
    one.wanted.blocks[i].duration_s *= 2.0;
    one.wanted.blocks[i].spindle_speed_rad_per_s *= 0.5;
  }
  std::string text = mill;
  text.replace(text.find("600."), 4, "300.");
  text.replace(text.find("8000"), 4, "4000");
  text.insert(text.find("GOTO/0,-20."), "SPINDL/8000,RPM,CLW\r\nFEDRAT/600.,MMPM\r\n");
  EXPECT_EQ(one.rewrite(), text);
}

// Chords of their own, each where it is wanted.
TEST(RewriteAptMoves, AMovedArcBecomesStraightMoves) {
  Case one = {.text = mill};
  const std::size_t chords = one.read.blocks.size() - 1;
  for (std::size_t i = 0; i < chords; ++i) {
    one.wanted.blocks[i].end.tip_m.x() += 1e-5;
    const double way_m = (one.read.blocks[i].end.tip_m - one.read.begin_of(i).tip_m).norm();
    const double wanted_m = (one.wanted.blocks[i].end.tip_m - one.wanted.begin_of(i).tip_m).norm();
    one.wanted.blocks[i].duration_s *= wanted_m / way_m * (i % 7 == 3 ? 2.0 : 1.0);
  }
  const std::string text = one.rewrite();
  EXPECT_NE(text.find("$$ CIRCLE/0,0,0,0,0,1.\r\n"), std::string::npos);
  const Program again = read_program_text(text, one.name);
  ASSERT_EQ(again.blocks.size(), one.wanted.blocks.size());
  for (std::size_t i = 0; i < again.blocks.size(); ++i) {
    EXPECT_LT((again.blocks[i].end.tip_m - one.wanted.blocks[i].end.tip_m).norm(), 2e-7);
    EXPECT_NEAR(again.blocks[i].duration_s, one.wanted.blocks[i].duration_s, 1e-3 * one.wanted.blocks[i].duration_s);
  }
}

// A hole without a feed of its own keeps the FEDRAT that a move behind it shares.
TEST(RewriteAptMoves, AFeedThatAHoleSharesIsSaidAgainBehindIt) {
  Case one = {.text = "GOTO/0,0,10\nFEDRAT/100\nCYCLE/DRILL,DEPTH,5,CLEAR,2\nGOTO/0,0,0\nCYCLE/OFF\nGOTO/9,0,10\n"};
  one.wanted.blocks.back().duration_s *= 0.5;
  EXPECT_EQ(one.rewrite(),
            "GOTO/0,0,10\nFEDRAT/100\nCYCLE/DRILL,DEPTH,5,CLEAR,2\nGOTO/0,0,0\nCYCLE/OFF\nFEDRAT/200\nGOTO/9,0,10\n");
}

TEST(RewriteAptMoves, FeedsOfCycles) {
  Case all = {.text = drill};
  for (Block& block : all.wanted.blocks) block.duration_s *= 0.5;
  std::string text = drill;
  text.replace(text.find("MMPM,60."), 8, "MMPM,120.");
  text.replace(text.find("FEDRAT/100."), 11, "FEDRAT/200.");
  EXPECT_EQ(all.rewrite(), text);
  // The second hole alone: the cycle is said again.
  Case second = {.text = drill};
  for (Block& block : second.wanted.blocks) {
    if (block.line == 8) block.duration_s *= 2.0;
  }
  text = drill;
  text.insert(text.find("GOTO/30."), "CYCLE/DEEP2,FEDTO,10.,1STPECK,5.,SUBPECK,4.,MMPM,30.,RAPTO,3.,RTRCTO,25.\n");
  EXPECT_EQ(second.rewrite(), text);
  Case moved = {.text = drill};
  moved.wanted.blocks[1].end.tip_m.x() += 1e-4;
  const std::string said = test::rejection([&] { static_cast<void>(moved.rewrite()); });
  EXPECT_NE(said.find("part.apt:7: GOTO: cannot be moved"), std::string::npos) << said;
}

}  // namespace rewrite_apt_moves_test
}  // namespace robomill::program
