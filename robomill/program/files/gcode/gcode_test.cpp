#include "robomill/program/files/program_files.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/program/files/gcode/reader.hpp"
#include "testing/program/reading.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace gcode_test {

using Eigen::Vector3d;

Program read(const std::string& text, std::optional<Machine> machine = {}) {
  return read_program_text(text, "part.ngc", {.machine = machine});
}

void expect_rejected(const std::string& text, const std::string& words, std::optional<Machine> machine = {}) {
  const std::string said = test::rejection([&] { static_cast<void>(read(text, machine)); });
  EXPECT_NE(said.find(words), std::string::npos) << text << "\n" << said;
}

TEST(Gcode, ReadsAFiveAxisProgram) {
  const Program program = read(
      "%\n( Impeller )\nM428 ;TCP:xyzac\nG93\nS600 M3\n\n"
      "G0  X  16.339  Y -25.409  Z  33.353  A -71.841  C -35.930\n"
      "G0  X   7.417  Y -13.098  Z  28.366  A -71.841  C -35.930\n"
      "G1  X   6.302  Y -11.560  Z  27.743  A -71.841  C -35.930  F 318\n"
      "G1  X   6.358  Y -12.418  Z  26.178  A -71.266  C -32.919  F 159\n"
      "M5\nM30\nG1 X1 Y1 F1 (not carried out)\n",
      Machine::xyzac_trt);
  ASSERT_EQ(program.blocks.size(), 5U) << "the last move turns in three parts";
  EXPECT_LT((program.start.tip_m - Vector3d(0.016339, -0.025409, 0.033353)).norm(), 1e-15);
  EXPECT_EQ(program.blocks[0].kind, Block::Kind::rapid);
  EXPECT_EQ(program.blocks[0].duration_s, 0.0);
  const Block& last = program.blocks.back();
  EXPECT_EQ(last.kind, Block::Kind::feed);
  EXPECT_EQ(last.line, 10U);
  EXPECT_DOUBLE_EQ(last.duration_s, 60.0 / 159.0 / 3.0);
  EXPECT_DOUBLE_EQ(last.spindle_speed_rad_per_s, 600.0 * std::numbers::pi / 30.0);
  constexpr double deg = std::numbers::pi / 180.0;
  EXPECT_LT((last.end.axis - tool_axis(Machine::xyzac_trt, -71.266 * deg, 0.0, -32.919 * deg)).norm(), 1e-15);
  EXPECT_LT((program.begin_of(2).tip_m - Vector3d(0.006302, -0.011560, 0.027743)).norm(), 1e-15);
  EXPECT_EQ(last.spindle, Spindle::clockwise);
  EXPECT_TRUE(program.skipped.empty()) << "M428 is obeyed";
}

TEST(Gcode, FeedPerMinuteIsModalAndTimesTheWay) {
  const Program program = read("G21 G90 G94\nG0 X0 Y0 Z5\nG1 Z-1 F 120\nX30 Y40\nF600 X0\n\nY0 F300\nG0 Z5\nG1 Z4\n");
  ASSERT_EQ(program.blocks.size(), 6U);
  EXPECT_NEAR(program.blocks[0].duration_s, 6.0 / 120.0 * 60.0, 1e-12);
  EXPECT_NEAR(program.blocks[1].duration_s, 50.0 / 120.0 * 60.0, 1e-12);
  EXPECT_NEAR(program.blocks[2].duration_s, 30.0 / 600.0 * 60.0, 1e-12);
  EXPECT_NEAR(program.blocks[3].duration_s, 40.0 / 300.0 * 60.0, 1e-12);
  EXPECT_EQ(program.blocks[4].kind, Block::Kind::rapid);
  EXPECT_NEAR(program.blocks[5].duration_s, 1.0 / 300.0 * 60.0, 1e-12);
}

