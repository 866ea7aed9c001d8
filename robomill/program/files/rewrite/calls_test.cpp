// Programs that call subprograms, rewritten with their calls expanded.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/program/files/gcode/calls.hpp"
#include "robomill/program/files/rewrite.hpp"
#include "robomill/program/files/rewrite/calls.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace rewrite_calls_test {

constexpr double mm = 1e-3;

struct Case {
  std::string text;
  ProgramReading reading = {};
  std::string name = "part.nc";
  Program read = read_program_text(text, name, reading);
  Program wanted = read;

  [[nodiscard]] Rewritten rewrite(const std::vector<std::string>& header = {}) const {
    return rewrite_program_text(text, name, reading, read, wanted, header);
  }
  [[nodiscard]] std::string rejected() const {
    return test::rejection([&] { static_cast<void>(rewrite()); });
  }
};

std::string expanded(const std::string& text) {
  return Case{.text = text}.rewrite().text;
}

std::string said_of(const std::string& text) {
  return Case{.text = text}.rejected();
}

TEST(RewriteCalls, EachPassHasItsOwnFeedAndSpeed) {
  Case part = {.text =
                   "%\nO1 (PART)\nN1 S4000 M3\nN2 G0 X0 Y0 Z5\nN3 M98 P70\nN4 G0 X9\nN5 M98 P70 L2 (twice)\nN6 M30\n"
                   "O70\nN1 G1 Z-1 F120\nN2 Z5 (up)\nN3 M99\n%\n"};
  const Rewritten same = part.rewrite({"Speeds by robomill"});
  EXPECT_EQ(same.text,
            "%\nO1 (PART)\n(Speeds by robomill)\n(3 calls of subprograms are expanded in place)\nN1 S4000 M3\n"
            "N2 G0 X0 Y0 Z5\n"
            "N3 (M98 P70)\nG1 Z-1 F120\nZ5 (up)\n(M99)\nN4 G0 X9\n"
            "N5 (M98 P70 L2) (twice)\nG1 Z-1 F120\nZ5 (up)\n(M99)\nG1 Z-1 F120\nZ5 (up)\n(M99)\nN6 M30\n%\n");
  EXPECT_EQ(same.expanded_calls, 3U);
  EXPECT_EQ(same.changed_lines + same.added_lines, 0U);
  EXPECT_EQ(same.first_changed, 5U) << "the first that calls";
  ASSERT_EQ(part.wanted.blocks.size(), 7U);
  part.wanted.blocks[1].duration_s *= 0.5;
  part.wanted.blocks[4].duration_s *= 2.0;
  for (std::size_t i = 3; i < 5; ++i) part.wanted.blocks[i].spindle_speed_rad_per_s = 3950.0 * units::rpm;
  part.wanted.blocks[5].end.tip_m.z() -= 0.25 * mm;
  part.wanted.blocks[5].duration_s *= 6.25 / 6.0;
  part.wanted.blocks[6].duration_s *= 6.25 / 6.0;
  const Rewritten out = part.rewrite();
  EXPECT_EQ(out.text,
            "%\nO1 (PART)\n(3 calls of subprograms are expanded in place)\nN1 S4000 M3\nN2 G0 X0 Y0 Z5\n"
            "N3 (M98 P70)\nG1 Z-1 F120\nZ5 F240 (up)\n(M99)\nN4 G0 X9\n"
            "N5 (M98 P70 L2) (twice)\nG1 Z-1 F120 S3950\nZ5 F60 (up)\n(M99)\nG1 Z-1.25 F120 S4000\nZ5 (up)\n(M99)\n"
            "N6 M30\n%\n");
  EXPECT_EQ(out.changed_lines, 4U);
}

TEST(RewriteCalls, OWordsAndTheirDefinitions) {
  Case part = {.text =
                   "o<a> sub\n(down)\nG91\nG1 Z-1 F60\no<a> endsub\nG0 X0 Y0 Z5\no<A> call (first)\nG90 G0 X1\n"
                   "  o<a> call ; second\nM2\nG1 X99 (not carried out)\n",
               .name = "part.ngc"};
  part.wanted.blocks[2].duration_s *= 0.5;
  EXPECT_EQ(part.rewrite().text,
            "(2 calls of subprograms are expanded in place)\nG0 X0 Y0 Z5\n(o<A> call) (first)\n(down)\nG91\n"
            "G1 Z-1 F60\n(o<a> endsub)\nG90 G0 X1\n  (o<a> call) ; second\n(down)\nG91\nG1 Z-1 F120\n(o<a> endsub)\n"
            "M2\n");
  EXPECT_EQ(part.rewrite().first_changed, 7U);
}

