#include "robomill/program/files/rewrite.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/program/files/rewrite/rewriter.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace rewrite_test {

using Eigen::Vector3d;

constexpr double mm = 1e-3;

struct Case {
  std::string text;
  ProgramReading reading = {};
  std::string name = "part.ngc";
  Program read = read_program_text(text, name, reading);
  Program wanted = read;

  [[nodiscard]] Rewritten rewrite(const std::vector<std::string>& header = {}) const {
    return rewrite_program_text(text, name, reading, read, wanted, header);
  }
  void feed_of_line(std::size_t line, double factor) {
    for (Block& block : wanted.blocks) {
      if (block.line == line) block.duration_s /= factor;
    }
  }
  void speed_of_lines(std::size_t first, std::size_t last, double rpm) {
    for (Block& block : wanted.blocks) {
      if (block.line >= first && block.line <= last) block.spindle_speed_rad_per_s = rpm * units::rpm;
    }
  }
  /// Moves the ends of lines, and of dwells that stand there.
  void move_lines(std::size_t first, std::size_t last, const Vector3d& by_mm) {
    for (std::size_t i = 0; i < wanted.blocks.size(); ++i) {
      Block& block = wanted.blocks[i];
      if (block.kind == Block::Kind::dwell) block.end.tip_m = wanted.begin_of(i).tip_m;
      if (block.line >= first && block.line <= last && block.kind != Block::Kind::dwell) block.end.tip_m += mm * by_mm;
    }
    keep_feeds();
  }
  /// Times as the feeds read ask for on the wanted ways.
  void keep_feeds() {
    for (std::size_t i = 0; i < wanted.blocks.size(); ++i) {
      Block& block = wanted.blocks[i];
      const double was = (read.blocks[i].end.tip_m - read.begin_of(i).tip_m).norm();
      const double is = (block.end.tip_m - wanted.begin_of(i).tip_m).norm();
      if (block.kind == Block::Kind::feed && was > 0.0 && is > 0.0)
        block.duration_s = read.blocks[i].duration_s * is / was;
    }
  }
  void expect_rejected(const std::string& words) const {
    const std::string said = test::rejection([&] { static_cast<void>(rewrite()); });
    EXPECT_NE(said.find(words), std::string::npos) << text << "\n" << said;
  }
};

TEST(Rewrite, NothingWantedIsNothingChanged) {
  for (const std::string text :
       {"%\n( Impeller )\nM428 ;TCP:xyzac\nG93\nS600 M3\n\nG0  X  16.339  Y -25.409  Z  33.353  A -71.841  C -35.930\n"
        "G1  X   6.302  Y -11.560  Z  27.743  A -71.841  C -35.930  F 318\nG1  X 6.3  Y -12.4  Z  26.178 A-71 C-32 "
        "F159\n"
        "M5\nM30\nG1 X1 Y1 F1 (not carried out)\n",
        "G20 G0 X1 Y2 Z3\r\nG91 G1 X1 F10\r\nG21 X25.4 F254\r\nG90 Z 1",
        "o1234\nn10 g0 x 1 2 . 5 y+.5 z-0.25 (a (comment) ; and more\n/ g1 x99 f1\nN20 G 1 X(why)13 F1 0 0\r\n   "
        "\t\r\n%\n",
        "$PART.MIN%\nG0 X0 Y0 ~\n Z0\nG1 X1 F60 ~  \nY2 ~\n\nG1 X3\n  $ Y4 (Okuma)\n$Z5\nX6 ; a comment ~\nX7\nX8 ~",
        "\xEF\xBB\xBFG0 X0 Y0 Z0\nG91 G2 X10 Y10 I10 F500\nX-10 Y-10 J-10 F100\nG90 G3 X1 Y1 R20\n"}) {
    const Case same = {.text = text, .reading = {.machine = Machine::xyzac_trt}};
    const Rewritten out = same.rewrite();
    EXPECT_EQ(out.text, text);
    EXPECT_EQ(out.changed_lines + out.added_lines + out.first_changed, 0U);
  }
}

