#include "robomill/jobs/smooth.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/page/report.hpp"
#include "testing/jobs/lobes_file.hpp"
#include "testing/support.hpp"

namespace robomill::jobs {
namespace smooth_test {

using robomill::test::rejection;

constexpr double jerk_limit = 100.0;

/// The hybrid machine over a part that lies 0.9 m before it.
std::string hybrid(const std::string& smoothing = "", double max_jerk = jerk_limit) {
  const std::string jerk = std::to_string(max_jerk);
  return R"([robot]
kind = "hybrid-2upr-rpu"
joint_min_position = [0.4, 0.4, 0.4, -0.8, -0.8]
joint_max_position = [1.4, 1.4, 1.4, 0.8, 0.8]
joint_max_velocity = [0.5, 0.5, 0.5, 1, 1]
joint_max_acceleration = [3, 3, 3, 5, 5]
joint_max_jerk = [)" +
         jerk + ", " + jerk + ", " + jerk + ", " + jerk + ", " + jerk + R"(]
[workpiece]
origin_mm = [0, 0, 900]
rotation_deg = [180, 0, 0]
[tool]
length_mm = 100
[program]
machine = "xyzac-trt"
[smoothing]
tip_tolerance_mm = 0.02
axis_tolerance_deg = 0.1
max_velocity_mm_per_s = 50
max_acceleration_mm_per_s2 = 500
max_jerk_mm_per_s3 = 10000
max_angular_velocity_deg_per_s = 60
max_angular_acceleration_deg_per_s2 = 600
max_angular_jerk_deg_per_s3 = 12000
)" + smoothing;
}

const std::string zigzag =
    "G21 G90 G94\nM8 T1\nG0 X0 Y0 Z0 A0 C0\nG1 X10 Y0 Z0 A-5 C10 F2400\nG1 X10 Y3 A-8\nG1 X0 Y3 A-4 C20\nG1 X0 Y6\nG2 "
    "X6 "
    "Y12 I6 J0\nG4 P0.1\nG1 X6 Y6 Z2\nM30\n";

class Smoothing : public ::testing::Test {
 protected:
  SmoothJob job(const std::string& cell = hybrid(), const std::string& program = zigzag) {
    SmoothJob out;
    out.cell = folder_.file("cell.toml", cell);
    out.program = folder_.file("part.ngc", program);
    out.options.output = folder_.at("t.csv");
    return out;
  }
  struct Rows {
    std::vector<std::string> names;
    std::vector<std::vector<double>> rows;
  };
  [[nodiscard]] Rows read(const std::filesystem::path& path) const {
    Rows out;
    std::istringstream text(io::read_file(path));
    std::string line;
    const auto cells = [](const std::string& from) {
      std::vector<std::string> parts;
      std::istringstream stream(from);
      for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
      return parts;
    };
    std::getline(text, line);
    out.names = cells(line);
    while (std::getline(text, line)) {
      std::vector<double> row;
      for (const std::string& cell : cells(line)) row.push_back(std::stod(cell));
      out.rows.push_back(row);
    }
    return out;
  }
  test::Folder folder_;
};

// What is promised holds of what is in the file, by differences of its numbers.
TEST_F(Smoothing, TheFileKeepsTheLimitsOfEveryJoint) {
  const process::SmoothResult result = run_smooth(job());
  ASSERT_TRUE(result.holds());
  ASSERT_TRUE(result.smoothed.written);
  const Rows file = read(folder_.at("t.csv"));
  ASSERT_EQ(file.names.size(), 13U);
  EXPECT_EQ(file.names[1], "q1");
  ASSERT_EQ(file.rows.size(), result.first().summary.samples);
  const double h = 1e-3;
  const double velocity[] = {0.5, 0.5, 0.5, 1, 1};
  const double acceleration[] = {3, 3, 3, 5, 5};
  double most = 0.0;
  for (std::size_t i = 3; i < file.rows.size(); ++i) {
    ASSERT_NEAR(file.rows[i][0] - file.rows[i - 1][0], h, 1e-12);
    for (std::size_t joint = 0; joint < 5; ++joint) {
      const auto q = [&](std::size_t back) { return file.rows[i - back][1 + joint]; };
      ASSERT_LE(std::abs(q(0) - q(1)) / h, velocity[joint] * (1 + 1e-6));
      ASSERT_LE(std::abs(q(0) - 2 * q(1) + q(2)) / (h * h), acceleration[joint] * (1 + 1e-6));
      const double jerk = std::abs(q(0) - 3 * q(1) + 3 * q(2) - q(3)) / (h * h * h);
      ASSERT_LE(jerk, jerk_limit * (1 + 1e-6));
      most = std::max(most, jerk);
    }
  }
  const auto& joints = result.first().summary.check.joints;
  double largest = 0.0;
  for (const auto& joint : joints) largest = std::max(largest, joint.jerk.max);
  EXPECT_NEAR(largest, most, 1e-6 * most);
  // It begins and ends where the program does.
  EXPECT_NEAR(file.rows.front()[6], 0.0, 1e-6);
  EXPECT_NEAR(file.rows.back()[6], 6.0, 1e-6);
  EXPECT_NEAR(file.rows.back()[7], 6.0, 1e-6);
  EXPECT_NEAR(file.rows.back()[8], 2.0, 1e-6);
  EXPECT_EQ(file.rows.back()[12], static_cast<double>(result.first().summary.blocks));
}

// Of the file's own numbers: the axis runs round the cone that C turns at constant A, as far as the program says and no
// further from it than the tolerance; the shortest way would stand still, or turn by 41 deg the other way.
TEST_F(Smoothing, TurningAxesFollowTheMachineOfTheProgram) {
  constexpr double tilt_deg = 30.0, tolerance_deg = 0.1;
  for (const double turn_deg : {360.0, 270.0, -270.0}) {
    const std::string program =
        "G21 G94 M428\nG0 X0 Y0 Z0 A30 C0\nG1 X20 C" + std::to_string(turn_deg) + " F300\nM30\n";
    SmoothJob turning = job(hybrid(), program);
    turning.options.record = false;
    const process::SmoothResult result = run_smooth(turning);
    ASSERT_TRUE(result.holds()) << turn_deg;
    const Rows file = read(folder_.at("t.csv"));
    const double deg = units::deg;
    double turned = 0.0;
    for (std::size_t i = 0; i < file.rows.size(); ++i) {
      const auto axis = [&](std::size_t row) { return &file.rows[row][9]; };
      ASSERT_NEAR(std::acos(axis(i)[2]) / deg, tilt_deg, tolerance_deg);
      if (i == 0) continue;
      const double *a = axis(i - 1), *b = axis(i);
      turned += std::atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
    }
    EXPECT_NEAR(turned / deg, -turn_deg, tolerance_deg / std::sin(tilt_deg * deg));
    EXPECT_NEAR(file.rows.back()[6], 20.0, 0.02);
    const path::CheckResult& check = result.first().summary.check;
    EXPECT_LE(check.axis_error_rad.max, tolerance_deg * deg);
    EXPECT_GT(check.axis_error_rad.max, 0.0);
  }
}

TEST_F(Smoothing, ReportsWhatWasLeftOutAndWhatWasFound) {
  const process::SmoothResult result = run_smooth(job());
  ASSERT_FALSE(result.smoothed.skipped.empty());
  EXPECT_EQ(result.smoothed.skipped.front().line, 2U);
  const auto json = nlohmann::json::parse(path::smooth_json(result.smoothed));
  EXPECT_EQ(json["program"], "part.ngc");
  EXPECT_EQ(json["joints"].size(), 5U);
  EXPECT_EQ(json["joints"][0]["unit"], "m");
  EXPECT_EQ(json["violations"], 0);
  EXPECT_LE(json["max_tip_error_mm"].get<double>(), 0.02);
  EXPECT_TRUE(json["gamma_deg"].is_null()) << "the machine has no such freedom";
  ASSERT_EQ(result.motions.size(), 1U);
  const path::Motion& motion = result.motions.front();
  EXPECT_EQ(motion.joints.size(), 5U);
  EXPECT_FALSE(result.outline.corners.empty());
  for (const Eigen::Matrix2Xd& way : motion.corner_paths_m) EXPECT_GT(way.cols(), 2);
  // The page's curves reach what the check found, and when.
  const signal::Band& jerk = motion.joints[0].jerk;
  Eigen::Index high = 0, low = 0;
  const double largest = std::max(jerk.high.maxCoeff(&high), -jerk.low.minCoeff(&low));
  EXPECT_NEAR(largest, json["joints"][0]["max_jerk"].get<double>(), 1e-3 * largest);
  const double at_s = json["joints"][0]["jerk"]["at_s"];
  const auto run = static_cast<Eigen::Index>(at_s / motion.run_s);
  const Eigen::Index found = jerk.high[high] >= -jerk.low[low] ? high : low;
  EXPECT_LE(std::abs(run - found), 1);
  EXPECT_GE(json["joints"][0]["jerk"]["block"], 1);
  EXPECT_LE(json["joints"][0]["jerk"]["block"], result.first().summary.blocks);
}

// Without the joints' jerk the earlier method breaks a tight limit of it: no file, unless it is wished.
TEST_F(Smoothing, WritesNothingThatBreaksALimit) {
  SmoothJob broken = job(hybrid("", 4.0));
  broken.method = path::Method::no_joint_jerk;
  const process::SmoothResult result = run_smooth(broken);
  EXPECT_FALSE(result.holds());
  EXPECT_FALSE(result.smoothed.written);
  EXPECT_FALSE(std::filesystem::exists(broken.options.output));
  // The document says where, limit by limit.
  const auto json = nlohmann::json::parse(path::smooth_json(result.smoothed));
  std::size_t violations = 0;
  for (const auto& joint : json["joints"]) {
    for (const char* name : {"velocity", "acceleration", "jerk", "position"}) {
      violations += joint[name]["violations"].get<std::size_t>();
    }
  }
  for (const char* part : {"tip", "axis"}) violations += json[part]["violations"].get<std::size_t>();
  for (const char* name : {"pose_error", "dwell_error"}) violations += json[name]["violations"].get<std::size_t>();
  violations += json["faulty_samples"].get<std::size_t>();
  EXPECT_GT(violations, 0U);
  EXPECT_EQ(violations, json["violations"]);
  broken.options.keep_violations = true;
  EXPECT_TRUE(run_smooth(broken).smoothed.written);
  EXPECT_TRUE(std::filesystem::exists(broken.options.output));
  // The one that is there now is taken for a result no longer.
  broken.options.keep_violations = false;
  const process::SmoothResult again = run_smooth(broken);
  EXPECT_FALSE(std::filesystem::exists(broken.options.output));
  ASSERT_FALSE(again.smoothed.notes.empty());
  EXPECT_EQ(again.smoothed.notes.back(), "The t.csv of an earlier run was removed: this one has none.");
}

TEST_F(Smoothing, ChecksTheMethodThatRuns) {
  SmoothJob trapezoid = job(hybrid("filters = 1\nmethod = \"paper\"\n"));
  trapezoid.options.record = false;
  trapezoid.options.keep_violations = true;
  trapezoid.compare = true;
  const process::SmoothResult result = run_smooth(trapezoid);
  EXPECT_EQ(result.first().method, path::Method::paper);
  ASSERT_FALSE(result.smoothed.notes.empty());
  const std::string& note = result.smoothed.notes.front();
  EXPECT_TRUE(note.starts_with("verified is left out: ")) << note;
  EXPECT_NE(note.find("cell.toml:24: smoothing.filters = 1; must be at least 2"), std::string::npos) << note;
  trapezoid.method = path::Method::verified;
  const std::string said = rejection([&] { static_cast<void>(run_smooth(trapezoid)); });
  EXPECT_NE(said.find("cell.toml:24: smoothing.filters = 1; must be at least 2"), std::string::npos) << said;
  // … and a file whose own method could not.
  SmoothJob other = job(hybrid("filters = 1\n"));
  other.method = path::Method::paper;
  other.options.keep_violations = true;
  EXPECT_EQ(run_smooth(other).first().method, path::Method::paper);
}

TEST_F(Smoothing, SetsMethodsSideBySide) {
  SmoothJob both = job(hybrid("method = \"paper\"\ndrive_bandwidth_hz = 8\n"));
  both.compare = true;
  both.options.keep_violations = true;
  const process::SmoothResult result = run_smooth(both);
  ASSERT_EQ(result.smoothed.methods.size(), 5U);
  EXPECT_EQ(result.first().method, path::Method::paper);
  EXPECT_EQ(read(both.options.output).rows.size(), result.first().summary.samples)
      << "the file is of the method asked for";
  ASSERT_EQ(result.motions.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    const path::SmoothedBy& by = result.smoothed.methods[i];
    EXPECT_GT(by.summary.duration_s, 0.5);
    ASSERT_EQ(by.tracking_error.size(), 5U);
    EXPECT_GT(by.tracking_error[3], 1e-6);
    EXPECT_EQ(result.motions[i].corner_paths_m.size(), result.outline.corners.size());
    const signal::Band& behind = result.motions[i].joints[3].tracking_error;
    EXPECT_DOUBLE_EQ(std::max(behind.high.maxCoeff(), -behind.low.minCoeff()), by.tracking_error[3]);
  }
  // The drives do not depend on whether a page is wished.
  both.options.record = false;
  EXPECT_EQ(run_smooth(both).first().tracking_error, result.first().tracking_error);
}

TEST_F(Smoothing, InACellThatWasRead) {
  SmoothJob elsewhere = job();
  cell::CellFile cell = cell::read_cell(elsewhere.cell, cell::Robots::any);
  const process::SmoothResult expected = run_smooth(elsewhere);
  elsewhere.cell = "elsewhere.toml";
  const process::SmoothResult result = run_smooth(elsewhere, std::move(cell));
  EXPECT_EQ(result.smoothed.cell, expected.smoothed.cell);
  EXPECT_EQ(result.first().summary.samples, expected.first().summary.samples);
  EXPECT_EQ(result.first().summary.duration_s, expected.first().summary.duration_s);
}

TEST_F(Smoothing, RejectsInTheUsersWords) {
  const auto said = [&](const std::string& cell, const std::string& program) {
    return rejection([&] { static_cast<void>(run_smooth(job(cell, program))); });
  };
  const std::string far = said(hybrid(), "G21 G90 G94\nG0 X0 Y0 Z0\nG1 X10 F600\nG1 X3000\n");
  EXPECT_NE(far.find("part.ngc"), std::string::npos) << far;
  EXPECT_NE(far.find("line 4"), std::string::npos) << far;
  std::string bare = hybrid();
  bare.resize(bare.find("[smoothing]"));
  EXPECT_NE(said(bare, zigzag).find("smoothing"), std::string::npos);
  EXPECT_NE(said(hybrid("method = \"fast\"\n"), zigzag).find("smoothing.method"), std::string::npos);
  EXPECT_NE(said(hybrid(), "G21 G90\nG0 X0 Y0 Z0\nG1 X10\n").find("part.ngc:3"), std::string::npos);
  std::string still = hybrid();
  still.replace(still.find("= 10000"), 7, "= 1e-13");
  EXPECT_NE(
      said(still, zigzag).find("cell.toml:20: smoothing.max_jerk_mm_per_s3 = 1e-13 mm/s^3; makes the program last"),
      std::string::npos)
      << said(still, zigzag);
  const std::string slow = said(hybrid(), "G21 G90 G94\nG0 X0 Y0 Z0\nG1 X10 F600\nG1 X20 F0.000001\nG1 X0 F600\n");
  EXPECT_NE(slow.find("(line 4): takes 1.667e+05 h at 1e-06 mm/min"), std::string::npos) << slow;
  EXPECT_NE(slow.find("part.ngc: block"), std::string::npos) << slow;
  const std::string day = "G21 G90 G94\nG0 X0 Y0 Z0\nG1 X10 F600\nG4 P4000\nG1 X0\n";
  EXPECT_NE(said(hybrid("max_duration_h = 1\n"), day).find("line 4): dwells for 1.111 h"), std::string::npos);
  SmoothJob program = job();
  program.options.output = folder_.at("t.src");
  EXPECT_NE(rejection([&] { static_cast<void>(run_smooth(program)); }).find("six revolute joints"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_.at("t.csv")));
}

TEST_F(Smoothing, StopsWhenAskedTo) {
  const std::atomic<bool> stop{true};
  Progress progress({}, &stop);
  EXPECT_THROW(static_cast<void>(run_smooth(job(), progress)), Interrupted);
  EXPECT_FALSE(std::filesystem::exists(folder_.at("t.csv")));
}

class PlanPath : public Smoothing {
 protected:
  std::filesystem::path plan(const std::string& more) {
    static_cast<void>(job());
    folder_.file("lobes.toml", test_support::lobes_file(R"(spindle_speed_rpm = [7000, 7500]
axial_depth_mm = [0, 3]
grid = [5, 6]
method = "zeroth-order"
)"));
    return folder_.file("job.toml", "[job]\nmodes = \"" ROBOMILL_SOURCE_DIR
                                    "/data/robot-modes.toml\"\nlobes = \"lobes.toml\"\n" +
                                        more);
  }
};

TEST_F(PlanPath, AddsTheTrajectoryToTheJob) {
  const PlanResult result =
      run_job(plan("program = \"part.ngc\"\ncell = \"cell.toml\"\n"), 1, Progress::none(), folder_.at("out"));
  ASSERT_TRUE(result.shown().path && result.shown().path->holds());
  write_plan(folder_.at("out"), result);
  const auto json = nlohmann::json::parse(io::read_file(folder_.at("out") / "plan.json"));
  EXPECT_EQ(json["path"]["samples"], result.shown().path->first().summary.samples);
  EXPECT_EQ(read(folder_.at("out") / "trajectory.csv").rows.size(), result.shown().path->first().summary.samples);
  EXPECT_EQ(nlohmann::json::parse(io::read_file(folder_.at("out") / "smooth.json")), json["path"]);
  EXPECT_NE(io::read_file(folder_.at("out") / "report.html").find("\"smooth\":{"), std::string::npos);
}

// The trajectory is there with the rest or not at all, and none of an earlier run is taken for this one's.
TEST_F(PlanPath, LeavesNoTrajectoryThatIsNotItsOwn) {
  const std::filesystem::path out = folder_.at("out");
  const std::filesystem::path file = plan("program = \"part.ngc\"\ncell = \"cell.toml\"\n");
  const PlanResult whole = run_job(file, 1, Progress::none(), out);
  EXPECT_FALSE(std::filesystem::exists(out / "trajectory.csv"));
  write_plan(out, whole);
  EXPECT_TRUE(std::filesystem::exists(out / "trajectory.csv"));
  const std::string listed = "\"file\":\"trajectory.csv\"";
  EXPECT_NE(io::read_file(out / "report.html").find(listed), std::string::npos);
  // A later stage that cannot go on leaves all as it was.
  const std::string before = io::read_file(out / "trajectory.csv");
  const std::filesystem::path bad = plan("program = \"part.ngc\"\ncell = \"cell.toml\"\n");
  folder_.file("lobes.toml", io::read_file(folder_.at("lobes.toml")) + "[dynamics]\nkeep_modes = [99]\n");
  folder_.file("part.ngc", "G21 G90 G94\nG0 X0 Y0 Z0 A0 C0\nG1 X5 F2400\n");
  EXPECT_NE(rejection([&] { static_cast<void>(run_job(bad, 1, Progress::none(), out)); }), "accepted");
  EXPECT_EQ(io::read_file(out / "trajectory.csv"), before);
  const auto files = std::filesystem::directory_iterator(out);
  EXPECT_EQ(std::distance(begin(files), end(files)), 6) << "nothing half-written is left";
  // One that breaks limits takes the older one away.
  const std::filesystem::path tight = plan("program = \"part.ngc\"\ncell = \"tight.toml\"\n");
  folder_.file("tight.toml", hybrid("method = \"no-joint-jerk\"\n", 4.0));
  const PlanResult broken = run_job(tight, 1, Progress::none(), out);
  ASSERT_FALSE(broken.shown().path->holds());
  EXPECT_NE(broken.warnings.front().find("the one of an earlier run was removed"), std::string::npos);
  write_plan(out, broken);
  EXPECT_FALSE(std::filesystem::exists(out / "trajectory.csv"));
  EXPECT_EQ(io::read_file(out / "report.html").find(listed), std::string::npos);
  EXPECT_FALSE(nlohmann::json::parse(io::read_file(out / "smooth.json"))["written"].get<bool>());
}

TEST_F(PlanPath, NeedsTheCellToSaySo) {
  EXPECT_NE(rejection([&] { static_cast<void>(run_job(plan("program = \"part.ngc\"\n"), 1)); }).find("job.program"),
            std::string::npos);
  const std::filesystem::path file = plan("program = \"part.ngc\"\ncell = \"bare.toml\"\n");
  std::string bare = hybrid();
  bare.resize(bare.find("[smoothing]"));
  folder_.file("bare.toml", bare);
  EXPECT_NE(rejection([&] { static_cast<void>(run_job(file, 1)); }).find("has no [smoothing]"), std::string::npos);
}

/// A KUKA before a part that faces upwards, its spindle tilted against the flange.
std::string kuka() {
  return R"([robot]
model = "kuka-kr210-r2700"
[workpiece]
origin_mm = [1700, 150, 800]
[tool]
mount_origin_mm = [60, 0, 160]
mount_rotation_deg = [0, 40, 0]
length_mm = 240
[program]
machine = "xyzac-trt"
[smoothing]
tip_tolerance_mm = 0.05
axis_tolerance_deg = 0.1
max_velocity_mm_per_s = 80
max_acceleration_mm_per_s2 = 500
max_jerk_mm_per_s3 = 10000
max_angular_velocity_deg_per_s = 60
max_angular_acceleration_deg_per_s2 = 600
max_angular_jerk_deg_per_s3 = 12000
)";
}

TEST(SmoothJob, BeginsAsAtHomeAndWhereAskedTo) {
  const robomill::test::Folder folder;
  const SmoothJob job = {.program = folder.file("p.ngc", "G21 G90 G94\nG0 X0 Y0 Z0\nG1 X9 F600\n"),
                         .cell = folder.file("cell.toml", kuka()),
                         .options = {.record = false}};
  const process::SmoothResult as_at_home = run_smooth(job);
  const path::Resemblance& like = *as_at_home.posture.resemblance;
  EXPECT_TRUE(like.known && like.shoulder && like.elbow && like.wrist);
  EXPECT_EQ(like.turns, 0);
  const nlohmann::json json = nlohmann::json::parse(path::smooth_json(as_at_home.smoothed));
  EXPECT_EQ(json["posture"]["joints"].size(), 6U);
  EXPECT_EQ(json["posture"]["whole_turns_from_home"], 0);
  // Half a turn of joint 4 with the wrist bent the other way, a whole turn of joint 6: the same pose.
  SmoothJob other = job;
  const robot::Position6 home = as_at_home.posture.posture.start / units::deg;
  other.near_deg = {home(0),  home(1),
                    home(2),  home(3) + (home(3) > 0.0 ? -180.0 : 180.0),
                    -home(4), home(5) + (home(5) > 0.0 ? -180.0 : 180.0)};
  const robot::Position6 there = run_smooth(other).posture.posture.start / units::deg;
  for (Eigen::Index i = 0; i < 6; ++i) EXPECT_NEAR(there(i), other.near_deg[static_cast<std::size_t>(i)], 1e-6) << i;
  other.near_deg.pop_back();
  EXPECT_NE(rejection([&] { (void)run_smooth(other); }).find("--posture: must hold one angle a joint, 6; it holds 5"),
            std::string::npos);
}

}  // namespace smooth_test
}  // namespace robomill::jobs