TEST(RewriteCalls, CallsOfEveryKindWithinCalls) {
  EXPECT_EQ(expanded("G0 X0 Y0 Z0\nG91\nM98P20007\nM30\nO7\nN5 G1 X2 F60 M98 P8\nG90 M99\nO8\nM97 P5 L3\nM99\nN5 Y1\n"
                     "G91 M99\n"),
            "(10 calls of subprograms are expanded in place)\nG0 X0 Y0 Z0\nG91\n(M98 P20007)\n"
            "G1 X2 F60 (M98 P8)\n(M97 P5 L3)\nY1\nG91 (M99)\nY1\nG91 (M99)\nY1\nG91 (M99)\n(M99)\nG90 (M99)\n"
            "G1 X2 F60 (M98 P8)\n(M97 P5 L3)\nY1\nG91 (M99)\nY1\nG91 (M99)\nY1\nG91 (M99)\n(M99)\nG90 (M99)\nM30\n");
  // A subprogram that ends the program.
  EXPECT_EQ(expanded("G0 X0 Y0 Z0\nM98 P7\nG1 X9\nM30\nO7\nG1 X2 F60\nM30\n"),
            "(1 call of subprograms is expanded in place)\nG0 X0 Y0 Z0\n(M98 P7)\nG1 X2 F60\nM30\n");
  // Before the first position, and a number within.
  EXPECT_EQ(expanded("M98 P7\nG1 X2 F60\nM30\nO7\nO8\nG0 X0 Y0 Z0\nM99\n"),
            "(1 call of subprograms is expanded in place)\n(M98 P7)\n(O8)\nG0 X0 Y0 Z0\n(M99)\nG1 X2 F60\nM30\n");
}

TEST(RewriteCalls, LineEndsAndOddLines) {
  EXPECT_EQ(expanded("\xEF\xBB\xBFg0 x0 y0 z0\r\nn 1 0 g1 x1 f60 p(which)7 m98 l 2 (go)\r\nx9\r\nm2\r\no7\r\n"
                     "n 1 y2\r\nn3\r\n\r\nm99"),
            "\xEF\xBB\xBF(2 calls of subprograms are expanded in place)\r\ng0 x0 y0 z0\r\n"
            "n 1 0 g1 x1 f60 (p[which]7 m98 l 2) (go)\r\ny2\r\n\r\n\r\n(m99)\r\ny2\r\n\r\n\r\n(m99)\r\nx9\r\nm2\r\n");
  EXPECT_EQ(expanded("G0 X0 Y0 Z0\nM98 P7\n%\nO7\nG1 X1 ~\nF60\nM99\n%\n"),
            "(1 call of subprograms is expanded in place)\nG0 X0 Y0 Z0\n(M98 P7)\nG1 X1 ~\nF60\n(M99)\n%\n");
}

// With the machine's switch off a deleted line is carried out.
TEST(RewriteCalls, DeletedLinesCallNothing) {
  EXPECT_EQ(
      expanded("G0 X0 Y0 Z0\n/M98 P8\nN3 / M98 P7 (a)\n/G1 X4\n/M99\nM98 P7\nM30\nO7\nN4 /M99\nN5 /X7\nG1 X1 F60\n"
               "M99\n"),
      "(1 call of subprograms is expanded in place)\nG0 X0 Y0 Z0\n(/M98 P8)\n(N3 / M98 P7) (a)\n/G1 X4\n/M99\n"
      "(M98 P7)\n(N4 /M99)\n/X7\nG1 X1 F60\n(M99)\nM30\n");
}

TEST(RewriteCalls, AProgramThatCallsNothingKeepsItsBytes) {
  for (const std::string text : {"G0 X0 Y0 Z0\nG1 X1 F60 (M98 P7)\nM30\nO7\nG1 X2\nM98 P8\nM99\n",
                                 "o1 sub\nG1 X9\no2 call\no1 endsub\nG0 X0 Y0 Z0\n/M98 P1\nG1 X1 F60\nM2\n"}) {
    EXPECT_EQ(expanded(text), text);
  }
  EXPECT_FALSE(may_call("(M98) M03 M9 O98\nX98 ; o1 call\no<m> sub\n", "part"));
  EXPECT_TRUE(may_call("G0 X0\rm 0 9(a)8 p1\r", "part"));
  EXPECT_TRUE(may_call("M97P1", "part"));
  EXPECT_TRUE(may_call("O <m> CALL", "part"));
}

