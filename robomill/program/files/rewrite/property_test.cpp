// Random programs with random changes, and mutated ones.
#include <fmt/format.h>
#include <gtest/gtest.h>

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
#include "robomill/program/files/gcode/words.hpp"
#include "robomill/program/files/rewrite.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace rewrite_property_test {

using Eigen::Vector3d;

constexpr double mm = 1e-3;

/// Programs of G-code that say all that is read, one of many ways.
class Writer {
 public:
  explicit Writer(std::uint64_t seed) : random_(seed) {}

  std::string program(bool rotary) {
    rotary_ = rotary;
    crlf_ = odds(3);
    small_ = odds(4);
    decimals_ = 2 + static_cast<int>(random_.index(3));
    if (odds(3)) end_line("%");
    if (odds(3)) end_line("O12 (name)");
    if (odds(2)) end_line("S" + number(random_.uniform(100.0, 9000.0)) + (odds(2) ? " M3" : " M4"));
    if (odds(3)) end_line("F" + number(random_.uniform(50.0, 2000.0)));
    end_line("G21 G90 G0 X0 Y0 Z0" + std::string(rotary ? " A0 C0" : ""));
    if (odds(2)) end_line("M3 S" + number(random_.uniform(100.0, 9000.0)));
    line_ = "G1";
    move_line(true);
    for (std::uint64_t n = 3 + random_.index(25); n-- > 0;) any_line();
    if (odds(2)) end_line("M5");
    if (odds(2)) end_line("M30");
    return text_;
  }

 private:
  bool odds(std::uint64_t one_of) { return random_.index(one_of) == 0; }
  [[nodiscard]] double unit() const { return inches_ ? 25.4 : 1.0; }
  std::string number(double value) const { return fmt::format("{:.{}f}", value, decimals_); }
  /// Rounds as the number that is written.
  double rounded(double value) const { return std::stod(number(value)); }

  void word(char letter, double value) {
    if (!line_.empty() && odds(3)) line_ += ' ';
    line_ += letter;
    if (odds(8)) line_ += ' ';
    line_ += number(value);
    if (odds(12)) line_ += "(F100 S5)";
  }

  void end_line(const std::string& text) {
    line_ = text;
    end_line();
  }
  void end_line() {
    if (small_) std::ranges::transform(line_, line_.begin(), [](char c) { return static_cast<char>(std::tolower(c)); });
    if (odds(8)) line_ += odds(2) ? " (X1 F5)" : " ; S7";
    text_ += line_ + (crlf_ ? "\r\n" : "\n");
    line_.clear();
  }

  void feed() {
    if (inverse_) {
      word('F', random_.uniform(5.0, 500.0));
    } else if (!has_feed_ || odds(4)) {
      word('F', random_.uniform(50.0, 2000.0) / unit());
      has_feed_ = true;
    }
  }

  void coordinate(int axis, double target) {
    const double base = incremental_ ? at_[axis] : 0.0;
    const double value = rounded((target - base) / unit());
    word("XYZ"[axis], value);
    at_[axis] = value * unit() + base;
  }

  void turn(char letter, double& angle, double target) {
    const double value = rounded(target - (incremental_ ? angle : 0.0));
    word(letter, value);
    angle = incremental_ ? angle + value : value;
  }

  void move_line(bool at_feed) {
    const bool axis_alone = rotary_ && odds(6);
    for (int axis = 0; axis < 3 && !axis_alone; ++axis) {
      if (axis == 0 || odds(2)) coordinate(axis, random_.uniform(-40.0, 40.0));
    }
    if (axis_alone || (rotary_ && odds(2))) {
      turn('A', a_, random_.uniform(-60.0, 60.0));
      if (odds(2)) turn('C', c_, random_.uniform(-90.0, 90.0));
    }
    if (at_feed || (!inverse_ && odds(5))) feed();
    if (odds(6)) word('S', random_.uniform(100.0, 9000.0));
    if (odds(8)) line_ += " M8";
    end_line();
  }

