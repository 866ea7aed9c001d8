#include "robomill/program/files/apt_reader.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "robomill/base/random.hpp"
#include "testing/program/reading.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace apt_reader_test {

using Eigen::Vector3d;

constexpr double mm = 1e-3;

Program read(const std::string& text) {
  const test::Folder folder;
  return read_program(folder.file("part.apt", text));
}

void expect_rejected(const std::string& text, const std::string& words) {
  const std::string said = test::rejection([&] { static_cast<void>(read(text)); });
  EXPECT_NE(said.find(words), std::string::npos) << text << "\n" << said;
}

// The statements as three CAM systems write them: spaces about the slash, minor words on either side of the number,
// continuations and comments.
TEST(Apt, ReadsAProgram) {
  const Program program = read(
      "$$ written by hand\nPARTNO  A PART / OF $5, NO MORE\nTOOL PATH/FINISH,TOOL,BALL6\nMULTAX/ON\nUNITS / MM\n"
      "LOADTL / 1, LENGTH, 100.0\nSPINDL / RPM, 3000.000000,  CLW\nCOOLNT/ON\nRAPID\n"
      "GOTO / 10.0, 20.0, 30.0, $\n 0.0, 0.0, 1.0\nRAPID\nGOTO/0,0,5\nFEDRAT / 600.0, MMPM\ngoto/0,0,0 $$ down\n"
      "FEDRAT/IPM,10\nGOTO/1.27D1,0,0,0.6,0,.8\nA1) GODLTA/0,-3,4\nDELAY/1.5\nGODLTA/2\nFEDRAT/MMPR,0.1\n"
      "GOTO/12.7,0,4,6.0E-1,0,0.8\nPPRINT GOTO/1,2,3 $\nFINI\nGOTO/99,99,99\n");
  ASSERT_EQ(program.blocks.size(), 7U);
  EXPECT_LT((program.start.tip_m - mm * Vector3d(10.0, 20.0, 30.0)).norm(), 1e-15);
  EXPECT_EQ(program.blocks[0].kind, Block::Kind::rapid);
  EXPECT_EQ(program.blocks[0].line, 13U);
  EXPECT_EQ(program.blocks[1].kind, Block::Kind::feed);
  EXPECT_NEAR(program.blocks[1].duration_s, 5.0 / 600.0 * 60.0, 1e-12);
  EXPECT_DOUBLE_EQ(program.blocks[1].spindle_speed_rad_per_s, 100.0 * std::numbers::pi);
  EXPECT_NEAR(program.blocks[2].duration_s, 12.7 / 254.0 * 60.0, 1e-12);
  EXPECT_LT((program.blocks[2].end.axis - Vector3d(0.6, 0.0, 0.8)).norm(), 1e-15);
  EXPECT_LT((program.blocks[3].end.tip_m - mm * Vector3d(12.7, -3.0, 4.0)).norm(), 1e-15);
  EXPECT_NEAR(program.blocks[3].duration_s, 5.0 / 254.0 * 60.0, 1e-12);
  EXPECT_EQ(program.blocks[4].kind, Block::Kind::dwell);
  EXPECT_EQ(program.blocks[4].duration_s, 1.5);
  EXPECT_LT((program.blocks[5].end.tip_m - mm * Vector3d(13.9, -3.0, 5.6)).norm(), 1e-15) << "along the tool's axis";
  const double way = Vector3d(1.2, -3.0, 1.6).norm();
  EXPECT_NEAR(program.blocks[6].duration_s, way / (0.1 * 3000.0) * 60.0, 1e-12);
  ASSERT_EQ(program.skipped.size(), 4U);
  EXPECT_EQ(program.skipped[0].line, 2U);
  EXPECT_EQ(program.skipped[0].what, "PARTNO  A PART / OF $5, NO MORE");
  EXPECT_EQ(program.skipped[1].what, "TOOL PATH/FINISH,TOOL,BALL6");
  EXPECT_EQ(program.skipped[2].what, "LOADTL / 1, LENGTH, 100.0");
  EXPECT_EQ(program.skipped[3].line, 23U);
}

