#include "robomill/cell/clearance.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/files/known_arms.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/jobs/smooth.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace path_clearance_test {

/// A spindle straight along the last axis, 300 mm long and 100 mm thick above 200 mm of holder and tool.
std::string cell(const std::string& geometry, const std::string& robot = "model = \"kuka-kr210-r2700\"\n") {
  return "[robot]\n" + robot + R"([workpiece]
origin_mm = [1600, 0, 700]
[tool]
length_mm = 500
[program]
machine = "xyzac-head"
[smoothing]
tip_tolerance_mm = 0.05
axis_tolerance_deg = 0.1
max_velocity_mm_per_s = 100
max_acceleration_mm_per_s2 = 500
max_jerk_mm_per_s3 = 10000
max_angular_velocity_deg_per_s = 60
max_angular_acceleration_deg_per_s2 = 600
max_angular_jerk_deg_per_s3 = 12000
sample_period_ms = 4
)" + geometry;
}

std::string geometry(const std::string& standing, const std::string& more = "") {
  return "[geometry]\nstickout_mm = 60\nshank_diameter_mm = 10\nholder = { length_mm = 140, diameter_mm = 40 }\n"
         "spindle = { length_mm = 300, diameter_mm = 100 }\nclearance_mm = 2\n" +
         more + "cell = [{ name = \"post\", " + standing + " }]\n";
}

const std::string pass = "G21 G90 G94\nS9000 M3\nG0 X0 Y0 Z20\nG1 Z0 F1200\nG1 X80\nG0 Z20\nM5\nM30\n";

class PathChecked : public ::testing::Test {
 protected:
  process::SmoothResult smooth(const std::string& cell_text, const char* output = "t.csv",
                               const std::string& program = pass) {
    SmoothJob job;
    job.cell = folder_.file("cell.toml", cell_text);
    job.program = folder_.file("part.ngc", program);
    job.options.output = folder_.at(output);
    job.options.record = false;
    job.options.keep_violations = keep_;
    return run_smooth(job);
  }
  [[nodiscard]] bool there(const char* name) const { return std::filesystem::exists(folder_.at(name)); }
  test::Folder folder_;
  bool keep_ = false;
};

// The spindle's axis runs from x = 1600 to 1680 mm: its side ends at 1730 mm, so a post at 1760 mm is 30 mm off there.
TEST_F(PathChecked, ReportsTheLeastDistanceWithItsBodiesAndLine) {
  const process::SmoothResult run =
      smooth(cell(geometry("box_from_mm = [1760, -200, 930], box_to_mm = [1800, 200, 1100]")));
  ASSERT_TRUE(run.smoothed.clearance.has_value());
  const path::PathClearance& found = *run.smoothed.clearance;
  EXPECT_TRUE(found.clear());
  EXPECT_NEAR(found.clearance.distance_m, 0.030, 0.5e-3);
  EXPECT_EQ(found.clearance.first == "post" ? found.clearance.second : found.clearance.first, "spindle");
  EXPECT_GE(found.line, 5U);                 // where the pass ends, or the retract from there
  EXPECT_LE(found.between_m, 4e-3 + 1e-12);  // twice the clearance
  EXPECT_TRUE(found.covers_moves());
  EXPECT_TRUE(there("t.csv"));
  EXPECT_EQ(shortfall(run), "");
}

// 30 mm inside the post at the pass's end, and 1 mm off where 2 are asked for: no file, whatever is kept.
TEST_F(PathChecked, ACollisionLeavesNoFile) {
  for (const bool keep : {false, true}) {
    for (const auto& [from_mm, said] : {std::pair("1700", "spindle collides with post"), {"1731", "come within"}}) {
      for (const char* output : {"t.csv", "t.src", "t.h5"}) {
        keep_ = keep;
        folder_.file(output, "of an earlier run");
        const process::SmoothResult run = smooth(
            cell(geometry(std::string("box_from_mm = [") + from_mm + ", -200, 930], box_to_mm = [1800, 200, 1100]")),
            output);
        EXPECT_FALSE(run.holds());
        EXPECT_FALSE(there(output)) << output << " " << keep;
        const std::string text = path::clearance_text(*run.smoothed.clearance);
        EXPECT_NE(text.find("spindle"), std::string::npos) << text;
        EXPECT_NE(text.find("post"), std::string::npos) << text;
        EXPECT_NE(shortfall(run).find("it was not written"), std::string::npos) << shortfall(run);
        EXPECT_NE(summary(run).find("line 5"), std::string::npos) << said << summary(run);
      }
    }
  }
}

// A plate thinner than the way of one block stands across the middle of the pass: ends of blocks do not meet it.
TEST_F(PathChecked, WhatStandsBetweenTheEndsOfBlocksIsSeen) {
  const process::SmoothResult run =
      smooth(cell(geometry("box_from_mm = [1639, -400, 930], box_to_mm = [1641, -49, 1300]")));
  ASSERT_TRUE(run.smoothed.clearance.has_value());
  EXPECT_FALSE(run.smoothed.clearance->clear());
  EXPECT_EQ(run.smoothed.clearance->line, 5U);
}