TEST(Gcode, OnlyTheAxisTurningTakesDegreesAMinute) {
  const Program program = read("G0 X0 Y0 Z0 A0 C0\nG1 A3 C4 F50\nG1 X10 A0 F50\nG20 G1 A6 F60\n", Machine::xyzac_trt);
  const auto duration_s = [&](std::size_t line) {
    double sum = 0.0;
    for (const Block& block : program.blocks) sum += block.line == line ? block.duration_s : 0.0;
    return sum;
  };
  EXPECT_NEAR(duration_s(2), 5.0 / 50.0 * 60.0, 1e-12);
  EXPECT_NEAR(duration_s(3), 10.0 / 50.0 * 60.0, 1e-12) << "the tip's way counts where it moves";
  EXPECT_NEAR(duration_s(4), 6.0 / 60.0 * 60.0, 1e-12) << "degrees have no inches";
  const Program vectors = read("G0 X0 Y0 Z0 I0 J0 K1\nG1 I0.6 J0 K0.8 F 30\n");
  EXPECT_NEAR(vectors.blocks[0].duration_s, std::atan2(0.6, 0.8) * 180.0 / std::numbers::pi / 30.0 * 60.0, 1e-12);
}

TEST(Gcode, InchesAndSteps) {
  const Program program = read("G20 G0 X1 Y2 Z3\nG91 G1 X1 F10\nG21 X25.4 F254\nG90 Z 1\n");
  ASSERT_EQ(program.blocks.size(), 3U);
  EXPECT_LT((program.start.tip_m - Vector3d(0.0254, 0.0508, 0.0762)).norm(), 1e-15);
  EXPECT_LT((program.blocks[0].end.tip_m - Vector3d(0.0508, 0.0508, 0.0762)).norm(), 1e-15);
  EXPECT_NEAR(program.blocks[0].duration_s, 6.0, 1e-12);
  EXPECT_LT((program.blocks[1].end.tip_m - Vector3d(0.0762, 0.0508, 0.0762)).norm(), 1e-15);
  EXPECT_NEAR(program.blocks[1].duration_s, 6.0, 1e-12);
  EXPECT_NEAR(program.blocks[2].end.tip_m.z(), 0.001, 1e-15);
  // A feed keeps the unit that it was given in.
  const Program kept = read("G20 G0 X0 Y0 Z0\nG1 X1 F10\nG21 X0\n");
  EXPECT_NEAR(kept.blocks[1].duration_s, 6.0, 1e-12);
}

TEST(Gcode, SpacesCaseCommentsNumbersAndDeletedBlocks) {
  const Program program = read(
      "o1234\nn10 g0 x 1 2 . 5 y+.5 z-0.25 (a (comment) ; and more\n/ g1 x99 f1\nN20 G 1 X(why)13 F1 0 0\r\n   "
      "\t\r\n%\n");
  EXPECT_LT((program.start.tip_m - Vector3d(0.0125, 0.0005, -0.00025)).norm(), 1e-15);
  ASSERT_EQ(program.blocks.size(), 1U);
  EXPECT_NEAR(program.blocks[0].duration_s, 0.5 / 100.0 * 60.0, 1e-12);
  ASSERT_EQ(program.skipped.size(), 2U);
  EXPECT_EQ(program.skipped[0].what, "O1234");
  EXPECT_EQ(program.skipped[1].what, "/g1x99f1");
  ASSERT_EQ(program.notes.size(), 1U);
  EXPECT_EQ(program.notes[0],
            "1 line with a slash (block delete) is left out, the first in line 3, as with the machine's switch on.");
}

TEST(Gcode, TheStartIsTheFirstCompletePosition) {
  const Program program = read("G0 Z10\nG0 Z20\nG0 X1 Y2\nG0 Z5\nG1 Z0 F1\n");
  EXPECT_LT((program.start.tip_m - Vector3d(0.001, 0.002, 0.020)).norm(), 1e-15);
  EXPECT_EQ(program.blocks.size(), 2U);
}

