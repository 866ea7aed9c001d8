#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/program/files/rewrite.hpp"
#include "testing/support.hpp"

namespace robomill::program {
namespace rewrite_apt_csv_test {

using Eigen::Vector3d;

struct Case {
  std::string text;
  std::string name = "part.apt";
  Program read = read_program_text(text, name);
  Program wanted = read;

  [[nodiscard]] Rewritten rewrite(const std::vector<std::string>& header = {}) const {
    return rewrite_program_text(text, name, {}, read, wanted, header);
  }
  void move(std::size_t block, const Vector3d& by_mm) {
    const double was = (wanted.blocks[block].end.tip_m - wanted.begin_of(block).tip_m).norm();
    wanted.blocks[block].end.tip_m += 1e-3 * by_mm;
    const double is = (wanted.blocks[block].end.tip_m - wanted.begin_of(block).tip_m).norm();
    wanted.blocks[block].duration_s *= is / was;
  }
};

const std::string apt =
    "$$ written by hand\nPARTNO  A PART / OF $5, NO MORE\nUNITS / MM\nSPINDL / RPM, 3000.000000,  CLW\nRAPID\n"
    "GOTO / 10.0, 20.0, 30.0, $\n 0.0, 0.0, 1.0\nRAPID\nGOTO/0,0,5\nFEDRAT / 600.0, MMPM\ngoto/0,0,0 $$ down\n"
    "GOTO/1.27D1,0,0,0.6,0,.8\nA1) GODLTA/0,-3,4\nDELAY/1.5\nGODLTA/2\nFEDRAT/MMPR,0.1\n"
    "GOTO/12.7,0,4,6.0E-1,0,0.8\nPPRINT GOTO/1,2,3 $\nFINI\nGOTO/99,99,99\n";

TEST(RewriteApt, NothingWantedIsNothingChanged) {
  const Case same = {.text = apt};
  EXPECT_EQ(same.rewrite().text, apt);
  EXPECT_EQ(same.rewrite({"by (robomill)"}).text, "$$ by (robomill)\n" + apt);
}

TEST(RewriteApt, FeedsAndSpeeds) {
  Case one = {.text = apt};
  ASSERT_EQ(one.read.blocks.size(), 7U);
  one.wanted.blocks[2].duration_s *= 0.5;
  one.wanted.blocks[3].spindle_speed_rad_per_s *= 1.1;
  std::string text = apt;
  const auto insert = [&](const std::string& before, const std::string& line) { text.insert(text.find(before), line); };
  insert("GOTO/1.27D1", "FEDRAT / 1200., MMPM\n");
  insert("A1) GODLTA", "SPINDL / RPM, 3300.,  CLW\nFEDRAT / 600., MMPM\n");
  insert("DELAY", "SPINDL / RPM, 3000.,  CLW\n");
  EXPECT_EQ(one.rewrite().text, text);
  EXPECT_EQ(one.rewrite().changed_lines, 0U);
  EXPECT_EQ(one.rewrite().added_lines, 4U);
  // A feed a revolution follows the speed.
  Case all = {.text = apt};
  for (Block& block : all.wanted.blocks) block.spindle_speed_rad_per_s *= 2.0;
  text = apt;
  text.replace(text.find("3000.000000"), 11, "6000.");
  text.replace(text.find("MMPR,0.1"), 8, "MMPR,0.05");
  EXPECT_EQ(all.rewrite().text, text);
}

TEST(RewriteApt, FeedsInInchesAndDegrees) {
  Case units = {
      .text = "UNITS/INCHES\nGOTO/1,0,0,0,0,1\nFEDRAT/10\nGOTO/2,0,0\nUNITS/MM\nGOTO/0,0,0\nGOTO/0,0,0,0,.6,.8\n"};
  units.wanted.blocks[1].duration_s *= 0.5;
  units.wanted.blocks[2].duration_s *= 0.25;
  EXPECT_EQ(units.rewrite().text,
            "UNITS/INCHES\nGOTO/1,0,0,0,0,1\nFEDRAT/10\nGOTO/2,0,0\nUNITS/MM\nFEDRAT/508,MMPM\nGOTO/0,0,0\n"
            "FEDRAT/40,MMPM\nGOTO/0,0,0,0,.6,.8\n");
}

TEST(RewriteApt, Positions) {
  Case one = {.text = apt};
  one.move(1, {0.0, 0.0, -0.5});
  one.move(3, {0.01, 0.0, 0.0});
  one.wanted.blocks[4].end = one.wanted.blocks[3].end;
  std::string text = apt;
  text.replace(text.find("goto/0,0,0"), 10, "goto/0,0,-0.5");
  text.replace(text.find("GODLTA/0,-3"), 11, "GODLTA/0.01,-3");
  text.replace(text.find("GODLTA/2"), 8, "GODLTA/1.19,0,1.6");
  // Feeds stay where the times follow the ways.
  for (const std::size_t i : {2U, 5U}) {
    const double was = (one.read.blocks[i].end.tip_m - one.read.begin_of(i).tip_m).norm();
    const double is = (one.wanted.blocks[i].end.tip_m - one.wanted.begin_of(i).tip_m).norm();
    one.wanted.blocks[i].duration_s = one.read.blocks[i].duration_s * is / was;
  }
  EXPECT_EQ(one.rewrite().text, text);
}

const std::string csv =
    "# a comment\n\nx_mm,y_mm,z_mm,i,j,k,feed_mm_per_min\n1,2,3,0,0,1,\n4, 6 ,3,0,0,1,300\n"
    "4,6,3,0.6,0,0.8,60\r\n+4,6,1.3e1,0,0,1,600";

TEST(RewriteCsv, FeedsAndPositions) {
  Case one = {.text = csv, .name = "part.csv"};
  EXPECT_EQ(one.rewrite().text, csv);
  EXPECT_EQ(one.rewrite({"by robomill"}).text, "# by robomill\n" + csv);
  one.move(0, {0.1, 0.0, 0.0});
  one.wanted.blocks[0].duration_s *= 2.0;
  one.wanted.blocks[1].end.tip_m.x() += 1e-4;
  one.wanted.blocks[1].duration_s *= 0.5;
  one.wanted.blocks[2].end.tip_m.x() += 1e-4;
  EXPECT_EQ(one.rewrite().text,
            "# a comment\n\nx_mm,y_mm,z_mm,i,j,k,feed_mm_per_min\n1,2,3,0,0,1,\n4.1, 6 ,3,0,0,1,150\n"
            "4.1,6,3,0.6,0,0.8,120\r\n4.1,6,1.3e1,0,0,1,600");
  Case commas = {.text = "feed_mm_per_min;k;j;i;\"z_mm\";y_mm;x_mm\n0;1;0;0;3;2;1,5\n60;1;0;0;3;2;\"2,5\"\n",
                 .name = "part.csv"};
  commas.wanted.blocks[0].end.tip_m.x() += 1e-4;
  commas.wanted.blocks[0].duration_s *= 4.0;
  EXPECT_EQ(commas.rewrite().text,
            "feed_mm_per_min;k;j;i;\"z_mm\";y_mm;x_mm\n0;1;0;0;3;2;1,5\n16,5;1;0;0;3;2;\"2,6\"\n");
}

TEST(RewriteCsv, HasNoSpeeds) {
  Case one = {.text = csv, .name = "part.csv"};
  one.wanted.blocks[0].spindle_speed_rad_per_s = 100.0;
  const std::string said = test::rejection([&] { static_cast<void>(one.rewrite()); });
  EXPECT_NE(said.find("part.csv:5: spindle speed: cannot be said by a program of columns"), std::string::npos) << said;
}

}  // namespace rewrite_apt_csv_test
}  // namespace robomill::program
