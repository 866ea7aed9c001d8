#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/program/files/gcode/reader.hpp"
#include "testing/program/reading.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace gcode_arcs_test {

using Eigen::Vector3d;

constexpr double pi = std::numbers::pi;
constexpr double mm = 1e-3;

Program read(const std::string& text, double chord_tolerance_m = 1e-6, std::optional<Machine> machine = {}) {
  return test_support::read_text<GcodeReader>(text, {.machine = machine, .chord_tolerance_m = chord_tolerance_m});
}

void expect_rejected(const std::string& text, const std::string& words, std::optional<Machine> machine = {}) {
  const std::string said = test::rejection([&] { static_cast<void>(read(text, 1e-6, machine)); });
  EXPECT_NE(said.find(words), std::string::npos) << text << "\n" << said;
}

/// Angle about the axis through `center` by which the chords have turned, each less than half a turn.
double turned(const Program& program, const Vector3d& center, const Vector3d& normal) {
  double sum = 0.0;
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    const Vector3d a = program.begin_of(i).tip_m - center;
    const Vector3d b = program.blocks[i].end.tip_m - center;
    const Vector3d a_flat = a - a.dot(normal) * normal;
    const Vector3d b_flat = b - b.dot(normal) * normal;
    sum += std::atan2(a_flat.cross(b_flat).dot(normal), a_flat.dot(b_flat));
  }
  return sum;
}

/// The plane's axes, first to second, and its normal.
struct Plane {
  const char* code;
  int first, second, normal;
};
constexpr std::array<Plane, 3> planes = {{{"G17", 0, 1, 2}, {"G18", 2, 0, 1}, {"G19", 1, 2, 0}}};

// What LinuxCNC's documentation shows of its arcs, worked out by hand.
TEST(GcodeArcs, QuartersAndCirclesGoTheRightWayRound) {
  const Program quarter = read("G0 X10 Y0 Z1\nG3 X0 Y10 I-10 J0 F600\n");
  EXPECT_NEAR(turned(quarter, Vector3d(0.0, 0.0, 1.0 * mm), Vector3d::UnitZ()), 0.5 * pi, 1e-12);
  EXPECT_EQ(quarter.blocks.back().end.tip_m, Vector3d(0.0, 10.0 * mm, 1.0 * mm));
  const Program rest = read("G0 X10 Y0 Z1\nG2 X0 Y10 I-10 F600\n");
  EXPECT_NEAR(turned(rest, Vector3d(0.0, 0.0, 1.0 * mm), Vector3d::UnitZ()), -1.5 * pi, 1e-12);
  const Program circle = read("G0 X10 Y0 Z1\nG2 I-10 F600\n");
  EXPECT_NEAR(turned(circle, Vector3d(0.0, 0.0, 1.0 * mm), Vector3d::UnitZ()), -2.0 * pi, 1e-12);
  EXPECT_EQ(circle.blocks.back().end.tip_m, circle.start.tip_m);
  const Program turns = read("G0 X10 Y0 Z1\nG3 I-10 Z4 P3 F600\n");
  EXPECT_NEAR(turned(turns, Vector3d(0.0, 0.0, 1.0 * mm), Vector3d::UnitZ()), 6.0 * pi, 1e-12);
  const Program half_more = read("G0 X10 Y0 Z1\nG3 X-10 I-10 P2 F600\n");
  EXPECT_NEAR(turned(half_more, Vector3d(0.0, 0.0, 1.0 * mm), Vector3d::UnitZ()), 3.0 * pi, 1e-12);
  // In G18 the plane is ZX: counterclockwise, seen from +Y, goes from Z to X.
  const Program upright = read("G18 G0 X0 Y0 Z10\nG3 X10 Z0 K-10 F600\n");
  EXPECT_NEAR(turned(upright, Vector3d::Zero(), Vector3d::UnitY()), 0.5 * pi, 1e-12);
  const Program side = read("G19 G0 X0 Y10 Z0\nG2 Y0 Z-10 J-10 F600\n");
  EXPECT_NEAR(turned(side, Vector3d::Zero(), Vector3d::UnitX()), -0.5 * pi, 1e-12);
}