TEST(Gcode, LeavesOutWhatDoesNotMove) {
  const Program program = read(
      "G17 G40 G49 G80 G54 G64 P0.01\nT1 M6\nG43 H1\nG0 X0 Y0 Z0\nG0 X0\nG1 Y0 F10\nG4 P1\nG1 A0 C90 F10\nG1 X1 F10\n",
      Machine::xyzac_trt);
  ASSERT_EQ(program.blocks.size(), 2U) << "at A0, C turns the part about the tool's own axis";
  EXPECT_EQ(program.blocks[0].kind, Block::Kind::dwell);
  ASSERT_EQ(program.skipped.size(), 3U);
  EXPECT_EQ(program.skipped[0].what, "G40 G49 G80 G54 G64 P0.01");
  EXPECT_EQ(program.skipped[1].what, "T1 M6");
  EXPECT_EQ(program.skipped[2].what, "G43 H1");
}

TEST(Gcode, RejectsWithLineWordAndRule) {
  const std::string head = "G0 X0 Y0 Z0\n";
  expect_rejected(head + "G1 X1\n", "part.ngc:2: F: is missing: no line up to this move at feed gives one");
  expect_rejected(head + "G1 X1 F0\n", "part.ngc:2: F = 0 mm/min; must be > 0 for a move at feed");
  expect_rejected(head + "G1 X1 F-3\n", "part.ngc:2: F = -3; must be > 0");
  expect_rejected(head + "G93 G1 X1 F2\nX2\n", "part.ngc:3: F: is missing: under G93 every move at feed");
  expect_rejected(head + "G1 X1 F5\nG93 X2\n", "part.ngc:3: F: is missing");
  expect_rejected(head + "G93 G1 X1 F2\nG94 X2\n", "part.ngc:3: F: is missing");
  expect_rejected(head + "G0 G1 X1\n", "part.ngc:2: G = 1; is the second code of its modal group");
  expect_rejected(head + "G20 G21\n", "G = 21; is the second code");
  expect_rejected(head + "G1 X1 X2 F1\n", "part.ngc:2: X = 2; comes twice");
  expect_rejected(head + "G1 Xnan F1\n", "part.ngc:2: \"xnanf1\": must be a letter and a number");
  expect_rejected(head + "G1 Xinf F1\n", "must be a letter and a number");
  expect_rejected(head + "G1 X--1 F1\n", "must be a letter and a number");
  expect_rejected(head + "G1 X+-1 F1\n", "must be a letter and a number");
  expect_rejected(head + "G1 X F1\n", "must be a letter and a number");
  expect_rejected(head + "G1 X1e3 F1\n", "E = 3; is a word not known here");
  expect_rejected(head + "G1 X1,A45 F1\n", "part.ngc:2: \",a45f1\": is a word of drawings (angles, bends)");
  expect_rejected(head + "G1 X1 U2 F1\n", "U = 2; is a word not known here");
  expect_rejected(head + "G1 X" + std::string(400, '9') + " F1\n", "that a double can hold");
  expect_rejected(head + "G1 X9999999 F1\n", "X = 1e+07 mm; must lie within 1 km");
  expect_rejected(head + "G5 X1 I1 J0 P1 Q1\n",
                  "part.ngc:2: G = 5; is a curve unless P alone stands with it (look-ahead of Fanuc). Let the CAM");
  expect_rejected(head + "G93 G1 X1 F0\n", "part.ngc:2: F = 0 1/min; must be > 0 for a move at feed");
  expect_rejected(head + "G1 X1 F2000000000\n", "F = 2e+09; is too large for any machine");
  expect_rejected(head + "G58.5\n", "G = 58.5; is no G code");
  expect_rejected(head + "G43.1 Z5\n", "It would move the tip by the words that come with it");
  expect_rejected(head + "G41 D1\n", "path of the tool's tip");
  expect_rejected(head + "G68 R30\n", "needs its centre in the plane G17");
  expect_rejected(head + "G95\n", "Use G93 or G94");
  expect_rejected(head + "G1 X1 R2 F1\n", "part.ngc:2: R = 2 mm; stands on a line that is no arc");
  expect_rejected(head + "G92.3\n", "It would move the program's frame");
  expect_rejected(head + "G10 L20 P1 X1\n", "L = 20; sets an extended work frame (Fanuc, Haas) or moves one");
  expect_rejected(head + "G29 X1\n", "G = 29; is not read");
  expect_rejected(head + "G76 X1 Z-1 R1 F1\n", "cuts a thread in LinuxCNC");
  expect_rejected(head + "G65 P9810 X1\n", "It calls a macro with arguments");
  expect_rejected(head + "G1234567\n", "is no G code");
  expect_rejected(head + "G1.05 X1\n", "is no G code");
  expect_rejected(head + "G4 X2\n", "part.ngc:2: G = 4; stands on a line with positions");
  expect_rejected(head + "G1 X#1 F1\n", "must be a letter and a number");
  expect_rejected(head + "#1=5\n", "is a parameter or an expression");
  expect_rejected(head + "o100 call [1]\n", "part.ngc:2: \"o100 call\": is a subroutine or its control");
  expect_rejected(head + "o100 while [1]\n", "part.ngc:2: \"o100 while\": is a subroutine or its control");
  expect_rejected(head + "o100 X1\n", "O = 100; is a subroutine or its control");
  expect_rejected(head + "osub call\n", "is a subroutine");
  expect_rejected(head + "G1 X1 F1 (half\n", "is a comment that does not end");
  expect_rejected(head + "S-1\n", "S = -1 rpm; must be >= 0");
  expect_rejected(head + "\xC3\xA4\n", "\"\\xc3\\xa4\": must begin with a letter");
  expect_rejected("X1 Y1 Z1\n", "part.ngc:1: G: is missing: none of G0 to G3 holds");
  expect_rejected("G0 X1 Y1\nG1 X2 F1\n", "part.ngc:2: Z: is not known where the first move at feed begins");
  expect_rejected("G91 G0 X1\n", "X = 1; is a step (G91) from a position");
  expect_rejected("(nothing)\n", "part.ngc: holds no complete position");
}

