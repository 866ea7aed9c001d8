// What posts of Fanuc, Haas and Mach write around the cut: retracts, frames, subprograms, look-ahead, other digits.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/program/files/gcode/calls.hpp"
#include "robomill/program/files/program_files.hpp"
#include "robomill/program/files/rewrite.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace gcode_dialects_test {

using Eigen::Vector3d;

Program read(const std::string& text, const std::string& name = "part.nc") {
  return read_program_text(text, name, {.machine = Machine::xyzac_trt});
}

std::string said_of(const std::string& text, const std::string& name = "part.nc") {
  try {
    static_cast<void>(read(text, name));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "";
}

void expect_said(const std::string& text, const std::string& words) {
  const std::string said = said_of(text);
  EXPECT_NE(said.find(words), std::string::npos) << text << "\n" << said;
}

void expect_end(const Program& program, const Vector3d& end_mm) {
  ASSERT_FALSE(program.blocks.empty());
  EXPECT_LT((program.blocks.back().end.tip_m - 1e-3 * end_mm).norm(), 1e-9);
}

double feed_length_mm(const Program& program) {
  double sum = 0.0;
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    if (program.blocks[i].kind != Block::Kind::feed) continue;
    sum += 1e3 * (program.blocks[i].end.tip_m - program.begin_of(i).tip_m).norm();
  }
  return sum;
}

const std::string head = "G21 G90\nG0 X0 Y0 Z5\nG1 Z-1 F60\nX10\n";

TEST(GcodeDialects, ARetractAfterTheLastCutEndsNoProgram) {
  for (const char* retract : {"G91 G28 Z0.", "G28 G91 Z0.\nG28 X0 Y0\nG90", "G53 G0 Z0.", "G0 G53 Z0 X-300.",
                              "G30 P2 Z5", "G28", "G49 G0 Z300", "T2 M6\nG0 X3", "G54.1 P7\nG0 X0 Y0", "M99"}) {
    const Program program = read(head + retract + "\nM30\n");
    EXPECT_NEAR(feed_length_mm(program), 16.0, 1e-9) << retract;
  }
}

TEST(GcodeDialects, ARapidComesBackFromTheMachinesPositionAboveThePart) {
  const Program program = read(head + "G91 G28 Z0.\nG90\nG0 X40 Y30\nG0 Z2\nG1 Z-2\nM30\n");
  ASSERT_EQ(program.blocks.size(), 6U);
  const Vector3d way[] = {{10, 0, 5}, {40, 30, 5}, {40, 30, 2}};  // up to the highest position, across, down
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(program.blocks[2 + i].kind, Block::Kind::rapid);
    EXPECT_LT((program.blocks[2 + i].end.tip_m - 1e-3 * way[i]).norm(), 1e-12) << i;
  }
  EXPECT_NEAR(program.blocks.back().duration_s, 4.0, 1e-9);
  EXPECT_EQ(program.notes.size(), 1U) << "the rapid to X40 is left out";
}

TEST(GcodeDialects, ACutFromAPositionThatIsNotKnownIsRejected) {
  expect_said(head + "G28 Z9\nG1 X3\n", "part.nc:6: Z: is not known where this line cuts: G28 in line 5 left the");
  expect_said(head + "G53 G0 X0\nG1 X5\n", "part.nc:6: X: is not known where this line cuts: G53 in line 5");
  expect_said(head + "G28\nG2 X5 I3\n", "is not known where this line cuts");
  expect_said(head + "G28 G91 Z0\nG0 Z3\nG1 Z-1\n", "Z: is not known where this line cuts");
}

TEST(GcodeDialects, LookAheadAndSmoothingAreNoted) {
  const std::string plain = "G0 X0 Y0 Z5\nG1 Z-1 F60\nX10\n";
  for (const char* mode : {"G5.1 Q1", "G05.1 Q1 X0 Y0 Z0", "G05 P10000", "G8 P1", "G61.1", "G187 P3", "G187 P3 E0.01",
                           "G103 P1", "G9", "G64 P0.01 Q0.02", "G50.1 X0", "G54.2 P0", "G10 L10 P1 R80."}) {
    const Program program = read(std::string(mode) + "\n" + plain);
    EXPECT_NEAR(feed_length_mm(program), 16.0, 1e-9) << mode;
    EXPECT_EQ(program.skipped.size(), 1U) << mode;
  }
  EXPECT_NE(said_of("G5.1 X1 Y2 I3 J4\n" + plain), "");
  EXPECT_NE(said_of("G5 X1 Y2 I3 J4 P1 Q2\n" + plain), "");
  EXPECT_NE(said_of("G8\n" + plain), "");
  EXPECT_NE(said_of("G187 X1\n" + plain), "");
}