TEST(RewriteCalls, OneToolsPartIsChangedAndTheOthersStay) {
  const std::string text =
      "T1 M6\nS900 M3\nG0 X0 Y0 Z5\nF100\nM98 P1\nG0 Z9\nT2 M6\nS800 M3\nG0 X0 Y0 Z5\nM98 P1 L2\nM30\nO1\nG91\n"
      "G1 Z-1\nG90\nG0 Z5\nM99\n";
  Case one = {.text = text, .reading = {.tool = {.number = 1}}};
  for (Block& block : one.wanted.blocks) {
    if (block.kind == Block::Kind::feed) block.duration_s *= 0.5;
  }
  EXPECT_EQ(one.rewrite().text,
            "(3 calls of subprograms are expanded in place)\nT1 M6\nS900 M3\nG0 X0 Y0 Z5\nF200\n(M98 P1)\nG91\nG1 Z-1\n"
            "G90\nG0 Z5\n(M99)\nG0 Z9\nF100\nT2 M6\nS800 M3\nG0 X0 Y0 Z5\n(M98 P1 L2)\nG91\nG1 Z-1\nG90\nG0 Z5\n(M99)\n"
            "G91\nG1 Z-1\nG90\nG0 Z5\n(M99)\nM30\n");
  Case two = {.text = text, .reading = {.tool = {.number = 2}}};
  two.wanted.blocks[2].duration_s *= 0.5;
  EXPECT_NE(two.rewrite().text.find("(M98 P1 L2)\nG91\nG1 Z-1\nG90\nG0 Z5\n(M99)\nG91\nG1 Z-1 F200\nG90\n"),
            std::string::npos)
      << two.rewrite().text;
}

TEST(RewriteCalls, ErrorsNameTheLineOfTheProgram) {
  const std::string text = "G0 X0 Y0 Z0\nM98 P7 L3\nM30\nO7\nG3 X0 Y10 I-10 J5 F60\nG0 X0 Y0\nM99\n";
  Case arc = {.text = text, .reading = {.chord_tolerance_m = 1e-4}};
  arc.wanted.blocks.back().end.axis = Eigen::Vector3d::UnitX();
  EXPECT_EQ(arc.rejected().find("part.nc:6: tool axis: cannot be said by this program"), 0U) << arc.rejected();
  arc.wanted = arc.read;
  arc.wanted.blocks[arc.wanted.blocks.size() - 4].duration_s *= 2.0;
  EXPECT_EQ(arc.rejected().find("part.nc:5: feed: must be one for all"), 0U) << arc.rejected();
  arc.wanted = arc.read;
  arc.read.blocks[1].end.tip_m.x() += 1e-3;
  EXPECT_EQ(arc.rejected().find("part.nc:5: as_read: is not what this file gives with its calls of subprograms"), 0U)
      << arc.rejected();
  arc.read.blocks.pop_back();
  EXPECT_EQ(arc.rejected().find("part.nc: wanted has"), 0U);
  EXPECT_NE(said_of("G0 X0 Y0 Z5\nM98 P7 ~\n\nM30\nO7\nG1 X1 F60\nM99\n")
                .find("part.nc:3: calls or ends a subprogram "
                      "in a statement over several lines"),
            std::string::npos);
}

TEST(RewriteCalls, TheExpandedProgramIsBounded) {
  const std::string comment(20'000, 'a');
  const std::string text =
      fmt::format("G0 X0 Y0 Z0\nM98 P7 L9\nG1 X1 F60\nM30\nO7\nM98 P8 L999\nM99\nO8\n({})\nM99\n", comment);
  EXPECT_EQ(said_of(text).find("part.nc:9: lies beyond the first 64 MB of the program with its calls of subprograms "
                               "expanded"),
            0U);
}

TEST(RewriteCalls, AnErrorIsMovedToItsOrigin) {
  const std::vector<std::size_t> origins = {0, 7, 3};
  const auto where = [&](const std::string& at) {
    return at_origin(InvalidInput(InvalidInput::Parts{.where = at, .rule = "is wrong"}), "a.nc", origins).parts().where;
  };
  EXPECT_EQ(where("a.nc:2"), "a.nc:7");
  EXPECT_EQ(where("a.nc:3"), "a.nc:3");
  EXPECT_EQ(where("a.nc:1"), "a.nc:1") << "a line of the header";
  EXPECT_EQ(where("a.nc:4"), "a.nc:4");
  EXPECT_EQ(where("b.nc:2"), "b.nc:2");
  EXPECT_EQ(where("a.nc"), "a.nc");
}

}  // namespace rewrite_calls_test
}  // namespace robomill::program
