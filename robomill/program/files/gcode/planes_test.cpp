// Planes that a program turns (G68) or tilts (G68.2, G53.1).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/program/files/gcode/reader.hpp"
#include "robomill/program/files/rewrite.hpp"
#include "testing/program/reading.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace gcode_planes_test {

using Eigen::Vector3d;
using test_support::expect_at;

Program read(const std::string& text, std::optional<Machine> machine = {}) {
  return test_support::read_text<GcodeReader>(text, {.machine = machine});
}

void expect_rejected(const std::string& text, const std::string& words) {
  const std::string said = test::rejection([&] { static_cast<void>(read(text)); });
  EXPECT_NE(said.find(words), std::string::npos) << text << "\n" << said;
}

double time_of(const Program& program) {
  double out = 0.0;
  for (const Block& block : program.blocks) out += block.duration_s;
  return out;
}

/// Rz(i) Rx(j) Rz(k) v, written out.
Vector3d euler(double i_deg, double j_deg, double k_deg, Vector3d v) {
  const auto about_z = [](double deg, const Vector3d& p) {
    const double s = std::sin(deg * units::deg), c = std::cos(deg * units::deg);
    return Vector3d(c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z());
  };
  const double s = std::sin(j_deg * units::deg), c = std::cos(j_deg * units::deg);
  v = about_z(k_deg, v);
  v = Vector3d(v.x(), c * v.y() - s * v.z(), s * v.y() + c * v.z());
  return about_z(i_deg, v);
}

TEST(GcodePlanes, G68TurnsPositionsAboutAPoint) {
  const Program program = read("G0 X0 Y0 Z0\nG68 X10 Y0 R90\nG0 X20 Y0 Z1\nG1 X20 Y5 F60\nG91 X1\nG90 G69\nG1 X0 Y0\n");
  expect_at(program.blocks[0].end, {10, 10, 1});
  expect_at(program.blocks[1].end, {5, 10, 1});
  expect_at(program.blocks[2].end, {5, 11, 1});
  expect_at(program.blocks[3].end, {0, 0, 1});
  EXPECT_NEAR(time_of(program), 5.0 + 1.0 + std::hypot(5.0, 11.0), 1e-9);
  const Program zx = read("G18\nG0 X0 Y0 Z0\nG68 Z0 X0 R90\nG1 Z2 F60\nX3\n");
  expect_at(zx.blocks[0].end, {2, 0, 0});
  expect_at(zx.blocks[1].end, {2, 0, -3});
}

TEST(GcodePlanes, ArcsTurnWithThem) {
  const std::string square = "G1 X10 Y0 F60\nG2 X20 Y10 I0 J10\nG3 X30 Y20 R10\n";
  const Program plain = read("G0 X0 Y0 Z0\n" + square);
  const Program turned = read("G0 X0 Y0 Z0\nG68 X0 Y0 R30\n" + square);
  ASSERT_EQ(plain.blocks.size(), turned.blocks.size());
  for (std::size_t i = 0; i < plain.blocks.size(); ++i) {
    expect_at(turned.blocks[i].end, euler(30, 0, 0, plain.blocks[i].end.tip_m / units::mm));
    EXPECT_NEAR(plain.blocks[i].duration_s, turned.blocks[i].duration_s, 1e-9);
  }
  const Program tilted = read("G0 X0 Y0 Z0\nG68.2 X1 Y2 Z3 I20 J40 K-70\nG90.1 G1 X10 Y0 Z0 F60\nG2 X20 Y10 I10 J10\n");
  const Vector3d center = Vector3d(1, 2, 3) + euler(20, 40, -70, {10, 10, 0});
  for (const Block& block : tilted.blocks) {
    if (block.line < 4) continue;
    EXPECT_NEAR((block.end.tip_m / units::mm - center).norm(), 10.0, 1e-9);
    EXPECT_NEAR((block.end.tip_m / units::mm - center).dot(euler(20, 40, -70, {0, 0, 1})), 0.0, 1e-9);
  }
  expect_at(tilted.blocks.back().end, Vector3d(1, 2, 3) + euler(20, 40, -70, {20, 10, 0}));
}