  // About a centre in the plane, to a point as far from it.
  void arc_line() {
    const auto plane = static_cast<int>(random_.index(3));
    static constexpr std::array<std::array<int, 3>, 3> axes = {{{0, 1, 2}, {2, 0, 1}, {1, 2, 0}}};
    const auto [u, v, w] = axes[static_cast<std::size_t>(plane)];
    const int decimals = std::exchange(decimals_, std::max(decimals_, 4));  // else radii do not fit
    const bool left = odds(2);
    line_ += fmt::format("G{} G{} ", 17 + plane, left ? 3 : 2);
    const double radius = random_.uniform(1.0, 30.0);
    const double begin = random_.uniform(0.0, 2.0 * std::numbers::pi);
    const double sweep = random_.uniform(0.2, 6.0);
    const double end = begin + (left ? sweep : -sweep);
    const double center_u = at_[u] - radius * std::cos(begin);
    const double center_v = at_[v] - radius * std::sin(begin);
    const double from_u = at_[u], from_v = at_[v];
    const bool whole = odds(8);
    if (!whole) {
      coordinate(u, center_u + radius * std::cos(end));
      coordinate(v, center_v + radius * std::sin(end));
    }
    if (odds(3)) coordinate(w, at_[w] + random_.uniform(-3.0, 3.0));
    if (!whole && odds(3) && std::abs(sweep - std::numbers::pi) > 0.3) {
      word('R', (sweep < std::numbers::pi ? radius : -radius) / unit());
    } else if (centers_absolute_) {
      word("IJK"[u], center_u / unit());
      word("IJK"[v], center_v / unit());
    } else {
      word("IJK"[u], (center_u - from_u) / unit());
      word("IJK"[v], (center_v - from_v) / unit());
    }
    if (rotary_ && odds(3)) turn('A', a_, random_.uniform(-60.0, 60.0));
    feed();
    if (odds(6)) word('S', random_.uniform(100.0, 9000.0));
    if (odds(9)) line_ += " M9";
    decimals_ = decimals;
    end_line();
  }

  void any_line() {
    if (odds(5)) line_ = fmt::format("N{} ", random_.index(1000));
    switch (random_.index(16)) {
      case 0:
        inches_ = !inches_;
        return end_line(line_ + (inches_ ? "G20" : "G21"));
      case 1:
        incremental_ = !incremental_;
        return end_line(line_ + (incremental_ ? "G91" : "G90"));
      case 2:
        inverse_ = !inverse_;
        has_feed_ = false;
        return end_line(line_ + (inverse_ ? "G93" : "G94"));
      case 3:
        centers_absolute_ = !centers_absolute_;
        return end_line(line_ + (centers_absolute_ ? "G90.1" : "G91.1"));
      case 4:
        return end_line(line_ + (odds(2) ? "G4 P1.5" : "M1"));
      case 5:
        return end_line(line_ + (odds(2) ? "M5" : "M3"));
      case 6:
        if (inverse_) return end_line("S500");
        has_feed_ = true;
        return end_line(line_ + "F" + number(random_.uniform(50.0, 2000.0) / unit()));
      case 7:
        return end_line("/ G1 X999 F1");
      case 8:
        line_ += "G0";
        return move_line(false);
      case 9:
      case 10:
      case 11:
        return arc_line();
      default:
        line_ += "G1";
        return move_line(true);
    }
  }

  Random random_;
  std::string text_, line_;
  bool rotary_ = false, crlf_ = false, small_ = false;
  int decimals_ = 3;
  bool inches_ = false, incremental_ = false, inverse_ = false, centers_absolute_ = false, has_feed_ = false;
  Vector3d at_ = Vector3d::Zero();  ///< mm
  double a_ = 0.0, c_ = 0.0;
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines(1);
  for (const char c : text) {
    lines.back() += c;
    if (c == '\n') lines.emplace_back();
  }
  if (lines.back().empty()) lines.pop_back();
  return lines;
}

/// How many lines of a program the new text keeps, in their order.
std::size_t kept_lines(const std::vector<std::string>& old, const std::vector<std::string>& now) {
  std::vector<std::size_t> best(now.size() + 1, 0);
  for (const std::string& line : old) {
    std::vector<std::size_t> next = best;
    for (std::size_t j = 0; j < now.size(); ++j) {
      next[j + 1] = std::max({next[j], best[j + 1], line == now[j] ? best[j] + 1 : 0});
    }
    best = std::move(next);
  }
  return best.back();
}

/// All comments, in their order.
std::string comments_of(const std::string& text) {
  std::string out;
  for (const std::string& line : lines_of(text)) {
    if (line[0] == '/') continue;
    for (std::size_t i = line.find_first_of("(;"); i != std::string::npos; i = line.find_first_of("(;", i)) {
      const std::size_t end = line[i] == '(' ? line.find(')', i) + 1 : line.find_first_of("\r\n", i);
      out += line.substr(i, end - i);
      i = end;
    }
  }
  return out;
}

