// Programs whose tool axes are rewritten, one by one.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/program/files/rewrite.hpp"
#include "robomill/program/files/rewrite/rewriter.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace rewrite_axes_test {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

constexpr double deg = units::deg;

struct Case {
  std::string text;
  ProgramReading reading = {};
  std::string name = "part.ngc";
  Program read = read_program_text(text, name, reading);
  Program wanted = read;

  [[nodiscard]] Rewritten rewrite() const { return rewrite_program_text(text, name, reading, read, wanted); }
  [[nodiscard]] std::string rewritten() const { return rewrite().text; }
  /// Turns the axes at the ends of lines, and of dwells there.
  void turn_lines(std::size_t first, std::size_t last, const AngleAxisd& by) {
    for (std::size_t i = 0; i < wanted.blocks.size(); ++i) {
      Block& block = wanted.blocks[i];
      if (block.line >= first && block.line <= last) block.end.axis = by * block.end.axis;
      if (block.kind == Block::Kind::dwell) block.end.axis = wanted.begin_of(i).axis;
    }
  }
  void expect_rejected(const std::string& words) const {
    const std::string said = test::rejection([&] { static_cast<void>(rewrite()); });
    EXPECT_NE(said.find(words), std::string::npos) << text << "\n" << said;
  }
};

AngleAxisd about_x(double degrees) {
  return {degrees * deg, Vector3d::UnitX()};
}
AngleAxisd about_y(double degrees) {
  return {degrees * deg, Vector3d::UnitY()};
}
AngleAxisd about_z(double degrees) {
  return {degrees * deg, Vector3d::UnitZ()};
}

const ProgramReading trt = {.machine = Machine::xyzac_trt};

// A turn about x by -t is A + t where C is 0, one about z by -t is C + t.
TEST(RewriteAxes, WordsChangeWhereTheyStandAndAreAddedWhereTheyDoNot) {
  Case tilt = {.text = "G0 X0 Y0 Z5 A10. C0. (go)\nG1 Z0 F100\nX10 A20\nX20\nG0 Z5\nG0 X0 A10.\nG1 Z0\n",
               .reading = trt};
  tilt.turn_lines(2, 5, about_x(-5.5));
  // A turn where the tip goes to depth, and back by the words of the second rapid.
  EXPECT_EQ(tilt.rewritten(),
            "G0 X0 Y0 Z5 A10. C0. (go)\nG1 Z0 A15.5 F100\nX10 A25.5\nX20\nG0 Z5\nG0 X0 A10.\nG1 Z0\n");
  tilt.wanted.start.axis = about_x(-5.5) * tilt.wanted.start.axis;
  EXPECT_EQ(tilt.rewritten(), "G0 X0 Y0 Z5 A15.5 C0. (go)\nG1 Z0 F100\nX10 A25.5\nX20\nG0 Z5\nG0 X0 A10.\nG1 Z0\n");
  EXPECT_EQ(tilt.rewrite().added_lines, 0U);
  Case turn = {.text = "G0 X0 Y0 Z5 A30\nG0 X1\nG1 Z0 F100\nG4 P1\nX10\nG0 Z5\nX0\n", .reading = trt};
  turn.turn_lines(2, 6, about_z(-20.0));
  EXPECT_EQ(turn.rewritten(), "G0 X0 Y0 Z5 A30\nG0 X1 C20\nG1 Z0 F100\nG4 P1\nX10\nG0 Z5\nX0 C0\n");
  Case small = {.text = "g0 x0 y0 z5 a30 c350\ng1 z0 f100\ng0z5\n", .reading = trt};
  small.turn_lines(2, 3, about_z(-20.0 - 1e-5));
  EXPECT_EQ(small.read.blocks.size(), 2U);
  EXPECT_EQ(small.rewritten().substr(0, 21), "g0 x0 y0 z5 a30 c350\n");
  EXPECT_NE(small.rewritten().find(" c370.00001"), std::string::npos) << "C goes on, it does not unwind";
}

TEST(RewriteAxes, StepsCountFromWhereTheAxesStand) {
  Case steps = {.text = "G0 X0 Y0 Z5 A10 C0\nG91 G0 A5\nG1 Z-5 F100\nX10 A5\nG0 Z5\nA-10\nG90 G1 X0\n", .reading = trt};
  steps.turn_lines(2, 5, about_x(-2.5));
  EXPECT_EQ(steps.rewritten(), "G0 X0 Y0 Z5 A10 C0\nG91 G0 A7.5\nG1 Z-5 F100\nX10 A5\nG0 Z5\nA-12.5\nG90 G1 X0\n");
}

