// What the parts of other tools say where one is chosen: GOHOME, FROM, RAPID, axes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/program/files/program_files.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace apt_passed_test {

using Eigen::Vector3d;

constexpr double mm = 1e-3;

Program read(const std::string& text, std::optional<int> tool) {
  return read_program_text(text, "part.apt", {.tool = {.number = tool}});
}

void expect_rejected(const std::string& text, int tool, const std::string& words) {
  const std::string said = test::rejection([&] { static_cast<void>(read(text, tool)); });
  EXPECT_NE(said.find(words), std::string::npos) << text << "\n" << said;
}

/// Poses, kinds and times; lines lie elsewhere.
void expect_same(const Program& one, const Program& other, const std::string& text) {
  EXPECT_EQ(one.start.tip_m, other.start.tip_m) << text;
  EXPECT_EQ(one.start.axis, other.start.axis) << text;
  ASSERT_EQ(one.blocks.size(), other.blocks.size()) << text;
  for (std::size_t i = 0; i < one.blocks.size(); ++i) {
    EXPECT_EQ(one.blocks[i].kind, other.blocks[i].kind) << i << text;
    EXPECT_EQ(one.blocks[i].end.tip_m, other.blocks[i].end.tip_m) << i << text;
    EXPECT_EQ(one.blocks[i].end.axis, other.blocks[i].end.axis) << i << text;
    EXPECT_EQ(one.blocks[i].duration_s, other.blocks[i].duration_s) << i << text;
  }
}

const std::string first = "LOADTL/1\nRAPID\nGOTO/0,0,10,0,0,1\nFEDRAT/60\nGOTO/0,0,0\nGOTO/10,0,0\n";

// Wherever another tool goes home to: the chosen one's part starts from its own first position.
TEST(AptPassed, AnothersHomeGivesNoStart) {
  const std::string parts[] = {"RAPID\nGOTO/0,5,10\nGOTO/0,5,0\nGOTO/9,5,0\n",
                               "GOTO/0,5,10\nGODLTA/0,0,-10\nGODLTA/-4\n",
                               "FROM/0,5,50\nGOTO/0,5,10\nRAPID\nGOTO/0,5,20\n",
                               "GOHOME\nGOTO/0,5,10\nGOTO/0,5,0\n",
                               "GOHOME/1,2,90\nRAPID\nGOTO/0,5,10\nGOTO/0,5,0\n",
                               "GOTO/0,5,10\nGOTO/0,5,0\nGOHOME\nRAPID\nGOTO/7,5,4\nGOTO/7,5,0\n"};
  for (const std::string& part : parts) {
    const Program alone = read("FEDRAT/60\nLOADTL/2\n" + part, {});
    for (const std::string home :
         {"", "GOHOME\n", "GOHOME/1,2,90\n", "RAPID\nGOHOME/1,2,90,0,0,1\n", "FROM/3,3,3\n", "FROM/3,3,3,0,0,1\n",
          "GOHOME\nGODLTA/0,0,7\n", "RETRCT\nGOHOME/1,2,90\n", "GOHOME/1,2,90\nGOTO/1,2,80\nGOHOME\n"}) {
      for (const std::string& text : {first + home + "LOADTL/2\n" + part, home + first + "LOADTL/2\n" + part,
                                      first + "LOADTL/2\n" + part + "LOADTL/3\n" + home + "GOTO/1,1,1\nFINI\n"}) {
        expect_same(read(text, 2), alone, text);
      }
    }
  }
  EXPECT_EQ(read(first + "GOHOME/1,2,90\nLOADTL/2\nGOHOME/4,5,80\nGOTO/0,5,0\n", 2).start.tip_m,
            mm * Vector3d(4, 5, 80))
      << "its own home is a position";
}

TEST(AptPassed, WithoutAPositionOfItsOwnItIsRejected) {
  for (const std::string home : {"GOHOME/1,2,90\n", "FROM/1,2,90\n", "GOTO/1,2,90\n", "GOHOME\n"}) {
    const std::string before = first + home + "LOADTL/2\n";
    expect_rejected(before + "GODLTA/0,0,-5\n", 2, "GODLTA: is a step from a position that no line has given");
    expect_rejected(before + "CIRCLE/0,0,0,0,0,1\nGOTO/1,0,0\n", 2, "is an arc from a position that no line has given");
    expect_rejected(before + "CYCLE/DRILL,5\nGOTO/1,0,0\n", 2, "has no heights");
    expect_rejected(before + "GOHOME\nFINI\n", 2, "program.tool = 2; comes to no complete position");
    expect_rejected(before + "RETRCT\nSTOP\nFINI\n", 2, "program.tool = 2; comes to no complete position");
  }
}

