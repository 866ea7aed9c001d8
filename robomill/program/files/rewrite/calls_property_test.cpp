// Random programs of nested calls, each pass with feeds and speeds of its own.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/program/files/gcode/words.hpp"
#include "robomill/program/files/rewrite.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace rewrite_calls_property_test {

/// Subprograms 1 to n, each of which may call those after it.
class Writer {
 public:
  explicit Writer(std::uint64_t seed) : random_(seed, 5) {}

  std::string program() {
    o_words_ = odds(3);
    end_ = odds(3) ? "\r\n" : "\n";
    count_ = 1 + random_.index(4);
    std::string definitions;
    for (std::uint64_t i = count_; i > 0; --i) definitions += definition(i);
    std::string main = line("S4000 M3") + line("G21 G90 G0 X0 Y0 Z0") + line("G1 X1 F600");
    main += body(0) + call(1) + body(0);
    main += line(odds(2) ? "M30" : "M2");
    return o_words_ ? definitions + main : main + definitions + (odds(2) ? line("%") : "");
  }

 private:
  bool odds(std::uint64_t one_of) { return random_.index(one_of) == 0; }
  std::string line(const std::string& words) {
    std::string out = odds(4) && words.front() != 'o' && words.front() != 'O' && words.front() != '%'
                          ? fmt::format("N{} ", random_.index(50)) + words
                          : words;
    if (odds(6) && words.front() != '%') out += odds(2) ? " (F1 M98)" : " ; S1";
    return out + end_;
  }
  std::string definition(std::uint64_t number) {
    if (o_words_) {
      return line(fmt::format("o{} sub", number)) + body(number) + line(fmt::format("o{} endsub", number));
    }
    return line(fmt::format("O{}", number)) + body(number) + line(odds(3) ? move() + " M99" : "M99");
  }
  std::string call(std::uint64_t number) {
    if (o_words_) return line(fmt::format("o{} call", number));
    const std::uint64_t repeats = 1 + random_.index(3);
    switch (random_.index(3)) {
      case 0:
        return line(fmt::format("M98 P{} L{}", number, repeats));
      case 1:
        return line(fmt::format("M98 P{}{:04}", repeats, number));
      default:
        return line(fmt::format("{} M98 P{}", move(), number));
    }
  }
  std::string move() {
    const double x = random_.uniform(-20.0, 20.0), y = random_.uniform(-20.0, 20.0);
    return fmt::format("G{} X{:.3f} Y{:.3f}", odds(4) ? 0 : 1, x, y) +
           (odds(3) ? fmt::format(" F{:.1f}", random_.uniform(100.0, 900.0)) : "") +
           (odds(6) ? fmt::format(" S{:.0f}", random_.uniform(1000.0, 9000.0)) : "");
  }
  std::string body(std::uint64_t number) {
    std::string out;
    for (std::uint64_t n = random_.index(5); n-- > 0;) {
      switch (random_.index(10)) {
        case 0:
          out += line(odds(2) ? "G91" : "G90");
          break;
        case 1:
          out += line(odds(2) ? "G20" : "G21");
          break;
        case 2:
          out += line("G4 P.5");
          break;
        case 3:
          out += line("G91 G2 X2 Y2 I2 F300");
          break;
        case 4:
        case 5:
          if (number < count_) out += call(number + 1 + random_.index(count_ - number));
          break;
        case 6:
          out += line(odds(2) ? "T5 M48" : "(what)");
          break;
        default:
          out += line(move());
      }
    }
    return out;
  }

  Random random_;
  bool o_words_ = false;
  std::uint64_t count_ = 1;
  std::string end_;
};

/// A factor for each stretch of blocks of one line.
void set_rates(Program& wanted, Random& random) {
  double factor = 1.0;
  double rpm = 4000.0;
  for (std::size_t i = 0; i < wanted.blocks.size(); ++i) {
    Block& block = wanted.blocks[i];
    if (i == 0 || block.line != wanted.blocks[i - 1].line) {
      factor = random.index(2) == 0 ? random.uniform(0.5, 2.0) : 1.0;
      if (random.index(5) == 0) rpm = random.uniform(1000.0, 9000.0);
    }
    block.spindle_speed_rad_per_s = rpm * units::rpm;
    if (block.kind == Block::Kind::feed) block.duration_s /= factor;
  }
}

