// Corners that a program rounds (,R) or cuts off (,C) between straight moves.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/program/files/gcode/reader.hpp"
#include "robomill/program/files/rewrite.hpp"
#include "testing/program/reading.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace gcode_corners_test {

using test_support::expect_at;
using test_support::sums_of;

Program read(const std::string& text) {
  return test_support::read_text<GcodeReader>(text);
}

void expect_rejected(const std::string& text, const std::string& words) {
  const std::string said = test::rejection([&] { static_cast<void>(read(text)); });
  EXPECT_NE(said.find(words), std::string::npos) << text << "\n" << said;
}

TEST(GcodeCorners, ARightAngleIsRounded) {
  const Program program = read("G0 X0 Y0 Z0\nG1 X50 ,R5 F600\nY40\nX0\nM30\n");
  // 45 + a quarter of a circle of 5 mm + 35 + 50
  const double arc_mm = 0.5 * std::numbers::pi * 5.0;
  EXPECT_NEAR(sums_of(program).way_mm(), 45.0 + arc_mm + 35.0 + 50.0, 1e-3 * arc_mm);
  EXPECT_NEAR(sums_of(program).time_s, (45.0 + arc_mm + 35.0 + 50.0) / 10.0, 1e-9);
  expect_at(program.blocks.front().end, {45, 0, 0});
  expect_at(program.blocks[program.blocks.size() - 2].end, {50, 40, 0});
  for (const Block& block : program.blocks) {
    EXPECT_EQ(block.line, block.end.tip_m.y() < 5.0001e-3 ? 2U : block.end.tip_m.x() > 0.0 ? 3U : 4U);
    if (block.line != 2 || block.end.tip_m.x() < 45.0001e-3) continue;
    EXPECT_NEAR((block.end.tip_m - Eigen::Vector3d(0.045, 0.005, 0.0)).norm(), 0.005, 1e-12);
    EXPECT_GT(block.tip_deviation_m, 0.0);
    EXPECT_LE(block.tip_deviation_m, 1e-6);
  }
}

TEST(GcodeCorners, ARightAngleIsChamfered) {
  const Program program = read("G20\nG0 X0 Y0 Z0\nG1 X2, C0.5 F10\nY-2\n");
  ASSERT_EQ(program.blocks.size(), 3U);
  expect_at(program.blocks[0].end, {38.1, 0, 0});
  expect_at(program.blocks[1].end, {50.8, -12.7, 0});
  expect_at(program.blocks[2].end, {50.8, -50.8, 0});
  EXPECT_NEAR(program.blocks[1].duration_s, 6.0 * 0.5 * std::numbers::sqrt2, 1e-12);
}

// Steps count from the corner that the program says, which the tool does not come to.
TEST(GcodeCorners, StepsAndSeveralCornersInTurn) {
  const Program steps = read("G0 X0 Y0 Z0\nG91 G1 X10 ,C2 F60\nY10 ,R3\nX-10 ,C1\n(a comment)\n\nY-9\nM30\n");
  expect_at(steps.blocks.back().end, {0, 1, 0});
  const double way = 8.0 + 2.0 * std::numbers::sqrt2 + 5.0 + 1.5 * std::numbers::pi + 6.0 + std::numbers::sqrt2 + 8.0;
  EXPECT_NEAR(sums_of(steps).way_mm(), way, 1e-3 * way);
  EXPECT_NEAR(sums_of(steps).time_s, way, 1e-9 * way);
  const Program fits = read("G0 X0 Y0 Z0\nG1 X10 ,C5 F60\nY10 ,C5\nX0\n");
  EXPECT_EQ(fits.blocks.size(), 4U) << "nothing is left of the middle move but its two chamfers";
}

TEST(GcodeCorners, InOtherPlanes) {
  const Program zx = read("G18\nG0 X0 Y3 Z0\nG1 Z-10 ,R2 F60\nX8\n");
  for (const Block& block : zx.blocks) EXPECT_NEAR(block.end.tip_m.y(), 3e-3, 1e-15);
  EXPECT_NEAR(sums_of(zx).time_s, 8.0 + std::numbers::pi + 6.0, 1e-9);
  expect_rejected("G0 X0 Y0 Z0\nG1 X10 ,R2 F60\nY10 Z-1\n", "part:3: ,R: stands between moves in the plane G17 alone");
  expect_rejected("G0 X0 Y0 Z0\nG1 Z-10 ,R2 F60\nX8\n", "part:2: ,R: stands between moves in the plane G17 alone");
}

// The feed, the speed and the coolant are those of the corner's line until its end.
TEST(GcodeCorners, KeepWhatTheirLineSays) {
  const Program program = read("S1000 M3\nG0 X0 Y0 Z0\nG1 X10 ,C2 F60 M8\nY10 F120 S2000 M9\nX0\n");
  ASSERT_EQ(program.blocks.size(), 4U);
  EXPECT_NEAR(program.blocks[0].duration_s, 8.0, 1e-12);
  EXPECT_NEAR(program.blocks[1].duration_s, 2.0 * std::numbers::sqrt2, 1e-12);
  EXPECT_NEAR(program.blocks[2].duration_s, 4.0, 1e-12);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(program.blocks[i].spindle_speed_rad_per_s, (i < 2 ? 1000.0 : 2000.0) * units::rpm, 1e-9) << i;
    EXPECT_EQ(program.blocks[i].coolant.flood, i < 3) << i;
  }
}