TEST(GcodeDialects, FramesMoveThePositions) {
  expect_end(read("G0 X0 Y0 Z0\nG52 X60 Z-2\nG1 X1 Y2 Z3 F60\n"), {61, 2, 1});
  expect_end(read("G0 X0 Y0 Z0\nG52 X60\nG52 X0\nG1 X1 F60\n"), {1, 0, 0});
  expect_end(read("G0 X5 Y0 Z0\nG92 X0\nG1 X1 F60\nG92.1\nG1 X2\n"), {2, 0, 0});
  expect_end(read("G0 X5 Y0 Z0\nG92 X0\nG1 X1 F60\n"), {6, 0, 0});
  expect_end(read("G92 X0 Y0 Z10\nG1 X1 F60\n"), {1, 0, 10});
  const std::string tables = "G10 L2 P1 X100 Y0 Z0\nG10 L2 P3 X130 Y-5 Z2\n";
  expect_end(read(tables + "G54 G0 X0 Y0 Z0\nG1 X1 F60\nG56\nG1 X1 Y0 Z0\n"), {31, -5, 2});
  expect_end(read(tables + "G56 G0 X0 Y0 Z0\nG1 X1 F60\nG54\nG1 X1 Y0 Z0\n"), {-29, 5, -2});
  expect_end(read("G54.1 P3\nG0 X0 Y0 Z0\nG1 X1 F60\n"), {1, 0, 0});
  expect_said(
      "G54\nG0 X0 Y0 Z0\nG1 X1 F60\nG55\nG0 X3\nG1 X1\n",
      "part.nc:4: G55: is another work frame than G54 (line 1) of the positions before; the offsets of G54 and G55 are "
      "not known, and line 6 cuts. Give them as the control's table has them, in the cell: [[program.frames]]");
  expect_said("G92 X0 Y0 Z10\nG1 X1 F60\nG92.1\nX2\n",
              "part.nc:3: G92.1: moves the program's frame by a position that");
}

TEST(GcodeDialects, SubprogramsOfTheFileAreCarriedOut) {
  const std::string text =
      "G21 G90 G17\nG0 Z25\nS7500 M3\nG52 X0 Y0\nM98 P70\nG52 X60 Y0\nM98 P70 L2\nM30\nO70\nG0 X10 Y12 Z25\nG1 Z-2 "
      "F700\n"
      "G0 Z25\nM97 P5\nM99\nN5 G1 Z20\nG0 Z25\nM99\n";
  const Program program = read(text);
  expect_end(program, {70, 12, 25});
  EXPECT_NEAR(feed_length_mm(program), 3.0 * (27.0 + 5.0), 1e-9);
  EXPECT_EQ(program.blocks.front().line, 11U);
  expect_end(read("G0 X0 Y0 Z0\nG91\nM98 P30007\nM30\nO7\nG1 X2 F60\nM99\n"), {6, 0, 0});
  expect_end(read("o<a> sub\nG1 X2 F60\no<a> endsub\nG0 X0 Y0 Z0\nG91\no<a> call\no<A> call\nM2\n"), {4, 0, 0});
  expect_end(read(":1\nG0 X0 Y0 Z0\nM98 P2\nM30\n:2\nG1 X2 F60\nM99\n"), {2, 0, 0});
  // Notes and words left out count once.
  EXPECT_EQ(read("G0 X0 Y0 Z0\nM98 P7 L9\nM30\nO7\nM48\nM99\n").skipped.size(), 1U);
  const std::string start = "G0 X0 Y0 Z0\n";
  expect_said(start + "M98 P7\n", "part.nc:2: calls O7, which this file does not contain");
  expect_said(start + "M97 P7\nM30\nO1\nN7\nM99\n", "part.nc:2: calls N7, which this program does not contain");
  expect_said(start + "M98 P7\nM30\nO7\nX1\n", "part.nc:2: calls O7, which does not end. Is its M99 missing?");
  expect_said(start + "M98 P7\nM30\nO7\nM98 P7\nM99\n", "more than 10 calls deep. Does a subprogram call itself?");
  expect_said(start + "M98 P7 L0\n", "L = 0; must be a whole number from 1 to 9999 with M98");
  expect_said(start + "M98\n", "P: must be a whole number");
  expect_said(start + "M98 P7\nM30\nO7\nO8\nM99\n", "begins another program before this one has ended");
  expect_said(start + "o1 sub\nX1\n", "part.nc:2: o1 sub: begins a subprogram that does not end");
  std::string bomb = start + "M98 P1\nM30\n";
  for (int i = 1; i < 9; ++i) bomb += fmt::format("O{}\nM98 P{} L9999\nM99\n", i, i + 1);
  expect_said(bomb + "O9\nM99\n", "makes more than 10000000 lines by its calls");
}