TEST(Rewrite, AFeedIsChangedWhereItStandsAndRestoredBehindIt) {
  Case one = {.text = "G0 X0 Y0 Z5\nG1 Z-1 F120 (down)\nX30 Y40\nx10 ; back\nX0\n"};
  one.feed_of_line(3, 0.75);
  EXPECT_EQ(one.rewrite().text, "G0 X0 Y0 Z5\nG1 Z-1 F120 (down)\nX30 Y40 F90\nx10 f120 ; back\nX0\n");
  EXPECT_EQ(one.rewrite().changed_lines, 2U);
  EXPECT_EQ(one.rewrite().first_changed, 3U);
  one.feed_of_line(2, 2.0);
  EXPECT_EQ(one.rewrite().text, "G0 X0 Y0 Z5\nG1 Z-1 F240 (down)\nX30 Y40 F90\nx10 f120 ; back\nX0\n");
  one.feed_of_line(4, 0.75);
  EXPECT_EQ(one.rewrite().text, "G0 X0 Y0 Z5\nG1 Z-1 F240 (down)\nX30 Y40 F90\nx10 ; back\nX0 F120\n");
}

// An F of its own line, or of a rapid move, says the feed of what follows.
TEST(Rewrite, AFeedThatHoldsForLaterMovesIsChangedWhereItStands) {
  Case later = {.text = "F200. (F100)\nG0 X0 Y0 Z0\nG0 X1 F500 ; F100\nG1 X2\nX3\nF 300\nG4 P1\nX4\nX5 F50\n"};
  later.feed_of_line(4, 0.5);
  later.feed_of_line(5, 0.5);
  later.feed_of_line(8, 2.0);
  EXPECT_EQ(later.rewrite().text,
            "F200. (F100)\nG0 X0 Y0 Z0\nG0 X1 F250 ; F100\nG1 X2\nX3\nF 600\nG4 P1\nX4\nX5 F50\n");
}

TEST(Rewrite, FeedsOfEveryKind) {
  Case inverse = {.text = "G93 G0 X0 Y0 Z0\nG1 X1 F 318 (in)\nX2 F159\n"};
  inverse.feed_of_line(2, 0.5);
  EXPECT_EQ(inverse.rewrite().text, "G93 G0 X0 Y0 Z0\nG1 X1 F 159 (in)\nX2 F159\n");
  Case inches = {.text = "G20 G0 X0 Y0 Z0\nG1 X1 F10\nG21 X0\nX1\n"};
  inches.feed_of_line(3, 2.0);
  EXPECT_EQ(inches.rewrite().text, "G20 G0 X0 Y0 Z0\nG1 X1 F10\nG21 X0 F508\nX1 F254\n")
      << "a word counts in the unit of its own line";
  Case degrees = {.text = "G20 G0 X0 Y0 Z0 A0 C0\nG1 A3 C4 F50\nX1\n", .reading = {.machine = Machine::xyzac_trt}};
  degrees.feed_of_line(2, 0.5);
  EXPECT_EQ(degrees.rewrite().text, "G20 G0 X0 Y0 Z0 A0 C0\nG1 A3 C4 F25\nX1 F50\n");
  Case modes = {.text = "G0 X0 Y0 Z0\nG1 X1 F600\nG93 X2 F60\nG94 X3 F600\nX4\n"};
  modes.feed_of_line(3, 3.0);
  modes.feed_of_line(5, 0.1234567);
  EXPECT_EQ(modes.rewrite().text, "G0 X0 Y0 Z0\nG1 X1 F600\nG93 X2 F180\nG94 X3 F600\nX4 F74.07402\n");
}

