// Programs with several work frames, whose offsets the reading or the program's G10 L2 gives.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/program/files/program_files.hpp"
#include "robomill/program/files/rewrite.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace work_frames_test {

using Eigen::Vector3d;
using Frames = std::vector<WorkFrame>;

WorkFrame frame(std::string code, double x_mm, double y_mm, double z_mm) {
  return {.code = std::move(code), .origin_m = units::mm * Vector3d(x_mm, y_mm, z_mm)};
}

const Frames table = {frame("G54", 100, 200, 300), frame("G55", 150, 190, 305), frame("G54.1 P3", -20, 0, 310)};

Program read(const std::string& text, const Frames& frames, std::optional<int> tool = {}) {
  return read_program_text(text, "part.nc", {.tool = {.number = tool}, .frames = frames});
}

void expect_said(const std::string& text, const Frames& frames, const std::string& words) {
  const std::string said = test::rejection([&] { static_cast<void>(read(text, frames)); });
  EXPECT_EQ(said.substr(0, words.size()), words) << said;
}

void expect_tips(const Program& program, const std::vector<Vector3d>& tips_mm) {
  ASSERT_EQ(program.blocks.size(), tips_mm.size());
  for (std::size_t i = 0; i < tips_mm.size(); ++i) {
    EXPECT_LT((program.blocks[i].end.tip_m - units::mm * tips_mm[i]).norm(), 1e-12)
        << i << ": " << program.blocks[i].end.tip_m.transpose();
  }
}

void expect_same(const Program& got, const Program& expected) {
  EXPECT_EQ(got.start.tip_m, expected.start.tip_m);
  ASSERT_EQ(got.blocks.size(), expected.blocks.size());
  for (std::size_t i = 0; i < got.blocks.size(); ++i) {
    EXPECT_EQ(got.blocks[i].end.tip_m, expected.blocks[i].end.tip_m) << i;
    EXPECT_EQ(got.blocks[i].duration_s, expected.blocks[i].duration_s) << i;
    EXPECT_EQ(got.blocks[i].line, expected.blocks[i].line) << i;
  }
}

TEST(WorkFrames, CodesNameThem) {
  std::set<int> known;
  for (const char* code : {"G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3", "G54.1 P1", "G54.1 P2",
                           "G154 P20", "G54.1 P300"}) {
    EXPECT_TRUE(known.insert(parse_work_frame(code)).second) << code;
  }
  EXPECT_EQ(parse_work_frame("G110"), parse_work_frame("G154 P1"));
  EXPECT_EQ(parse_work_frame("G129"), parse_work_frame("g154p20"));
  EXPECT_EQ(parse_work_frame("G154 P3"), parse_work_frame("G54.1 P3"));
  EXPECT_EQ(parse_work_frame("G54 P3"), parse_work_frame("G54.1 P3")) << "as a line of a program";
  for (const char* code :
       {"",        "G53",    "54",       "G54.2",      "G54.1",  "G154",     "G55 P1",     "G55.1",
        "G59.4",   "G60",    "G109",     "G110.5",     "G130",   "G54.1 P0", "G54.1 P301", "G54.1 P1.5",
        "G55 G56", "G55 X1", "P3 G54.1", "G55 (left)", "G59.11", "/G55",     "Gxy",        "G55;"}) {
    const std::string said = test::rejection([&] { static_cast<void>(parse_work_frame(code)); });
    EXPECT_EQ(said, fmt::format("program.frames.code = \"{}\"; must be a work frame of G-code: G54 to G59, G59.1 to "
                                "G59.3, G54.1 P1 to P300, G154 P1 to P300, or G110 to G129",
                                code));
  }
}

// By hand: a position of another frame is moved by that frame's offsets less those of the first one.
TEST(WorkFrames, PositionsOfOthersAreMovedIntoTheFirst) {
  const std::string text =
      "G21 G90 G54\nG0 X0 Y0 Z5\nG1 Z-1 F600\nX10\nG0 Z5\nG55 G0 X1 Y2\nG1 Z-1\nG54.1 P3\nX0 Y0 Z0\nG52 X7\nX1\nM30\n";
  expect_tips(read(text, table),
              {{0, 0, -1}, {10, 0, -1}, {10, 0, 5}, {51, -8, 5}, {51, -8, 4}, {-120, -200, 10}, {-112, -200, 10}});
  expect_tips(read("G55\nG0 X0 Y0 Z0\nG1 X1 F60\nG54\nX0 Y0 Z0\n", table), {{1, 0, 0}, {-50, 10, -5}});
  expect_tips(read("G0 X0 Y0 Z0\nG1 X1 F60\nG112 X0\n", table), {{1, 0, 0}, {-120, 0, 0}});
  expect_tips(read("G0 X0 Y0 Z0\nG1 X1 F60\nG55\nG91 X1\nG90 X1\n", table), {{1, 0, 0}, {2, 0, 0}, {51, 0, 0}});
}