TEST(RewriteAxes, EveryMachineHasItsLetters) {
  const std::string text = "G0 X0 Y0 Z5\nG1 Z0 F100\n";
  const Vector3d axis = about_y(20.0) * Vector3d::UnitZ();
  const auto at = [&](Machine machine) {
    Case one = {.text = text, .reading = {.machine = machine}};
    one.wanted.start.axis = one.wanted.blocks[0].end.axis = axis;
    return one.rewritten();
  };
  EXPECT_EQ(at(Machine::xyzac_trt), "G0 X0 Y0 Z5 A20 C90\nG1 Z0 F100\n");
  EXPECT_EQ(at(Machine::xyzac_head), "G0 X0 Y0 Z5 A20 C90\nG1 Z0 F100\n");
  EXPECT_EQ(at(Machine::xyzbc_trt), "G0 X0 Y0 Z5 B-20\nG1 Z0 F100\n");
  EXPECT_EQ(at(Machine::xyzbc_head), "G0 X0 Y0 Z5 B20\nG1 Z0 F100\n");
}

// A line of a great circle that even turns of A and C would leave has lines between, at one feed.
TEST(RewriteAxes, AMoveThatAMachineWouldLeaveIsSaidInPieces) {
  Case lean = {.text = "G0 X0 Y0 Z0 A10 C0\nG1 X9 A16 F90 M9 (on)\nX10 F60\n", .reading = trt};
  lean.wanted.start.axis = about_y(10.0) * lean.wanted.start.axis;
  lean.turn_lines(2, 3, about_y(10.0));
  const Rewritten out = lean.rewrite();
  EXPECT_GT(out.added_lines, 2U);
  EXPECT_LT(out.added_lines, 20U);
  EXPECT_EQ(out.changed_lines, 2U);
  EXPECT_NE(out.text.find(" F90 (on)\nG1 X"), std::string::npos) << out.text;
  EXPECT_NE(out.text.find(" M9\nX10 F60\n"), std::string::npos) << out.text;
  const Program got = read_program_text(out.text, "part.ngc", trt);
  ASSERT_EQ(got.blocks.size(), lean.read.blocks.size() + out.added_lines);
  for (std::size_t i = 0; i < out.added_lines + 1; ++i) {
    const double share = got.blocks[i].end.tip_m.x() / 9e-3;
    const Pose at = between(lean.wanted.start, lean.wanted.blocks[0].end, share);
    EXPECT_LT(angle_between(got.blocks[i].end.axis, at.axis), 1e-6) << "the knots lie on the great circle";
    EXPECT_LE(got.blocks[i].axis_deviation_rad, trt.axis_tolerance_rad);
  }
  // As it is read: a great circle is one line.
  Case straight = {.text = lean.text, .reading = {.machine = Machine::xyzac_trt, .rotary = Rotary::great_circle}};
  straight.wanted.start.axis = about_y(10.0) * straight.wanted.start.axis;
  straight.turn_lines(2, 3, about_y(10.0));
  EXPECT_EQ(straight.rewrite().added_lines, 0U);
}

// Rapids turn as the machine turns; they stay one line and come back as several blocks.
TEST(RewriteAxes, ARapidStaysOneLine) {
  Case rapid = {.text = "G0 X0 Y0 Z0 A20 C0\nG0 X10\nG1 X11 F60\n", .reading = trt};
  rapid.turn_lines(2, 3, about_y(25.0));
  const Rewritten out = rapid.rewrite();
  EXPECT_EQ(out.added_lines, 0U);
  const Program got = read_program_text(out.text, "part.ngc", trt);
  EXPECT_GT(got.blocks.size(), rapid.read.blocks.size());
  EXPECT_EQ(got.blocks.back().kind, Block::Kind::feed);
  EXPECT_LT((got.blocks.back().end.axis - rapid.wanted.blocks.back().end.axis).norm(), 1e-7);
}