TEST(Rewrite, SpeedsAreChangedWhereTheyStandOrAdded) {
  Case speeds = {.text = "S4000 M3\nG0 X0 Y0 Z0\nG0 X1\nG1 X2 F60 (S1)\nG4 P1\nX3\nM5\nG0 Z9\nM3 S4000\nG1 Z0\n"};
  speeds.speed_of_lines(3, 4, 3950.0);
  EXPECT_EQ(speeds.rewrite().text,
            "S3950 M3\nG0 X0 Y0 Z0\nG0 X1\nG1 X2 F60 (S1)\nS4000\nG4 P1\nX3\nM5\nG0 Z9\nM3 S4000\nG1 Z0\n")
      << "an S on the line of a dwell may be its revolutions";
  EXPECT_EQ(speeds.rewrite().added_lines, 1U);
  EXPECT_EQ(speeds.rewrite().changed_lines, 1U);
  speeds.speed_of_lines(3, 6, 3950.0);
  EXPECT_EQ(speeds.rewrite().text,
            "S3950 M3\nG0 X0 Y0 Z0\nG0 X1\nG1 X2 F60 (S1)\nG4 P1\nX3\nM5\nG0 Z9\nM3 S4000\nG1 Z0\n")
      << "while the spindle is off its speed does not count";
  speeds.speed_of_lines(6, 6, 1234.56789);
  speeds.speed_of_lines(10, 10, 4100.0);
  EXPECT_EQ(speeds.rewrite().text,
            "S3950 M3\nG0 X0 Y0 Z0\nG0 X1\nG1 X2 F60 (S1)\nG4 P1\nX3 S1234.568\nM5\nG0 Z9\nM3 S4100\nG1 Z0\n");
}

// An S that another one follows at once stays; one on a line with moves is theirs.
TEST(Rewrite, AnSThatHoldsForNothingStays) {
  Case speeds = {.text = "M3 S100\nS200\nG0 X0 Y0 Z0\nG1 X1 F60 S300\nS400\n"};
  speeds.speed_of_lines(4, 4, 350.0);
  EXPECT_EQ(speeds.rewrite().text, "M3 S100\nS200\nG0 X0 Y0 Z0\nG1 X1 F60 S350\nS400\n");
  Case without = {.text = "G0 X0 Y0 Z0\nG1 X1 F60\n"};
  without.speed_of_lines(2, 2, 350.0);
  without.expect_rejected("part.ngc:2: S: cannot be changed where the program has not turned its spindle on");
}

TEST(Rewrite, PositionsAreChangedOrAddedWhereTheyAreNotWritten) {
  Case moved = {.text = "G0 X0 Y0 Z0\nG1 X1. F60\nX2. (two)\nX3. Y1.\n"};
  moved.move_lines(2, 2, {0.0, 0.01, 0.0});
  EXPECT_EQ(moved.rewrite().text, "G0 X0 Y0 Z0\nG1 X1. Y0.01 F60\nX2. Y0. (two)\nX3. Y1.\n");
  moved.move_lines(3, 3, {1.0, 0.0, -0.00254});
  EXPECT_EQ(moved.rewrite().text, "G0 X0 Y0 Z0\nG1 X1. Y0.01 F60\nX3. Y0. Z-0.0025 (two)\nX3. Y1. Z0.\n");
  Case steps = {.text = "G20 G0 X0 Y0 Z0\nG91 G1 Z1 F60\nZ1\nX1\n"};
  steps.move_lines(3, 3, {25.4, 0.0, 2.54});
  EXPECT_EQ(steps.rewrite().text, "G20 G0 X0 Y0 Z0\nG91 G1 Z1 F60\nX1 Z1.1\nX0 Z-0.1\n");
  Case start = {.text = "G0 Z9\nX1 Y1\nG1 Z0 F60\n"};
  start.wanted.start.tip_m.x() += 1e-3;
  start.keep_feeds();
  EXPECT_EQ(start.rewrite().text, "G0 Z9\nX2 Y1\nG1 X1 Z0 F60\n");
  // A position that moves nothing follows what is before it.
  Case again = {.text = "G0 X0 Y0 Z0\nG1 X1 F60\nX1 Y0 M8\nX2\n"};
  again.move_lines(2, 2, {0.5, 0.25, 0.0});
  EXPECT_EQ(again.rewrite().text, "G0 X0 Y0 Z0\nG1 X1.5 Y0.25 F60\nX1.5 Y0.25 M8\nX2 Y0\n");
}

