#include "robomill/path/files/smoothing_toml.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "robomill/base/random.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/io/toml/file.hpp"
#include "testing/support.hpp"
#include "testing/text.hpp"

namespace robomill::cell {
namespace cell_smoothing_test {

using robomill::test::Folder;
using robomill::test::rejection;
using robomill::test::seeds;

constexpr double deg = std::numbers::pi / 180.0;

const std::string good = R"([robot]
kind = "hybrid-2upr-rpu"
joint_min_position = [0.4, 0.4, 0.4, -1, -1]
joint_max_position = [1.2, 1.2, 1.2, 1, 1]
joint_max_velocity = [0.5, 0.5, 0.5, 1, 1]
joint_max_acceleration = [5, 5, 5, 8, 8]
joint_max_jerk = [100, 100, 100, 200, 200]
[workpiece]
origin_mm = [0, 0, 900]
rotation_deg = [180, 0, 0]
[tool]
length_mm = 100
[smoothing]
tip_tolerance_mm = 0.02
axis_tolerance_deg = 0.03
max_velocity_mm_per_s = 50
max_acceleration_mm_per_s2 = 500
max_jerk_mm_per_s3 = 10000
max_angular_velocity_deg_per_s = 10
max_angular_acceleration_deg_per_s2 = 100
max_angular_jerk_deg_per_s3 = 2000
sample_period_ms = 2
method = "optimal"
filters = 3
free_gamma = true
drive_bandwidth_hz = 20
drive_damping_ratio = 0.8
flexible_joint_hz = [10, 11, 12, 13, 14]
flexible_joint_damping_ratio = 0.02
)";

std::string with(const std::string& old_text, const std::string& new_text) {
  return test_support::replaced(good, old_text, new_text);
}

path::SmoothingFile read(const Folder& folder, const std::string& text) {
  const auto path = folder.file("cell.toml", text);
  const CellFile cell = read_cell(path, Robots::any);
  const auto machine = kinematics(cell);
  return path::read_smoothing(*cell.document, machine->limits(), machine->joints());
}

TEST(SmoothingToml, ReadsEveryKeyInItsUnit) {
  const Folder folder;
  const path::SmoothingFile file = read(folder, good);
  const path::SmoothingOptions& o = file.options;
  EXPECT_DOUBLE_EQ(o.tip_tolerance_m, 2e-5);
  EXPECT_DOUBLE_EQ(o.axis_tolerance_rad, 0.03 * deg);
  EXPECT_DOUBLE_EQ(o.max_velocity_m_per_s, 0.05);
  EXPECT_DOUBLE_EQ(o.max_acceleration_m_per_s2, 0.5);
  EXPECT_DOUBLE_EQ(o.max_jerk_m_per_s3, 10.0);
  EXPECT_DOUBLE_EQ(o.max_angular_velocity_rad_per_s, 10.0 * deg);
  EXPECT_DOUBLE_EQ(o.max_angular_acceleration_rad_per_s2, 100.0 * deg);
  EXPECT_DOUBLE_EQ(o.max_angular_jerk_rad_per_s3, 2000.0 * deg);
  EXPECT_DOUBLE_EQ(o.sample_period_s, 0.002);
  EXPECT_EQ(o.method, path::Method::optimal);
  EXPECT_EQ(o.filters, 3);
  EXPECT_TRUE(file.free_gamma);
  EXPECT_EQ(file.drive_bandwidth_hz, std::vector<double>(5, 20.0));
  EXPECT_EQ(file.drive_damping_ratio, 0.8);
  EXPECT_EQ(file.flexible_joint_hz, (std::vector<double>{10.0, 11.0, 12.0, 13.0, 14.0}));
  EXPECT_EQ(file.flexible_joint_damping_ratio, 0.02);
}

TEST(SmoothingToml, KnowsEveryMethod) {
  const Folder folder;
  using path::Method;
  const std::pair<std::string, Method> methods[] = {{"\"verified\"", Method::verified},
                                                    {"\"optimal\"", Method::optimal},
                                                    {"\"paper\"", Method::paper},
                                                    {"\"paper-as-printed\"", Method::paper_as_printed},
                                                    {"\"no-joint-jerk\"", Method::no_joint_jerk}};
  for (const auto& [name, method] : methods) {
    EXPECT_EQ(read(folder, with("\"optimal\"", name)).options.method, method);
  }
  EXPECT_EQ(read(folder, with("method = \"optimal\"\n", "")).options.method, Method::verified);
  EXPECT_TRUE(read(folder, with("drive_bandwidth_hz = 20\n", "")).drive_bandwidth_hz.empty());
  EXPECT_EQ(read(folder, with("sample_period_ms = 2\n", "")).options.sample_period_s, 0.001);
  EXPECT_EQ(read(folder, good).options.max_duration_s, 86400.0);
  EXPECT_DOUBLE_EQ(read(folder, with("filters = 3\n", "max_duration_h = 0.5\n")).options.max_duration_s, 1800.0);
}

TEST(SmoothingToml, SaysWhatIsWrongAndWhere) {
  const Folder folder;
  const auto expect = [&](const std::string& old_text, const std::string& new_text, const std::string& message) {
    const std::string said = rejection([&] { (void)read(folder, with(old_text, new_text)); });
    EXPECT_EQ(said.substr(folder.path().string().size() + 1).substr(0, message.size()), message);
  };
  expect("tip_tolerance_mm = 0.02", "tip_tolerance_mm = 0",
         "cell.toml:14: smoothing.tip_tolerance_mm = 0 mm; must be > 0. 0.02 mm suits finishing");
  expect("axis_tolerance_deg = 0.03\n", "", "cell.toml:13: smoothing.axis_tolerance_deg: is missing; must be > 0");
  expect("max_jerk_mm_per_s3 = 10000", "max_jerk_mm_per_s3 = -3",
         "cell.toml:18: smoothing.max_jerk_mm_per_s3 = -3 mm/s^3; must be > 0");
  expect("max_angular_jerk_deg_per_s3 = 2000", "max_angular_jerk_deg_per_s3 = \"fast\"",
         "cell.toml:21: smoothing.max_angular_jerk_deg_per_s3 = \"fast\"; must be a finite number");
  expect("sample_period_ms = 2", "sample_period_ms = 0",
         "cell.toml:22: smoothing.sample_period_ms = 0 ms; must be > 0");
  expect("filters = 3", "max_duration_h = 0", "cell.toml:24: smoothing.max_duration_h = 0 h; must be > 0");
  expect("\"optimal\"", "\"fast\"", "cell.toml:23: smoothing.method = \"fast\"; must be one of \"verified\"");
  expect("filters = 3", "filters = 4", "cell.toml:24: smoothing.filters = 4; must be >= 1 and <= 3");
  expect("filters = 3", "filters = 1", "cell.toml:24: smoothing.filters = 1; must be at least 2");
  expect("drive_bandwidth_hz = 20", "drive_bandwidth_hz = [1, 2]",
         "cell.toml:26: smoothing.drive_bandwidth_hz: must hold one number for all joints or one a joint, 5");
  expect("drive_bandwidth_hz = 20", "drive_bandwidth_hz = -1",
         "cell.toml:26: smoothing.drive_bandwidth_hz = -1 Hz; must");
  expect("drive_damping_ratio = 0.8", "drive_damping_ratio = 0",
         "cell.toml:27: smoothing.drive_damping_ratio = 0; must be > 0");
  expect("tip_tolerance_mm", "tip_tolerance_m", "cell.toml:14: smoothing.tip_tolerance_m: is not known here");
  expect("joint_max_jerk = [100, 100, 100, 200, 200]\n", "",
         "cell.toml:1: robot.joint_max_jerk: is missing; must be > 0. Smoothing needs every joint's velocity");
  expect("joint_max_jerk = [100, 100, 100, 200, 200]", "joint_max_jerk = [100, 100, 0, 200, 200]",
         "cell.toml:7: robot.joint_max_jerk[3] = 0; must be > 0. Smoothing needs every joint's velocity");
  expect("[5, 5, 5, 8, 8]", "[5, 5, -5, 8, 8]",
         "cell.toml:6: robot.joint_max_acceleration[3] = -5; must be > 0. Smoothing needs");
  EXPECT_NE(
      rejection([&] { (void)read(folder, good.substr(0, good.find("[smoothing]"))); }).find("smoothing: is missing"),
      std::string::npos);
}

// What holds is the method that will run, whichever of the two the file names.
TEST(SmoothingToml, AMethodBeforeTheFilesIsTheOneThatIsChecked) {
  const Folder folder;
  const auto read_by = [&](const std::string& text, path::Method method) {
    const auto path = folder.file("cell.toml", text);
    const CellFile cell = read_cell(path, Robots::any);
    const auto machine = kinematics(cell);
    return path::read_smoothing(*cell.document, machine->limits(), machine->joints(), method);
  };
  std::string one = with("filters = 3", "filters = 1");
  EXPECT_EQ(read_by(one, path::Method::paper).options.method, path::Method::paper);
  one.replace(one.find("\"optimal\""), 9, "\"paper\"");
  EXPECT_EQ(read(folder, one).options.filters, 1);
  const std::string said = rejection([&] { (void)read_by(one, path::Method::verified); });
  EXPECT_NE(said.find("cell.toml:24: smoothing.filters = 1; must be at least 2 where jerk is limited"),
            std::string::npos)
      << said;
}

TEST(SmoothingToml, DamagedFilesAreReadOrRejected) {
  const Folder folder;
  Random random(54);
  int taken = 0;
  for (int k = 0; k < seeds(2000); ++k) {
    try {
      read(folder, test_support::damaged(good, k, random)).options.validate();
      ++taken;
    } catch (const InvalidInput&) {
      continue;
    }
  }
  EXPECT_GT(taken, 3);
}

}  // namespace cell_smoothing_test
}  // namespace robomill::cell