TEST(GcodePlanes, G53_1TurnsTheToolToTheNormal) {
  const std::string text =
      "G54 G0 X0 Y0 Z100\nG68.2 X10 Y20 Z30 I90 J45 K0\nG53.1\nG0 X0 Y0\nG43 H1 Z50\nG1 Z-2 F120\nX8\nG0 "
      "Z50\nG69\nM30\n";
  const Program program = read(text);
  const Vector3d normal = euler(90, 45, 0, {0, 0, 1});
  const auto at = [&](double x, double y, double z) -> Vector3d {
    return Vector3d(10, 20, 30) + euler(90, 45, 0, {x, y, z});
  };
  ASSERT_GE(program.blocks.size(), 4U);
  EXPECT_EQ(program.start.axis, Vector3d::UnitZ());
  for (const Block& block : program.blocks) {
    EXPECT_TRUE(block.line < 6 || (block.end.axis - normal).norm() < 1e-12) << block.line;
  }
  const std::size_t n = program.blocks.size();
  expect_at(program.blocks[n - 4].end, at(0, 0, 50));
  expect_at(program.blocks[n - 3].end, at(0, 0, -2));
  expect_at(program.blocks[n - 2].end, at(8, 0, -2));
  expect_at(program.blocks[n - 1].end, at(8, 0, 50));
  EXPECT_NEAR(time_of(program), (52.0 + 8.0) / 2.0, 1e-9);
  ASSERT_EQ(program.assumed.size(), 1U);
  EXPECT_EQ(program.assumed[0].what, "The tool's axis after G53.1");
  for (const Machine machine : {Machine::xyzac_trt, Machine::xyzbc_trt, Machine::xyzac_head, Machine::xyzbc_head}) {
    const Program with_machine = read(text, machine);
    EXPECT_TRUE(with_machine.assumed.empty());
    EXPECT_LT((with_machine.blocks.back().end.axis - normal).norm(), 1e-12);
    expect_at(with_machine.blocks.back().end, at(8, 0, 50));
  }
  EXPECT_LT((read("G68.2 X0 Y0 Z0 I0 J30 K0\nG53.1\nG0 X0 Y0 Z0\nG1 X1 F60\n").start.axis -
             Vector3d(0.0, -0.5, 0.5 * std::numbers::sqrt3))
                .norm(),
            1e-12);
}

// A machine's rotary axes stand along the plane from there on.
TEST(GcodePlanes, RotaryWordsGoOnFromThePlane) {
  const std::string text = "G0 X0 Y0 Z100\nG68.2 X0 Y0 Z0 I0 J30 K0\nG53.1\nG0 X0 Y0 Z50\nG69\nG0 X0 Y0 Z100\n";
  const Program back = read(text + "G0 A0 C0\nG1 X1 F60\n", Machine::xyzac_trt);
  EXPECT_EQ(back.blocks.back().end.axis, Vector3d::UnitZ());
  const Program stays = read(text + "G1 X1 F60\n", Machine::xyzac_trt);
  EXPECT_LT((stays.blocks.back().end.axis - euler(0, 30, 0, {0, 0, 1})).norm(), 1e-12);
}

TEST(GcodePlanes, WhereTheToolStandsAfterG53_1IsNotKnown) {
  expect_rejected("G0 X0 Y0 Z9\nG68.2 X0 Y0 Z0 I0 J30 K0\nG53.1\nG1 X1 Y0 Z0 F60\n",
                  "is not known where this line cuts: G53.1 in line 3 left the positions of the program");
  expect_rejected("G0 X0 Y0 Z9\nG68.2 X0 Y0 Z0 I0 J30 K0\nG53.1\nG0 X0 Y0\nG1 Z0 F60\n",
                  "is not known where this line");
  // Without it the tool stays, and its position is known in the plane as well.
  const Program program = read("G0 X0 Y0 Z10\nG68.2 X0 Y0 Z0 I0 J90 K0\nG1 X5 F60\n");
  expect_at(program.blocks[0].end, {5, 0, 10});
  EXPECT_EQ(program.blocks[0].end.axis, Vector3d::UnitZ());
}

TEST(GcodePlanes, AfterARetractAllThreePositionsComeAgain) {
  const std::string retract = "G0 X0 Y0 Z9\nG1 X1 F60\nG91 G28 Z0\nG90\nG68.2 X0 Y0 Z0 I0 J30 K0\nG53.1\nG0 X2 Y3\n";
  expect_at(read(retract + "Z5\nG1 Z0\n").blocks.back().end, euler(0, 30, 0, {2, 3, 0}));
  expect_rejected(retract + "G1 Z0\n", "is not known where this line cuts");
  // About Z, X and Y stay known where Z is not.
  expect_at(read("G0 X0 Y0 Z9\nG1 X1 F60\nG91 G28 Z0\nG90\nG68 X0 Y0 R90\nG0 Z5\nG1 Z0\n").blocks.back().end,
            {1, 0, 0});
}