TEST(GcodeDialects, SubprogramsAreReadAgainAfterRewinding) {
  const test::Folder folder;
  const auto file = open_program(folder.file("part.nc", "G0 X0 Y0 Z0\nG91\nM98 P7 L3\nM30\nO7\nG1 X2 F60 M48\nM99\n"));
  Block block;
  for (int pass = 0; pass < 3; ++pass) {
    std::size_t count = 0;
    while (file->next(block)) ++count;
    EXPECT_EQ(count, 3U);
    EXPECT_EQ(file->remarks().skipped_count, 1U);
    file->rewind();
  }
}

TEST(GcodeDialects, NumbersWithTwoMeaningsAreRejected) {
  const std::string text = "G0 X0 Y0 Z50.\nG1 Z-1.5 F300\nX80\n";
  expect_said(text,
              "part.nc:3: X80: has no point, and Z50. in line 1 has one: it is 80 mm, or 0.08 mm on controls that "
              "count the smallest step (Fanuc, Haas). Write X80. or X0.08");
  EXPECT_EQ(read(text, "part.ngc").assumed.size(), 1U) << "LinuxCNC counts mm";
  EXPECT_EQ(said_of("G0 X0 Y0 Z0\nG1 X8 F60\nX1.5\nX7.250\n"), "") << "zeros are left out";
  expect_said("G20 G0 X0 Y0 Z5.\nG1 X3 F9\n", "it is 3 in, or 0.0003 in on controls");
}

TEST(GcodeDialects, ArcsThatRoundingMakesAreNoted) {
  const std::string start = "G0 X30.000 Y10.000 Z0\n";
  EXPECT_NE(read(start + "G2 X30.000 Y9.999 I5.000 J0.001 F60\n").notes.at(0).find("almost a whole turn"),
            std::string::npos);
  EXPECT_NE(read(start + "G3 X30.001 Y10 I0 J5.000 F60\n").notes.at(0).find("almost nothing"), std::string::npos);
  EXPECT_TRUE(read(start + "G3 X30 Y10 I0 J5.000 F60\n").notes.empty()) << "a whole circle";
  const Program rounded = read("G0 X-1.55 Y-4.76 Z0\nG3 X-1.60 Y-4.79 I-0.03 J0.01 F60\n");
  EXPECT_NE(rounded.notes.at(0).find("few decimals"), std::string::npos);
  expect_said("G0 X-1.55 Y-4.76 Z0\nG3 X-1.600 Y-4.79 I-0.03 J0.01 F60\n", "is by how much the arc's radius");
}

TEST(GcodeDialects, OtherLineEndsAndDeletedBlocks) {
  const Program program = read("G0 X0 Y0 Z0\rG1 X3 F60\rN7 /G1 X9\rY4\r");
  expect_end(program, {3, 4, 0});
  EXPECT_EQ(program.blocks.back().line, 4U);
  EXPECT_EQ(program.skipped.size(), 1U);
  const Program inches = read("//PLATE\nG70\nG0 X1. Y0 Z0\nG1 X2. F12\n");
  expect_end(inches, {50.8, 0, 0});
  EXPECT_EQ(inches.assumed.at(0).key, "G20");
  expect_said("G0 X0 Y0 Z0\nG71 P1 Q2\n", "is a cycle where such words come with it");
}