TEST(Apt, KeepsSpindleCoolantAndStops) {
  const Program program = read(
      "FEDRAT/60\nGOTO/0,0,0\nGOTO/1,0,0\nSPINDL/3000,CCLW\nCOOLNT/MIST\nGOTO/2,0,0\nSPINDL/3000\nCOOLNT/ON\n"
      "GOTO/3,0,0\nSTOP\nOPSTOP\nSPINDL/OFF\nCOOLNT/OFF\nGOTO/4,0,0\n");
  ASSERT_EQ(program.blocks.size(), 6U);
  const Spindle spindle[] = {Spindle::not_given, Spindle::counterclockwise, Spindle::clockwise,
                             Spindle::clockwise, Spindle::clockwise,        Spindle::off};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(program.blocks[i].spindle, spindle[i]) << i;
  EXPECT_EQ(program.blocks[1].coolant, (Coolant{.mist = true}));
  EXPECT_EQ(program.blocks[2].coolant, (Coolant{.mist = true, .flood = true}));
  EXPECT_EQ(program.blocks[5].coolant, Coolant{});
  EXPECT_EQ(program.blocks[3].operator_stop, OperatorStop::always);
  EXPECT_EQ(program.blocks[4].operator_stop, OperatorStop::optional);
  EXPECT_EQ(program.blocks[4].end.tip_m, program.blocks[2].end.tip_m);
}

// The length of another tool is not known, so that a tool changes before it cuts or not at all.
TEST(Apt, RejectsAnotherToolOnceOneHasCut) {
  EXPECT_EQ(read("LOADTL/1\nGOTO/0,0,0\nLOADTL/2\nFEDRAT/60\nGOTO/1,0,0\nLOADTL/2\nGOTO/2,0,0\nLOADTL/3\nFINI\n")
                .blocks.size(),
            2U);
  expect_rejected(
      "LOADTL/1\nFEDRAT/60\nGOTO/0,0,0\nGOTO/1,0,0\nLOADTL/2,LENGTH,80\nRAPID\nGOTO/2,0,0\n",
      "part.apt:5: LOADTL: mounts another tool than the one that has cut, whose length is not known here, and "
      "line 7 moves it");
}

TEST(Apt, FromIsTheStart) {
  const Program program = read("FROM/1,2,3,0,1,0\nFROM/1,2,3\nFEDRAT/60\nGOTO/1,2,4\n");
  EXPECT_LT((program.start.tip_m - mm * Vector3d(1.0, 2.0, 3.0)).norm(), 1e-18);
  EXPECT_EQ(program.start.axis, Vector3d::UnitY());
  ASSERT_EQ(program.blocks.size(), 1U);
  EXPECT_NEAR(program.blocks[0].duration_s, 1.0, 1e-12);
  EXPECT_EQ(program.blocks[0].end.axis, Vector3d::UnitY());
}

TEST(Apt, InchesAndUnitsOfFeeds) {
  const Program program = read(
      "UNITS/INCHES\nGOTO/1,0,0\nFEDRAT/10\nGOTO/2,0,0\nFEDRAT/254,MMPM\nGOTO/3,0,0\nUNITS/MM\nGOTO/0,0,0\n"
      "FEDRAT/PERMIN,508\nGOTO/25.4,0,0\nSPINDL/100,CCLW\nFEDRAT/IPR,.1\nGOTO/0,0,0\nFEDRAT/2.54,PERREV\nGOTO/"
      "25.4,0,0\n");
  ASSERT_EQ(program.blocks.size(), 6U);
  const double seconds[] = {6.0, 6.0, 18.0, 3.0, 6.0, 6.0};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(program.blocks[i].duration_s, seconds[i], 1e-12) << i;
  EXPECT_LT((program.blocks[0].end.tip_m - Vector3d(0.0508, 0.0, 0.0)).norm(), 1e-16);
}

TEST(Apt, WhereTheAxisAloneTurnsAFeedIsDegreesAMinute) {
  const Program program = read("GOTO/0,0,0,0,0,1\nFEDRAT/30,MMPM\nGOTO/0,0,0,.6,0,.8\n");
  EXPECT_NEAR(program.blocks[0].duration_s, std::atan2(0.6, 0.8) * 180.0 / std::numbers::pi / 30.0 * 60.0, 1e-12);
}