TEST(Rewrite, AnArcMovesAsAWhole) {
  Case arc = {.text =
                  "G0 X0 Y0 Z0\nG1 X10 F60\nG3 X0 Y10 I-10 (round)\nG2 X10 Y0 R10\nG90.1 G3 X0 Y10 I0 J0\nG1 X0 Y0\n"};
  arc.move_lines(2, 5, {0.5, 0.0, -0.125});
  EXPECT_EQ(arc.rewrite().text,
            "G0 X0 Y0 Z0\nG1 X10.5 Z-0.125 F60\nG3 X0.5 Y10 I-10 (round)\nG2 X10.5 Y0 R10\nG90.1 G3 X0.5 Y10 I0.5 J0\n"
            "G1 X0 Y0 Z0\n");
  EXPECT_EQ(arc.rewrite().added_lines, 0U);
  // Whole circles, and steps.
  Case circle = {.text = "G90 G0 X10 Y0 Z1\nG1 Z0 F60\nG2 I-10 X10\nG91 G2 I-10\nG3 X-10 Y10 I-10\n"};
  circle.move_lines(2, 5, {0.1, 0.2, 0.3});
  EXPECT_EQ(circle.rewrite().text,
            "G90 G0 X10 Y0 Z1\nG1 X10.1 Y0.2 Z0.3 F60\nG2 I-10 X10.1\nG91 G2 I-10\nG3 X-10 Y10 I-10\n");
}

TEST(Rewrite, AnArcBecomesItsChordsWhereItsPartsGoElsewhere) {
  Case arc = {.text = "G0 X10 Y0 Z0\nN5 G3 X0 Y10 I-10 F60 M9 (round)\r\nX-10 Y0 J-10\nG1 X0\n",
              .reading = {.chord_tolerance_m = 4e-4}};
  ASSERT_EQ(arc.read.blocks.size(), 7U);
  arc.wanted.blocks[0].end.tip_m.z() += 1e-3;
  arc.keep_feeds();
  const Rewritten out = arc.rewrite();
  EXPECT_EQ(out.text,
            "G0 X10 Y0 Z0\nN5 G1 X8.6603 Y5 Z1 F59.31696 (round)\nG1 X5 Y8.6603 Z0\nG1 X0 Y10 M9\r\n"
            "G3 X-10 Y0 J-10 F60\nG1 X0\n")
      << "chords are shorter than their arc";
  EXPECT_EQ(out.changed_lines, 2U);
  EXPECT_EQ(out.added_lines, 2U);
}

TEST(Rewrite, OneLineAsksForOneFeedAndOneSpeed) {
  Case arc = {.text = "S100 M3\nG0 X10 Y0 Z0\nG3 X0 Y10 I-10 F60\n"};
  arc.wanted.blocks[3].duration_s *= 2.0;
  arc.expect_rejected("part.ngc:3: feed: must be one for all 56 parts of the arc that this line says");
  Case speed = {.text = arc.text};
  speed.wanted.blocks[3].spindle_speed_rad_per_s *= 2.0;
  speed.expect_rejected("part.ngc:3: S: must be one speed for all blocks of this line");
}

TEST(Rewrite, AMoveOfTurningAxesIsSplitWhereItsTipLeavesTheLine) {
  Case turn = {.text = "G0 X0 Y0 Z0 A0 C0\nG1 X4 A20 C30 F60 M5\nG91 X1 A1\nG0 A10 X3\n",
               .reading = {.machine = Machine::xyzac_trt, .axis_tolerance_rad = 1e-3}};
  const std::size_t parts = turn.read.blocks.size();
  ASSERT_GT(parts, 4U);
  turn.wanted.blocks[0].end.tip_m.z() += 1e-4;
  turn.keep_feeds();
  const Rewritten out = turn.rewrite();
  EXPECT_EQ(out.added_lines + 4, static_cast<std::size_t>(std::count(out.text.begin(), out.text.end(), '\n')));
  EXPECT_NE(out.text.find(" C30 M5\nG91"), std::string::npos) << out.text;
}

