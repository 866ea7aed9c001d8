// Programs whose tool is leaned about the centre of its ball, by one rotation a stretch between rapids.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/program/files/rewrite.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace rewrite_axes_property_test {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double ball_radius_m = 4e-3;

Pose leaned(const Pose& pose, const Matrix3d& lean) {
  const Vector3d axis = (lean * pose.axis).normalized();
  return {.tip_m = pose.tip_m + ball_radius_m * (pose.axis - axis), .axis = axis};
}

Matrix3d random_lean(Random& random) {
  if (random.index(4) == 0) return Matrix3d::Identity();
  const Vector3d about = Vector3d(random.normal(), random.normal(), random.normal()).normalized();
  return AngleAxisd(random.uniform(0.0, 30.0) * units::deg, about).toRotationMatrix();
}

/// Leans each stretch; the last line of the rapids between goes evenly from one lean to the other.
Program leaned(const Program& read, Random& random) {
  Program wanted = read;
  Matrix3d lean = random.index(3) == 0 ? Matrix3d(Matrix3d::Identity()) : random_lean(random);
  wanted.start = leaned(read.start, lean);
  const auto kind_is = [&](std::size_t i, Block::Kind kind) {
    return i < read.blocks.size() && read.blocks[i].kind == kind;
  };
  for (std::size_t i = 0; i < read.blocks.size();) {
    std::size_t end = i + 1;
    while (kind_is(i, Block::Kind::rapid) && end < read.blocks.size() && read.blocks[end].line == read.blocks[i].line &&
           kind_is(end, Block::Kind::rapid)) {
      ++end;
    }
    const bool rapid = kind_is(i, Block::Kind::rapid);
    if (rapid && !kind_is(end, Block::Kind::rapid)) lean = random_lean(random);
    const Pose from = wanted.begin_of(i);
    const Pose to = kind_is(i, Block::Kind::dwell) ? from : leaned(read.blocks[end - 1].end, lean);
    for (std::size_t k = i; k < end; ++k) {
      const double share = static_cast<double>(k + 1 - i) / static_cast<double>(end - i);
      wanted.blocks[k].end = k + 1 == end ? to : between(from, to, share);
    }
    i = end;
  }
  for (std::size_t i = 0; i < read.blocks.size(); ++i) {
    if (read.blocks[i].kind != Block::Kind::feed) continue;
    const double was_m = (read.blocks[i].end.tip_m - read.begin_of(i).tip_m).norm();
    const double is_m = (wanted.blocks[i].end.tip_m - wanted.begin_of(i).tip_m).norm();
    if (was_m > 0.0 && is_m > 0.0) wanted.blocks[i].duration_s *= is_m / was_m;
  }
  return wanted;
}

/// A wanted move at feed, and the blocks that make it: each is on the wanted line, its axis within the tolerance of the
/// wanted great circle where the tip is, and all take the wanted time. Digits change a way by up to 0.5 um.
void expect_feed(const Program& got, std::size_t first, std::size_t last, const Block& wanted, const Pose& begin,
                 double axis_tolerance_rad, const std::string& text) {
  const Vector3d way = wanted.end.tip_m - begin.tip_m;
  const double slack = way.norm() > 0.0 ? std::min(5e-7 / way.norm(), 1.0) : 0.0;
  const double turn_rad = angle_between(begin.axis, wanted.end.axis);
  double time_s = 0.0;
  for (std::size_t i = first; i < last; ++i) time_s += got.blocks[i].duration_s;
  ASSERT_NEAR(time_s, wanted.duration_s, (2e-5 + 1.01 * slack) * wanted.duration_s) << text;
  double elapsed_s = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    const Block& block = got.blocks[i];
    ASSERT_LE(block.axis_deviation_rad, axis_tolerance_rad);
    for (const double within : {0.5, 1.0}) {
      const Pose at = between(got.begin_of(i), block.end, within);
      const double share = slack < 0.01 && way.norm() > 0.0 ? (at.tip_m - begin.tip_m).dot(way) / way.squaredNorm()
                                                            : (elapsed_s + within * block.duration_s) / time_s;
      const Pose want = between(begin, wanted.end, std::clamp(share, 0.0, 1.0));
      ASSERT_LT((at.tip_m - want.tip_m).norm(), 5e-7) << text;
      ASSERT_LT(angle_between(at.axis, want.axis), axis_tolerance_rad + 2e-7 + slack * turn_rad) << text;
    }
    elapsed_s += block.duration_s;
  }
}