void expect_blocks(const Program& got, const Program& wanted, const std::string& text) {
  ASSERT_EQ(got.blocks.size(), wanted.blocks.size()) << text;
  for (std::size_t i = 0; i < wanted.blocks.size(); ++i) {
    const Block& a = got.blocks[i];
    const Block& b = wanted.blocks[i];
    ASSERT_EQ(a.kind, b.kind) << text;
    ASSERT_LT((a.end.tip_m - b.end.tip_m).norm(), 1e-9) << text << i;
    ASSERT_NEAR(a.spindle_speed_rad_per_s, b.spindle_speed_rad_per_s, 1e-5 * b.spindle_speed_rad_per_s) << text << i;
    ASSERT_NEAR(a.duration_s, b.duration_s, 1e-5 * b.duration_s) << text << i;
  }
}

TEST(RewriteCallsProperty, RandomCallsWithRatesOfTheirOwn) {
  const ProgramReading reading = {.chord_tolerance_m = 1e-4};
  int programs = 0;
  for (int seed = 0; seed < test::seeds(4000); ++seed) {
    const std::string text = Writer(static_cast<std::uint64_t>(seed)).program();
    const Program read = read_program_text(text, "part.ngc", reading);
    if (read.blocks.size() > 300) continue;
    ++programs;
    const Rewritten same = rewrite_program_text(text, "part.ngc", reading, read, read);
    ASSERT_GT(same.expanded_calls, 0U) << text;
    ASSERT_EQ(same.changed_lines + same.added_lines, 0U) << text;
    Program again = read_program_text(same.text, "part.ngc", reading);
    expect_blocks(again, read, text + "\n" + same.text);
    ASSERT_EQ(rewrite_program_text(same.text, "part.ngc", reading, again, again).text, same.text);
    Program wanted = read;
    Random random(static_cast<std::uint64_t>(seed), 6);
    set_rates(wanted, random);
    const Rewritten out = rewrite_program_text(text, "part.ngc", reading, read, wanted);
    again = read_program_text(out.text, "part.ngc", reading);
    expect_blocks(again, wanted, text + "\n" + out.text);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(programs, test::seeds(4000) / 2);
}

// Cut off or changed at any place: what is read is rewritten to the same blocks, and calls nothing, or is rejected.
TEST(RewriteCallsProperty, SurvivesMutations) {
  const std::string good =
      "%\nO1\nG21 G90\nS600 M3\nG0 X0 Y0 Z5.\nG1 X1. F60\nM98 P7 L2\nN4 X2. M98 P20008\n/M98 P9\nM97 P9\nM30\n"
      "N9 G0 Z3.\nM99\nO7\nN1 G91 X2. F9\nG90 M99\nO8\nN2 M98 P7\nM99\n%\n";
  static constexpr std::string_view letters = "GXYZPLNMOo0123456789./%\n\r ~$()";
  Random random(78);
  int rewritten = 0, expanded = 0, rejected = 0;
  std::string last;
  for (int i = 0; i < test::seeds(40000); ++i) {
    std::string text = good;
    for (std::uint64_t n = random.index(4); n-- > 0;) {
      text[random.index(text.size())] = letters[random.index(letters.size())];
    }
    if (random.index(8) == 0) text.resize(1 + random.index(text.size() - 1));
    Program read;
    try {
      read = read_program_text(text, "part.nc");
    } catch (const InvalidInput&) {
      continue;
    }
    if (read.blocks.size() > 300) continue;
    ++rewritten;
    try {
      const Rewritten out = rewrite_program_text(text, "part.nc", {}, read, read);
      expanded += out.expanded_calls > 0 ? 1 : 0;
      if (out.expanded_calls == 0) {
        ASSERT_EQ(out.text, text);
      }
      const Program again = read_program_text(out.text, "part.nc");
      expect_blocks(again, read, text + "\n" + out.text);
      if (out.expanded_calls > 0) {
        ASSERT_EQ(rewrite_program_text(out.text, "part.nc", {}, again, again).text, out.text);
      }
    } catch (const InvalidInput& error) {
      ++rejected;
      last = error.what() + ("\n" + text);
    }
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(expanded, 10);
  EXPECT_LE(rejected, rewritten / 20) << last;
  RecordProperty("rewritten", rewritten);
  RecordProperty("expanded", expanded);
  RecordProperty("rejected", rejected);
  RecordProperty("last", last);
}

}  // namespace rewrite_calls_property_test
}  // namespace robomill::program