// Straight through the pole A changes its sign and C stands.
TEST(RewriteAxes, ThePoleIsPassedByTheTilt) {
  for (const double off_deg : {0.0, 1e-9, 1e-6, 1e-4, 0.01, 1.0}) {
    Case pole = {.text = "G0 X0 Y0 Z0 A-20 C30\nG1 X9 A-12 F60\nX18 A-6\nX27 A-20\n", .reading = trt};
    const AngleAxisd back = about_z(-30.0), lean = about_x(-12.0);
    const auto leaned = [&](const Vector3d& axis) {
      return Vector3d(back * (about_y(off_deg) * (lean * (back.inverse() * axis))));
    };
    pole.wanted.start.axis = leaned(pole.read.start.axis);
    for (Block& block : pole.wanted.blocks) block.end.axis = leaned(block.end.axis);
    for (Vector3d* axis : {&pole.wanted.start.axis, &pole.wanted.blocks[0].end.axis}) axis->normalize();
    const Rewritten out = pole.rewrite();
    if (off_deg <= 1e-6) {
      EXPECT_EQ(out.added_lines, 0U) << off_deg << "\n" << out.text;
    } else {
      EXPECT_GT(out.added_lines, 0U) << off_deg << "\n" << out.text;
      EXPECT_LT(out.added_lines, 200U) << off_deg << "\n" << out.text;
    }
    if (off_deg == 0.0) {
      EXPECT_EQ(out.text, "G0 X0 Y0 Z0 A-8 C30\nG1 X9 A0 F60\nX18 A6\nX27 A-8\n");
    }
  }
  // Out of the pole in another direction: C must turn where the tilt is none, so that one short line does.
  Case out_of = {.text = "G0 X0 Y0 Z0 A0 C0\nG1 X9 A5 F60\n", .reading = trt};
  out_of.wanted.blocks[0].end.axis = about_z(-70.0) * out_of.read.blocks[0].end.axis;
  const Rewritten out = out_of.rewrite();
  EXPECT_GT(out.added_lines, 0U);
  EXPECT_LT(out.added_lines, 5U) << out.text;
}

TEST(RewriteAxes, FeedsWhereTheTipStandsCountTheTurnOfTheWords) {
  Case still = {.text = "G0 X0 Y0 Z0 A10 C0\nG1 A14 F60\nX1\n",
                .reading = {.machine = Machine::xyzac_trt, .rotary = Rotary::great_circle}};
  still.wanted.start.axis = about_z(-40.0) * still.wanted.start.axis;
  still.wanted.blocks[0].end.axis = about_z(-40.0) * about_x(-4.0) * still.read.blocks[0].end.axis;
  still.wanted.blocks[1].end.axis = still.wanted.blocks[0].end.axis;
  EXPECT_EQ(still.rewritten(), "G0 X0 Y0 Z0 A10 C40\nG1 A18 F120\nX1 F60\n") << "twice as far in the same time";
  // A tip that stood moves, and one that moved stands.
  Case moved = still;
  moved.wanted = moved.read;
  moved.wanted.blocks[0].end.tip_m.y() = 2e-3;
  moved.wanted.blocks[1].end.tip_m.y() = 2e-3;
  EXPECT_EQ(moved.rewritten(), "G0 X0 Y0 Z0 A10 C0\nG1 Y2 A14 F30\nX1 F60\n");
  moved.wanted = moved.read;
  moved.wanted.blocks[1].end = {.tip_m = Vector3d::Zero(), .axis = about_x(-2.0) * moved.read.blocks[0].end.axis};
  EXPECT_EQ(moved.rewritten(), "G0 X0 Y0 Z0 A10 C0\nG1 A14 F60\nX0 A16 F120\n");
  Case inverse = {.text = "G93 G0 X0 Y0 Z0 A10 C0\nG1 A14 F60\nX1 F30\n", .reading = still.reading};
  inverse.turn_lines(2, 3, about_x(-4.0));
  EXPECT_EQ(inverse.rewritten(), "G93 G0 X0 Y0 Z0 A10 C0\nG1 A18 F60\nX1 F30\n");
}

TEST(RewriteAxes, VectorsOfGcode) {
  Case vector = {.text = "G0 X0 Y0 Z0 I0 J0 K1\nG1 X9 I.6 J0 K.8 F60 (n)\nX10\nX10 I.6 J0 K0.8\nG2 X12 I1\nG0 X0\n"};
  vector.turn_lines(2, 5, about_z(90.0));
  EXPECT_EQ(vector.rewritten(),
            "G0 X0 Y0 Z0 I0 J0 K1\nG1 X9 I0 J0.6 K0.8 F60 (n)\nX10\nX10 I0 J0.6 K0.8\nG2 X12 I1\nG0 X0 I0.6 J0 K0.8\n");
}

const std::string apt =
    "MULTAX/ON\nGOTO/0,0,5,0,0,1\nFEDRAT/60\nGOTO/0,0,0 $$ down\nGOTO/9,0,0,$\n0.6,0,.8\nGOTO/9,0,0,.6,0,.8\nRAPID\n"
    "gODLTA/5\nGODLTA/0,-3,4\nFINI\n";