TEST(Apt, KnownSwitchesAreSkippedWhenOff) {
  const Program program = read(
      "MSYS/0,0,0,1,0,0,0,1,0\nGOTO/0,0,0\nCYCLE/OFF\nCUTCOM/OFF\nTRACUT/NOMORE\nMSYS/0,0,0, 1,0,0,0,1,0\nSPINDL/OFF\n"
      "SPINDL/SFM,200\nDELAY/REV,3\nDELAY/0\nMULTAX/OFF\nEND\nTLON=1\nP1=CIRCLE/0,0,0,5\nFEDRAT/9\nGOTO/1,0,0\n");
  EXPECT_EQ(program.blocks.size(), 1U);
  EXPECT_EQ(program.skipped.size(), 11U);
}

TEST(Apt, NotesAxesThatAreNearlyUnitVectors) {
  const Program program = read("FEDRAT/9\nGOTO/0,0,0\nGOTO/1,0,0,0,0,0.9995\n");
  EXPECT_EQ(program.blocks[0].end.axis, Vector3d::UnitZ());
  ASSERT_EQ(program.notes.size(), 1U);
  EXPECT_EQ(program.notes[0], "1 axis made a unit vector, off by up to 0.0005, the first in line 3.");
}

TEST(Apt, RejectsWithLineWordAndRule) {
  const std::string head = "FEDRAT/100\nGOTO/0,0,0\n";
  expect_rejected(head + "GOTO/1,2\n", "part.apt:3: GOTO: has 2 numbers; must have 3 or 6");
  expect_rejected(head + "GOTO/1,2,3,0,0,1,4\n", "GOTO: has 7 numbers; must have 3 or 6");
  expect_rejected(head + "GOTO\n", "GOTO: has 0 numbers");
  expect_rejected(head + "GOTO/P1\n", "part.apt:3: GOTO = \"P1\"; must be a finite number");
  expect_rejected(head + "GOTO/1,,3\n", "part.apt:3: GOTO: has an empty field");
  expect_rejected(head + "GOTO/1,NAN,3\n", "\"NAN\"; must be a finite number");
  expect_rejected(head + "GOTO/1,1E999,3\n", "must be a finite number");
  expect_rejected(head + "GOTO/1,2,3000000\n", "z = 3e+06 mm; must lie within 1 km");
  expect_rejected(head + "GODLTA/900000\nGODLTA/900000\n", "part.apt:4: GODLTA = 900000 mm; must lie within 1 km");
  expect_rejected(head + "GOTO/1,2,3,0,0,2\n", "i, j, k = 2; must be a vector of length 1, within 1e-3");
  expect_rejected(head + "GOTO/1,2,3,0,0,0\n", "i, j, k = 0; must be a vector of length 1");
  expect_rejected(head + "GOTO/1,2,3,0,0,-1\n", "axis = 180 deg; turns by half a circle in one move");
  expect_rejected("GODLTA/1,2,3\n", "GODLTA: is a step from a position that no line has given");
  expect_rejected(head + "FROM/1,0,0\n", "FROM = \"FROM/1,0,0\"; is another position than the one");
  expect_rejected("GOTO/0,0,0\nGOTO/1,0,0\n",
                  "part.apt:2: FEDRAT: must be > 0 where the tool moves at feed. Is a FEDRAT/ missing");
  expect_rejected("FEDRAT/0\nGOTO/0,0,0\nGOTO/1,0,0\n", "part.apt:3: FEDRAT: must be > 0");
  expect_rejected(head + "FEDRAT/-1\n", "FEDRAT = -1; must be > 0");
  expect_rejected(head + "FEDRAT/NAN\n", "FEDRAT = \"NAN\"; is no unit of a feed known here");
  expect_rejected(head + "FEDRAT/1,2\n", "has two numbers");
  expect_rejected(head + "FEDRAT/MMPM\n", "FEDRAT: has no number");
  expect_rejected(head + "FEDRAT/5,INVERS\n", "FEDRAT = \"INVERS\"; is no unit of a feed known here");
  expect_rejected(head + "FEDRAT/.1,MMPR\nGOTO/1,0,0\n", "part.apt:4: FEDRAT = 0.1 mm/rev; needs a spindle speed");
  expect_rejected(head + "UNITS/CM\n", "UNITS = \"CM\"; is no unit known here");
  expect_rejected(head + "SPINDL/-5\n", "SPINDL = -5; must be > 0");
  expect_rejected(head + "DELAY/-1\n", "DELAY = -1 s; must lie between 0 and a day");
  expect_rejected(head + "MSYS/1,0,0,1,0,0,0,1,0\n", "changes the coordinate system within the program");
  expect_rejected(head + "TRACUT/M1\n", "It would move the program's frame");
  expect_rejected(
      head + "NURBS / 0,0,0, $\n 0,0,1,5\nGOTO/5,0,0\n",
      "part.apt:3: NURBS = \"NURBS / 0,0,0,   0,0,1,5\"; is not read: it may move the tool or its frame. Let the "
      "CAM system write straight moves GOTO/");
  expect_rejected(head + "TLON,GOFWD/(CIRCLE/0,0,0,5),ON,(LINE/0,0,0,1,1,1)\n", "TLON = \"TLON,GOFWD/");
  expect_rejected(head + "TLAXIS/0,0,1\n", "Give the axis with each GOTO/");
  expect_rejected(head + "ROTABL/90\n", "It would move the program's frame");
  expect_rejected("PPRINT\n", "part.apt: holds no complete position");
}

