// Moves at feed and in rapid whose rotary axes turn: along the machine's own curve, or the shortest way.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/program/files/gcode/reader.hpp"
#include "testing/program/reading.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace gcode_rotary_test {

using Eigen::Vector3d;

constexpr double deg = std::numbers::pi / 180.0;

Program read(const std::string& text, Rotary rotary = Rotary::machine, Machine machine = Machine::xyzac_trt) {
  return test_support::read_text<GcodeReader>(text, {.machine = machine, .rotary = rotary});
}

/// Angle about z by which the axis turns along the program, with its sign.
double turned_deg(const Program& program) {
  double sum = 0.0;
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    const Vector3d &a = program.begin_of(i).axis, &b = program.blocks[i].end.axis;
    sum += std::atan2(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y());
  }
  return sum / deg;
}

// On a table C turns the part, so that the tool goes round it the other way.
TEST(GcodeRotary, FullAndLongTurnsGoAsFarAsTheWordsSay) {
  const std::string head = "M428\nG0 X0 Y0 Z0 A30 C0\n";
  EXPECT_NEAR(turned_deg(read(head + "G1 X20 C360 F600\n")), -360.0, 1e-9);
  EXPECT_NEAR(turned_deg(read(head + "G1 X20 C270 F600\n")), -270.0, 1e-9);
  EXPECT_NEAR(turned_deg(read(head + "G1 X20 C-270 F600\n")), 270.0, 1e-9);
  EXPECT_NEAR(turned_deg(read(head + "G0 X20 C-720\n")), 720.0, 1e-9) << "in rapid alike";
  EXPECT_NEAR(turned_deg(read(head + "G1 C360 F600\n")), -360.0, 1e-9) << "where the axis alone turns";
  EXPECT_NEAR(turned_deg(read(head + "G91 G1 X20 C200 F600\nX20 C200\n")), -400.0, 1e-9);
  const Program full = read(head + "G1 X20 C360 F600\n");
  for (const Block& block : full.blocks) {
    EXPECT_EQ(block.line, 3U);
    EXPECT_EQ(block.kind, Block::Kind::feed);
    EXPECT_NEAR(angle_between(block.end.axis, Vector3d::UnitZ()), 30.0 * deg, 1e-12);
  }
  for (const Block& block : read(head + "G0 X20 C360\n").blocks) {
    EXPECT_EQ(block.kind, Block::Kind::rapid);
    EXPECT_EQ(block.duration_s, 0.0);
  }
  // Over the pole, half a turn is as good as any.
  EXPECT_LT((read("M428\nG0 X0 Y0 Z0 A-90\nG0 A90\n").blocks.back().end.axis - Vector3d::UnitY()).norm(), 1e-15);
}

// Of a random move: parts of one time each, their tips on the line, their axes on the machine's curve at the same
// share; between them the axis leaves that curve by no more than its block says, and no more than 0.001 deg.
TEST(GcodeRotary, TipsGoStraightWhileTheAxisFollowsTheMachine) {
  Random random(31);
  static constexpr Machine machines[] = {Machine::xyzac_trt, Machine::xyzbc_trt, Machine::xyzac_head,
                                         Machine::xyzbc_head};
  for (int i = 0; i < test::seeds(1000); ++i) {
    const Machine machine = machines[random.index(4)];
    const bool with_a = machine == Machine::xyzac_trt || machine == Machine::xyzac_head;
    const double tilt_deg = random.uniform(-95.0, 95.0), turn_deg = random.uniform(-400.0, 400.0);
    const double to_tilt_deg = tilt_deg + random.uniform(-20.0, 20.0),
                 to_turn_deg = turn_deg + random.uniform(-400.0, 400.0);
    const bool inverse = random.index(2) == 0;
    const std::string text = fmt::format("{} M128\nG0 X0 Y0 Z0 {}{:.9f} C{:.9f}\nG1 X3 Y-4 Z12 {}{:.9f} C{:.9f} F30\n",
                                         inverse ? "G93" : "G94", with_a ? 'A' : 'B', tilt_deg, turn_deg,
                                         with_a ? 'A' : 'B', to_tilt_deg, to_turn_deg);
    const Program program = read(text, Rotary::machine, machine);
    const auto count = static_cast<double>(program.blocks.size());
    double time_s = 0.0;
    for (std::size_t k = 0; k < program.blocks.size(); ++k) {
      const Block& block = program.blocks[k];
      time_s += block.duration_s;
      ASSERT_NEAR(block.duration_s, (inverse ? 2.0 : 26.0) / count, 1e-9) << text;
      const auto axis_at = [&](double share) {
        const double tilt = (tilt_deg + share * (to_tilt_deg - tilt_deg)) * deg;
        return tool_axis(machine, tilt, tilt, (turn_deg + share * (to_turn_deg - turn_deg)) * deg);
      };
      const double end = static_cast<double>(k + 1) / count;
      ASSERT_LT((block.end.tip_m - 1e-3 * end * Vector3d(3.0, -4.0, 12.0)).norm(), 1e-14) << text;
      ASSERT_LT((block.end.axis - axis_at(end)).norm(), 1e-9) << text;
      const double within = random.uniform();
      const Pose pose = between(program.begin_of(k), block.end, within);
      const double off = angle_between(pose.axis, axis_at((static_cast<double>(k) + within) / count));
      ASSERT_LE(off, block.axis_deviation_rad + 1e-9) << text;
      ASSERT_LE(block.axis_deviation_rad, 1e-3 * deg * (1.0 + 1e-9)) << text;
      ASSERT_EQ(block.tip_deviation_m, 0.0);
    }
    EXPECT_NEAR(time_s, inverse ? 2.0 : 26.0, 1e-9);
  }
}