/// All words but those of speed and feed.
std::string other_words(const std::string& text) {
  std::string out;
  GcodeWords words;
  for (const std::string& line : lines_of(text)) {
    words.scan(line.substr(0, line.find_first_of("\r\n")), "part", 1);
    for (const GcodeWords::Word& word : words.words()) {
      if (word.letter != 'f' && word.letter != 's') out += word.text;
    }
  }
  return out;
}

/// Times by which the tip keeps its feed, faster or slower by a factor a line.
void set_rates(const Program& read, Program& wanted, Random& random, bool speeds) {
  double rpm = 0.0;
  double factor = 1.0;
  std::size_t line = 0;
  for (std::size_t i = 0; i < wanted.blocks.size(); ++i) {
    Block& block = wanted.blocks[i];
    if (block.line != line) {
      line = block.line;
      factor = random.index(3) == 0 ? random.uniform(0.5, 2.0) : 1.0;
      if (random.index(6) == 0) rpm = random.index(2) == 0 ? 0.0 : random.uniform(100.0, 9000.0);
    }
    const bool told = block.spindle != Spindle::not_given || block.spindle_speed_rad_per_s > 0.0;
    if (speeds && told && rpm > 0.0) block.spindle_speed_rad_per_s = rpm * units::rpm;
    if (block.kind != Block::Kind::feed) continue;
    const double was = (read.blocks[i].end.tip_m - read.begin_of(i).tip_m).norm();
    const double is = (block.end.tip_m - wanted.begin_of(i).tip_m).norm();
    block.duration_s *= (was > 0.0 && is > 0.0 ? is / was : 1.0) / factor;
  }
}

/// One offset for a while, another one then; or one of its own for each block.
void move_tips(Program& wanted, Random& random, bool each) {
  Vector3d offset = Vector3d::Zero();
  std::size_t line = 0;
  for (std::size_t i = 0; i < wanted.blocks.size(); ++i) {
    Block& block = wanted.blocks[i];
    if (block.line != line && random.index(4) == 0) {
      offset = random.index(3) == 0 ? Vector3d(Vector3d::Zero())
                                    : Vector3d(random.normal(), random.normal(), random.normal()) * 0.1 * mm;
    }
    line = block.line;
    if (each) offset += 0.003 * mm * Vector3d(random.normal(), random.normal(), random.normal());
    block.end.tip_m = block.kind == Block::Kind::dwell ? wanted.begin_of(i).tip_m : Vector3d(block.end.tip_m + offset);
  }
}

void expect_same_moves(const Program& got, const Program& wanted, const std::string& text) {
  ASSERT_EQ(got.blocks.size(), wanted.blocks.size()) << text;
  for (std::size_t i = 0; i < wanted.blocks.size(); ++i) {
    const Block& a = got.blocks[i];
    const Block& b = wanted.blocks[i];
    ASSERT_EQ(a.kind, b.kind) << text;
    ASSERT_LT((a.end.tip_m - b.end.tip_m).norm(), 2.1e-7) << text << i;
    ASSERT_LT((a.end.axis - b.end.axis).norm(), 1e-7) << text;
    if (b.spindle != Spindle::off) {
      ASSERT_NEAR(a.spindle_speed_rad_per_s, b.spindle_speed_rad_per_s, 1e-5 * b.spindle_speed_rad_per_s) << text;
    }
    const double way = (b.end.tip_m - wanted.begin_of(i).tip_m).norm();
    const double slack = 1e-5 + (way > 0.0 ? 4e-7 / way : 0.0);
    ASSERT_NEAR(a.duration_s, b.duration_s, slack * b.duration_s) << text << i;
  }
}

struct Tally {
  int programs = 0, rejected = 0;
  std::string last = {};
};

/// Rewrites a program as wanted, and looks at what has come of it.
void check(const std::string& text, const std::string& name, const ProgramReading& reading, const Program& read,
           const Program& wanted, bool rates_alone, Tally& tally) {
  ++tally.programs;
  Rewritten out;
  try {
    out = rewrite_program_text(text, name, reading, read, wanted);
  } catch (const InvalidInput& error) {
    ++tally.rejected;
    tally.last = error.what() + ("\n" + text);
    return;
  }
  const Program got = read_program_text(out.text, name, reading);
  expect_same_moves(got, wanted, text + "\n" + out.text);
  const std::vector<std::string> old_lines = lines_of(text);
  const std::vector<std::string> new_lines = lines_of(out.text);
  ASSERT_EQ(new_lines.size(), old_lines.size() + out.added_lines) << text << "\n" << out.text;
  ASSERT_GE(kept_lines(old_lines, new_lines), old_lines.size() - out.changed_lines) << text << "\n" << out.text;
  ASSERT_EQ(rewrite_program_text(out.text, name, reading, got, got).text, out.text);
  if (name != "part.ngc") return;
  ASSERT_EQ(comments_of(out.text), comments_of(text)) << text << "\n" << out.text;
  if (rates_alone) {
    ASSERT_EQ(other_words(out.text), other_words(text)) << text << "\n" << out.text;
  }
}