TEST(Gcode, RejectsAxesThatTheMachineDoesNotHave) {
  const std::string head = "G0 X0 Y0 Z0\n";
  expect_rejected(head + "G0 A1\n", "part.ngc:2: A = 1 deg; turns an axis of a machine that is not stated");
  expect_rejected(head + "G0 B1\n", "B = 1 deg; turns an axis that the stated machine does not have",
                  Machine::xyzac_trt);
  expect_rejected(head + "G0 A1\n", "does not have", Machine::xyzbc_head);
  expect_rejected(head + "G0 I1 J0\n", "K: is missing; I, J and K come together");
  expect_rejected(head + "G0 I3 J4 K0\n", "I, J, K = 5; must be a vector of length 1");
  expect_rejected(head + "G0 I0 J0 K1\nG0 A1\n", "the other way as well", Machine::xyzac_trt);
  EXPECT_EQ(test::field_of([] { static_cast<void>(parse_machine("xyzab")); }), "program.machine");
  EXPECT_EQ(parse_machine("xyzbc-head"), Machine::xyzbc_head);
}

TEST(Gcode, ADwellStandsWhereTheLastMoveEnded) {
  const Program program = read("G4 P1\nG0 X1 Y2 Z3 S100\nG04 P0.5\nG1 X2 F60\nG4 P150. F90 (a new feed)\nG4 P0\nX3\n");
  ASSERT_EQ(program.blocks.size(), 4U);
  EXPECT_EQ(program.blocks[0].kind, Block::Kind::dwell);
  EXPECT_EQ(program.blocks[0].duration_s, 0.5);
  EXPECT_EQ(program.blocks[0].line, 3U);
  EXPECT_EQ(program.blocks[0].end.tip_m, program.start.tip_m);
  EXPECT_GT(program.blocks[0].spindle_speed_rad_per_s, 0.0);
  EXPECT_EQ(program.blocks[2].duration_s, 150.0);
  EXPECT_EQ(program.blocks[2].end.tip_m, program.blocks[1].end.tip_m);
  EXPECT_NEAR(program.blocks[3].duration_s, 1.0 / 90.0 * 60.0, 1e-12);
  ASSERT_EQ(program.skipped.size(), 2U) << "before the first position, and of no time";
  EXPECT_EQ(program.skipped[0].what, "G4 P1");
  EXPECT_EQ(program.skipped[1].line, 6U);
  ASSERT_EQ(program.notes.size(), 1U);
  EXPECT_EQ(program.notes[0],
            "1 dwell of up to 150 s, the first in line 5: P counts in seconds here, on some controllers in ms.");

  const std::string head = "G0 X0 Y0 Z0\n";
  expect_rejected(head + "G4\n", "part.ngc:2: P: is missing: the time of the dwell G4, in seconds");
  expect_rejected(head + "G4 F2\n", "in seconds. F and S are a feed and a speed here");
  expect_rejected(head + "G4 S2\n", "F and S are a feed and a speed here");
  expect_rejected(head + "G4 U2\n", "U = 2; is a word not known here. Is it the time of the dwell? Give that as P");
  expect_rejected(head + "G4 P-1\n", "P = -1 s; must lie between 0 and a day");
  expect_rejected(head + "G4 P90000.\n", "P = 90000 s; must lie between 0 and a day");
}