// The axis goes on, as i, j, k of GOTO and FROM do.
TEST(AptPassed, AnAxisOfAnotherToolGoesOn) {
  const std::string part = "LOADTL/2\nGOTO/0,5,10\nGOTO/0,5,0\n";
  for (const std::string word : {"GOTO", "FROM", "GOHOME"}) {
    const Program program = read(first + word + "/1,2,90,0,.6,.8\n" + part, 2);
    EXPECT_LT((program.start.axis - Vector3d(0, 0.6, 0.8)).norm(), 1e-12) << word;
    EXPECT_EQ(program.start.tip_m, mm * Vector3d(0, 5, 10)) << word;
    EXPECT_EQ(program.blocks.size(), 1U) << word;
  }
}

// A RAPID is of the next move alone, be it one that is not read.
TEST(AptPassed, ARapidOfAnotherToolEndsWithItsMove) {
  const std::string part = "LOADTL/2\nFROM/0,5,50\nGOTO/0,5,10\n";
  for (const std::string move : {"GOTO/1,2,90\n", "GOHOME/1,2,90\n", "GODLTA/0,0,80\n"}) {
    const Program program = read(first + "RAPID\n" + move + part, 2);
    ASSERT_EQ(program.blocks.size(), 1U) << move;
    EXPECT_EQ(program.blocks[0].kind, Block::Kind::feed) << move;
    EXPECT_NEAR(program.blocks[0].duration_s, 40.0, 1e-9) << move;
  }
  EXPECT_EQ(read(first + "GOHOME/1,2,90\nRAPID\n" + part, 2).blocks[0].kind, Block::Kind::rapid)
      << "one that has moved nothing yet is of the next tool's first move";
}

// What comes behind the chosen part moves it no more.
TEST(AptPassed, TheChosenPartEndsWhereItEnded) {
  const std::string second = "LOADTL/2\nRAPID\nGOTO/5,5,50\nGOHOME/9,9,90\n";
  for (const std::string end : {"", "GOHOME\n", "RETRCT\n"}) {
    for (const std::string behind : {"FINI\n", "LOADTL/1\nFINI\n", "LOADTL/1\nGOHOME\nFINI\n", "LOADTL/1\nSTOP\nFINI\n",
                                     "LOADTL/1\nDELAY/2\nOPSTOP\n"}) {
      const Program program = read(first + end + second + behind, 1);
      ASSERT_GE(program.blocks.size(), 2U) << end << behind;
      EXPECT_EQ(program.blocks[1].kind, Block::Kind::feed);
      for (std::size_t i = 1; i < program.blocks.size(); ++i) {
        EXPECT_EQ(program.blocks[i].end.tip_m, mm * Vector3d(10, 0, 0)) << end << behind;
      }
    }
  }
  expect_rejected(first + second + "LOADTL/1\nGOHOME/0,0,90\n", 1, "T1: moves again in this line after T2 (line 7)");
  expect_rejected(first + second + "LOADTL/1\nGODLTA/1\n", 1, "T1: moves again in this line after T2 (line 7)");
}

// Random parts of three tools, each with homes and steps: the chosen one is what it is alone.
TEST(AptPassed, EachPartIsWhatItIsAlone) {
  for (int seed = 0; seed < test::seeds(2000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const auto number = [&] { return static_cast<int>(random.index(200)) - 100; };
    const auto statement = [&]() -> std::string {
      switch (random.index(9)) {
        case 0:
          return "GOHOME\nRAPID\nGOTO/" + fmt::format("{},{},{}\n", number(), number(), number());
        case 1:
          return fmt::format("GOHOME/{},{},{}\n", number(), number(), number());
        case 2:
          return fmt::format("RAPID\nGOHOME/{},{},{},0,0,1\n", number(), number(), number());
        case 3:
          return fmt::format("GODLTA/{},{},{}\n", number(), number(), number());
        case 4:
          return fmt::format("RAPID\nGOTO/{},{},{}\n", number(), number(), number());
        case 5:
          return "DELAY/1\n";
        default:
          return fmt::format("GOTO/{},{},{},0,0,1\n", number(), number(), number());
      }
    };
    std::string text;
    std::string parts[3];
    for (int tool = 0; tool < 3; ++tool) {
      std::string& part = parts[tool];
      part = fmt::format("LOADTL/{}\nFEDRAT/{}\n", tool + 1, 60 * (tool + 1));
      if (random.index(3) == 0) part += fmt::format("FROM/{},{},{}\n", number(), number(), number());
      part += fmt::format("GOTO/{},{},{},0,0,1\n", number(), number(), number());
      for (int i = 0; i < 8; ++i) part += statement();
      if (random.index(2) == 0) part += "GOHOME\n";
      text += part;
    }
    for (int tool = 0; tool < 3; ++tool) expect_same(read(text + "FINI\n", tool + 1), read(parts[tool], {}), text);
  }
}

}  // namespace apt_passed_test
}  // namespace robomill::program
