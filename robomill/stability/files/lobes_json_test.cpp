#include "robomill/stability/files/lobes_schema.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/io/json.hpp"

namespace robomill::stability {
namespace lobes_json_test {

LobesResult small_result() {
  LobesResult r;
  r.spindle_speed_rad_per_s = Eigen::Vector2d(4000.0, 16000.0) * units::rpm;
  r.axial_depth_m = Eigen::Vector3d(0.0, 1.5e-3, 3e-3);
  r.spectral_radius = Eigen::MatrixXd::Constant(3, 2, 0.5);
  r.spectral_radius(2, 1) = 1.25;
  r.boundary = {{8000.0 * units::rpm, 1.2e-3, 563.5, BifurcationType::hopf, {8, modal::ModeOwner::workpiece}, 2e-7, 1},
                {9000.0 * units::rpm, 2.1e-3, 225.0, BifurcationType::flip, {7}, 0.0, 2}};
  r.limit.resize(2);
  r.limit[0].spindle_speed_rad_per_s = 4000.0 * units::rpm;
  r.limit[1] = {16000.0 * units::rpm, Limit::Status::found, 2.5e-3, 540.0, BifurcationType::hopf, {8}, 3e-7};
  PointResult point;
  point.spindle_speed_rad_per_s = 6500.0 * units::rpm;
  point.axial_depth_m = 0.6e-3;
  point.spectral_radius = 1.104;
  point.multiplier = {0.0, 1.104};
  point.error_estimate = 1.8e-3;
  point.mode = {8};
  r.points = {point};
  r.evaluations = 8;
  r.unsettled = 2;
  r.uncertain = 1;
  r.seconds = 0.25;
  return r;
}

nlohmann::json as_written(const LobesResult& result) {
  return nlohmann::json::parse(io::dump(lobes_object(result)));
}

TEST(LobesJson, SaysEverythingInShopUnits) {
  const nlohmann::json json = as_written(small_result());
  EXPECT_EQ(json["spindle_speed_rpm"], (std::vector<double>{4000.0, 16000.0}));
  EXPECT_EQ(json["axial_depth_mm"], (std::vector<double>{0.0, 1.5, 3.0}));
  ASSERT_EQ(json["spectral_radius"].size(), 3U);
  EXPECT_EQ(json["spectral_radius"][2], (std::vector<double>{0.5, 1.25}));
  ASSERT_EQ(json["boundary"].size(), 2U);
  EXPECT_EQ(json["boundary"][0]["spindle_speed_rpm"], 8000.0);
  EXPECT_EQ(json["boundary"][0]["axial_depth_mm"], 1.2);
  EXPECT_EQ(json["boundary"][0]["chatter_frequency_hz"], 563.5);
  EXPECT_EQ(json["boundary"][0]["kind"], "hopf");
  EXPECT_EQ(json["boundary"][0]["mode"], 8);
  EXPECT_EQ(json["boundary"][0]["mode_of"], "workpiece");
  EXPECT_EQ(json["boundary"][0]["curve"], 1);
  EXPECT_EQ(json["boundary"][0]["error_estimate"], 2e-7);
  EXPECT_EQ(json["boundary"][1]["kind"], "flip");
  EXPECT_TRUE(json["limit"][0]["axial_depth_mm"].is_null());
  EXPECT_EQ(json["limit"][1]["axial_depth_mm"], 2.5);
  ASSERT_EQ(json["points"].size(), 1U);
  EXPECT_EQ(json["points"][0]["spindle_speed_rpm"], 6500.0);
  EXPECT_EQ(json["points"][0]["spectral_radius"], 1.104);
  EXPECT_EQ(json["points"][0]["stable"], false);
  EXPECT_EQ(json["points"][0]["error_estimate"], 1.8e-3);
  EXPECT_EQ(json["method"], "collocation");
  EXPECT_EQ(json["period"], "tooth");
  EXPECT_EQ(json["evaluations"], 8);
  EXPECT_EQ(json["limit"][1]["error_estimate"], 3e-7);
  EXPECT_EQ(json["unsettled"], 2);
  EXPECT_EQ(json["uncertain"], 1);
  EXPECT_EQ(json["seconds"], 0.25);
}

TEST(LobesJson, HasLimitAndMarginOfAPointWhereTheyAreKnown) {
  LobesResult result = small_result();
  result.points[0].axial_depth_m = 0.6e-3;
  EXPECT_FALSE(as_written(result)["points"][0].contains("margin"));
  result.points[0].limit_depth_m = 0.8e-3;
  nlohmann::json point = as_written(result)["points"][0];
  EXPECT_EQ(point["limit_depth_mm"], 0.8);
  EXPECT_EQ(point["margin"], 0.25);
  result.points[0].limit_depth_m = std::numeric_limits<double>::infinity();
  point = as_written(result)["points"][0];
  EXPECT_TRUE(point["limit_depth_mm"].is_null());
  EXPECT_TRUE(point["margin"].is_null());
}

TEST(LobesJson, LeavesOutTheMapWhereNobodyAskedForIt) {
  LobesResult result = small_result();
  result.spectral_radius.resize(0, 0);
  const nlohmann::json json = as_written(result);
  EXPECT_FALSE(json.contains("spectral_radius"));
  EXPECT_TRUE(json.contains("limit"));
}

}  // namespace lobes_json_test
}  // namespace robomill::stability