/// The new program goes through the wanted poses, and between them as is wanted.
void expect_same_motion(const Program& got, const Program& wanted, const ProgramReading& reading,
                        const std::string& text) {
  const auto ends_at = [&](std::size_t i, const Pose& pose) {
    return (got.blocks[i].end.tip_m - pose.tip_m).norm() < 2.1e-7 && (got.blocks[i].end.axis - pose.axis).norm() < 1e-7;
  };
  std::size_t at = 0;
  for (std::size_t i = 0; i < wanted.blocks.size(); ++i) {
    const Block& block = wanted.blocks[i];
    const bool rapid = block.kind == Block::Kind::rapid;
    if (rapid && i + 1 < wanted.blocks.size() && wanted.blocks[i + 1].kind == Block::Kind::rapid) continue;
    const std::size_t first = at;
    while (at < got.blocks.size() && got.blocks[at].kind == block.kind && (rapid || !ends_at(at, block.end))) ++at;
    if (!rapid) ++at;
    ASSERT_LE(at, got.blocks.size()) << text << "block " << i;
    ASSERT_GT(at, first) << text << "block " << i;
    ASSERT_EQ(got.blocks[at - 1].kind, block.kind) << text << "block " << i;
    ASSERT_TRUE(ends_at(at - 1, block.end)) << text << "block " << i;
    if (block.kind == Block::Kind::feed) {
      expect_feed(got, first, at, block, wanted.begin_of(i), reading.axis_tolerance_rad, text);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
  ASSERT_EQ(at, got.blocks.size()) << text;
}

struct Tally {
  int programs = 0, rejected = 0;
  std::size_t lines = 0, added = 0;
  std::string last = {};
};

std::size_t count_lines(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

void check(const std::string& text, const std::string& name, const ProgramReading& reading, const Program& read,
           const Program& wanted, Tally& tally) {
  ++tally.programs;
  Rewritten out;
  try {
    out = rewrite_program_text(text, name, reading, read, wanted);
  } catch (const InvalidInput& error) {
    ++tally.rejected;
    tally.last = error.what() + ("\n" + text);
    return;
  }
  tally.lines += count_lines(text);
  tally.added += out.added_lines;
  ASSERT_EQ(count_lines(out.text), count_lines(text) + out.added_lines) << text << "\n" << out.text;
  const Program got = read_program_text(out.text, name, reading);
  expect_same_motion(got, wanted, reading, text + "\n" + out.text);
  ASSERT_EQ(rewrite_program_text(out.text, name, reading, got, got).text, out.text);
}

constexpr std::array<Machine, 4> machines = {Machine::xyzac_trt, Machine::xyzbc_trt, Machine::xyzac_head,
                                             Machine::xyzbc_head};

/// Stretches of moves and arcs with turning axes; one of many ways to write them.
class Writer {
 public:
  Writer(std::uint64_t seed, Machine machine) : random_(seed, 4), tilt_letter_(tilt_index(machine) == 0 ? 'A' : 'B') {}

  std::string program() {
    text_ = fmt::format("G90 {}{}\nS3000 M3\n", odds(3) ? "G20 " : "G21 ", inverse_ ? "G93" : "G94");
    unit_ = text_.find("G20") != std::string::npos ? 25.4 : 1.0;
    text_ +=
        fmt::format("G0 X0 Y0 Z{:.4f} {}{:.3f} C{:.3f}\n", 5.0 / unit_, tilt_letter_, tilt_ = angle(), turn_ = angle());
    z_ = 5.0 / unit_;
    for (std::uint64_t n = 1 + random_.index(4); n-- > 0;) stretch();
    return text_ + "M2\n";
  }

 private:
  bool odds(std::uint64_t one_of) { return random_.index(one_of) == 0; }
  double angle() { return odds(5) ? 0.0 : std::round(1000.0 * random_.uniform(-35.0, 35.0)) / 1000.0; }
  std::string feed() {
    if (inverse_) return fmt::format(" F{:.2f}", random_.uniform(5.0, 200.0));
    if (has_feed_ && !odds(4)) return {};
    has_feed_ = true;
    return fmt::format(" F{:.2f}", random_.uniform(100.0, 2000.0) / unit_);
  }
  std::string place(char letter, double& at, double by) {
    const double step = std::round(1e4 * by / unit_) / 1e4;
    at += step;
    return fmt::format(" {}{:.4f}", letter, steps_ ? step : at);
  }
  std::string turn() {
    std::string out;
    if (odds(2)) out += place(tilt_letter_, tilt_, unit_ * random_.uniform(-3.0, 3.0));
    if (odds(3))
      out += place('C', turn_, unit_ * (odds(3) ? random_.uniform(-60.0, 60.0) : random_.uniform(-4.0, 4.0)));
    return out;
  }
  void stretch() {
    if (odds(4)) text_ += fmt::format("G{}\n", std::exchange(steps_, !steps_) ? 90 : 91);
    if (odds(4)) {
      inverse_ = !inverse_;
      has_feed_ = false;
      text_ += inverse_ ? "G93\n" : "G94\n";
    }
    text_ += "G0" + place('X', x_, random_.uniform(-20.0, 20.0)) + (odds(2) ? turn() : "") + "\n";
    for (std::uint64_t n = 2 + random_.index(8); n-- > 0;) move();
    text_ += "G0" + place('Z', z_, 2.0) + "\n";
  }
  void move() {
    if (odds(9)) text_ += odds(2) ? "G4 P0.5\n" : "M1\n";
    if (odds(6)) {
      const double radius = random_.uniform(1.0, 9.0);
      text_ += fmt::format("G{}", odds(2) ? 2 : 3) + place('X', x_, 2.0 * radius) + (odds(3) ? turn() : "") +
               fmt::format(" I{:.5f}", radius / unit_) + feed() + "\n";
      return;
    }
    const std::string turned = turn();
    if (!turned.empty() && odds(4)) {
      text_ += "G1" + turned + feed() + "\n";
      return;
    }
    text_ += "G1" + place('X', x_, random_.uniform(0.3, 6.0)) +
             (odds(2) ? place('Y', y_, random_.uniform(-3.0, 3.0)) : "") + turned +
             (odds(3) ? place('Z', z_, random_.uniform(-0.5, 0.5)) : "") + feed() + "\n";
  }

  Random random_;
  char tilt_letter_;
  std::string text_;
  double unit_ = 1.0;
  bool steps_ = false, inverse_ = false, has_feed_ = false;
  double x_ = 0.0, y_ = 0.0, z_ = 0.0, tilt_ = 0.0, turn_ = 0.0;
};

TEST(RewriteAxesProperty, RandomStretchesOfGcode) {
  Tally tally;
  for (int seed = 0; seed < test::seeds(6000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed), 5);
    const Machine machine = machines[random.index(4)];
    const std::string text = Writer(static_cast<std::uint64_t>(seed), machine).program();
    const ProgramReading reading = {.machine = machine,
                                    .rotary = random.index(3) == 0 ? Rotary::great_circle : Rotary::machine,
                                    .chord_tolerance_m = 1e-4,
                                    .axis_tolerance_rad = random.index(2) == 0 ? 1e-2 : 1e-3};
    const Program read = read_program_text(text, "part.ngc", reading);
    check(text, "part.ngc", reading, read, leaned(read, random), tally);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(tally.rejected, 0) << tally.last;
  RecordProperty("rejected", tally.rejected);
  RecordProperty("last", tally.last);
  RecordProperty("added_lines_percent", static_cast<int>(100 * tally.added / std::max<std::size_t>(tally.lines, 1)));
}

TEST(RewriteAxesProperty, RandomStretchesOfVectors) {
  Tally tally;
  static constexpr std::array<const char*, 3> names = {"part.apt", "part.csv", "part.ngc"};
  for (int seed = 0; seed < test::seeds(6000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed), 6);
    const std::size_t dialect = random.index(3);
    std::string text = dialect == 0   ? "MULTAX/ON\nSPINDL/3000,RPM,CLW\nFEDRAT/500,MMPM\n"
                       : dialect == 1 ? "x_mm,y_mm,z_mm,i,j,k,feed_mm_per_min\n"
                                      : "S3000 M3\n";
    Vector3d axis = Vector3d::UnitZ(), tip = Vector3d::Zero();
    for (std::uint64_t n = 4 + random.index(30), i = 0; i < n; ++i) {
      if (random.index(6) > 0) tip += Vector3d(random.uniform(0.1, 3.0), random.normal(), 0.1 * random.normal());
      if (random.index(3) > 0)
        axis = Vector3d(axis + 0.1 * Vector3d(random.normal(), random.normal(), 0.0)).normalized();
      if (random.index(9) == 0) axis = Vector3d::UnitZ();
      const std::string place = dialect == 2 ? fmt::format("X{:.3f} Y{:.3f} Z{:.3f}", tip.x(), tip.y(), tip.z())
                                             : fmt::format("{:.3f},{:.3f},{:.3f}", tip.x(), tip.y(), tip.z());
      const bool rapid = i == 0 || random.index(6) == 0;
      const bool silent = i > 0 && random.index(4) == 0;
      if (dialect == 0) {
        text += rapid ? "RAPID\n" : random.index(5) == 0 ? "FEDRAT/333\n" : "";
        if (i > 0 && random.index(8) == 0) {
          text += "GODLTA/1.5,0,0.25\n";
        } else {
          text += "GOTO/" + place + (silent ? "" : fmt::format(",{:.6f},{:.6f},{:.6f}", axis.x(), axis.y(), axis.z())) +
                  "\n";
        }
      } else if (dialect == 1) {
        text += fmt::format("{},{:.7f},{:.7f},{:.7f},{:.1f}\n", place, axis.x(), axis.y(), axis.z(),
                            random.uniform(50.0, 900.0));
      } else {
        text += (rapid ? "G0 " : "G1 ") + place +
                (silent ? "" : fmt::format(" I{:.6f} J{:.6f} K{:.6f}", axis.x(), axis.y(), axis.z())) +
                (rapid ? "\n" : " F300\n");
        if (random.index(9) == 0) text += "G2 X" + fmt::format("{:.3f}", tip.x() + 2.0) + " I1 F200\n";
        if (text.ends_with("F200\n")) tip.x() = std::round(1e3 * tip.x()) / 1e3 + 2.0;
      }
    }
    const Program read = read_program_text(text, names[dialect]);
    check(text, names[dialect], {}, read, leaned(read, random), tally);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(tally.rejected, 0) << tally.last;
  RecordProperty("rejected", tally.rejected);
  RecordProperty("last", tally.last);
}

/// A hollow finished to and fro: A and C on each line, rapids between the passes.
std::string hollow() {
  std::string out = "(a hollow)\nG21 G90 G94 M428\nS9000 M3\n";
  for (int pass = 0; pass < 4; ++pass) {
    const double way = pass % 2 == 0 ? 18.0 : -18.0;
    const std::string y = fmt::format("Y{:.3f}", 0.6 * pass - 1.2);
    for (int i = 0; i <= 24; ++i) {
      const double bow = std::sin(std::numbers::pi * i / 24.0);
      const std::string place = fmt::format("X{:.3f} {}", way * (i / 12.0 - 1.0), y);
      if (i == 0) out += fmt::format("G0 {} Z4.000 A{:.3f} C0.000\n", place, -10.0 - 10.0 * bow);
      out += fmt::format("G1 {} Z{:.3f} A{:.3f} C0.000 F{}\n", place, -0.15 - 0.45 * bow, -10.0 - 10.0 * bow,
                         i == 0 ? 300 : 900);
    }
    out += "G0 Y-4.000 Z4.000\n";
  }
  return out + "M2\n";
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out(1);
  for (const char c : text) {
    if (c == '\n') {
      out.emplace_back();
    } else {
      out.back() += c;
    }
  }
  return out;
}

// Passes that are not leaned keep their bytes, and F stays everywhere.
TEST(RewriteAxesProperty, PassesOfAHollow) {
  const std::filesystem::path path = ROBOMILL_SOURCE_DIR "/examples/force-along-program/hollow.ngc";
  Tally tally;
  for (int seed = 0; seed < test::seeds(200); ++seed) {
    Random random(static_cast<std::uint64_t>(seed), 7);
    const std::string text = seed % 2 == 0 ? hollow() : io::read_file(path);
    const ProgramReading reading = {.machine = Machine::xyzac_trt};
    const Program read = read_program_text(text, "part.ngc", reading);
    const Program wanted = leaned(read, random);
    check(text, "part.ngc", reading, read, wanted, tally);
    if (HasFatalFailure()) return;
    if (seed % 2 != 0) continue;
    const std::string out = rewrite_program_text(text, "part.ngc", reading, read, wanted).text;
    const std::vector<std::string> old_lines = lines_of(text);
    const std::vector<std::string> new_lines = lines_of(out);
    auto next = new_lines.begin();
    for (std::size_t i = 0; i < read.blocks.size(); ++i) {
      if ((wanted.begin_of(i).axis - read.begin_of(i).axis).norm() > 1e-12 ||
          (wanted.blocks[i].end.axis - read.blocks[i].end.axis).norm() > 1e-12) {
        continue;
      }
      next = std::find(next, new_lines.end(), old_lines[read.blocks[i].line - 1]);
      ASSERT_NE(next, new_lines.end()) << old_lines[read.blocks[i].line - 1] << "\n" << out;
      ++next;
    }
    const auto words = [](const std::string& all, char letter) { return std::ranges::count(all, letter); };
    ASSERT_EQ(words(out, 'F'), words(text, 'F')) << out;
  }
  EXPECT_EQ(tally.rejected, 0) << tally.last;
  RecordProperty("added_lines_percent", static_cast<int>(100 * tally.added / std::max<std::size_t>(tally.lines, 1)));
}

// Cut off, changed at any place: what is read is rewritten as wanted or rejected.
TEST(RewriteAxesProperty, SurvivesMutations) {
  static constexpr std::array<std::string_view, 3> good = {
      "%\n(p)\nG93 G21\nS600 M3\nG0 X16.339 Y-25.409 Z33.353 A-71.841 C-35.930\nG1 X6.302 Y-11.5 Z27 A-71 C-35 F318\n"
      "G94 F100\nX1\nG2 X3 I1 A-70\nG4 P1\nG91 Y1\nG3 G18 X1 Z2 Y1 R4\nG0 X1\nG90 G20 Z.5\nN5 G1 X 1 A3 ; end\nM30\n",
      "$$ x\nPARTNO A\nUNITS/MM\nMULTAX/ON\nSPINDL/RPM,3000,CLW\nRAPID\nGOTO/10,20,30,$\n0,0,1\nFEDRAT/600.0,MMPM\n"
      "GOTO/0,0,5\nRAPID\nGOTO/1.27D1,0,0,0.6,0,.8\nGODLTA/0,-3,4\nDELAY/1.5\nRAPID\nGODLTA/2\nFEDRAT/MMPR,.1\nGOTO/"
      "12,0,4\nFINI\n",
      "# a\nx_mm,y_mm,z_mm,i,j,k,feed_mm_per_min\n1,2,3,0,0,1,\n4, 6 "
      ",3,0,0,1,300\n4,6,\"3\",0.6,0,0.8,60\n+4,6,1.3e1,0,0,1,6\n"};
  static constexpr std::array<const char*, 3> names = {"part.ngc", "part.apt", "part.csv"};
  static constexpr std::string_view letters = "GXYZABCIJKRPFNMSTO0123456789.-+ ()%$~;/,EDL\n\r";
  const ProgramReading reading = {.machine = Machine::xyzac_trt, .chord_tolerance_m = 1e-3, .axis_tolerance_rad = 1e-2};
  Random random(78);
  Tally tally;
  for (int i = 0; i < test::seeds(30000); ++i) {
    const auto dialect = static_cast<std::size_t>(i) % 3;
    std::string text(good[dialect]);
    for (std::uint64_t n = random.index(4); n-- > 0;) {
      text[random.index(text.size())] =
          random.index(8) == 0 ? static_cast<char>(random.index(256)) : letters[random.index(letters.size())];
    }
    Program read;
    try {
      read = read_program_text(text, names[dialect], reading);
    } catch (const InvalidInput&) {
      continue;
    }
    const Program wanted = leaned(read, random);
    ++tally.programs;
    try {
      const Rewritten out = rewrite_program_text(text, names[dialect], reading, read, wanted);
      expect_same_motion(read_program_text(out.text, names[dialect], reading), wanted, reading, text + "\n" + out.text);
    } catch (const InvalidInput& error) {
      ++tally.rejected;
      tally.last = error.what() + ("\n" + text);
    }
    if (HasFatalFailure()) return;
  }
  RecordProperty("programs", tally.programs);
  RecordProperty("rejected", tally.rejected);
  RecordProperty("last", tally.last);
  EXPECT_GT(tally.programs, 100);
  EXPECT_LE(tally.rejected, tally.programs / 200) << tally.last;
}

}  // namespace rewrite_axes_property_test
}  // namespace robomill::program