TEST(GcodeCorners, WhatTheyCannotStandBesideIsRejected) {
  const std::string begin = "G0 X0 Y0 Z0\nG1 X10 ,R2 F60\n";
  expect_rejected(begin + "G2 X20 I5\n",
                  "part:2: ,R: needs a straight move G1 in the same plane right after it, and line 3");
  for (const char* next : {"G0 Y10", "M30", "M8", "G55 Y10", "G4 P1", "T2 M6", "G18 Y10", "G28 Y0", "G69 Y1"}) {
    expect_rejected(begin + next + "\n", "part:2: ,R: needs a straight move");
  }
  expect_rejected(begin, "part:2: ,R: has no move behind it");
  expect_rejected(begin + "X10\n", "part:3: ,R: stands between moves of which this line's moves nothing");
  expect_rejected(begin + "X0\n", "part:2: ,R: stands where the path turns back");
  expect_rejected(begin + "Y1.9\n", "part:2: ,R: takes 2 mm of each move beside it, and the shorter has 1.9 mm left");
  expect_rejected("G0 X0 Y0 Z0\nG1 X10 ,C6 F60\nY10 ,C6\nX0\n", "part:3: ,C: takes 6 mm of each move beside it");
  expect_rejected("G0 X0 Y0 Z0\nG0 X10 ,R2\nY10\n", "part:2: ,R = 2 mm; is read on a line of a straight move G1 alone");
  expect_rejected("G0 X0 Y0 Z0\nG2 X10 I5 ,R2 F60\nY10\n", "part:2: ,R = 2 mm; is read on a line of a straight move");
  expect_rejected("G0 X0 Y0 Z0\nG93 G1 X10 ,R2 F60\nY10 F60\n", "part:2: ,R = 2 mm; needs a feed per minute");
  expect_rejected("G0 X0 Y0 Z0\nG1 X10 ,R0 F60\nY10\n", "part:2: ,R = 0 mm; must be > 0");
  expect_rejected("G0 X0 Y0 Z0\nG1 X10 ,R2 ,C2 F60\nY10\n", "part:2: ,C = 2; is the second corner of this line");
  expect_rejected("G0 X0 Y0 Z0\nG1 X10 ,A45 F60\nY10\n", "part:2: \",a45f60\"");
  expect_rejected("G0 X0 Y0 Z0\nG1 X10 , F60\n", "part:2: \",f60\"");
  expect_rejected("G0 X0 Y0 Z0\nG1 X10 ,R F60\n", "part:2: \",rf60\": must be a letter and a number");
  expect_rejected("G0 X0 Y0 Z0\nG1 X10 R2 F60\n", "A corner is rounded by ,R with its comma");
  expect_rejected("G0 X0 Y0 Z0\nG1 X10 C2 F60\n", "A corner is cut off by ,C with its comma");
  expect_rejected("G1 X10 Y0 Z0 ,R2 F60\nY10\n", "part:1: ,R = 2 mm; needs a move to its corner");
}

TEST(GcodeCorners, ASpeedAndAFeedAreRewritten) {
  const std::string text = "S1000 M3\nG0 X0 Y0 Z0\nG1 X10 ,R2 F60\nY10\nX0 ,C1\nY0\nG0 Z5\nM30\n";
  const Program program = read_program_text(text, "part.nc");
  Program wanted = program;
  for (Block& block : wanted.blocks) {
    block.spindle_speed_rad_per_s *= 0.5;
    block.duration_s *= 0.5;
  }
  EXPECT_EQ(rewrite_program_text(text, "part.nc", {}, program, wanted).text,
            "S500 M3\nG0 X0 Y0 Z0\nG1 X10 ,R2 F120\nY10\nX0 ,C1\nY0\nG0 Z5\nM30\n");
  for (Block& block : wanted.blocks) block.end.tip_m.x() += 1e-3;
  EXPECT_THROW(static_cast<void>(rewrite_program_text(text, "part.nc", {}, program, wanted)), InvalidInput);
}

// Against the circle that touches both moves, by its defining property: all of it r from a centre that is r from both
// lines.
TEST(GcodeCorners, ARoundedCornerTouchesBothMoves) {
  for (int seed = 0; seed < test::seeds(300); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const auto direction = [&](double angle) { return Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0); };
    const double first = random.uniform(-3.0, 3.0);
    const double turn = random.uniform(0.05, 2.8) * (random.uniform() < 0.5 ? -1.0 : 1.0);
    const double r = random.uniform(0.5, 3.0);
    const double cut = r * std::tan(0.5 * std::abs(turn));
    const Eigen::Vector3d corner = (cut + 5.0) * direction(first);
    const Eigen::Vector3d end = corner + (cut + 7.0) * direction(first + turn);
    const Program program = read(fmt::format("G0 X0 Y0 Z0\nG1 X{:.9f} Y{:.9f} ,R{:.9f} F60\nX{:.9f} Y{:.9f}\n",
                                             corner.x(), corner.y(), r, end.x(), end.y()));
    const double way = 5.0 + r * std::abs(turn) + 7.0;
    EXPECT_NEAR(sums_of(program).time_s, way, 1e-6 * way);
    EXPECT_NEAR(sums_of(program).way_mm(), way, 1e-3 * way);
    const double side = turn > 0.0 ? 1.0 : -1.0;
    const Eigen::Vector3d center = 5.0 * direction(first) + side * r * direction(first + 0.5 * std::numbers::pi);
    for (std::size_t i = 0; i + 1 < program.blocks.size(); ++i) {
      EXPECT_NEAR((program.blocks[i].end.tip_m / units::mm - center).norm(), r, 1e-6);
    }
    EXPECT_LT((program.blocks.back().end.tip_m / units::mm - end).norm(), 1e-8);
  }
}

}  // namespace gcode_corners_test
}  // namespace robomill::program
