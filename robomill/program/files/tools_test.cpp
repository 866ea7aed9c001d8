// Programs of several tools: which part is read, what the others still say, and what a rewriting leaves as it is.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/program/files/program_files.hpp"
#include "robomill/program/files/rewrite.hpp"
#include "testing/program/reading.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace tools_test {

using test_support::expect_at;
using test_support::sums_of;

/// A tool by its number, by its name, or a part of it; {}: no choice.
struct Choice : ToolChoice {
  Choice() = default;
  Choice(int tool, std::optional<int> one = {}) : ToolChoice{.number = tool, .part = one} {}
  Choice(const char* called, std::optional<int> one = {}) : ToolChoice{.name = called, .part = one} {}
};

Program read(const std::string& text, const Choice& tool, const std::string& name = "part.nc") {
  return read_program_text(text, name, {.machine = Machine::xyzac_trt, .tool = tool});
}

std::string said_of(const std::string& text, const Choice& tool, const std::string& name = "part.nc") {
  try {
    static_cast<void>(read(text, tool, name));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

void expect_rejected(const std::string& text, const Choice& tool, const std::string& words,
                     const std::string& name = "part.nc") {
  const std::string said = said_of(text, tool, name);
  EXPECT_NE(said.find(words), std::string::npos) << said << "\n" << words;
}

const std::string two =
    "G21 G90\nT4 M6\nS7000 M3\nG0 X30 Y20 Z12\nG1 Z-1 F300\nX38\nG0 Z12\n"
    "T6 M6\nS9500 M3\nG0 X44 Y-6\nZ3\nG1 Z-2\nY4 F600\nG0 Z12\nM30\n";

TEST(Tools, OneIsChosen) {
  const Program first = read(two, 4);
  expect_at(first.start, {30, 20, 12});
  expect_at(first.blocks.back().end, {38, 20, 12});
  EXPECT_EQ(first.blocks.size(), 3U);
  EXPECT_NEAR(sums_of(first).way_mm(), 13.0 + 8.0 + 13.0, 1e-9);
  EXPECT_NEAR(sums_of(first).time_s, 60.0 * (13.0 + 8.0) / 300.0, 1e-9);
  EXPECT_NEAR(first.blocks[0].spindle_speed_rad_per_s, 7000.0 * units::rpm, 1e-9);
  const Program second = read(two, 6);
  expect_at(second.start, {44, -6, 3});
  expect_at(second.blocks.back().end, {44, 4, 12});
  EXPECT_EQ(second.blocks.front().line, 12U);
  EXPECT_NEAR(sums_of(second).way_mm(), 5.0 + 10.0 + 14.0, 1e-9);
  EXPECT_NEAR(sums_of(second).time_s, 60.0 * (5.0 / 300.0 + 10.0 / 600.0), 1e-9) << "F300 holds from the other part";
  EXPECT_NEAR(second.blocks[0].spindle_speed_rad_per_s, 9500.0 * units::rpm, 1e-9);
  const auto parts = [](const Program& program) {
    std::vector<std::string> out;
    for (const Skipped& skipped : program.skipped) {
      if (skipped.what.starts_with("the part")) out.push_back(fmt::format("{}: {}", skipped.line, skipped.what));
    }
    return out;
  };
  EXPECT_EQ(parts(first), std::vector<std::string>{"8: the part of T6, 8 lines"});
  EXPECT_EQ(parts(second), std::vector<std::string>{"2: the part of T4, 6 lines"});
}

TEST(Tools, WithoutAChoiceTheErrorListsThem) {
  EXPECT_EQ(
      said_of(two, {}),
      "part.nc:8: M6: mounts another tool than the one that has cut, whose length is not known here, and line 12 "
      "cuts. program.tool = 4 in the cell reads that tool's part alone. The program has:\n  T4: line 2, 6 lines, 3 "
      "moves, 4.2 s at feed\n  T6: line 8, 8 lines, 3 moves, 2 s at feed");
  std::string plunges = two;
  plunges.erase(plunges.find("Z3\n"), 3);
  expect_rejected(
      plunges, {},
      "\n  T6: line 8, 7 lines, cannot be read alone: line 11: Z is not known where this line cuts: M6 in line "
      "8 left the positions of the program");
  expect_rejected(plunges, 6, "part.nc:11: Z: is not known where this line cuts: M6 in line 8");
}

TEST(Tools, OneThatIsNotThereIsRejected) {
  expect_rejected(two, 7, "part.nc: program.tool = 7; is no tool of this program: it has T4 (line 2) and T6 (line 8)");
  expect_rejected("G0 X0 Y0 Z0\nG1 X1 F60\n", 1, "program.tool = 1; is no tool of this program, which names none");
  expect_rejected("T1 M6\nG0 X0 Y0\nT2 M6\nG0 X0 Y0 Z0\nG1 X1 F60\n", 1, "comes to no complete position");
  expect_rejected("x_mm,y_mm,z_mm,i,j,k,feed_mm_per_min\n0,0,0,0,0,1,\n1,0,0,0,0,1,60\n", 1, "which names none",
                  "part.csv");
  expect_rejected("M6\nG0 X0 Y0 Z0\nG1 X1 F60\n", 0, "which names none");
}

TEST(Tools, PartsThatAreNotReadStillSayModes) {
  const std::string inches = "G20 G91\nT1 M6\nG0 X1 Y1 Z1\nG2 X1 I7 F1\nG17 G90\nF10\nT2 M6\nG0 X1 Y0 Z0\nG1 X2\nM30\n";
  const Program program = read(inches, 2);
  expect_at(program.start, {25.4, 0, 0});
  EXPECT_NEAR(sums_of(program).time_s, 6.0, 1e-9) << "an arc that could not be read alone does not count";
  const std::string turned = "G21\nT1 M6\nG0 X0 Y0 Z0 A0 C0\nG1 X1 A-30 C90 F60\nT2 M6\nG0 X5 Y0 Z0\nG1 X6\nM30\n";
  EXPECT_LT(
      (read(turned, 2).start.axis - tool_axis(Machine::xyzac_trt, -30.0 * units::deg, 0.0, 90.0 * units::deg)).norm(),
      1e-12)
      << "the rotary axes stay where the other tool's part has left them";
  const std::string local = "G21\nT1 M6\nG0 X0 Y0 Z0\nG1 X1 F60\nG52 X10\nT2 M6\nG0 X0 Y0 Z0\nG1 X1\nM30\n";
  expect_at(read(local, 2).start, {10, 0, 0});
  const std::string shifted = "G21\nT1 M6\nG0 X0 Y0 Z0\nG1 X1 F60\nG92 X10\nT2 M6\nG0 X0 Y0 Z0\nG1 X1\nM30\n";
  expect_rejected(shifted, 2, "part.nc:5: G92: moves the program's frame by a position that is not known here");
  EXPECT_EQ(said_of("G21\nT1 M6\nG0 X0 Y0 Z0\nG92 X10\nG92.1\nT2 M6\nG0 X0 Y0 Z0\nG1 X1 F60\nM30\n", 2), "");
  const std::string frames = "T1 M6\nG54 G0 X0 Y0 Z0\nG1 X1 F60\nT2 M6\nG55 G0 X0 Y0 Z0\nG1 X1\nM30\n";
  const Program other = read(frames, 2);
  ASSERT_EQ(other.assumed.size(), 1U);
  EXPECT_EQ(other.assumed[0].taken, "G55, in which T2 begins; the tools before it begin in G54");
  EXPECT_TRUE(read(frames, 1).assumed.empty());
}

// What T6 cuts between the parts of T4 is missing in those of T4 alone.
TEST(Tools, OneThatComesBackIsReadByItsParts) {
  const std::string back =
      "T4 M6\nG0 X0 Y0 Z0\nG1 X1 F60\nT6 M6\nG0 X0 Y0 Z5\nG1 X1\nT4 M6\nG0 X0 Y0 Z0\nG1 Z-2\nM30\n";
  expect_rejected(back, 4,
                  "part.nc:8: T4: moves again in this line after T6 (line 4) has moved: what that one cuts would be "
                  "missing between the two parts. program.tool_part = 1 in the cell reads the part before it alone, 2 "
                  "the one that begins here");
  EXPECT_EQ(read(back, 6).blocks.size(), 1U);
  expect_rejected(
      back, {},
      "program.tool = 4 and program.tool_part = 1 in the cell read that part alone. The program has:\n  part "
      "1 of T4: line 1, 3 lines, 1 move, 1 s at feed\n  T6: line 4, 3 lines, 1 move, 1 s at feed\n  part 2 of "
      "T4: line 7, 4 lines, 1 move, 2 s at feed");
  const Program first = read(back, {4, 1});
  ASSERT_EQ(first.blocks.size(), 1U);
  expect_at(first.blocks[0].end, {1, 0, 0});
  const Program second = read(back, {4, 2});
  ASSERT_EQ(second.blocks.size(), 1U);
  expect_at(second.start, {0, 0, 0});
  expect_at(second.blocks[0].end, {0, 0, -2});
  EXPECT_NEAR(sums_of(second).time_s, 2.0, 1e-12);
  ASSERT_FALSE(second.skipped.empty());
  EXPECT_TRUE(std::ranges::any_of(second.skipped, [](const Skipped& skipped) {
    return skipped.line == 1 && skipped.what == "the part of T4, 3 lines";
  })) << "what is not read is listed";
  expect_rejected(back, {4, 3}, "part.nc: program.tool_part = 3; is no part of T4, which moves in 2 parts");
  EXPECT_EQ(read(back, {6, 1}).blocks.size(), 1U) << "of one part the first is all";
  EXPECT_EQ(said_of("T4 M6\nG0 X0 Y0 Z0\nG1 X1 F60\nT6 M6\nG0 X0 Y0 Z5\nG1 X1\nT4 M6\nG28\nM30\n", 4), "")
      << "mounted to be ready for the next part alone";
  EXPECT_EQ(read("T4 M6\nG0 X0 Y0 Z0\nG1 X1 F60\nT6 M6\nT4 M6\nG1 X2\nM30\n", 4).blocks.size(), 2U);
  const std::string waits = "T4 M6\nG0 X0 Y0 Z0\nG1 X1 F60\nT6 M6\nG0 X0 Y0 Z5\nG1 X5\nT4 M6\nG4 P1\nM0\nG28\nM30\n";
  EXPECT_EQ(read(waits, 4).blocks.size(), 1U) << "where the tool waits there is not known";
}

TEST(Tools, AChoiceIsOneToolAndOneOfItsParts) {
  const auto said = [](const ToolChoice& choice) {
    try {
      choice.validate();
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(said({}), "");
  EXPECT_EQ(said({.number = 0, .part = 1}), "");
  EXPECT_EQ(said({.number = 1, .name = "MILL"}),
            "number: is given beside the tool's name, \"MILL\": give one of the two");
  EXPECT_EQ(said({.number = -1}), "number = -1; must be >= 0");
  EXPECT_EQ(said({.name = "MILL", .part = 0}), "part = 0; must be >= 1");
  EXPECT_EQ(said({.part = 2}), "part = 2; is one of a tool's, and no tool is chosen");
}

TEST(Tools, TAloneChangesThemWhereNoM6Does) {
  const std::string named = "T1\nS1000 M3\nG0 X0 Y0 Z0\nG1 X1 F60\nT2\nG0 X0 Y0 Z2\nG1 X4\nM30\n";
  const Program program = read(named, 2);
  expect_at(program.start, {0, 0, 2});
  EXPECT_NEAR(sums_of(program).time_s, 4.0, 1e-12);
  ASSERT_EQ(program.assumed.size(), 1U);
  EXPECT_EQ(program.assumed[0].what, "T without an M6");
  expect_rejected(named, {},
                  "part.nc:5: T2: names another tool than the one that has cut, in a program without M6, and line 7 "
                  "cuts. program.tool = 1 in the cell reads that tool's part alone. The program has:\n  T1: line 1, 4 "
                  "lines, 1 move, 1 s at feed\n  T2: line 5, 4 lines, 1 move, 4 s");
  EXPECT_EQ(said_of("T1 M6\nG0 X0 Y0 Z0\nT2\nG1 X1 F60\nT3\nX2\nM30\n", {}), "") << "made ready";
  EXPECT_EQ(said_of("T1 M6\nG0 X0 Y0 Z0\nT2\nG1 X1 F60\nT3\nX2\nM30\n", 1), "");
  EXPECT_EQ(said_of("T1\nG0 X0 Y0 Z0\nG1 X1 F60\nM30\n", {}), "");
}

TEST(Tools, OfApt) {
  const std::string file =
      "PARTNO A\nUNITS/MM\nFROM/0,0,50\nLOADTL/1\nSPINDL/1000,CLW\nRAPID\nGOTO/0,0,10\nFEDRAT/100\nGOTO/0,0,0\n"
      "GOTO/10,0,0\nLOAD/TOOL,2\nSELECT/TOOL,1\nRAPID\nGOTO/0,5,10\nGODLTA/0,0,-10\nFEDRAT/200\nGOTO/0,5,-1,0,0,1\n"
      "FINI\n";
  const Program first = read(file, 1, "part.apt");
  expect_at(first.start, {0, 0, 10});
  EXPECT_NEAR(sums_of(first).way_mm(), 20.0, 1e-9);
  EXPECT_NEAR(sums_of(first).time_s, 12.0, 1e-9);
  const Program second = read(file, 2, "part.apt");
  expect_at(second.start, {0, 5, 10});
  EXPECT_NEAR(sums_of(second).time_s, 60.0 * (10.0 / 100.0 + 1.0 / 200.0), 1e-9);
  expect_rejected(
      file, {},
      "part.apt:11: LOAD: mounts another tool than the one that has cut, whose length is not known here, and "
      "line 14 moves it. program.tool = 1 in the cell reads that tool's part alone. The program has:",
      "part.apt");
  expect_rejected(file, {},
                  "\n  T1: line 4, 7 lines, 2 moves, 12 s at feed\n  T2: line 11, 8 lines, 2 moves, 6.3 s at feed",
                  "part.apt");
  expect_rejected(file, 3, "program.tool = 3; is no tool of this program: it has T1 (line 4) and T2 (line 11)",
                  "part.apt");
  expect_rejected("LOADTL/1\nFEDRAT/60\nGOTO/0,0,0\nGOTO/1,0,0\nLOADTL/2\nGOTO/0,0,9\nLOADTL/1\nGOTO/2,0,0\nFINI\n", 1,
                  "part.apt:8: T1: moves again in this line after T2 (line 5) has moved", "part.apt");
}

// Cycles, compensation and arcs of another tool count for nothing, unless they are still on.
TEST(Tools, WhatAptDoesWithOthersIsPassed) {
  const auto file = [](const std::string& others) {
    return "LOAD/TOOL,1\nFEDRAT/60\nGOTO/0,0,9\n" + others + "LOAD/TOOL,2\nGOTO/0,0,5\nGOTO/0,0,0\nFINI\n";
  };
  EXPECT_NEAR(sums_of(read(file("CYCLE/DRILL,5\nGOTO/1,0,0\nCYCLE/OFF\nCUTCOM/LEFT\nGOTO/2,0,0\nCUTCOM/OFF\n"
                                "CIRCLE/0,0,0,0,0,1,5\nINDIRV/1,0,0\nTLON,GOFWD/(LINE)\n"),
                           2, "part.apt"))
                  .time_s,
              5.0, 1e-9);
  expect_rejected(file("CYCLE/DRILL,5\n"), 2,
                  "part.apt:6: LOAD = \"CYCLE/DRILL,5\"; of another tool is still on where this one moves", "part.apt");
  for (const char* statement : {"TRANS/1,2,3", "ROTABL/30", "CALL/A", "TRACUT/1,0,0,0", "JUMPTO/A"}) {
    expect_rejected(file(std::string(statement) + "\n"), 2, "part.apt:4: ", "part.apt");
  }
}

// The paths' tools of NX have names; LOAD gives the number.
TEST(Tools, OfNx) {
  const std::string one = "TOOL PATH/A,TOOL,MILL\nLOAD/TOOL,4\nFEDRAT/60\nGOTO/0,0,0\nGOTO/1,0,0\n";
  expect_rejected(one + "TOOL PATH/B,TOOL,DRILL\nGOTO/2,0,0\n", {},
                  "part.cls:6: TOOL PATH: mounts another tool than the one that has cut", "part.cls");
  expect_rejected(one + "TOOL PATH/B,TOOL,DRILL\nGOTO/2,0,0\n", {}, "The program has:\n  T4: line 2, 4 lines, 1 move",
                  "part.cls");
  const std::string numbered = one + "TOOL PATH/B,TOOL,DRILL\nLOAD/TOOL,5\nGOTO/2,0,0\nGOTO/9,0,0\n";
  expect_rejected(numbered, {}, "\n  T4: line 2, 4 lines, 1 move, 1 s at feed\n  T5: line 7,", "part.cls");
  EXPECT_NEAR(sums_of(read(numbered, 5, "part.cls")).way_mm(), 7.0, 1e-9);
  expect_rejected("LOADTL/1\nFEDRAT/60\nGOTO/0,0,0\nGOTO/1,0,0\nGOHOME\nLOADTL/2\nGOTO/5,5,5\nGOTO/6,5,5\n", {},
                  "part.cls:6: LOADTL: mounts another tool", "part.cls");
  expect_rejected("LOADTL/1\nFEDRAT/60\nGOTO/0,0,0\nGOTO/1,0,0\nLOADTL/2\nFROM/0,0,100\nGOTO/5,5,5\n", {},
                  "part.cls:5: LOADTL: mounts another tool", "part.cls");
  EXPECT_EQ(read("LOADTL/1\nFEDRAT/60\nGOTO/0,0,0\nGOTO/1,0,0\nLOADTL/01\nGOTO/2,0,0\n", {}, "part.cls").blocks.size(),
            2U);
}

TEST(Tools, WithoutNumbersAreChosenByTheirNames) {
  const std::string text =
      "TOOL PATH/A,TOOL,MILL\nFEDRAT/60\nGOTO/0,0,0\nGOTO/1,0,0\nTOOL PATH/B,TOOL,DRILL\nGOTO/2,0,0\nGOTO/9,0,0\n"
      "TOOL PATH/C,TOOL,MILL\nGOTO/0,0,0\nGOTO/3,0,0\n";
  expect_rejected(
      text, {},
      "program.tool_name = \"MILL\" and program.tool_part = 1 in the cell read that part alone. The program "
      "has:\n  part 1 of MILL: line 1, 4 lines, 1 move, 1 s at feed\n  DRILL: line 5, 3 lines, 1 move, 7 s at "
      "feed\n  part 2 of MILL: line 8, 3 lines, 1 move, 3 s at feed",
      "part.cls");
  EXPECT_NEAR(sums_of(read(text, "DRILL", "part.cls")).way_mm(), 7.0, 1e-9);
  EXPECT_NEAR(sums_of(read(text, {"MILL", 2}, "part.cls")).way_mm(), 3.0, 1e-9);
  expect_rejected(text, "SAW",
                  "program.tool_name = \"SAW\"; is no tool of this program: it has MILL (line 1) and DRILL",
                  "part.cls");
  expect_rejected(text, 1, "program.tool = 1; is no tool of this program: it has MILL (line 1) and DRILL", "part.cls");
}

// W is the system of the program's first position, whichever tool is chosen.
TEST(Tools, PositionsCountInTheSystemOfTheFirstOne) {
  const std::string text =
      "MSYS/0,0,0,1,0,0,0,1,0\nLOAD/TOOL,1\nFEDRAT/100\nGOTO/0,0,10,.6,0,.8\nGOTO/0,0,0,.6,0,.8\n"
      "MSYS/100,0,0,1,0,0,0,1,0\nLOAD/TOOL,2\nGOTO/0,0,10\nGOTO/0,0,0\n";
  const Program program = read(text, 2, "part.cls");
  expect_at(program.start, {100, 0, 10});
  EXPECT_EQ(program.start.axis, Eigen::Vector3d::UnitZ());
  EXPECT_FALSE(program.assumed.empty());
}

TEST(Tools, CutsOfOthersBetweenArcsAreNotMissed) {
  expect_rejected(
      "LOADTL/1\nFROM/10,0,0\nFEDRAT/60\nINDIRV/0,1,0\nTLON,GOFWD/(CIRCLE/0,0,0,10),ON,(LINE/0,0,0,0,10,0)\n"
      "LOADTL/2\nGOTO/9,9,9\nGOTO/0,10,0\nLOADTL/1\nINDIRV/-1,0,0\n"
      "TLON,GOFWD/(CIRCLE/0,0,0,10),ON,(LINE/0,0,0,-10,0,0)\n",
      1, "T1: moves again in this line after T2 (line 6) has moved", "part.cls");
}

TEST(Tools, AreListedFromWithinSubprograms) {
  expect_rejected("T1 M6\nG0 X0 Y0 Z5\nF100\nM98 P1\nT2 M6\nG0 X0 Y0 Z5\nM98 P1\nM30\nO1\nG1 Z-1\nG0 Z5\nM99\n", {},
                  "The program has:\n  T1: line 1");
}

Rewritten rewrite(const std::string& text, const Choice& tool, double speed, double feed,
                  const std::string& name = "part.nc") {
  const ProgramReading reading = {.machine = Machine::xyzac_trt, .tool = tool};
  const Program program = read_program_text(text, name, reading);
  Program wanted = program;
  for (Block& block : wanted.blocks) {
    block.spindle_speed_rad_per_s *= speed;
    block.duration_s /= block.kind == Block::Kind::feed ? feed : 1.0;
  }
  return rewrite_program_text(text, name, reading, program, wanted);
}

TEST(Tools, ARewritingLeavesTheOthersAsTheyAre) {
  EXPECT_EQ(rewrite(two, 4, 1.0, 1.0).text, two);
  EXPECT_EQ(rewrite(two, 4, 0.5, 2.0).text,
            "G21 G90\nT4 M6\nS3500 M3\nG0 X30 Y20 Z12\nG1 Z-1 F600\nX38\nG0 Z12\n"
            "F300\nT6 M6\nS9500 M3\nG0 X44 Y-6\nZ3\nG1 Z-2\nY4 F600\nG0 Z12\nM30\n")
      << "T6 goes on by the F300 that T4's part has said";
  EXPECT_EQ(rewrite(two, 6, 0.5, 2.0).text,
            "G21 G90\nT4 M6\nS7000 M3\nG0 X30 Y20 Z12\nG1 Z-1 F300\nX38\nG0 Z12\n"
            "T6 M6\nS4750 M3\nG0 X44 Y-6\nZ3\nG1 Z-2 F600\nY4 F1200\nG0 Z12\nM30\n");
  const std::string apt =
      "LOADTL/1\nSPINDL/1000,CLW\nFEDRAT/100,MMPM\nGOTO/0,0,0\nGOTO/10,0,0\nLOADTL/2\nRAPID\nGOTO/0,5,10\nGOTO/0,5,0\n"
      "FINI\n";
  EXPECT_EQ(rewrite(apt, 1, 0.5, 2.0, "part.apt").text,
            "LOADTL/1\nSPINDL/500,CLW\nFEDRAT/200,MMPM\nGOTO/0,0,0\nGOTO/10,0,0\nSPINDL/1000,RPM,CLW\nFEDRAT/100,MMPM\n"
            "LOADTL/2\nRAPID\nGOTO/0,5,10\nGOTO/0,5,0\nFINI\n");
  const std::string stopped =
      "LOADTL/1\nSPINDL/1000,CLW\nFEDRAT/100,MMPM\nGOTO/0,0,0\nGOTO/10,0,0\nSPINDL/OFF\nLOADTL/2\nRAPID\n"
      "GOTO/0,5,10\nSPINDL/2000,CLW\nGOTO/0,5,0\n";
  const std::string half = rewrite(stopped, 1, 0.5, 1.0, "part.apt").text;
  EXPECT_NE(half.find("GOTO/10,0,0\nSPINDL/OFF\nLOADTL/2\n"), std::string::npos) << "no turning in the change\n"
                                                                                 << half;
}

TEST(Tools, ARewritingEndsWhereTheNextPartBegins) {
  const ProgramReading reading = {.tool = {.number = 4}};
  const Program program = read_program_text(two, "part.nc", reading);
  Program wanted = program;
  wanted.blocks.back().end.tip_m.z() += 1e-3;
  try {
    static_cast<void>(rewrite_program_text(two, "part.nc", reading, program, wanted));
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("part.nc:8: tip: must be as it was read"), std::string::npos)
        << error.what();
  }
  wanted.blocks.back() = program.blocks.back();
  wanted.blocks[1].end.tip_m.y() += 1e-3;
  EXPECT_NE(rewrite_program_text(two, "part.nc", reading, program, wanted).text.find("X38 Y21"), std::string::npos);
}

// Random programs of tools that come back: each part is what it is as a file of its own behind the same modes, and a
// rewriting of one leaves the others.
TEST(Tools, EachPartIsAProgramOfItsOwn) {
  for (int seed = 0; seed < test::seeds(200); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const auto number = [&](double most) { return std::round(random.uniform(-most, most) * 100.0) / 100.0; };
    std::string text = "G21 G90 G17\n";
    std::vector<std::string> parts;
    std::vector<ToolChoice> choices;
    for (int at = 0; at < 5; ++at) {
      int tool = 1 + static_cast<int>(random.index(3));
      if (at > 0 && tool == choices.back().number) tool = 1 + tool % 3;
      const auto before =
          std::ranges::count_if(choices, [&](const ToolChoice& choice) { return choice.number == tool; });
      choices.push_back({.number = tool, .part = static_cast<int>(before) + 1});
      std::string& part = parts.emplace_back();
      part = fmt::format("T{} M6\nS{} M3\nG0 X{} Y{} Z{}\n", tool, 1000 * (at + 1), number(50), number(50), 20.5);
      for (int i = 0; i < 6; ++i) {
        part += fmt::format("G{} X{} Y{} F{}\n", random.uniform(0.0, 1.0) < 0.2 ? 0 : 1, number(50), number(50),
                            100 + 100 * at + i);
      }
      part += "G0 Z20.5\n";
      text += part;
    }
    text += "M30\n";
    for (std::size_t at = 0; at < parts.size(); ++at) {
      const ProgramReading reading = {.machine = Machine::xyzac_trt, .tool = choices[at]};
      const Program chosen = read_program_text(text, "part.nc", reading);
      const Program alone = read("G21 G90 G17\n" + parts[at] + "M30\n", {});
      ASSERT_EQ(chosen.blocks.size(), alone.blocks.size()) << text;
      EXPECT_EQ(chosen.start.tip_m, alone.start.tip_m);
      for (std::size_t i = 0; i < alone.blocks.size(); ++i) {
        EXPECT_EQ(chosen.blocks[i].end.tip_m, alone.blocks[i].end.tip_m);
        EXPECT_EQ(chosen.blocks[i].duration_s, alone.blocks[i].duration_s);
      }
      const std::string again = rewrite(text, {*choices[at].number, choices[at].part}, 0.7, 1.3).text;
      for (std::size_t other = 0; other < parts.size(); ++other) {
        EXPECT_EQ(again.find(parts[other]) == std::string::npos, other == at) << again;
      }
    }
  }
}

// Any text is read or rejected, and what is read is finite.
TEST(Tools, ChangedTextIsReadOrRejected) {
  const std::string planes =
      "G21 G90 G17\nT1 M6\nS900 M3\nG0 X0 Y0 Z9\nG68 X1 Y2 R30\nG1 X9 ,R2 F60\nY9 ,C1\nX0\nG69\nG91 G28 Z0\nG90\nT2 "
      "M6\n"
      "G68.2 X1 Y2 Z3 I10 J20 K30\nG53.1\nG0 X0 Y0\nZ5\nG1 Z-1\nG2 X4 I2\nG0 Z5\nG69\nG55\nT1\nM30\n";
  const std::string letters = "GMTXYZIJKRCF,.-0123456789 \n/%(;";
  for (int seed = 0; seed < test::seeds(4000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    std::string text = random.uniform() < 0.3 ? two : planes;
    const std::uint64_t changes = 1 + random.index(4);
    for (std::uint64_t i = 0; i < changes; ++i) {
      const std::size_t at = random.index(text.size());
      const double kind = random.uniform();
      if (kind < 0.4) {
        text[at] = letters[random.index(letters.size())];
      } else if (kind < 0.7) {
        text.insert(at, 1, letters[random.index(letters.size())]);
      } else {
        text.erase(at, 1 + random.index(9));
      }
    }
    for (const Choice& tool : {Choice(), Choice(1), Choice(2), Choice(1, 2)}) {
      try {
        const Program program = read(text, tool);
        for (const Block& block : program.blocks) {
          ASSERT_TRUE(block.end.tip_m.allFinite() && block.end.axis.allFinite() && block.duration_s >= 0.0) << text;
          ASSERT_NEAR(block.end.axis.norm(), 1.0, 1e-9) << text;
        }
      } catch (const InvalidInput& error) {
        ASSERT_NE(std::string(error.what()).find("part.nc"), std::string::npos) << text << error.what();
      }
    }
  }
}

}  // namespace tools_test
}  // namespace robomill::program