TEST(GcodePlanes, WhatIsNotReadIsRejected) {
  const std::string tilt = "G0 X0 Y0 Z9\nG68.2 X0 Y0 Z0 I0 J30 K0\n";
  for (const char* line : {"G68.2 X0 Y0 Z0 I0 J0 K0", "G68 X0 Y0 R1"}) {
    expect_rejected(tilt + line + "\n", "comes while G68.2 (line 2) is on. Write G69 before it");
  }
  for (const char* line : {"G55", "G52 X1", "G92 X0", "G10 L2 P1 X0 Y0 Z0"}) {
    expect_rejected(tilt + line + "\n", "changes the work frame while G68.2 (line 2) is on");
  }
  expect_rejected(tilt + "G28 Z50\n", "Write G91 G28 Z0");
  expect_rejected(tilt + "G1 X0 F60\nG81 X1 Y1 Z-1 R1\n", "G81 is not read in a tilted plane");
  for (const char* line : {"G68.2 X0 Y0 Z0", "G68.2 I0 J0 K0", "G68.2 X0 Y0 I0 J0 K0"}) {
    expect_rejected(fmt::format("G0 X0 Y0 Z9\n{}\n", line), "part:2: G = 68.2; needs X, Y, Z, its origin, and I, J, K");
  }
  expect_rejected("G0 X0 Y0 Z9\nG68.2 P1 X0 Y0 Z0 I0 J0 K0\n", "part:2: G = 68.2; is read without P, Q and L");
  expect_rejected("G0 X0 Y0 Z9\nG68.2 X0 Y0 Z0 A-45 C225\n", "part:2: G = 68.2; is not read with A, B and C");
  expect_rejected("G0 X0 Y0 Z9\nG91\nG68 X0 Y0 R3\n", "part:3: G = 68; is not read with steps (G91)");
  for (const char* line : {"G68 X0 R3", "G68 X0 Y0", "G68"}) {
    expect_rejected(fmt::format("G0 X0 Y0 Z9\n{}\n", line), "part:2: G = 68; needs its centre in the plane G17 and R");
  }
  expect_rejected("G0 X0 Y0 Z9\nG68 X0 Y0 Z0 R3\n", "part:2: G = 68; turns in space");
  expect_rejected("G0 X0 Y0 Z9\nG68 X0 Y0 I0 J0 K1 R3\n", "part:2: G = 68; turns in space");
  expect_rejected("G0 X0 Y0 Z9\nG53.1\n", "part:2: G = 53.1; turns the tool to a tilted plane, and none is on");
  expect_rejected("G0 X0 Y0 Z9\nG68 X0 Y0 R5\nG53.1\n", "part:3: G = 53.1; turns the tool to a tilted plane");
}

TEST(GcodePlanes, CyclesAndCornersInATurnedPlane) {
  const Program holes = read("G0 X0 Y0 Z9\nG68 X0 Y0 R90\nG81 X5 Y0 Z-2 R1 F60\nX7\nG80\nG69\nM30\n");
  for (const Block& block : holes.blocks) {
    if (block.kind == Block::Kind::feed) expect_at(block.end, {0, block.line == 3 ? 5.0 : 7.0, -2});
  }
  const Program corner = read("G0 X0 Y0 Z0\nG68.2 X0 Y0 Z0 I0 J90 K0\nG1 X10 ,C2 F60\nY10\nM30\n");
  expect_at(corner.blocks[0].end, {8, 0, 0});
  expect_at(corner.blocks[1].end, {10, 0, 2});
  expect_at(corner.blocks[2].end, {10, 0, 10});
}

TEST(GcodePlanes, SpeedsAndFeedsAreRewritten) {
  const std::string text =
      "S1000 M3\nG0 X0 Y0 Z100\nG68.2 X10 Y20 Z30 I90 J45 K0\nG53.1\nG0 X0 Y0\nZ50\nG1 Z-2 F120\nG2 X8 I4\nG0 "
      "Z50\nG69\n"
      "M30\n";
  const Program program = read_program_text(text, "part.nc");
  Program wanted = program;
  for (Block& block : wanted.blocks) {
    block.spindle_speed_rad_per_s *= 0.5;
    block.duration_s *= 0.5;
  }
  std::string expected = text;
  expected.replace(expected.find("S1000"), 5, "S500").replace(expected.find("F120"), 4, "F240");
  EXPECT_EQ(rewrite_program_text(text, "part.nc", {}, program, wanted).text, expected);
  for (Block& block : wanted.blocks) block.end.tip_m.x() += 1e-3;
  wanted.start.tip_m.x() += 1e-3;
  EXPECT_THROW(static_cast<void>(rewrite_program_text(text, "part.nc", {}, program, wanted)), InvalidInput);
}

TEST(GcodePlanes, AnyEulerAnglesInAnyFrame) {
  for (int seed = 0; seed < test::seeds(300); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const auto some = [&](double most) { return std::round(random.uniform(-most, most) * 1000.0) / 1000.0; };
    const std::array<double, 9> n = {some(50),  some(50), some(50), some(180), some(89),
                                     some(180), some(9),  some(9),  some(9)};
    const Vector3d shift(some(20), some(20), some(20));
    const Program program =
        read(fmt::format("G52 X{} Y{} Z{}\nG0 X0 Y0 Z0\nG68.2 X{} Y{} Z{} I{} J{} K{}\nG53.1\n"
                         "G0 X0 Y0 Z60\nG1 X{} Y{} Z{} F600\n",
                         shift.x(), shift.y(), shift.z(), n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7], n[8]));
    const Vector3d end = shift + Vector3d(n[0], n[1], n[2]) + euler(n[3], n[4], n[5], {n[6], n[7], n[8]});
    expect_at(program.blocks.back().end, end);
    EXPECT_LT((program.blocks.back().end.axis - euler(n[3], n[4], n[5], {0, 0, 1})).norm(), 1e-12);
    EXPECT_NEAR(program.blocks.back().duration_s, (Vector3d(n[6], n[7], n[8] - 60.0)).norm() / 10.0, 1e-9);
  }
}

}  // namespace gcode_planes_test
}  // namespace robomill::program