TEST(RewriteAxes, AptAndCsv) {
  Case part = {.text = apt, .name = "part.apt"};
  ASSERT_EQ(part.read.blocks.size(), 4U);
  part.turn_lines(4, 10, about_z(90.0));
  part.wanted.blocks[2].end.tip_m = {9e-3, 3e-3, 4e-3};
  part.wanted.blocks[3].end.tip_m = {9e-3, 0.0, 8e-3};
  EXPECT_EQ(
      part.rewritten(),
      "MULTAX/ON\nGOTO/0,0,5,0,0,1\nFEDRAT/60\nGOTO/0,0,0 $$ down\nGOTO/9,0,0,$\n0,0.6,0.8\nGOTO/9,0,0,0,0.6,0.8\n"
      "RAPID\ngODLTA/5\nGODLTA/0,-3,4\nFINI\n");
  part.turn_lines(9, 10, about_z(-90.0));
  EXPECT_EQ(
      part.rewritten(),
      "MULTAX/ON\nGOTO/0,0,5,0,0,1\nFEDRAT/60\nGOTO/0,0,0 $$ down\nGOTO/9,0,0,$\n0,0.6,0.8\nGOTO/9,0,0,0,0.6,0.8\n"
      "RAPID\ngoto/9,3,4,0.6,0,0.8\nGODLTA/0,-3,4\nFINI\n");
  part.wanted = part.read;
  part.wanted.blocks[0].end.axis = {0.6, 0.0, 0.8};
  EXPECT_NE(part.rewritten().find("GOTO/0,0,0,0.6,0,0.8 $$ down\n"), std::string::npos);

  Case rows = {.text = "k;x_mm;y_mm;z_mm;i;j;feed_mm_per_min\n1;0;0;0;0;0;\n0,8;9;0;0;0,6;0;60\n0,8;9;0;0;0,6;0;60\n",
               .name = "part.csv"};
  rows.wanted.blocks[0].end.axis = about_z(30.0) * rows.read.blocks[0].end.axis;
  EXPECT_EQ(rows.rewritten(),
            "k;x_mm;y_mm;z_mm;i;j;feed_mm_per_min\n1;0;0;0;0;0;\n0,8;9;0;0;0,51961524;0,3;60\n"
            "0,8;9;0;0;0,51961524;0,3;60\n");
}

TEST(RewriteAxes, RejectsWhatADialectCannotSay) {
  Case plain = {.text = "G0 X0 Y0 Z0\nG1 X1 F60\n"};
  plain.wanted.blocks[0].end.axis = Vector3d::UnitX();
  plain.expect_rejected(
      "part.ngc:2: tool axis: cannot be said by this program: it turns no axis, and without "
      "program.machine A, B and C have no meaning. Give program.machine");
  Case arc = {.text = "G0 X0 Y0 Z0\nG2 X1 I.5 F60\n"};
  arc.turn_lines(2, 2, about_x(5.0));
  arc.expect_rejected("part.ngc:2: tool axis: cannot be said by this program");
  Case start = {.text = "N1 (s)\nG0 X0 Y0 Z0\nG1 X1 F60\n"};
  start.wanted.start.axis = start.wanted.blocks[0].end.axis = Vector3d::UnitX();
  start.expect_rejected("part.ngc:2: tool axis: cannot be said");
  Case three = {.text = "GOTO/0,0,0\nFEDRAT/60\nGOTO/1,0,0\nGODLTA/1\n", .name = "part.apt"};
  three.turn_lines(3, 3, about_x(5.0));
  three.expect_rejected(
      "part.apt:3: GOTO: cannot say a tool axis: the program has no MULTAX, and no position with its "
      "axis. Let the CAM system write the program for five axes, with MULTAX/ON");
  three.wanted = three.read;
  three.turn_lines(4, 4, about_x(5.0));
  three.expect_rejected("part.apt:4: GODLTA: cannot say a tool axis");
  Case off = {.text = "MULTAX/OFF\nGOTO/0,0,0\nFEDRAT/60\nGOTO/1,0,0\n", .name = "part.apt"};
  off.turn_lines(4, 4, about_x(5.0));
  off.expect_rejected("part.apt:4: GOTO: cannot say a tool axis: MULTAX is off here");
}

