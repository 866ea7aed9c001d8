// Arcs as CAM systems write them, against closed forms.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>

#include "robomill/base/units.hpp"
#include "robomill/program/files/apt_reader.hpp"
#include "testing/program/reading.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace apt_arcs_test {

using Eigen::Vector3d;
using test_support::sums_of;

constexpr double mm = 1e-3;
constexpr double pi = std::numbers::pi;

Program read(const std::string& text) {
  return test_support::read_text<AptReader>(text);
}

void expect_rejected(const std::string& text, const std::string& words) {
  const std::string said = test::rejection([&] { static_cast<void>(read(text)); });
  EXPECT_NE(said.find(words), std::string::npos) << text << "\n" << said;
}

void expect_end(const Program& program, const Vector3d& at_mm) {
  EXPECT_LT((program.blocks.back().end.tip_m - mm * at_mm).norm(), 1e-9);
}

/// Feed length within 0.1 %, time within 1 %.
void expect_way(const Program& program, double feed_mm, double feed_mm_per_min) {
  const test_support::Sums got = sums_of(program);
  EXPECT_NEAR(got.feed_mm, feed_mm, 1e-3 * feed_mm);
  EXPECT_NEAR(got.time_s, 60.0 * feed_mm / feed_mm_per_min, 0.01 * got.time_s);
}

// The blocks of the arc lie on its circle.
void expect_on_circle(const Program& program, const Vector3d& center_mm, const Vector3d& normal, double radius_mm) {
  for (const Block& block : program.blocks) {
    if (block.tip_deviation_m == 0.0) continue;
    const Vector3d way = block.end.tip_m / mm - center_mm;
    EXPECT_NEAR((way - way.dot(normal) * normal).norm(), radius_mm, 1e-5) << block.line;
    EXPECT_LE(block.tip_deviation_m, 1.0001e-6);
  }
}

// Six numbers, counterclockwise about the axis: a lead-in, three quarters of a circle, a whole one.
TEST(AptArcs, SolidWorksCam) {
  const std::string head =
      "PARTNO/1\nUNIT/MM\nINSERT/[HOLDER=A] 10MM END MILL\nCUTTER/10.,0,5.,0,0,0,73.\nLOAD/TOOL,2\nCOOLNT/FLOOD\n"
      "SPINDL/8000,RPM,CLW\nTRNTYP/WORLD,0,0,0\nCSYS/1.,0,0,0,0,1.,0,0,0,0,1.,0\nRAPID/\nGOTO/10.,0,25.\nRAPID/\n"
      "GOTO/10.,0,-1.\nCUTCOM/LEFT\nFEDRAT/600.,MMPM\n";
  const Program left = read(head + "CIRCLE/0,0,-1.,0,0,1.\nGOTO/0,-10.,-1.\nCUTCOM/OFF\nFINI\n");
  expect_way(left, 15.0 * pi, 600.0);
  expect_end(left, {0.0, -10.0, -1.0});
  expect_on_circle(left, {0.0, 0.0, -1.0}, Vector3d::UnitZ(), 10.0);
  ASSERT_EQ(left.assumed.size(), 1U);
  EXPECT_EQ(left.assumed[0].what, "Path under CUTCOM, from line 14 on");
  const Program right = read(head + "CIRCLE/0,0,-1.,0,0,-1.\nGOTO/0,-10.,-1.\n");
  expect_way(right, 5.0 * pi, 600.0);
  const Program whole = read(head + "CIRCLE/0,0,-1.,0,0,1.\nGOTO/10.,0,-1.\nCIRCLE/0,0,-1.,0,0,-1.\nGOTO/10.,0,-1.\n");
  expect_way(whole, 40.0 * pi, 600.0);
  const Program helix = read(head + "CIRCLE/0,0,-1.,0,0,1.\nGOTO/10.,0,-4.\n");
  expect_way(helix, std::hypot(20.0 * pi, 3.0), 600.0);
  expect_end(helix, {10.0, 0.0, -4.0});
  // About X, with the tool along it.
  const Program aside = read(
      "UNIT/MM\nTRNTYP/WORLD,0,0,0\nCSYS/0,0,-1.,0,-1.,0,0,0,0,1.,0,0\nRAPID/\nGOTO/3.,5.,0,-1.,0,0\nFEDRAT/60.,MMPM\n"
      "CIRCLE/3.,0,0,1.,0,0\nGOTO/3.,0,5.,-1.,0,0\n");
  expect_way(aside, 2.5 * pi, 60.0);
  EXPECT_EQ(aside.blocks.back().end.axis, -Vector3d::UnitX());
}