// Cut off, changed at any place, or noise: rejected or read, and what is read is finite.
TEST(Apt, SurvivesMutations) {
  const std::string good =
      "$$ x\nPARTNO A\nUNITS/MM\nMULTAX/ON\nSPINDL/RPM,3000,CLW\nRAPID\nGOTO/10,20,30,$\n0,0,1\nFEDRAT/600.0,MMPM\n"
      "GOTO/0,0,5\nGOTO/1.27D1,0,0,0.6,0,.8\nGODLTA/0,-3,4\nDELAY/1.5\nGODLTA/2\nFEDRAT/MMPR,.1\nGOTO/12,0,4\nFINI\n";
  const std::string round =
      "UNIT/MM\nTRNTYP/WORLD,0,0,0\nCSYS/1.,0,0,0,0,1.,0,0,0,0,1.,0\nLOAD/TOOL,1\nSPINDL/900,RPM,CLW\nRAPID/\n"
      "GOTO/0,0,25.\nCYCLE/INIT\nCYCLE/DEEP2,FEDTO,9.,1STPECK,5.,SUBPECK,2.,MMPM,60.,RAPTO,3.,RTRCTO,25.\nGOTO/0,0,0\n"
      "CYCLE/OFF\nCUTCOM/LEFT\nFEDRAT/9.,MMPM\nGOTO/5.,0,0\nCIRCLE/0,0,0,0,0,1.\nGOTO/0,5.,0\nINDIRV/-1,0,0\n"
      "TLON,GOFWD/(CIRCLE/0,0,0,5),ON,(LINE/0,0,0,-5,0,0)\nCLRSRF/0,0,1,9\nRETRCT\nGOHOME\n$$*CATIA0\n$$ 1 0 0 1\n";
  Random random(31);
  int accepted = 0;
  for (int i = 0; i < test::seeds(100000); ++i) {
    const std::string& base = i % 3 == 1 ? round : good;
    std::string text = base;
    if (i % 8 == 0) {
      text.resize(1 + random.index(120));
      for (char& c : text) c = static_cast<char>(random.index(256));
    } else {
      static constexpr std::string_view letters = "GOTFEDRAPINCLYK/,$.()0123456789-+ED \n";
      for (std::uint64_t n = 1 + random.index(3); n-- > 0;) {
        text[random.index(text.size())] =
            i % 4 == 1 ? static_cast<char>(random.index(256)) : letters[random.index(letters.size())];
      }
      if (i % 4 == 2) text.resize(1 + random.index(base.size() - 1));
    }
    try {
      const Program program = test_support::read_text<AptReader>(text);
      ++accepted;
      for (const Block& block : program.blocks) {
        ASSERT_TRUE(block.end.tip_m.allFinite()) << text;
        ASSERT_NEAR(block.end.axis.norm(), 1.0, 1e-12) << text;
        ASSERT_EQ(block.kind != Block::Kind::rapid, block.duration_s > 0.0) << text;
        ASSERT_TRUE(std::isfinite(block.duration_s)) << text;
      }
    } catch (const InvalidInput&) {
      continue;
    }
  }
  EXPECT_GT(accepted, 100);
}

}  // namespace apt_reader_test
}  // namespace robomill::program