TEST_F(PathChecked, WithoutGeometryEveryHeaderAndSummarySaysSo) {
  const process::SmoothResult run = smooth(cell(""), "t.src");
  ASSERT_TRUE(there("t.src")) << summary(run);
  EXPECT_FALSE(run.smoothed.clearance.has_value());
  EXPECT_NE(io::read_file(folder_.at("t.src")).find("; collisions: not checked"), std::string::npos);
  EXPECT_NE(summary(run).find("collisions not checked"), std::string::npos);
  EXPECT_NE(summary(run).find("geometry"), std::string::npos);
  const process::SmoothResult checked =
      smooth(cell(geometry("box_from_mm = [1760, -200, 930], box_to_mm = [1800, 200, 1100]")), "t.src");
  const std::string header = io::read_file(folder_.at("t.src"));
  EXPECT_NE(header.find("; collisions: clear: "), std::string::npos) << header.substr(0, 2000);
  EXPECT_EQ(summary(checked).find("nothing was checked"), std::string::npos);
}

// The cell's tool and base in the words of each pendant: tip 500 mm along z of the flange, W at (1600, 0, 700) mm.
TEST_F(PathChecked, AnExportedProgramStatesToolAndBase) {
  ASSERT_TRUE(smooth(cell(""), "t.src").smoothed.written);
  const std::string krl = io::read_file(folder_.at("t.src"));
  EXPECT_NE(krl.find("{X 0.000,Y 0.000,Z 500.000,A 0.0000,B 0.0000,C 0.0000}"), std::string::npos);
  EXPECT_NE(krl.find("{X 1600.000,Y 0.000,Z 700.000,A 0.0000,B 0.0000,C 0.0000}"), std::string::npos);
  EXPECT_NE(krl.find("load: not given"), std::string::npos);
  // Turned about z, the new y and the new x: R = Rz(90) Ry(0) Rx(180).
  std::string turned = cell("");
  turned.replace(turned.find("[tool]"), 6, "rotation_deg = [0, 0, 30]\n[tool]\nmass_kg = 12\ncenter_mm = [1, 2, 150]");
  ASSERT_TRUE(smooth(turned, "t.src").smoothed.written);
  const std::string other = io::read_file(folder_.at("t.src"));
  EXPECT_NE(other.find("{X 1600.000,Y 0.000,Z 700.000,A 30.0000,B 0.0000,C 0.0000}"), std::string::npos);
  EXPECT_NE(other.find("load: 12 kg, centre of mass in the flange frame X 1.000 Y 2.000 Z 150.000 mm"),
            std::string::npos);
}

TEST_F(PathChecked, AProgramForAnotherMakersControllerIsRejected) {
  const std::string text = test::rejection([&] { static_cast<void>(smooth(cell(""), "t.mod")); });
  EXPECT_NE(text.find("is a program for ABB's controllers; the arm of cell.toml is of KUKA"), std::string::npos)
      << text;
  EXPECT_NE(text.find(".src"), std::string::npos) << text;
  EXPECT_NE(test::rejection([&] { static_cast<void>(smooth(cell(""), "t.script")); }), "");
  EXPECT_FALSE(there("t.mod"));
}

TEST(Makers, AreKnownByNamesOfArmsAndModels) {
  for (const auto& [name, maker] : {std::pair("kuka-kr210-r2700", "KUKA"),
                                    {"kuka_kr16_2", "KUKA"},
                                    {"kr120r2500pro", "KUKA"},
                                    {"abb-irb4600-60-205", "ABB"},
                                    {"irb6640", "ABB"},
                                    {"ur-5e", "Universal Robots"},
                                    {"ur10e_robot", "Universal Robots"},
                                    {"fanuc-m20ia", "FANUC"},
                                    {"staubli-rx160", "Stäubli"},
                                    {"yaskawa-gp25", "Yaskawa"}}) {
    EXPECT_EQ(cell::maker_of(name), maker) << name;
  }
  for (const char* name : {"", "arm", "sour5", "krone", "robot", "my-cell", "surface"})
    EXPECT_EQ(cell::maker_of(name), "") << name;
}

// One output cannot carry out two speeds: no file unless it is asked for, and then its header says which are left out.
TEST_F(PathChecked, ARobotProgramOfSeveralSpindleSpeedsIsNotWritten) {
  std::string two = pass;
  two.replace(two.find("G0 Z20\nM5"), 6, "G0 Z20\nS7000\nG1 X0 F1200\nG0 Z20");
  EXPECT_TRUE(smooth(cell(""), "t.csv", two).smoothed.written);
  const process::SmoothResult run = smooth(cell(""), "t.src", two);
  EXPECT_FALSE(run.smoothed.written);
  EXPECT_FALSE(there("t.src"));
  EXPECT_NE(shortfall(run).find("one spindle speed of several"), std::string::npos) << shortfall(run);
  EXPECT_NE(summary(run).find("9000, 7000 rpm"), std::string::npos) << summary(run);
  keep_ = true;
  EXPECT_TRUE(smooth(cell(""), "t.src", two).smoothed.written);
  EXPECT_NE(io::read_file(folder_.at("t.src")).find("NOT CARRIED OUT"), std::string::npos);
  keep_ = false;
  EXPECT_TRUE(smooth(cell(""), "t.src").smoothed.written);
}

}  // namespace path_clearance_test
}  // namespace robomill::jobs