TEST(GcodeRotary, MovesOfGreatCirclesStayWhole) {
  EXPECT_EQ(read("M128\nG0 X0 Y0 Z0 A0 C40\nG1 X1 A25 F60\n").blocks.size(), 1U) << "a meridian";
  EXPECT_EQ(read("M128\nG0 X0 Y0 Z0 A0 C40\nG1 X1 C400 F60\n").blocks.size(), 1U) << "about the pole";
  EXPECT_TRUE(read("M128\nG0 X0 Y0 Z0 A0 C40\nG1 C400 F60\n").blocks.empty()) << "… the axis stands";
  const Program vectors = read("G0 X0 Y0 Z0 I0.6 J0 K0.8\nG1 X1 I0 J0.6 K0.8 F60\n");
  ASSERT_EQ(vectors.blocks.size(), 1U);
  EXPECT_EQ(vectors.blocks[0].axis_deviation_rad, 0.0);
}

TEST(GcodeRotary, TheShortestWayIsAnOption) {
  const std::string head = "M428\nG0 X0 Y0 Z0 A30 C0\n";
  const Program program = read(head + "G1 X20 C170 F600\nG0 C440\n", Rotary::great_circle);
  ASSERT_EQ(program.blocks.size(), 2U);
  EXPECT_EQ(program.blocks[0].axis_deviation_rad, 0.0);
  const auto said = [&](const std::string& text) {
    return test::rejection([&] { static_cast<void>(read(head + text, Rotary::great_circle)); });
  };
  EXPECT_NE(said("G1 X20 C360 F600\n")
                .find("part:3: C = 360 deg; turns by half a circle or more, which no shortest "
                      "way does. program.rotary = \"machine\" turns"),
            std::string::npos);
  EXPECT_NE(said("G1 X20 C-200 F600\n").find("C = -200 deg; turns by half a circle or more"), std::string::npos);
  EXPECT_NE(said("G0 A-90\nG0 A90\n").find("turns by half a circle in one move"), std::string::npos);
  EXPECT_EQ(read(head + "G0 A0\nG1 X20 C360 F600\n", Rotary::great_circle).blocks.size(), 2U) << "nothing turns";
  EXPECT_EQ(parse_rotary("machine"), Rotary::machine);
  EXPECT_EQ(parse_rotary("great-circle"), Rotary::great_circle);
  EXPECT_EQ(test::field_of([] { static_cast<void>(parse_rotary("straight")); }), "program.rotary");
}

// Chords of an arc say by how much they leave it, too.
TEST(GcodeRotary, PartsOfArcsSayByHowMuchTheyLeaveThem) {
  const Program arc = read("M128\nG0 X10 Y0 Z0 A30 C0\nG3 X0 Y10 I-10 C90 F600\n");
  const auto count = static_cast<double>(arc.blocks.size());
  for (std::size_t k = 0; k < arc.blocks.size(); ++k) {
    const Block& block = arc.blocks[k];
    const Vector3d middle = 0.5 * (arc.begin_of(k).tip_m + block.end.tip_m);
    EXPECT_NEAR(0.01 - middle.norm(), block.tip_deviation_m, 1e-3 * block.tip_deviation_m);
    EXPECT_LE(block.tip_deviation_m, 1e-6);
    const double share = (static_cast<double>(k) + 0.5) / count;
    const Pose pose = between(arc.begin_of(k), block.end, 0.5);
    const Vector3d axis = tool_axis(Machine::xyzac_trt, 30.0 * deg, 0.0, share * 90.0 * deg);
    EXPECT_LE(angle_between(pose.axis, axis), block.axis_deviation_rad + 1e-12);
  }
}

}  // namespace gcode_rotary_test
}  // namespace robomill::program