// Eleven numbers, clockwise; TIMES counts whole turns.
TEST(AptArcs, Nx) {
  const std::string head =
      "TOOL PATH/TRIM,TOOL,MILL\nTLDATA/MILL,6.0000,0.0000,75.0000,0.0000,0.0000\n"
      "MSYS/5.1250,4.3250,0.5000,1.0000000,0.0000000,0.0000000,0.0000000,1.0000000,0.0000000\n$$ centerline data\n"
      "PAINT/PATH\nFEDRAT/MMPM,250.0000\nGOTO/-8.0000,2.0000,0.0000,0.0000000,0.0000000,1.0000000\nPAINT/COLOR,31\n";
  const Program corner = read(head +
                              "CIRCLE/-6.0000,2.0000,0.0000,0.0000000,0.0000000,1.0000000,2.0000,0.0600,0.5000,6.0000,"
                              "0.0000\nGOTO/-6.0000,4.0000,0.0000\nEND-OF-PATH\n");
  expect_way(corner, pi, 250.0);
  expect_end(corner, {-6.0, 4.0, 0.0});
  const Program helix = read(head + "CIRCLE/-6,2,0,0,0,1,2,.06,.5,6,0,TIMES,3\nGOTO/-8,2,-1.5\n");
  expect_way(helix, std::hypot(12.0 * pi, 1.5), 250.0);
  expect_rejected(head + "CIRCLE/-6,2,0,0,0,1,2,.06,.5,6,0,TIMES,3\nGOTO/-6,4,-1.5\n", "is read for whole turns alone");
}

// Seven numbers, counterclockwise, with several points of the arc behind them.
TEST(AptArcs, Creo) {
  const std::string head = "UNITS / MM\nRAPID\nGOTO / 10.0, 0.0, 0.0\nFEDRAT / 300.0, MMPM\n";
  const double c = 10.0 * std::cos(pi / 4.0);
  const std::string half = fmt::format("{:.10f}", c);
  const Program points = read(head + "CIRCLE / 0.0, 0.0, 0.0, $\n0.0, 0.0, 1.0, 10.0\nGOTO / " + half + ", " + half +
                              ", 0.0\nGOTO / 0.0, 10.0, 0.0\nGOTO / -10.0, 0.0, 0.0\nGOTO / -20.0, 0.0, 0.0\n");
  expect_way(points, 10.0 * pi + 10.0, 300.0);
  ASSERT_EQ(points.assumed.size(), 1U);
  EXPECT_NE(points.assumed[0].what.find("from line 8 on"), std::string::npos) << points.assumed[0].what;
  expect_rejected(head + "CIRCLE/0,0,0,0,0,-1,10\nGOTO/0,10,0\nGOTO/-10,0,0\nGOTO/0,-10,0\n",
                  "has points that run the other way round");
  expect_rejected(head + "CIRCLE/0,0,0,0,0,1,12\nGOTO/0,10,0\n", "in the statement 12");
}

// Autodesk: the angle tells the sense where the axis does not; ISO: counterclockwise.
TEST(AptArcs, Movarc) {
  const std::string head = "UNITS/MM\nRAPID\nGOTO/10, 0, 0\nFEDRAT/300, MMPM\n";
  const auto arc = [&](const std::string& text) { return sums_of(read(head + text)).feed_mm; };
  EXPECT_NEAR(arc("MOVARC/0, 0, 0, 0, 0, 1, 10, ANGLE, 90\nGOTO/0, 10, 0\n"), 5.0 * pi, 0.01);
  EXPECT_NEAR(arc("MOVARC/0, 0, 0, 0, 0, 1, 10, ANGLE, 270\nGOTO/0, 10, 0\n"), 15.0 * pi, 0.03);
  EXPECT_NEAR(arc("MOVARC/0, 0, 0, 0, 0, -1, 10, ANGLE, 90\nGOTO/0, 10, 0\n"), 5.0 * pi, 0.01);
  EXPECT_NEAR(arc("MOVARC/ CENTER, 0, 0, 0, AXIS, 0, 0, -1, RADIUS, 10\nGOTO/0, 10, 0\n"), 15.0 * pi, 0.03);
  expect_rejected(head + "MOVARC/0,0,0,0,0,1,10,ANGLE,120\nGOTO/0,10,0\n", "does not lead to the position behind it");
}