// Random arcs and helices in every plane: ends of chords on the arc, no chord further from it than the tolerance, all
// of them equal in length and time, the last end as programmed.
TEST(GcodeArcs, ChordsStandOnTheArcAndNearIt) {
  Random random(21);
  for (int i = 0; i < test::seeds(3000); ++i) {
    const Plane plane = planes[random.index(3)];
    const bool left = random.index(2) == 0;
    const double radius = std::exp(random.uniform(std::log(0.01), std::log(500.0)));  // mm
    const double tolerance_m = std::exp(random.uniform(std::log(1e-8), std::log(1e-4)));
    const double begin = random.uniform(0.0, 2.0 * pi);
    const double sweep = random.index(5) == 0 ? 2.0 * pi : random.uniform(1e-3, 2.0 * pi);
    const double rise = random.index(2) == 0 ? 0.0 : random.uniform(-20.0, 20.0);
    const auto in_space = [&](double x, double y, double z) {
      Vector3d out;
      out[plane.first] = x;
      out[plane.second] = y;
      out[plane.normal] = z;
      return out;
    };
    const Vector3d center = in_space(random.uniform(-50.0, 50.0), random.uniform(-50.0, 50.0), 3.0);
    const auto on_arc = [&](double angle, double height) {
      return Vector3d(center + radius * in_space(std::cos(angle), std::sin(angle), 0.0) + in_space(0.0, 0.0, height));
    };
    const Vector3d from = on_arc(begin, 0.0);
    const Vector3d to = sweep == 2.0 * pi ? on_arc(begin, rise) : on_arc(begin + (left ? sweep : -sweep), rise);
    const Vector3d offset = center - from;
    static constexpr std::array<char, 3> words = {'I', 'J', 'K'};
    const auto word = [](int axis) { return words[static_cast<std::size_t>(axis)]; };
    const std::string text =
        fmt::format("{} G0 X{:.17f} Y{:.17f} Z{:.17f}\nF600 {} X{:.17f} Y{:.17f} Z{:.17f} {}{:.17f} {}{:.17f}\n",
                    plane.code, from.x(), from.y(), from.z(), left ? "G3" : "G2", to.x(), to.y(), to.z(),
                    word(plane.first), offset[plane.first], word(plane.second), offset[plane.second]);
    const Program program = read(text, tolerance_m);
    const Vector3d normal = in_space(0.0, 0.0, 1.0);
    ASSERT_NEAR(turned(program, mm * center, normal), left ? sweep : -sweep, 1e-9) << text;
    const auto count = static_cast<double>(program.blocks.size());
    ASSERT_LT((program.blocks.back().end.tip_m - mm * to).norm(), 1e-15) << text;
    const double length = std::hypot(radius * sweep, rise);
    for (std::size_t k = 0; k < program.blocks.size(); ++k) {
      const Block& block = program.blocks[k];
      const double share = static_cast<double>(k + 1) / count;
      const Vector3d exact = mm * on_arc(begin + (left ? share : -share) * sweep, share * rise);
      ASSERT_LT((block.end.tip_m - exact).norm(), 1e-12) << text;
      // At the same share of time the arc is no further from the chord than the tolerance.
      const double middle = (static_cast<double>(k) + 0.5) / count;
      const Vector3d bow = mm * on_arc(begin + (left ? middle : -middle) * sweep, middle * rise);
      ASSERT_LT((0.5 * (program.begin_of(k).tip_m + block.end.tip_m) - bow).norm(), tolerance_m + 1e-14) << text;
      ASSERT_NEAR(block.duration_s, length / 600.0 * 60.0 / count, 1e-9 * block.duration_s) << text;
    }
    // Not many more chords than that takes.
    const double needed = std::max(sweep * std::sqrt(radius * mm / (8.0 * tolerance_m)), sweep / (0.5 * pi));
    ASSERT_LE(count, std::ceil(1.001 * needed + 0.001)) << text;
  }
}