TEST(Gcode, AxesAreMadeUnitVectorsWithANoteWhereTheyNearlyAre) {
  const Program program = read(
      "G0 X0 Y0 Z0 I0 J0 K1\nG1 X1 I0.6003 J0 K0.8004 F10\nX2 I0.6 J0 K0.8\nX3 I0.599999 J0 K0.8\n"
      "X4 I0 J-0.6 K0.7993\nX5 I0 J0 K1.0000009\n");
  ASSERT_EQ(program.blocks.size(), 5U);
  EXPECT_LT((program.blocks[0].end.axis - Vector3d(0.6, 0.0, 0.8)).norm(), 1e-12);
  for (const Block& block : program.blocks) EXPECT_NEAR(block.end.axis.norm(), 1.0, 1e-15);
  ASSERT_EQ(program.notes.size(), 1U);
  EXPECT_EQ(program.notes[0], "2 axes made a unit vector, off by up to 0.00056, the first in line 2.");
  expect_rejected("G0 X0 Y0 Z0 I0 J0 K1.0011\n", "I, J, K = 1.0011; must be a vector of length 1, within 1e-3");
  expect_rejected("G0 X0 Y0 Z0 I0 J0 K0\n", "I, J, K = 0; must be a vector of length 1");
  expect_rejected("G0 X0 Y0 Z0 I0 J0 K1\nG1 I0 J0 K-1 F1\n", "part.ngc:2: axis = 180 deg; turns by half a circle");
}

// A statement over several lines counts where it begins.
TEST(Gcode, StatementsGoOnInTheNextLine) {
  const Program program = read(
      "$PART.MIN%\nG0 X0 Y0 ~\n Z0\nG1 X1 F60 ~  \nY2 ~\n\nG1 X3\n  $ Y4 (Okuma)\n$Z5\nX6 ; a comment ~\nX7\nX8 ~");
  ASSERT_EQ(program.blocks.size(), 5U);
  EXPECT_EQ(program.blocks[0].end.tip_m, Vector3d(0.001, 0.002, 0.0));
  EXPECT_EQ(program.blocks[0].line, 4U);
  EXPECT_EQ(program.blocks[1].end.tip_m, Vector3d(0.003, 0.004, 0.005));
  EXPECT_EQ(program.blocks[1].line, 7U);
  EXPECT_EQ(program.blocks[2].line, 10U);
  EXPECT_EQ(program.blocks[4].end.tip_m.x(), 0.008);
  ASSERT_EQ(program.skipped.size(), 1U);
  EXPECT_EQ(program.skipped[0].what, "$part.min%");
  expect_rejected("G0 X0 Y0 Z0\nG1 ~\nX1\n", "part.ngc:2: F: is missing");
  std::string endless = "G0 X0 Y0 Z0\n";
  for (int i = 0; i < 9000; ++i) endless += "X1 ~\n";
  expect_rejected(endless, "part.ngc:2: begins a statement of more than 32768 bytes");
}