TEST(WorkFrames, TheReadingsAreThoseOfG10L2) {
  const std::string body =
      "G21 G90 S900 M3\nG0 X0 Y0 Z5\nG1 Z-1 F600\nG55\nG0 X1 Y2\nG2 X5 Y2 I2 J0\nG54 G81 X3 Y1 Z-3 R1 F90\nG55 "
      "X4\nG80\n"
      "G28 G91 Z0\nG90 G54 G0 X9 Y9\nZ1\nG1 Z-1\nM30\n";
  expect_same(read("(G54)\n(G55)\n" + body, table),
              read("G10 L2 P1 X100 Y200 Z300\nG10 L2 P2 X150 Y190 Z305\n" + body, {}));
}

TEST(WorkFrames, OneFrameNeedsNone) {
  for (const char* text : {"G0 X.1 Y.2 Z.3\nG1 X1.1 F60\nG52 X.7\nX1.3\n", "G92 X0 Y0 Z10\nG1 X1 F60\nG92 X7\nX8\n",
                           "G54.1 P3\nG0 X.1 Y0 Z0\nG1 X1 F60\n", "G58\nG0 X.1 Y0 Z0\nG1 X1 F60\n"}) {
    expect_same(read(text, {frame("G54", 0.1, 1.0 / 3.0, -700.7), frame("G54.1 P3", 0.3, 0.7, 0.1)}), read(text, {}));
  }
  EXPECT_TRUE(read("G0 X0 Y0 Z0\nG1 X1 F60\n", table).assumed.empty());
  expect_said("G92 X0 Y0 Z9\nG1 X1 F60\nG55 X1\n", {table[1]}, "part.nc:3: G55: is another work frame than G54 of the");
  expect_tips(read("G92 X0 Y0 Z9\nG1 X1 F60\nG55 X1\n", table), {{1, 0, 9}, {51, 0, 9}});
}

TEST(WorkFrames, OneThatIsNotGivenIsNamed) {
  const std::string text = "G54\nG0 X0 Y0 Z0\nG1 X1 F60\nG55\nG0 X3\nG1 X1\n";
  const std::string begin =
      "part.nc:4: G55: is another work frame than G54 (line 1) of the positions before; the offsets of ";
  const std::string give =
      ", and line 6 cuts. Give them as the control's table has them, in the cell: "
      "[[program.frames]] code = ";
  const std::string by_g10 = "; or by G10 L2 P X Y Z before the first position";
  expect_said(text, {table[0]}, begin + "G55 are not known" + give + "\"G55\", origin_mm = [x, y, z]" + by_g10);
  expect_said(text, {table[1]}, begin + "G54 are not known" + give + "\"G54\", origin_mm = [x, y, z]" + by_g10);
  expect_said(
      text, {table[2]},
      begin + "G54 and G55 are not known" + give + "\"G54\", origin_mm = [x, y, z], and the same for \"G55\"" + by_g10);
  const std::string extended =
      test::rejection([&] { static_cast<void>(read("G0 X0 Y0 Z0\nG1 X1 F60\nG154 P7 X1\n", table)); });
  EXPECT_EQ(
      extended,
      "part.nc:3: G154 P7: is another work frame than G54 of the positions before; the offsets of G154 P7 are not "
      "known, and line 3 cuts. Give them as the control's table has them, in the cell: [[program.frames]] code = "
      "\"G154 P7\", origin_mm = [x, y, z]");
  EXPECT_EQ(read("G0 X0 Y0 Z0\nG1 X1 F60\nG56\nG0 X3\nM30\n", table).blocks.size(), 1U) << "nothing cuts in it";
  expect_said(
      "G0 X0 Y0 Z0\nG1 X1 F60\nG10 L2 P1 X1 Y2 Z3\nG1 X2\n", {},
      "part.nc:3: G10: moves G54 after positions in it; its offsets before are not known, and line 4 cuts. Give "
      "them as the control's table has them, in the cell: [[program.frames]] code = \"G54\"");
}