// The same arc by its radius, by its centre from the begin, and by its absolute centre.
TEST(GcodeArcs, RadiusAndCenterGiveTheSameArc) {
  Random random(22);
  for (int i = 0; i < test::seeds(2000); ++i) {
    const bool left = random.index(2) == 0;
    const bool inches = random.index(2) == 0;
    const double radius = random.uniform(0.5, 80.0);
    const double begin = random.uniform(0.0, 2.0 * pi);
    const double sweep = random.uniform(0.02, 2.0 * pi - 0.02);
    if (std::abs(sweep - pi) < 0.02) continue;
    const double x = random.uniform(-50.0, 50.0);
    const double y = random.uniform(-50.0, 50.0);
    const double end = begin + (left ? sweep : -sweep);
    const std::string head =
        fmt::format("{} G0 X{:.17f} Y{:.17f} Z0\nF600 {} X{:.17f} Y{:.17f} Z1 ", inches ? "G20" : "G21",
                    x + radius * std::cos(begin), y + radius * std::sin(begin), left ? "G3" : "G2",
                    x + radius * std::cos(end), y + radius * std::sin(end));
    const Program by_radius = read(head + fmt::format("R{:.17f}\n", sweep < pi ? radius : -radius));
    const Program by_center =
        read(head + fmt::format("I{:.17f} J{:.17f}\n", -radius * std::cos(begin), -radius * std::sin(begin)));
    const Program absolute = read(head + fmt::format("G90.1 I{:.17f} J{:.17f}\n", x, y));
    ASSERT_EQ(by_center.blocks.size(), absolute.blocks.size());
    ASSERT_NEAR(static_cast<double>(by_radius.blocks.size()), static_cast<double>(by_center.blocks.size()), 1.0);
    ASSERT_NEAR(turned(by_radius,
                       by_radius.start.tip_m +
                           (inches ? 25.4e-3 : mm) * -radius * Vector3d(std::cos(begin), std::sin(begin), 0.0),
                       Vector3d::UnitZ()),
                left ? sweep : -sweep, 1e-9);
    for (std::size_t k = 0; k < by_center.blocks.size(); ++k) {
      ASSERT_LT((by_center.blocks[k].end.tip_m - absolute.blocks[k].end.tip_m).norm(), 1e-12);
      if (by_radius.blocks.size() == by_center.blocks.size()) {
        ASSERT_LT((by_center.blocks[k].end.tip_m - by_radius.blocks[k].end.tip_m).norm(), 1e-11);
      }
    }
  }
}

TEST(GcodeArcs, RotaryAxesTurnEvenly) {
  const Program program = read("G0 X10 Y0 Z0 A20 C0\nG3 I-10 A50 C360 F600\n", 1e-4, Machine::xyzac_trt);
  const auto count = static_cast<double>(program.blocks.size());
  EXPECT_GE(count, 360.0) << "parts that leave the axis by 0.001 deg";
  constexpr double deg = pi / 180.0;
  for (std::size_t k = 0; k < program.blocks.size(); ++k) {
    const double share = static_cast<double>(k + 1) / count;
    const Vector3d axis = tool_axis(Machine::xyzac_trt, (20.0 + 30.0 * share) * deg, 0.0, 360.0 * share * deg);
    ASSERT_LT((program.blocks[k].end.axis - axis).norm(), 1e-12);
  }
  // Without such words the axis stays, also one given as a vector: I and J are the centre here.
  const Program still = read("G0 X10 Y0 Z0 I0.6 J0 K0.8\nG3 X0 Y10 I-10 F600\nG1 X1 I0 J0 K1\n");
  EXPECT_EQ(still.begin_of(still.blocks.size() - 1).axis, still.start.axis);
  EXPECT_LT((still.start.axis - Vector3d(0.6, 0.0, 0.8)).norm(), 1e-15);
  EXPECT_EQ(still.blocks.back().end.axis, Vector3d::UnitZ());
}

TEST(GcodeArcs, InverseTimeIsThatOfTheWholeArc) {
  const Program program = read("G93 G0 X10 Y0 Z0\nG2 X0 Y10 I-10 F30\nX10 Y0 J-10 F60\n");
  double sum = 0.0;
  for (const Block& block : program.blocks) sum += block.duration_s;
  EXPECT_NEAR(sum, 2.0 + 1.0, 1e-12);
  for (const Block& block : program.blocks) EXPECT_TRUE(block.line == 2 || block.line == 3);
  expect_rejected("G93 G0 X10 Y0 Z0\nG2 X0 Y10 I-10 F30\nX10 Y0 J-10\n", "part:3: F: is missing: under G93");
}

TEST(GcodeArcs, StepsBringAnArcBackToItsBegin) {
  const Program program = read("G0 X0.1 Y0.2 Z0.3\nG91 G2 X0 Y0 I0.7 F60\nG3 X.1 Y.1 J.1\nX-.1 Y-.1 J-.1 Z0.5\n");
  double sum = 0.0;
  double whole = 0.0;
  for (const Block& block : program.blocks) {
    sum += block.duration_s;
    if (block.line == 2) whole += block.duration_s;
  }
  EXPECT_NEAR(whole, 2.0 * pi * 0.7, 1e-9);
  EXPECT_NEAR(sum, 2.0 * pi * 0.7 + 0.5 * pi * 0.1 + std::hypot(0.5 * pi * 0.1, 0.5), 1e-9);
  EXPECT_LT((program.blocks.back().end.tip_m - mm * Vector3d(0.1, 0.2, 0.8)).norm(), 1e-16);
}