// The direction at the begin tells the sense; the line ends at the end.
TEST(AptArcs, Catia) {
  const std::string head = "RAPID\nGOTO / 10.00000, 0.00000, 5.00000\nFEDRAT/ 300.0000,MMPM\n";
  const std::string curve =
      "TLON,GOFWD/ (CIRCLE/     0.00000,     0.00000,     5.00000,$\n   10.00000),ON,(LINE/     0.00000,     0.00000,  "
      " "
      "  5.00000,$\n     0.00000,     10.00000,     5.00000)\n";
  const Program left = read(head + "INDIRV/  0.00000,  1.00000,  0.00000\n" + curve);
  expect_way(left, 5.0 * pi, 300.0);
  expect_end(left, {0.0, 10.0, 5.0});
  const Program right = read(head + "INDIRV/  0.00000, -1.00000,  0.00000\n" + curve);
  expect_way(right, 15.0 * pi, 300.0);
  const Program whole =
      read(head + "INDIRV/0,1,0\nTLON,GOFWD/(CIRCLE/0,0,5,10),ON,2,INTOF,(LINE/0,0,5,10,0,5)\nGOTO/0,0,5\n");
  expect_way(whole, 20.0 * pi + 10.0, 300.0);
  const Program aside = read(head + "INDIRV/0,0,1\nTLON,GOFWD/(CIRCLE/CANON,0,0,5,0,1,0,10),ON,(LINE/0,0,5,0,0,15)\n");
  expect_way(aside, 5.0 * pi, 300.0);
  expect_rejected(head + curve, "has no direction before it");
  expect_rejected(head + "INDIRV/1,0,0\n" + curve, "begins across its direction");
  expect_rejected(head + "INDIRV/0,1,0\nTLON,GOFWD/(CIRCLE/0,0,5,10),ON,(PLANE/0,0,1,5)\n", "is not read");
}

// A tool axis that changes along an arc does so evenly.
TEST(AptArcs, TurnsTheAxisEvenly) {
  const Program program = read("GOTO/10,0,0,0,0,1\nFEDRAT/300\nCIRCLE/0,0,0,0,0,1\nGOTO/0,10,0,0,.6,.8\n");
  const double whole_rad = std::atan2(0.6, 0.8);
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    const double share = static_cast<double>(i + 1) / static_cast<double>(program.blocks.size());
    EXPECT_NEAR(angle_between(Vector3d::UnitZ(), program.blocks[i].end.axis), share * whole_rad, 1e-12);
  }
}

TEST(AptArcs, RejectsWhatIsNoArc) {
  const std::string head = "GOTO/10,0,0\nFEDRAT/300\n";
  expect_rejected("FEDRAT/9\nCIRCLE/0,0,0,0,0,1\nGOTO/1,0,0\n", "is an arc from a position that no line has given");
  expect_rejected(head + "CIRCLE/0,0,0,0,0,1\nGOTO/0,10.02,0\n", "part:4: CIRCLE = 10 mm; is the arc's radius");
  expect_rejected(head + "CIRCLE/10,0,0,0,0,1\nGOTO/10,0,0\n", "it has no radius");
  expect_rejected(head + "CIRCLE/0,0,0,0,0,2\nGOTO/0,10,0\n", "must be a vector of length 1");
  expect_rejected(head + "CIRCLE/0,0,0,0,0,1\nCIRCLE/0,0,0,0,0,1\nGOTO/0,10,0\n", "follows another CIRCLE/");
  expect_rejected(head + "CIRCLE/0,0,0,0,0,1,10,.1\nGOTO/0,10,0\n", "has 8 numbers; must have 6, 7 or 11");
  expect_rejected(head + "CIRCLE/P1,0,0,0,0,1\nGOTO/0,10,0\n", "\"P1\"; must be a finite number");
  expect_rejected(head + "1.0, 2.0, 3.0\n", "has numbers without a word");
}

}  // namespace apt_arcs_test
}  // namespace robomill::program