TEST(Rewrite, AHeaderStandsBehindWhatMustComeFirst) {
  const std::vector<std::string> header = {"Speeds by robomill (0.5 \xC2\xB5m)", "second"};
  const std::string moves = "G0 X0 Y0 Z0\r\nG1 X1 F60\r\n";
  const auto with = [&](const std::string& head) { return Case{.text = head + moves}.rewrite(header).text; };
  const std::string comments = "(Speeds by robomill [0.5 ?m])\r\n(second)\r\n";
  EXPECT_EQ(with(""), comments + moves);
  EXPECT_EQ(with("%\r\n"), "%\r\n" + comments + moves);
  EXPECT_EQ(with("%\r\nO0012 (part)\r\n(more)\r\n"), "%\r\nO0012 (part)\r\n" + comments + "(more)\r\n" + moves);
  EXPECT_EQ(with("\xEF\xBB\xBF(first)\r\n"), "\xEF\xBB\xBF" + comments + "(first)\r\n" + moves);
}

TEST(Rewrite, WordsOverTwoLinesAndCommentsWithinThem) {
  Case odd = {.text = "G0 X0 Y0 Z0\nG1 X1(one)0 F6(six)0 ~\n\nX2 ~\n5\n"};
  odd.feed_of_line(2, 2.0);
  EXPECT_EQ(odd.rewrite().text, "G0 X0 Y0 Z0\nG1 X1(one)0 F120(six) ~\n\nX2 ~\n5 F60\n");
  odd.move_lines(4, 4, {1.0, 0.0, 0.0});
  odd.expect_rejected("part.ngc:4: X: is a word over two lines, which cannot be changed");
}

TEST(Rewrite, RejectsWhatCannotBeWanted) {
  const Case good = {.text = "S9 M3\nG0 X0 Y0 Z0\nG1 X1 F60\nG4 P1\nG0 X2\n"};
  Case bad = good;
  bad.wanted.blocks.pop_back();
  bad.expect_rejected("part.ngc: wanted has 2 blocks where the program has 3");
  bad = good;
  for (Block& block : bad.wanted.blocks) block.end.axis = Vector3d::UnitX();
  bad.expect_rejected("part.ngc:3: tool axis: cannot be said by this program");
  bad = good;
  bad.wanted.blocks[0].coolant.flood = true;
  bad.expect_rejected("part.ngc:3: wanted.blocks[0]: may differ from what was read in speed, time, tip and axis alone");
  bad = good;
  bad.wanted.blocks[0].duration_s = 0.0;
  bad.expect_rejected("part.ngc:3: wanted.blocks[0].duration_s: must be finite and > 0 for a move at feed");
  bad = good;
  bad.wanted.blocks[1].duration_s = 2.0;
  bad.expect_rejected("part.ngc:4: wanted.blocks[1].duration_s: may differ for moves at feed alone");
  bad = good;
  bad.wanted.blocks[0].end.tip_m.x() = std::nan("");
  bad.expect_rejected("part.ngc:3: wanted.blocks[0].end.tip_m: must be finite");
  bad = good;
  bad.wanted.blocks[0].end.tip_m.x() = 2e-3;
  bad.expect_rejected("part.ngc:4: wanted.blocks[1].end.tip_m: must be where the block before it ends");
  bad = good;
  bad.wanted.blocks[2].end.tip_m.x() = 2e3;
  bad.expect_rejected("could not be rewritten: must lie within 1 km");
  bad = good;
  bad.wanted.blocks[0].duration_s = 1e-9;
  bad.expect_rejected("could not be rewritten: is too large for any machine");
  bad = good;
  bad.read.blocks[0].end.tip_m.x() = 2e-3;
  bad.expect_rejected("part.ngc:3: as_read: is not what this file gives");
  bad = good;
  bad.move_lines(3, 3, {-1.0, 0.0, 0.0});
  bad.wanted.blocks[1].end.tip_m = bad.wanted.blocks[0].end.tip_m;
  bad.expect_rejected("part.ngc:3: could not be rewritten: it makes 0 blocks instead of 1");
}