TEST(RewriteProperty, RandomGcode) {
  Tally tally;
  for (int seed = 0; seed < test::seeds(20000); ++seed) {
    const bool rotary = seed % 3 == 0;
    const std::string text = Writer(static_cast<std::uint64_t>(seed)).program(rotary);
    const ProgramReading reading = {
        .machine = Machine::xyzac_trt, .chord_tolerance_m = 1e-3, .axis_tolerance_rad = 1e-2};
    Program read;
    try {
      read = read_program_text(text, "part.ngc", reading);
    } catch (const InvalidInput& error) {
      ADD_FAILURE() << error.what() << "\n" << text;
      return;
    }
    ASSERT_EQ(rewrite_program_text(text, "part.ngc", reading, read, read).text, text);
    Random random(static_cast<std::uint64_t>(seed), 1);
    Program wanted = read;
    const std::uint64_t moved = random.index(4);
    if (moved > 1) move_tips(wanted, random, moved == 3);
    set_rates(read, wanted, random, true);
    check(text, "part.ngc", reading, read, wanted, moved <= 1, tally);
    if (HasFatalFailure()) return;
  }
  EXPECT_LE(tally.rejected, tally.programs / 200) << tally.last;
  RecordProperty("rejected", tally.rejected);
  RecordProperty("last", tally.last);
}

TEST(RewriteProperty, RandomAptAndCsv) {
  Tally tally;
  for (int seed = 0; seed < test::seeds(10000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed), 2);
    const bool apt = seed % 2 == 0;
    const bool inches = apt && random.index(3) == 0;
    std::string text = apt ? inches ? "UNITS/INCHES\n" : "$$ a part\n" : "x_mm;y_mm;z_mm;i;j;k;feed_mm_per_min\n";
    if (apt)
      text +=
          fmt::format("SPINDL/{:.1f}{}\n", random.uniform(100.0, 9000.0), random.index(2) == 0 ? ",CLW" : ",RPM,CCLW");
    bool started = false;
    for (std::uint64_t n = 3 + random.index(20); n-- > 0;) {
      const Vector3d axis = Vector3d(random.normal(), random.normal(), 5.0).normalized();
      const Vector3d tip(random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0));
      const double feed = random.uniform(10.0, 900.0);
      const std::string numbers =
          fmt::format("{:.3f}{}{:.4f}{}{:.2f}", tip.x(), apt ? ',' : ';', tip.y(), apt ? ", " : ";", tip.z());
      if (!apt) {
        text += fmt::format("{};{:.7f};{:.7f};{:.7f};{:.3f}\n", numbers, axis.x(), axis.y(), axis.z(), feed);
        continue;
      }
      static constexpr std::array<const char*, 4> units = {",MMPM", ",IPM", "", ",PERMIN"};
      if (!started || random.index(3) == 0) text += fmt::format("FEDRAT/{:.3f}{} $$ F\n", feed, units[random.index(4)]);
      if (random.index(6) == 0) text += fmt::format("FEDRAT/{:.3f},MMPR\n", 1e-3 * feed);
      if (random.index(6) == 0) text += fmt::format("SPINDL/RPM,{:.2f},CLW\n", random.uniform(100.0, 9000.0));
      if (random.index(9) == 0) text += "SPINDL/OFF\n";
      if (random.index(9) == 0) text += "DELAY/2\n";
      if (random.index(5) == 0) text += "RAPID\n";
      if (started && random.index(4) == 0) {
        text += "GODLTA/" + (random.index(3) == 0 ? fmt::format("{:.3f}", tip.x()) : numbers) + "\n";
      } else {
        text += fmt::format("GOTO / {}{}{:.7f},{:.7f},{:.7f}\n", numbers, random.index(3) == 0 ? ",$\n" : ",", axis.x(),
                            axis.y(), axis.z());
      }
      started = true;
    }
    const std::string name = apt ? "part.apt" : "part.csv";
    const Program read = read_program_text(text, name);
    ASSERT_EQ(rewrite_program_text(text, name, {}, read, read).text, text);
    Program wanted = read;
    const std::uint64_t moved = random.index(3);
    if (moved > 0) move_tips(wanted, random, moved == 2);
    set_rates(read, wanted, random, apt);
    check(text, name, {}, read, wanted, moved == 0, tally);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(tally.rejected, 0) << tally.last;
}