TEST(WorkFrames, WrongOnesAreRejected) {
  const std::string text = "G0 X0 Y0 Z0\nG1 X1 F60\n";
  expect_said(text, {table[0], frame("G154 P1", 0, 0, 0), frame("G110", 0, 0, 0)},
              "frames[3].code = \"G110\"; is the work frame that frames[2] gives, \"G154 P1\"");
  expect_said(text, {frame("G53", 0, 0, 0)}, "frames[1].code = \"G53\"; must be a work frame of G-code: G54 to G59");
  expect_said(text, {frame("G54", 0, 1.5e6, 0)}, "frames[1].origin_m[2] = 1500 m; must lie within 1 km");
  EXPECT_EQ(test::field_of([&] { static_cast<void>(read(text, {{.code = "G54"}})); }), "frames[1].origin_m[1]");
  const auto said = [](const std::string& other, const char* name) {
    return test::rejection([&] { static_cast<void>(read_program_text(other, name, {.frames = table})); });
  };
  EXPECT_EQ(
      said("GOTO/0,0,0\nGOTO/1,0,0\n", "part.apt"),
      "part.apt: program.frames: are work frames of G-code, and this program is APT/CL. Take them out of the cell");
  EXPECT_EQ(said("x_mm,y_mm,z_mm,i,j,k,feed_mm_per_min\n0,0,0,0,0,1,\n1,0,0,0,0,1,60\n", "part.csv"),
            "part.csv: program.frames: are work frames of G-code, and this program is a CSV of poses. Take them out of "
            "the cell");
}

// The control obeys G10 L2: it writes the table when it comes.
TEST(WorkFrames, TheProgramsG10L2ComesLast) {
  const std::string head = "G0 X0 Y0 Z0\nG1 X1 F60\n";
  const Program changed = read(head + "G55 X0\nG10 L2 P2 X160\nX0\n", table);
  expect_tips(changed, {{1, 0, 0}, {50, 0, 0}, {60, 0, 0}});
  ASSERT_EQ(changed.assumed.size(), 1U);
  EXPECT_EQ(changed.assumed[0].what, "Offsets of G55");
  EXPECT_EQ(changed.assumed[0].taken, "those of the program's G10 L2 from line 4 on; the cell has others");
  const Program own = read("G10 L2 P1 X90 Y200 Z300\n" + head + "G55 X0 Y0\n", table);
  expect_tips(own, {{1, 0, 0}, {60, -10, 0}});
  EXPECT_EQ(own.assumed.size(), 1U);
  EXPECT_TRUE(read("G10 L2 P1 X100 Y200 Z300\n" + head + "G55 X0\n", table).assumed.empty()) << "the same offsets";
}

// Heights of a cycle count in the frame of each hole.
TEST(WorkFrames, HolesOfACycleAreThoseOfTheirFrame) {
  expect_tips(
      read("G0 X0 Y0 Z20\nG81 X3 Y1 Z-3 R1 F90\nG55 X4 Y0\nG80\n", table),
      {{3, 1, 20}, {3, 1, 1}, {3, 1, -3}, {3, 1, 20}, {54, -10, 20}, {54, -10, 6}, {54, -10, 2}, {54, -10, 20}});
}

// One workpiece for each of the tools: W is the frame in which the program begins, not the part that is read.
TEST(WorkFrames, EachToolHasTheProgramsFrame) {
  const std::string text = "T1 M6\nG54 G0 X0 Y0 Z9\nG1 Z0 F60\nT2 M6\nG55 G0 X0 Y0 Z9\nG1 Z0\nG54 X0 Y0\nM30\n";
  const Program first = read(text, table, 1);
  EXPECT_EQ(first.start.tip_m, units::mm * Vector3d(0, 0, 9));
  const Program second = read(text, table, 2);
  EXPECT_LT((second.start.tip_m - units::mm * Vector3d(50, -10, 14)).norm(), 1e-12);
  expect_tips(second, {{50, -10, 5}, {0, 0, 5}});
  EXPECT_TRUE(second.assumed.empty());
  const std::string one = "T1 M6\nG54 G0 X0 Y0 Z9\nG1 Z0 F60\nT2 M6\nG55 G0 X0 Y0 Z9\nG1 Z0\nM30\n";
  const Program alone = read(one, {table[1]}, 2);
  EXPECT_EQ(alone.start.tip_m, units::mm * Vector3d(0, 0, 9)) << "where the program's frame is not given";
  EXPECT_EQ(alone.assumed.size(), 1U);
}

TEST(WorkFrames, RewritingWritesPositionsOfTheirFrame) {
  const std::string text =
      "G21 G90 S900 M3\nG54 G0 X0 Y0 Z5\nG1 Z-1 F600\nX10\nG55 G0 X1 Y2\nG1 X3 Z-2 F300\nG54.1 P3 X0 Y0\nM30\n";
  const ProgramReading reading = {.frames = table};
  const Program program = read(text, table);
  EXPECT_EQ(rewrite_program_text(text, "part.nc", reading, program, program).text, text);
  Program wanted = program;
  for (Block& block : wanted.blocks) {
    block.spindle_speed_rad_per_s *= 2.0;
    block.end.tip_m.x() += 0.25 * units::mm;
  }
  wanted.start.tip_m.x() += 0.25 * units::mm;
  EXPECT_EQ(rewrite_program_text(text, "part.nc", reading, program, wanted).text,
            "G21 G90 S1800 M3\nG54 G0 X0.25 Y0 Z5\nG1 Z-1 F600\nX10.25\nG55 G0 X1.25 Y2\nG1 X3.25 Z-2 F300\nG54.1 P3 "
            "X0.25 Y0\nM30\n");
  EXPECT_THROW(static_cast<void>(rewrite_program_text(text, "part.nc", {}, program, wanted)), InvalidInput)
      << "another reading";
}