TEST(Gcode, TheSecondPercentEndsTheProgram) {
  const Program program = read("(name)\n%\nO1\nG0 X0 Y0 Z0\nX1\n%\nX2\n");
  EXPECT_EQ(program.blocks.size(), 1U);
  EXPECT_EQ(program.skipped.size(), 1U);
}

TEST(Gcode, ReadsLineByLine) {
  ProgramRemarks remarks(10);
  GcodeReader reader("part.ngc", {}, remarks);
  Block block;
  reader.take("G0 X0 Y0 Z0");
  EXPECT_FALSE(reader.pop(block));
  ASSERT_TRUE(reader.start().has_value());
  reader.take("G1 X3 Y4 F300 M8");
  ASSERT_TRUE(reader.pop(block));
  EXPECT_NEAR(block.duration_s, 1.0, 1e-15);
  EXPECT_FALSE(reader.pop(block));
  EXPECT_EQ(remarks.skipped_count(), 0U);
  EXPECT_FALSE(reader.ended());
  reader.take("M2");
  EXPECT_TRUE(reader.ended());
}

// Cut off or changed at any place, or made of nothing but noise, a program is rejected or read; what is read is finite.
TEST(Gcode, SurvivesMutations) {
  const std::string good =
      "%\n(p)\nG93 G21\nS600 M3\nG0 X16.339 Y-25.409 Z33.353 A-71.841 C-35.930\nG1 X6.302 Y-11.5 Z27 A-71 C-35 F318\n"
      "G94 F100\nX1\nG2 X3 I1 A-70\nG4 P1\nG91 Y1\nG3 G18 X1 Z2 Y1 R4\nG90 G20 Z.5\nN5 G1 X 1 A3 ; end\nM30\n";
  Random random(11);
  int accepted = 0;
  for (int i = 0; i < test::seeds(100000); ++i) {
    std::string text = good;
    const bool noise = i % 4 == 0;
    if (noise) {
      text.resize(1 + random.index(120));
      for (char& c : text) c = static_cast<char>(random.index(256));
    } else {
      static constexpr std::string_view letters = "GXYZABCIJKRPFNMSTO0123456789.-+ ()%$~;/\n\r";
      for (std::uint64_t n = random.index(4); n-- > 0;) {
        text[random.index(text.size())] =
            i % 4 == 1 ? static_cast<char>(random.index(256)) : letters[random.index(letters.size())];
      }
      if (i % 4 == 2) text.resize(1 + random.index(good.size() - 1));
    }
    try {
      const Program program =
          test_support::read_text<GcodeReader>(text, {.machine = Machine::xyzac_trt, .chord_tolerance_m = 1e-4});
      ++accepted;
      for (const Block& block : program.blocks) {
        ASSERT_TRUE(block.end.tip_m.allFinite()) << text;
        ASSERT_NEAR(block.end.axis.norm(), 1.0, 1e-12) << text;
        ASSERT_TRUE(std::isfinite(block.duration_s)) << text;
        const bool stops = block.operator_stop != OperatorStop::none;
        ASSERT_EQ(block.kind != Block::Kind::rapid, block.duration_s > 0.0 || stops) << text;
        ASSERT_GE(block.line, 1U);
      }
    } catch (const InvalidInput&) {
      continue;
    }
  }
  EXPECT_GT(accepted, 10);
}

}  // namespace gcode_test
}  // namespace robomill::program