// Ends rounded to three decimals, as CAM systems write them, leave the circle by a rounding alone.
TEST(GcodeArcs, TakesWhatRoundingMakesOfAnArc) {
  const Program program =
      read("G0 X7.071 Y7.071 Z0\nG3 X-7.071 Y7.0710 I-7.071 J-7.071 F600\nG2 X-7.075 Y-7.071 R10\n");
  for (const Block& block : program.blocks) {
    if (block.line == 2) {
      ASSERT_NEAR(block.end.tip_m.head<2>().norm(), 10.0 * mm, 1e-6);
    }
  }
  // A radius too small by less than the last digit makes half a circle.
  const Program half = read("G0 X0 Y0 Z0\nG3 X20 R9.9999 F600\n");
  EXPECT_NEAR(turned(half, Vector3d(10.0 * mm, 0.0, 0.0), Vector3d::UnitZ()), pi, 1e-12);
}

TEST(GcodeArcs, RejectsWithLineAndByHowMuch) {
  const std::string head = "G0 X0 Y0 Z0 F100\n";
  expect_rejected(head + "G2 X10 Y0 I5.3 J0\n",
                  "part:2: I, J = 0.6 mm; is by how much the arc's radius at its end (4.7) differs from that at its "
                  "begin (5.3); must be <= 0.0053. Centres count from the begin of the arc (G91.1)");
  expect_rejected(head + "G90.1 G2 X10 Y0 I5.3 J0\n", "Centres are absolute (G90.1)");
  expect_rejected(head + "G2 X1200 Y0 I600.3 J0\n", "must be <= 0.5");
  expect_rejected(head + "G20 G2 X1 Y0 I0.501 J0\n", "I, J = 0.002 in; is by how much");
  expect_rejected(head + "G2 X10 R4.9\n",
                  "part:2: R = 4.9 mm; is too small by 0.1 mm: half the distance of the arc's ends is 5 mm");
  expect_rejected(head + "G2 R5\n",
                  "part:2: R = 5 mm; does not define an arc that ends where it begins. Give its centre by I, J");
  expect_rejected(head + "G2 X1 R0\n", "R = 0 mm; must not be 0");
  expect_rejected(head + "G2 X1 R1 I1\n", "R = 1 mm; stands beside I, J or K");
  expect_rejected(head + "G2 X1 R2000000\n", "R: gives an arc a radius above 1 km");
  expect_rejected(head + "G2 X1\n", "part:2: I, J or R: is missing: an arc in the plane G17 needs its centre");
  expect_rejected(head + "G18 G2 X1\n", "K, I or R: is missing: an arc in the plane G18");
  expect_rejected(head + "G2 X1 I0.5 K1\n", "K = 1 mm; lies across the plane G17 of the arc");
  expect_rejected(head + "G90.1 G2 X1 I0.5 J0 K0\n", "K = 0 mm; lies across the plane G17");
  expect_rejected(head + "G90.1 G2 X1 I0.5\n", "I, J: must both be given where centres are absolute");
  expect_rejected(head + "G2 I0 J0\n", "lies where the arc begins or ends: it has no radius");
  expect_rejected(head + "G2 X1 I.5 P0\n", "P = 0; must be a whole number of turns");
  expect_rejected(head + "G2 X1 I.5 P1.5\n", "P = 1.5; must be a whole number of turns");
  expect_rejected(head + "G2 X1 I.5 L2\n", "L: is not read with an arc");
  expect_rejected(head + "G2 X1 I.5 Q2\n", "Q: is not read with an arc");
  expect_rejected(head + "G2 G3 X1 I.5\n", "is the second code of its modal group");
  expect_rejected(head + "G17 G18 G2 X1 I.5\n", "G = 18; is the second code of its modal group");
  expect_rejected(head + "G2 X1 I.5 F0\n", "F = 0 mm/min; must be > 0 for a move at feed");
  expect_rejected(head + "G2 X1 I.5 A3\n", "A = 3 deg; turns an axis of a machine that is not stated");
  expect_rejected(head + "G1 X1 I0 J0 K1\nG2 X2 I.5 A3\n",
                  "A, B, C: stand in a program that gives its axis the other way", Machine::xyzac_trt);
  expect_rejected("G0 X0 Y0 F100\nG2 X1 I.5\n", "part:2: Z: is not known where the first arc begins");
  const std::string said = test::rejection([&] { static_cast<void>(read(head + "G2 X0 I990000 P900\n", 1e-9)); });
  EXPECT_NE(said.find("part:2: I, J: would make a move of "), std::string::npos) << said;
}

}  // namespace gcode_arcs_test
}  // namespace robomill::program
