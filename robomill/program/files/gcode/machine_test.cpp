// M codes, and G codes that change what positions mean: obeyed or rejected, never skipped.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robomill/program/files/gcode/reader.hpp"
#include "testing/program/reading.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace gcode_machine_test {

Program read(const std::string& text) {
  return test_support::read_text<GcodeReader>(text, {.machine = Machine::xyzac_trt});
}

std::string said_of(const std::string& text) {
  try {
    static_cast<void>(read(text));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

void expect_rejected(const std::string& text, const std::string& words) {
  const std::string said = said_of(text);
  EXPECT_NE(said.find(words), std::string::npos) << text << "\n" << said;
}

const std::string head = "G0 X0 Y0 Z0\nG1 X1 F60\n";

TEST(GcodeMachine, KnowsNoOtherMcode) {
  EXPECT_NE(find_mcode(30), nullptr);
  EXPECT_EQ(find_mcode(20), nullptr);
  EXPECT_EQ(find_mcode(-1), nullptr);
  EXPECT_EQ(find_mcode(999), nullptr);
}

TEST(GcodeMachine, EveryMcodeIsReadOrRejectedWithItsLine) {
  const std::set<int> read_codes = {0,  1,  2,  3,  4,  5,  7,  8,  9,  10, 11, 12, 19, 29,  30,  31,  33, 34,
                                    35, 40, 41, 42, 43, 44, 45, 48, 49, 51, 52, 53, 62, 63,  64,  65,  67, 68,
                                    70, 71, 73, 74, 76, 77, 80, 81, 83, 84, 88, 89, 99, 128, 129, 428, 429};
  const std::set<int> ends = {2, 30, 99};
  for (int code = 0; code < 1100; ++code) {
    const std::string text = head + fmt::format("M{}\nG1 X2\n", code);
    if (read_codes.contains(code)) {
      EXPECT_EQ(said_of(text), "") << code;
      EXPECT_EQ(said_of(text).empty() && read(text).blocks.size() == 1, ends.contains(code)) << code;
    } else if (code == 6 || code == 16) {
      expect_rejected(text, "part:3: M6: mounts another tool");
    } else {
      expect_rejected(text, fmt::format("part:3: M = {}; is not ", code));
    }
  }
  expect_rejected(head + "M3.5\n", "M = 3.5; is not known to be harmless");
  expect_rejected(head + "M-3\n", "M = -3; is not known to be harmless");
}

TEST(GcodeMachine, SaysWhatARejectedCodeDoes) {
  expect_rejected(
      head + "M98 P1\n",
      "part:3: M = 98; is not carried out here: calls a subprogram (LinuxCNC, Fanuc and Haas), machines open "
      "corners completely (Heidenhain)");
  expect_rejected(head + "M97 P1\n", "calls a subprogram within the program (Fanuc and Haas)");
  expect_rejected(head + "M198 P1\n", "calls a subprogram of another file");
  expect_rejected(head + "M126\n", "turns rotary axes the shorter way (Heidenhain)");
  expect_rejected(head + "M101\n", "is not known to be harmless. In LinuxCNC it is the user's own code");
  expect_rejected(head + "M99 P10\n", "M = 99; jumps to another line");
}

// All G codes from 0 to 999.9: those that are read, those that move nothing, and every other one rejected.
TEST(GcodeMachine, EveryGcodeIsReadOrRejectedWithItsLine) {
  std::set<int> read_codes = {0,    10,   170, 180, 190, 200, 210, 800, 900, 901, 910, 911, 930,  940,  150,
                              400,  490,  500, 610, 611, 640, 690, 921, 922, 970, 980, 990, 430,  434,  435,
                              90,   131,  220, 230, 250, 281, 301, 401, 501, 620, 630, 670, 1000, 1030, 1130,
                              1870, 2550, 280, 300, 520, 530, 920, 591, 592, 593, 700, 710, 2340, 2690};
  for (int code = 540; code <= 590; code += 10) read_codes.insert(code);
  for (int code = 1100; code <= 1290; code += 10) read_codes.insert(code);
  for (int code = 0; code < 10000; ++code) {
    const std::string text = fmt::format("G0 X0 Y0 Z0\nG{}\nG4 P1\n", 0.1 * code);
    // Arcs' ends, a dwell's time, a frame's number, a hole's depth.
    const std::set<int> need_more = {20, 30, 40, 100, 541, 1540, 730, 740, 810, 820, 830, 840, 850, 860, 880, 890};
    if (need_more.contains(code)) continue;
    const std::string said = said_of(text);
    if (read_codes.contains(code)) {
      EXPECT_EQ(said, "") << code;
    } else {
      EXPECT_EQ(said.find(fmt::format("part:2: G = {:g}", 0.1 * code)), 0U) << code << said;
    }
  }
}

TEST(GcodeMachine, CodesThatChangeMotionAreNeverSkipped) {
  for (const char* line : {"G43.1 Z5",     "G43.2 H2", "G44 H1",     "G55",      "G59.3",
                           "G54.1 P3",     "G54.2 P1", "G68 X0 R30", "G68.2 X0", "G51 X2",
                           "G10 L2 P1 X1", "G110",     "G92.3",      "G154 P2",  "G53 G0 X0",
                           "G28",          "G30 Z0",   "G41 D1",     "G42",      "G5 X1 I1 J1 P1 Q1",
                           "G5.1 Q1 I1",   "G5.2",     "G73 Z-1 R1", "G76",      "G81 Z-1",
                           "G82",          "G83",      "G84",        "G85",      "G86",
                           "G87",          "G88",      "G89",        "G65 P1",   "G66 P1",
                           "G16",          "G7",       "G95",        "G96 S100", "G50 X2",
                           "O100 call",    "O100 sub", "#1=2",       "G1 X#1",   "G1 X[1+2]",
                           "M98 P1",       "M97 P1",   "M198 P1",    "M6 T2",    "M72",
                           "M91",          "M94",      "M126",       "M140"}) {
    EXPECT_FALSE(said_of(head + line + "\nG1 X2\n").empty()) << line;
  }
}

TEST(GcodeMachine, SpindleAndCoolantAreKept) {
  const Program program = read(
      "G0 X0 Y0 Z0\nX1\nS1000 M3 M8\nG1 X2 F60\nM7 X3\nM9 X4\nM4 X5\nM5 X6\nX7\nM88 X8\nM89 M19 X9\nG2 X11 I1 M3\n"
      "G2 X13 I1 M5\nX15 I1\n");
  const auto of_line = [&](std::size_t line) {
    std::vector<Block> blocks;
    std::ranges::copy_if(program.blocks, std::back_inserter(blocks), [&](const Block& b) { return b.line == line; });
    return blocks;
  };
  const Coolant off, flood = {.flood = true}, both = {.mist = true, .flood = true}, through = {.through_tool = true};
  struct Expected {
    std::size_t line;
    Spindle spindle;
    Coolant coolant;
  };
  for (const auto& [line, spindle, coolant] : {Expected{2, Spindle::not_given, off},
                                               {4, Spindle::clockwise, flood},
                                               {5, Spindle::clockwise, both},
                                               {6, Spindle::clockwise, both},
                                               {7, Spindle::counterclockwise, off},
                                               {8, Spindle::counterclockwise, off},
                                               {9, Spindle::off, off},
                                               {10, Spindle::off, through},
                                               {11, Spindle::off, through},
                                               {12, Spindle::clockwise, off},
                                               {13, Spindle::clockwise, off},
                                               {14, Spindle::off, off}}) {
    const std::vector<Block> blocks = of_line(line);
    ASSERT_FALSE(blocks.empty()) << line;
    for (const Block& block : blocks) {
      EXPECT_EQ(block.spindle, spindle) << line;
      EXPECT_EQ(block.coolant, coolant) << line;
    }
  }
  EXPECT_EQ(read("S5 M3\nG0 X0 Y0 Z0\nM5\nM3\nX1\n").blocks[0].spindle, Spindle::clockwise);
  EXPECT_TRUE(program.skipped.empty());
}

TEST(GcodeMachine, StopsAreDwellsAfterTheirLine) {
  const Program program = read("M0\nG0 X0 Y0 Z0\nM1 X1\nM0\nG3 X3 I1 F60 M0\nG4 P1 M1\n");
  std::vector<Block> stops;
  std::ranges::copy_if(program.blocks, std::back_inserter(stops),
                       [](const Block& block) { return block.operator_stop != OperatorStop::none; });
  ASSERT_EQ(stops.size(), 4U) << "the first one comes before there is a place to stop at";
  const OperatorStop kinds[] = {OperatorStop::optional, OperatorStop::always, OperatorStop::always,
                                OperatorStop::optional};
  const double x_mm[] = {1.0, 1.0, 3.0, 3.0};
  const std::size_t lines[] = {3, 4, 5, 6};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(stops[i].kind, Block::Kind::dwell);
    EXPECT_EQ(stops[i].duration_s, 0.0);
    EXPECT_EQ(stops[i].operator_stop, kinds[i]) << i;
    EXPECT_EQ(stops[i].line, lines[i]);
    EXPECT_NEAR(stops[i].end.tip_m.x(), 1e-3 * x_mm[i], 1e-15);
  }
  EXPECT_EQ(program.blocks.back().operator_stop, OperatorStop::optional);
  ASSERT_EQ(program.notes.size(), 1U);
  EXPECT_EQ(
      program.notes[0],
      "4 stops for the operator (M0, M1), the first in line 3: the tool comes to rest there, and goes on at once in "
      "a trajectory.");
}

TEST(GcodeMachine, AnotherToolIsRejectedOnceOneHasCut) {
  EXPECT_EQ(said_of("T1 M6\nG0 X0 Y0 Z0\nT2\nM6\nG1 X1 F60\nM6 T2\nX2\nT3 (made ready)\nX3\nM6\nM30\n"), "");
  expect_rejected(
      "T1 M6\nG0 X0 Y0 Z0\nG1 X1 F60\nG0 Z5\nM6 T2\nM3\nG0 X5\nG1 Z0\nX6\nM6\n#1=3\nT3 M6\nX1\nM30\nT4 M6\n",
      "part:5: M6: mounts another tool than the one that has cut, whose length is not known here, and line 8 "
      "cuts; the program has T1 (line 1, 4 lines), T2 (line 5, 7 lines) and T3 (line 12, 3 lines). Write a program "
      "for each tool");
  EXPECT_EQ(said_of("T1 M6\nG0 X0 Y0 Z0\nG1 X1 F60\nM6 T2\nG0 X5 Y3\nM30\n"), "") << "it does not cut";
  expect_rejected("T1 M6\nG0 X0 Y0 Z0\nG2 X2 I1 F60\nT2\nM16\nG3 X0 I-1\n", "part:5: M6: mounts another tool");
}

TEST(GcodeMachine, TheToolsLengthHoldsFromTheFirstMoveAtFeed) {
  EXPECT_EQ(said_of("G49\nG0 X0 Y0\nG43 H1 Z5\nG1 X1 F60\nG43 H1 X2\nG49\nM30\n"), "");
  EXPECT_EQ(said_of("G0 X0 Y0 Z0\nG49 G1 X1 F60\nG17 G49 G80\nG1 X2\n"), "") << "no length was on";
  expect_rejected("G43 H1 G0 X0 Y0 Z0\nG1 X1 F60\nG49\nG0 Z50\nG1 X2\n",
                  "part:3: G49: changes the tool's length after moves at feed, and line 5 cuts");
  EXPECT_EQ(said_of("G43 H1 G0 X0 Y0 Z0\nG1 X1 F60\nG49\nG0 Z50\nM30\n"), "") << "a retract after the last cut";
  expect_rejected("G43 H1 G0 X0 Y0 Z0\nG1 X1 F60\nG43 H21 X2\n", "part:3: G43: changes the tool's length");
  expect_rejected("G0 X0 Y0 Z0\nG1 X1 F60\nG43 H1 Z2\n", "part:3: G43: changes the tool's length");
}

TEST(GcodeMachine, WithoutTheToolCentrePointTurnedAxesAreRejected) {
  for (const auto& [on, off] : {std::pair("M428", "M429"), {"M128", "M129"}, {"G43.4 H1", "G49"}, {"G234", "G49"}}) {
    const std::string turned = fmt::format("{}\nG0 X0 Y0 Z0 A-30 C5\nG1 X1 F60\n{}\n", on, off);
    const Program program = read(turned + "M30\n");
    EXPECT_EQ(program.blocks.size(), 1U);
    EXPECT_TRUE(program.assumed.empty());
    for (const Skipped& skipped : program.skipped) {
      EXPECT_TRUE(skipped.what == "H1" || skipped.what == "G49") << skipped.what << ": what is obeyed is not skipped";
    }
    const std::string said = said_of(turned + "G0 Z50\nG1 X2\n");
    EXPECT_NE(said.find("part:4: "), std::string::npos) << said;
    EXPECT_EQ(said_of(turned + "G0 Z50\nM30\n"), "");
  }
  expect_rejected("M128\nG0 X0 Y0 Z0 A-30 C5\nM129\nG1 Z50 F60\n",
                  "part:3: M129: turns the tool centre point off: positions are the machine's then, not the tip's, and "
                  "line 4 cuts");
  EXPECT_EQ(said_of("M129\nG0 X0 Y0 Z0\nG1 X1 F60\n"), "") << "nothing is turned";
  const Program program = read("G0 X0 Y0 Z0 A0 C0\nG1 X1 F60\nG1 X2 A-30\nG1 X3\n");
  EXPECT_TRUE(program.notes.empty());
  EXPECT_EQ(program.assumed, (std::vector<Assumption>{{.what = "Positions with rotary axes turned, from line 3 on",
                                                       .taken = "those of the tool's tip",
                                                       .key = "G43.4, M128 or M428"}}));
}

}  // namespace gcode_machine_test
}  // namespace robomill::program
