// Drilling cycles against their moves as the controls' manuals list them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/program/files/program_files.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace gcode_cycles_test {

using Eigen::Vector3d;

Program read(const std::string& text) {
  return read_program_text(text, "part.nc");
}

const std::string head = "G21 G90 S800 M3\nG0 X0 Y0 Z20\n";

/// "r 10,0,2" a rapid, "f" at feed, "d 0.5" a dwell.
std::vector<std::string> moves_of(const std::string& text) {
  std::vector<std::string> out;
  for (const Block& block : read(head + text).blocks) {
    const Vector3d mm = 1e3 * block.end.tip_m;
    out.push_back(block.kind == Block::Kind::dwell
                      ? fmt::format("d {:g}", block.duration_s)
                      : fmt::format("{} {:g},{:g},{:g}", block.kind == Block::Kind::feed ? 'f' : 'r',
                                    std::round(1e6 * mm.x()) / 1e6, std::round(1e6 * mm.y()) / 1e6,
                                    std::round(1e6 * mm.z()) / 1e6));
  }
  return out;
}

using Moves = std::vector<std::string>;

TEST(GcodeCycles, MakeTheirMoves) {
  EXPECT_EQ(moves_of("G81 X10 Z-5 R2 F60\nY4\nG80\n"), (Moves{"r 10,0,20", "r 10,0,2", "f 10,0,-5", "r 10,0,20",
                                                              "r 10,4,20", "r 10,4,2", "f 10,4,-5", "r 10,4,20"}));
  EXPECT_EQ(moves_of("G99 G82 X10 Z-5 R2 P500 F60\nG98 Y4 P.25\n"),
            (Moves{"r 10,0,20", "r 10,0,2", "f 10,0,-5", "d 0.5", "r 10,0,2", "r 10,4,2", "f 10,4,-5", "d 0.25",
                   "r 10,4,20"}));
  EXPECT_EQ(moves_of("G99 G83 X10 Z-5 R2 Q3 F60\n"),
            (Moves{"r 10,0,20", "r 10,0,2", "f 10,0,-1", "r 10,0,2", "r 10,0,-0.746", "f 10,0,-4", "r 10,0,2",
                   "r 10,0,-3.746", "f 10,0,-5", "r 10,0,2"}));
  EXPECT_EQ(moves_of("G99 G73 X10 Z-4 R2 Q3 F60\n"),
            (Moves{"r 10,0,20", "r 10,0,2", "f 10,0,-1", "r 10,0,-0.746", "f 10,0,-4", "r 10,0,2"}));
  EXPECT_EQ(moves_of("G85 X10 Z-4 R2 F60\n"), (Moves{"r 10,0,20", "r 10,0,2", "f 10,0,-4", "f 10,0,2", "r 10,0,20"}));
  EXPECT_EQ(moves_of("G99 G89 X10 Z-4 R2 P1. F60\n"), (Moves{"r 10,0,20", "r 10,0,2", "f 10,0,-4", "d 1", "f 10,0,2"}));
  EXPECT_EQ(moves_of("G99 G88 X10 Z-4 R2 F60\n"), (Moves{"r 10,0,20", "r 10,0,2", "f 10,0,-4", "d 0", "r 10,0,2"}));
  // Steps count from the initial level, and are repeated.
  EXPECT_EQ(moves_of("G91 G99 G81 X10 Z-7 R-18 F60 K2\n"),
            (Moves{"r 10,0,20", "r 10,0,2", "f 10,0,-5", "r 10,0,2", "r 20,0,2", "f 20,0,-5", "r 20,0,2"}));
  EXPECT_EQ(moves_of("G81 Z-5 R2 F60 L0\nX3\nM8\n"), (Moves{"r 3,0,20", "r 3,0,2", "f 3,0,-5", "r 3,0,20"}));
  // From below R the tool rises first.
  EXPECT_EQ(moves_of("G81 X10 Z-5 R25 F60\n"), (Moves{"r 0,0,25", "r 10,0,25", "f 10,0,-5", "r 10,0,25"}));
  // A code of motion ends a cycle, and G80 stands beside it.
  EXPECT_EQ(moves_of("G81 Z-5 R2 F60\nG0 G80 X9\n").back(), "r 9,0,20");
}