// The program of an example, its tips moved and its rates changed at random.
TEST(RewriteProperty, AProgramOfTheExamples) {
  const std::filesystem::path path = ROBOMILL_SOURCE_DIR "/examples/force-along-program/hollow.ngc";
  const std::string text = io::read_file(path);
  const ProgramReading reading = {.machine = Machine::xyzac_trt};
  const Program read = read_program(path, reading);
  EXPECT_EQ(rewrite_program(path, reading, read, read).text, text);
  Tally tally;
  for (int seed = 0; seed < test::seeds(200); ++seed) {
    Random random(static_cast<std::uint64_t>(seed), 3);
    Program wanted = read;
    if (seed % 3 > 0) move_tips(wanted, random, seed % 3 == 2);
    set_rates(read, wanted, random, true);
    check(text, "part.ngc", reading, read, wanted, seed % 3 == 0, tally);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(tally.rejected, 0) << tally.last;
}

// Cut off, changed at any place: what is read is rewritten as wanted or rejected.
TEST(RewriteProperty, SurvivesMutations) {
  static constexpr std::array<std::string_view, 3> good = {
      "%\n(p)\nG93 G21\nS600 M3\nG0 X16.339 Y-25.409 Z33.353 A-71.841 C-35.930\nG1 X6.302 Y-11.5 Z27 A-71 C-35 F318\n"
      "G94 F100\nX1\nG2 X3 I1 A-70\nG4 P1\nG91 Y1\nG3 G18 X1 Z2 Y1 R4\nG90 G20 Z.5\nN5 G1 X 1 A3 ; end\nM30\n",
      "$$ x\nPARTNO A\nUNITS/MM\nMULTAX/ON\nSPINDL/RPM,3000,CLW\nRAPID\nGOTO/10,20,30,$\n0,0,1\nFEDRAT/600.0,MMPM\n"
      "GOTO/0,0,5\nGOTO/1.27D1,0,0,0.6,0,.8\nGODLTA/0,-3,4\nDELAY/1.5\nGODLTA/2\nFEDRAT/MMPR,.1\nGOTO/12,0,4\nFINI\n",
      "# a\nx_mm,y_mm,z_mm,i,j,k,feed_mm_per_min\n1,2,3,0,0,1,\n4, 6 "
      ",3,0,0,1,300\n4,6,\"3\",0.6,0,0.8,60\n+4,6,1.3e1,0,0,1,6\n"};
  static constexpr std::array<const char*, 3> names = {"part.ngc", "part.apt", "part.csv"};
  static constexpr std::string_view letters = "GXYZABCIJKRPFNMSTO0123456789.-+ ()%$~;/,EDL\n\r";
  const ProgramReading reading = {.machine = Machine::xyzac_trt, .chord_tolerance_m = 1e-3, .axis_tolerance_rad = 1e-2};
  Random random(77);
  Tally tally;
  for (int i = 0; i < test::seeds(60000); ++i) {
    const auto dialect = static_cast<std::size_t>(i) % 3;
    std::string text(good[dialect]);
    for (std::uint64_t n = random.index(4); n-- > 0;) {
      text[random.index(text.size())] =
          random.index(8) == 0 ? static_cast<char>(random.index(256)) : letters[random.index(letters.size())];
    }
    if (random.index(6) == 0) text.resize(1 + random.index(text.size() - 1));
    Program read;
    try {
      read = read_program_text(text, names[dialect], reading);
    } catch (const InvalidInput&) {
      continue;
    }
    ASSERT_EQ(rewrite_program_text(text, names[dialect], reading, read, read).text, text);
    Program wanted = read;
    const std::uint64_t moved = random.index(4);
    if (moved > 1) move_tips(wanted, random, moved == 3);
    set_rates(read, wanted, random, dialect != 2);
    ++tally.programs;
    try {
      const Rewritten out = rewrite_program_text(text, names[dialect], reading, read, wanted);
      expect_same_moves(read_program_text(out.text, names[dialect], reading), wanted, text + "\n" + out.text);
    } catch (const InvalidInput& error) {
      ++tally.rejected;
      tally.last = error.what();
    }
    if (HasFatalFailure()) return;
  }
  RecordProperty("programs", tally.programs);
  RecordProperty("rejected", tally.rejected);
  RecordProperty("last", tally.last);
  EXPECT_GT(tally.programs, 100);
  EXPECT_LE(tally.rejected, tally.programs / 5) << tally.last;
}

}  // namespace rewrite_property_test
}  // namespace robomill::program
