#include "robomill/path/files/motion_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "robomill/base/units.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace motion_json_test {

using nlohmann::json;

signal::Band band(double low, double high) {
  return {.low = Eigen::Vector2d(0.0, low), .high = Eigen::Vector2d(0.0, high)};
}

ProgramOutline outlined() {
  ProgramOutline outline;
  outline.path_m = Eigen::Matrix3Xd::Zero(3, 2);
  outline.path_m.col(1) << 0.01, 0.02, 0.03;
  ProgramCorner corner{.block = 3, .line = 14, .turn_rad = 90.0 * units::deg, .radius_m = 0.6e-3};
  corner.vertices_m = Eigen::Matrix2Xd::Constant(2, 3, 1e-3);
  outline.corners = {corner};
  return outline;
}

Motion moved() {
  Motion motion;
  motion.run_s = 0.002;
  motion.tip_speed_m_per_s = band(0.04, 0.05);
  motion.axis_speed_rad_per_s = band(0.0, 2.0 * units::deg);
  motion.joints = {
      {.prismatic = true, .velocity = band(-0.5, 0.25), .acceleration = band(-1.0, 1.0), .jerk = band(-9.0, 8.0)},
      {.velocity = band(-3.0 * units::deg, 0.0),
       .acceleration = band(0.0, 0.0),
       .jerk = band(0.0, 0.0),
       .tracking_error = band(0.0, 0.5 * units::deg)}};
  motion.tip_m = outlined().path_m;
  motion.tip_speed_at_m_per_s = Eigen::Vector2d(0.0, 0.05);
  motion.corner_paths_m = {Eigen::Matrix2Xd::Constant(2, 4, 0.1e-3)};
  return motion;
}

TEST(MotionJson, NumbersAreTheStructsInShopUnits) {
  const json data = json::parse(motion_json(outlined(), {moved(), moved()}));
  EXPECT_EQ(data["program"]["z_mm"], json::parse("[0.0, 30.0]"));
  const json& corner = data["corners"][0];
  EXPECT_EQ(corner["block"], 4) << "from 1";
  EXPECT_EQ(corner["line"], 14);
  EXPECT_EQ(corner["turn_deg"], 90.0);
  EXPECT_EQ(corner["radius_mm"], 0.6);
  EXPECT_EQ(corner["program"]["y_mm"].size(), 3U);
  EXPECT_FALSE(corner["program"].contains("z_mm")) << "in a plane";
  ASSERT_EQ(data["motions"].size(), 2U);
  const json& motion = data["motions"][1];
  EXPECT_EQ(motion["run_s"], 0.002);
  EXPECT_EQ(motion["tip_speed_mm_per_s"]["low"][1], 40.0);
  EXPECT_EQ(motion["tip_speed_mm_per_s"]["high"][1], 50.0);
  EXPECT_NEAR(motion["axis_speed_deg_per_s"]["high"][1].get<double>(), 2.0, 1e-12);
  EXPECT_EQ(motion["joints"][0]["unit"], "mm");
  EXPECT_EQ(motion["joints"][0]["velocity"]["low"][1], -500.0);
  EXPECT_TRUE(motion["joints"][0]["tracking_error"].is_null());
  EXPECT_EQ(motion["joints"][1]["unit"], "deg");
  EXPECT_NEAR(motion["joints"][1]["velocity"]["low"][1].get<double>(), -3.0, 1e-12);
  EXPECT_NEAR(motion["joints"][1]["tracking_error"]["high"][1].get<double>(), 0.5, 1e-12);
  EXPECT_EQ(motion["tip"]["x_mm"][1], 10.0);
  EXPECT_EQ(motion["tip"]["speed_mm_per_s"][1], 50.0);
  ASSERT_EQ(motion["corner_paths"].size(), 1U);
  EXPECT_EQ(motion["corner_paths"][0]["x_mm"].size(), 4U);
}

TEST(MotionJson, HasAPathForEachCorner) {
  Motion motion = moved();
  motion.corner_paths_m.clear();
  EXPECT_EQ(robomill::test::field_of([&] { static_cast<void>(motion_json(outlined(), {motion})); }),
            "motions.corner_paths_m");
}

}  // namespace motion_json_test
}  // namespace robomill::path