double rounded(double value) {
  constexpr double decimals = 1e3;
  return std::round(decimals * value) / decimals;
}

/// A random program over random frames, with its tips by hand.
struct RandomProgram {
  std::string text = {};
  Frames frames = {};                  ///< that the program's G10 L2 does not give
  std::vector<Vector3d> tips_mm = {};  ///< the start first
};

RandomProgram random_program(Random& random) {
  constexpr std::array<const char*, 6> codes = {"G54", "G55", "G59", "G59.3", "G54.1 P3", "G115"};
  constexpr std::array<int, 6> of_g10 = {1, 2, 6, 9, 0, 0};
  const auto any = [&](double most) {
    return Vector3d(rounded(random.uniform(-most, most)), rounded(random.uniform(-most, most)),
                    rounded(random.uniform(-most, most)));
  };
  RandomProgram out;
  out.text = "G21 G90 S900 M3 F500\n";
  std::array<Vector3d, codes.size()> offsets_mm;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const Vector3d& at = offsets_mm[i] = any(900.0);
    if (of_g10[i] > 0 && random.index(2) == 0) {
      out.text += fmt::format("G10 L2 P{} X{:.3f} Y{:.3f} Z{:.3f}\n", of_g10[i], at.x(), at.y(), at.z());
    } else {
      out.frames.push_back(frame(codes[i], at.x(), at.y(), at.z()));
    }
  }
  const std::size_t base = random.index(codes.size());
  std::size_t now = base;
  Vector3d tip_mm = any(50.0);
  out.text += fmt::format("{} G0 X{:.3f} Y{:.3f} Z{:.3f}\n", codes[base], tip_mm.x(), tip_mm.y(), tip_mm.z());
  out.tips_mm.push_back(tip_mm);
  for (std::uint64_t n = 4 + random.index(12); n-- > 0;) {
    std::string line = random.index(3) == 0 ? "G0" : "G1";
    if (random.index(2) == 0) {
      now = random.index(codes.size());
      line = std::string(codes[now]) + (random.index(2) == 0 ? " " : "\n") + line;
    }
    const Vector3d words = any(50.0);
    const std::uint64_t given = 1 + random.index(7);
    for (int i = 0; i < 3; ++i) {
      if ((given >> i & 1U) == 0) continue;
      line += fmt::format(" {}{:.3f}", "XYZ"[i], words[i]);
      tip_mm[i] = words[i] + offsets_mm[now][i] - offsets_mm[base][i];
    }
    out.text += line + "\n";
    if ((tip_mm - out.tips_mm.back()).norm() > 1e-9) out.tips_mm.push_back(tip_mm);  // none of length zero
  }
  out.text += "M30\n";
  return out;
}

TEST(WorkFrames, RandomProgramsAreThoseByHandAndAreRewritten) {
  for (int seed = 0; seed < test::seeds(2000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const RandomProgram made = random_program(random);
    const ProgramReading reading = {.frames = made.frames};
    const Program program = read_program_text(made.text, "part.nc", reading);
    ASSERT_EQ(program.blocks.size() + 1, made.tips_mm.size()) << made.text;
    Program wanted = program;
    for (std::size_t i = 0; i < program.blocks.size(); ++i) {
      ASSERT_LT((program.blocks[i].end.tip_m - units::mm * made.tips_mm[i + 1]).norm(), 1e-12) << made.text;
      wanted.blocks[i].end.tip_m += units::mm * Vector3d(random.uniform(), random.uniform(), random.uniform());
      if (program.blocks[i].kind != Block::Kind::feed) continue;
      wanted.blocks[i].duration_s *= (wanted.blocks[i].end.tip_m - wanted.begin_of(i).tip_m).norm() /
                                     (program.blocks[i].end.tip_m - program.begin_of(i).tip_m).norm();
    }
    ASSERT_EQ(rewrite_program_text(made.text, "part.nc", reading, program, program).text, made.text);
    const std::string text = rewrite_program_text(made.text, "part.nc", reading, program, wanted).text;
    const Program again = read_program_text(text, "part.nc", reading);
    ASSERT_EQ(again.blocks.size(), wanted.blocks.size()) << text;
    for (std::size_t i = 0; i < again.blocks.size(); ++i) {
      ASSERT_LT((again.blocks[i].end.tip_m - wanted.blocks[i].end.tip_m).norm(), 2e-7) << text;
    }
  }
}

}  // namespace work_frames_test
}  // namespace robomill::program