TEST(RewriteAxes, RejectsAxesThatNoneCanWant) {
  const Case good = {.text = "G0 X0 Y0 Z0 A10 C0\nG1 X1 F60\nG4 P1\nX2 A20\n", .reading = trt};
  Case bad = good;
  bad.wanted.blocks[0].end.axis *= 1.00001;
  bad.expect_rejected("part.ngc:2: wanted.blocks[0].end.axis: must be a vector of length 1");
  bad = good;
  bad.wanted.start.axis.x() = std::numeric_limits<double>::quiet_NaN();
  bad.expect_rejected("wanted.start.axis: must be a vector of length 1");
  bad = good;
  bad.wanted.blocks[1].end.axis = Vector3d::UnitX();
  bad.expect_rejected("part.ngc:3: wanted.blocks[1].end.axis: must be where the block before it ends");
  bad = good;
  bad.wanted.blocks.back().end.axis = -bad.wanted.blocks[1].end.axis;
  bad.expect_rejected(
      "part.ngc:4: wanted.blocks[2].end.axis: must be less than half a circle from where the block begins");
  // A line that only turns, and is to turn no more.
  Case turn = {.text = "G0 X0 Y0 Z0 A10 C0\nG1 A12 F60\nX1\n", .reading = trt};
  turn.turn_lines(2, 3, about_x(2.0));
  turn.expect_rejected("part.ngc:2: could not be rewritten: it makes 0 blocks instead of 1");
  // Positions that would become the machine's.
  Case machine = {.text = "M429\nG0 X0 Y0 Z0\nG1 X1 F60\n", .reading = trt};
  machine.turn_lines(3, 3, about_x(2.0));
  machine.expect_rejected("could not be rewritten: turns the tool centre point off");
}

// What the verification lets come back in other parts.
TEST(RewriteAxes, PartsOfAMoveAreItsOwn) {
  const Pose begin;
  Block whole = {.end = {.tip_m = {0.01, 0.0, 0.0}, .axis = about_x(10.0) * Vector3d::UnitZ()}, .duration_s = 1.0};
  std::vector<Block> parts(4, whole);
  for (std::size_t i = 0; i < 4; ++i) {
    parts[i].end = between(begin, whole.end, 0.25 * static_cast<double>(i + 1));
    parts[i].duration_s = 0.25;
  }
  const auto says = [&](auto change) {
    std::vector<Block> got = parts;
    change(got);
    return blocks_difference({&whole, 1}, begin, got, begin, 1e-5);
  };
  using Blocks = std::vector<Block>;
  EXPECT_EQ(says([](Blocks&) {}), "");
  EXPECT_EQ(says([](Blocks& got) { got[1].end.axis = about_x(5.0005) * Vector3d::UnitZ(); }), "");
  EXPECT_NE(says([](Blocks& got) { got[1].end.axis = about_x(5.001) * Vector3d::UnitZ(); }), "");
  EXPECT_NE(says([](Blocks& got) { got[1].end.tip_m.y() = 3e-7; }), "");
  EXPECT_NE(says([](Blocks& got) { got[1].duration_s = 0.26; }), "");
  EXPECT_NE(says([](Blocks& got) { got[2].kind = Block::Kind::rapid; }), "");
  EXPECT_NE(says([](Blocks& got) { got[2].coolant.flood = true; }), "");
  EXPECT_NE(says([](Blocks& got) { got.pop_back(); }), "");
  EXPECT_NE(says([](Blocks& got) { got.push_back(got.back()); }), "");
  EXPECT_NE(says([](Blocks& got) {
              for (Block& block : got) block.duration_s *= 1.001;
            }),
            "")
      << "its feed counts";
  // The axis of a rapid goes between as the machine turns; its tip goes the wanted way, to the wanted end.
  whole.kind = Block::Kind::rapid;
  for (Block& part : parts) part.kind = Block::Kind::rapid;
  EXPECT_EQ(says([](Blocks&) {}), "");
  EXPECT_EQ(says([](Blocks& got) { got[1].end.axis = Vector3d::UnitY(); }), "");
  EXPECT_NE(says([](Blocks& got) { got[3].end.axis = Vector3d::UnitY(); }), "");
  EXPECT_NE(says([](Blocks& got) { got[1].end.tip_m.y() = 3e-7; }), "");
  EXPECT_NE(says([](Blocks& got) { got[1].kind = Block::Kind::feed; }), "");
  EXPECT_NE(says([](Blocks& got) { got.pop_back(); }), "");
}

}  // namespace rewrite_axes_test
}  // namespace robomill::program