TEST(GcodeCycles, TurnTheSpindleAsTheyTapAndBore) {
  const auto spindles = [](const std::string& text) {
    std::vector<Spindle> out;
    for (const Block& block : read(head + text).blocks) out.push_back(block.spindle);
    return out;
  };
  const Spindle on = Spindle::clockwise, back = Spindle::counterclockwise, off = Spindle::off;
  EXPECT_EQ(spindles("M29 S500\nG84 X1 Z-5 R2 F60\nG0 X0\n"), (std::vector<Spindle>{on, on, on, back, on, on}));
  EXPECT_EQ(spindles("G99 G86 X1 Z-5 R2 F60\nG80\nG0 X0\n"), (std::vector<Spindle>{on, on, on, off, on}));
  EXPECT_EQ(spindles("G99 G86 X1 Z-5 R2 F60\nX2\n"), (std::vector<Spindle>{on, on, on, off, on, on, off}));
}

// Length and time at feed of random holes: each is drilled once, and each peck but the first adds its clearance.
TEST(GcodeCycles, LengthAndTimeAreThoseOfTheHoles) {
  Random random(72);
  for (int i = 0; i < test::seeds(2000); ++i) {
    // In whole micrometres, as they are written: the number of pecks is that of the program's numbers.
    const auto um = [&](double low_mm, double high_mm) { return std::lround(1e3 * random.uniform(low_mm, high_mm)); };
    const long r_um = um(1.0, 4.0), depth_um = um(2.0, 40.0), q_um = um(0.3, 9.0);
    const double r = 1e-3 * static_cast<double>(r_um), depth = 1e-3 * static_cast<double>(depth_um),
                 q = 1e-3 * static_cast<double>(q_um);
    const double feed = random.uniform(20.0, 900.0), dwell = random.uniform(0.1, 2.0);
    const bool pecks = random.index(2) == 0;
    const auto holes = 1 + random.index(9);
    const std::string text =
        head + fmt::format("G{} {} X1 Y1 Z{:.3f} R{:.3f} {}{:.3f} F{:.1f}\nG91 X5 L{}\nG80\n", 98 + random.index(2),
                           pecks ? "G83" : "G82", r - depth, r, pecks ? "Q" : "P", pecks ? q : dwell, feed, holes);
    const Program program = read(text);
    double length_mm = 0.0, time_s = 0.0;
    for (std::size_t k = 0; k < program.blocks.size(); ++k) {
      time_s += program.blocks[k].duration_s;
      if (program.blocks[k].kind == Block::Kind::feed) {
        length_mm += 1e3 * (program.blocks[k].end.tip_m - program.begin_of(k).tip_m).norm();
      }
    }
    const double count = 1.0 + static_cast<double>(holes);
    const double added_mm = pecks ? 0.254 * static_cast<double>((depth_um - 1) / q_um) : 0.0;
    EXPECT_NEAR(length_mm, count * (depth + added_mm), 1e-6) << text;
    const double expected_s = count * (60.0 * length_mm / count / feed + (pecks ? 0.0 : dwell));
    EXPECT_NEAR(time_s, expected_s, 1e-2 * expected_s) << text;
    EXPECT_NEAR(program.blocks.back().end.tip_m.x(), 1e-3 * (1.0 + 5.0 * static_cast<double>(holes)), 1e-6);
  }
}

TEST(GcodeCycles, RejectWithLineAndRemedy) {
  const auto says = [](const std::string& text, const std::string& words) {
    const std::string said = test::rejection([&] { static_cast<void>(read(head + text)); });
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  says("G81 X1 Z-5 F60\n", "part.nc:3: R: G81 needs R: the height that it drills from");
  says("G81 X1 R2 F60\n", "part.nc:3: Z: G81 needs Z: the bottom of the hole");
  says("G83 X1 Z-5 R2 F60\n", "part.nc:3: Q: G83 needs Q > 0: the depth of a peck");
  says("G81 X1 Z-5 R2\n", "F: is missing");
  says("G81 X1 Z5 R2 F60\n", "needs a bottom Z that is not above R");
  says("G18 G81 X1 Z-5 R2 F60\n", "is read in the plane G17 alone");
  says("G83 X1 Z-5 R2 Q1 I1 F60\n", "is not read with I or J");
  says("G93 G81 X1 Z-5 R2 F60\n", "needs a feed per minute");
  says("G81 G0 X1 Z-5 R2 F60\n", "is the second code of motion on this line");
  says("G83 X1 Z-500 R2 Q.001 F60\n", "part.nc:3: Q");
  says("G81 X1 Z-5 R2 F60 L9999\nG83 Q.1 X2 L9999\n", "would make more than 100000 moves of one line");
  says("G87 X1 Z-5 R2 F60\n", "It bores from behind");
}

}  // namespace gcode_cycles_test
}  // namespace robomill::program
