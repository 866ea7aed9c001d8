#include "robomill/program/files/program_csv.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "robomill/base/random.hpp"
#include "testing/program/reading.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace program_csv_test {

using Eigen::Vector3d;

const std::string header = "x_mm,y_mm,z_mm,i,j,k,feed_mm_per_min\n";

Program read(const std::string& text) {
  const test::Folder folder;
  return read_program(folder.file("part.csv", text));
}

void expect_rejected(const std::string& text, const std::string& words) {
  const std::string said = test::rejection([&] { static_cast<void>(read(text)); });
  EXPECT_NE(said.find(words), std::string::npos) << text << "\n" << said;
}

TEST(ProgramCsv, ReadsRowsOfTheKnownColumns) {
  const Program program =
      read("# a comment\n\n" + header +
           "1,2,3,0,0,1,\n4, 6 ,3,0,0,1,300\n4,6,3,0.6,0,0.8,60\n4,6,3,.6,0,.8,5\n+4,6,1.3e1,0,0,1,600\r\n");
  EXPECT_LT((program.start.tip_m - 1e-3 * Vector3d(1.0, 2.0, 3.0)).norm(), 1e-18);
  ASSERT_EQ(program.blocks.size(), 3U);
  EXPECT_EQ(program.blocks[0].line, 5U);
  EXPECT_EQ(program.blocks[0].kind, Block::Kind::feed);
  EXPECT_NEAR(program.blocks[0].duration_s, 1.0, 1e-12);
  EXPECT_NEAR(program.blocks[1].duration_s, std::atan2(0.6, 0.8) * 180.0 / std::numbers::pi, 1e-12)
      << "degrees a minute where the axis alone turns";
  EXPECT_NEAR(program.blocks[2].duration_s, 1.0, 1e-12);
  EXPECT_EQ(program.blocks[2].line, 8U);
}

TEST(ProgramCsv, ColumnsComeInAnyOrderAndSeparator) {
  const Program program = read("feed_mm_per_min;k;j;i;\"z_mm\";y_mm;x_mm\n0;1;0;0;3;2;1,5\n60;1;0;0;3;2;\"2,5\"\n");
  ASSERT_EQ(program.blocks.size(), 1U);
  EXPECT_NEAR(program.blocks[0].end.tip_m.x(), 2.5e-3, 1e-18);
  EXPECT_NEAR(program.blocks[0].duration_s, 1.0, 1e-12);
  EXPECT_EQ(read("x_mm\ty_mm\tz_mm\ti\tj\tk\tfeed_mm_per_min\n1\t2\t3\t0\t0\t1\t\n1\t2\t4\t0\t0\t1\t9\n").blocks.size(),
            1U);
}

TEST(ProgramCsv, RejectsWithLineColumnAndValue) {
  const std::string head = header + "1,2,3,0,0,1,\n";
  expect_rejected("x_mm,y_mm,z_mm,i,k\n1,2,3,4,5\n", "part.csv:1: has no column j, feed_mm_per_min");
  expect_rejected("x_mm,y_mm,z_mn,i,j,k,feed_mm_per_min\n",
                  "header = \"z_mn\"; is no column known here. Did you mean z_mm?");
  expect_rejected("1,2,3,0,0,1,5\n", "part.csv:1: header = \"1\"; is no column known here");
  expect_rejected("x_mm,x_mm\n", "names a column twice");
  expect_rejected(head + "1,2,4,0,0,1,\n", "part.csv:3: feed_mm_per_min: is empty");
  expect_rejected(head + "1,2,4,0,0,1\n", "part.csv:3: feed_mm_per_min: is empty");
  expect_rejected(head + "1,2,4,0,0,1,0\n", "part.csv:3: feed_mm_per_min = 0 mm/min; must be > 0");
  expect_rejected(head + "1,2,4,0,0,1,-5\n", "feed_mm_per_min = -5; must be > 0");
  expect_rejected(head + "1,2,4,0,0,1,1e12\n", "is too large for any machine");
  expect_rejected(head + "1,,4,0,0,1,9\n", "part.csv:3: y_mm: is empty");
  expect_rejected(head + "1,nan,4,0,0,1,9\n", "part.csv:3: y_mm = \"nan\"; must be a finite number");
  expect_rejected(head + "1,inf,4,0,0,1,9\n", "must be a finite number");
  expect_rejected(head + "1,two,4,0,0,1,9\n", "y_mm = \"two\"; must be a finite number");
  expect_rejected(head + "1,2,4,0,0,1,9,9\n",
                  "part.csv:3: has 8 fields where there are 7 columns. Decimal commas need");
  expect_rejected(head + "1e7,2,4,0,0,1,9\n", "x_mm = 1e+07 mm; must lie within 1 km");
  expect_rejected(head + "1,2,4,0,0,2,9\n", "i, j, k = 2; must be a vector of length 1");
  expect_rejected(head + "1,2,4,0,0,0,9\n", "i, j, k = 0; must be a vector of length 1");
  expect_rejected(head + "1,2,4,0,0,-1,9\n", "axis = 180 deg; turns by half a circle");
  expect_rejected(header, "part.csv: holds no complete position");
}

TEST(ProgramCsv, SurvivesMutations) {
  const std::string good = header + "1,2,3,0,0,1,\n4,6,3,0,0,1,300\n4,6,3,0.6,0,0.8,60\n4,6,13,0,0,1,600\n";
  Random random(41);
  int accepted = 0;
  for (int i = 0; i < test::seeds(100000); ++i) {
    std::string text = good;
    const std::size_t from = i % 4 == 0 ? 0 : header.size();
    static constexpr std::string_view letters = "0123456789.,;-+eE\"#\n\t ";
    for (std::uint64_t n = 1 + random.index(3); n-- > 0;) {
      text[from + random.index(text.size() - from)] =
          i % 3 == 0 ? static_cast<char>(random.index(256)) : letters[random.index(letters.size())];
    }
    if (i % 5 == 0) text.resize(1 + random.index(good.size() - 1));
    try {
      const Program program = test_support::read_text<CsvReader>(text);
      ++accepted;
      for (const Block& block : program.blocks) {
        ASSERT_TRUE(block.end.tip_m.allFinite()) << text;
        ASSERT_NEAR(block.end.axis.norm(), 1.0, 1e-12) << text;
        ASSERT_TRUE(block.duration_s > 0.0 && std::isfinite(block.duration_s)) << text;
      }
    } catch (const InvalidInput&) {
      continue;
    }
  }
  EXPECT_GT(accepted, 50);
}

}  // namespace program_csv_test
}  // namespace robomill::program