// What the verification compares of a block.
TEST(Rewrite, ABlockThatDiffersIsSeen) {
  const Pose begin;
  Block wanted = {.end = {.tip_m = {0.01, 0.0, 0.0}}, .duration_s = 1.0, .spindle_speed_rad_per_s = 100.0};
  wanted.spindle = Spindle::clockwise;
  const auto says = [&](auto change) {
    Block got = wanted;
    change(got);
    return block_difference(wanted, begin, got, begin);
  };
  EXPECT_EQ(says([](Block&) {}), "");
  EXPECT_EQ(says([](Block& block) { block.end.tip_m.y() = 1e-7; }), "");
  EXPECT_EQ(says([](Block& block) { block.end.tip_m.y() = 3e-7; }),
            "the tip comes to (10, 0.0003, 0) mm, off by 0.0003 mm");
  EXPECT_EQ(says([](Block& block) { block.end.axis = Vector3d(1e-6, 0.0, 1.0).normalized(); }), "the axis is another");
  EXPECT_EQ(says([](Block& block) { block.duration_s = 1.0001; }), "its feed is 599.940006 mm/min instead of 600");
  EXPECT_EQ(says([](Block& block) { block.spindle_speed_rad_per_s = 100.01; }),
            "the spindle's speed is 955.025152 rpm instead of 954.929659");
  EXPECT_EQ(says([](Block& block) { block.kind = Block::Kind::rapid; }), "it is another kind of move");
  EXPECT_EQ(says([](Block& block) { block.coolant.flood = true; }), "spindle, coolant or stop are others");
  EXPECT_EQ(says([](Block& block) { block.spindle = Spindle::off; }), "spindle, coolant or stop are others");
  // Where the axis alone turns, the time counts.
  wanted.end = {.tip_m = Vector3d::Zero(), .axis = Vector3d::UnitX()};
  EXPECT_EQ(says([](Block& block) { block.duration_s = 1.000009; }), "");
  EXPECT_EQ(says([](Block& block) { block.duration_s = 1.0001; }), "it takes 1.0001 s instead of 1");
  wanted.kind = Block::Kind::dwell;
  EXPECT_EQ(says([](Block& block) { block.duration_s = 1.000009; }), "the dwell takes another time");
}

TEST(Rewrite, NumbersAreWrittenWithoutZerosAtTheirEnd) {
  EXPECT_EQ(decimal_text(10.0, 4, false), "10");
  EXPECT_EQ(decimal_text(10.0, 0, true), "10.");
  EXPECT_EQ(decimal_text(-0.00004, 4, true), "0.");
  EXPECT_EQ(decimal_text(-0.05, 4, false), "-0.05");
  EXPECT_EQ(significant_text(3999.9999999999995, false), "4000");
  EXPECT_EQ(significant_text(0.000123456789, false), "0.0001234568");
  EXPECT_EQ(significant_text(12345678.9, true), "12345679.");
  EXPECT_EQ(significant_text(0.0, false), "0");
}

TEST(Rewrite, ReadsAndNamesTheFile) {
  const test::Folder folder;
  const auto path = folder.file("a.nc", "G0 X0 Y0 Z0\nG1 X1 F60\n");
  Program read = read_program(path);
  Program wanted = read;
  wanted.blocks[0].duration_s *= 0.5;
  EXPECT_EQ(rewrite_program(path, {}, read, wanted).text, "G0 X0 Y0 Z0\nG1 X1 F120\n");
}

}  // namespace rewrite_test
}  // namespace robomill::program