// Frames and retracts are rewritten with their bytes; positions count from their frame.
TEST(GcodeDialects, RewritesToItself) {
  const std::string text =
      "G21 G90\nS900 M3\nG0 X0 Y0 Z5\nG52 X60 Y3\nG1 X1 Z-1 F60\nG90.1\nG2 X3 I2 J0\nG92 X0\nG1 X5.5\nG91 G28 "
      "Z0.\nG90\n"
      "G0 X9 Y9\nZ2\nG81 X9 Y9 Z-3 R1 F80\nX12\nG80\nG53 G0 Z0\nM30\n";
  const ProgramReading reading;
  const Program program = read_program_text(text, "part.nc", reading);
  EXPECT_EQ(rewrite_program_text(text, "part.nc", reading, program, program).text, text);
  Program wanted = program;
  for (Block& block : wanted.blocks) {
    block.spindle_speed_rad_per_s *= 1.5;
    if (block.kind == Block::Kind::feed) block.duration_s *= 0.5;
  }
  const std::string faster = rewrite_program_text(text, "part.nc", reading, program, wanted).text;
  EXPECT_NE(faster.find("G81 X9 Y9 Z-3 R1 F160\n"), std::string::npos) << faster;
  EXPECT_NE(faster.find("S1350"), std::string::npos);
  EXPECT_NE(faster.find("G53 G0 Z0\n"), std::string::npos);
  wanted = program;
  for (std::size_t i = 0; i < 2; ++i) wanted.blocks[i].end.tip_m.y() += 1e-4;
  const std::string moved = rewrite_program_text(text, "part.nc", reading, program, wanted).text;
  EXPECT_NE(moved.find("Y0.1"), std::string::npos) << moved;
}

// Cut off or changed at any place a program is read or rejected, and what is read is finite.
TEST(GcodeDialects, SurvivesMutations) {
  const std::string good =
      "%\nO1\nG21 G90 G5.1 Q1\nG54\nG0 X0 Y0 Z5.\nG43 H1 Z2.\nG52 X1.\nG1 X1. F60\nM98 P7 L2\nG92 X0\nG83 X3. Y1. Z-3. "
      "R1. Q.5 "
      "P100 F90\nG91 X2. L3\nG80 G90\nG28 G91 Z0\nG53 G0 Z0\nG90 G0 X1. Y1. Z1.\nG10 L2 P1 X1. Y2. Z3.\nG70\nM97 "
      "P9\nM30\n"
      "N9 G0 Z3.\nM99\nO7\nG1 X2. F9\nG82 Z-1. R.5 P.2\nG80 M99\n";
  ASSERT_EQ(said_of(good), "");
  static constexpr std::string_view letters = "GXYZRQPLKHMNOST0123456789.-/%\n\r: ,";
  Random random(71);
  int accepted = 0;
  for (int i = 0; i < test::seeds(40000); ++i) {
    std::string text = good;
    for (std::uint64_t n = 1 + random.index(4); n-- > 0;) {
      text[random.index(text.size())] = letters[random.index(letters.size())];
    }
    if (i % 4 == 0) text.resize(1 + random.index(good.size() - 1));
    try {
      const Program program = read_program_text(text, "part.nc", {.chord_tolerance_m = 1e-4});
      ++accepted;
      for (const Block& block : program.blocks) {
        ASSERT_TRUE(block.end.tip_m.allFinite()) << text;
        ASSERT_TRUE(std::isfinite(block.duration_s) && block.duration_s >= 0.0) << text;
        ASSERT_EQ(block.kind == Block::Kind::feed, block.kind == Block::Kind::feed && block.duration_s > 0.0) << text;
      }
    } catch (const InvalidInput&) {
      continue;
    }
  }
  EXPECT_GT(accepted, 10);
}

}  // namespace gcode_dialects_test
}  // namespace robomill::program
