#include "robomill/path/files/smooth_json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "robomill/base/units.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace smooth_json_test {

SmoothedProgram smoothed() {
  SmoothedBy by;
  by.summary = {.duration_s = 12.5,
                .lower_bound_s = 11.0,
                .blocks = 16,
                .samples = 12501,
                .rounds = 2,
                .plan_s = 0.25,
                .emit_s = 0.025002};
  by.summary.check.tip_error_m = {.max = 0.019e-3, .limit = 0.02e-3};
  by.summary.check.axis_error_rad = {.max = 0.01 * units::deg, .limit = 0.02 * units::deg};
  by.summary.check.tip_velocity = {.max = 0.049, .limit = 0.05, .violations = 1};
  by.summary.check.joints.resize(2);
  by.summary.check.joints[0].jerk = {.max = 99.0, .limit = 100.0, .violations = 3, .at_s = 1.5, .block = 4};
  by.summary.check.joints[0].velocity = {.max = 0.5, .limit = 1.0, .violations = 4};
  by.summary.check.joints[1].position = {.max = -0.25, .limit = 0.0};
  by.tracking_error = {1e-5, 2e-5};
  SmoothedProgram out;
  out.program = "part.ngc";
  out.cell = "cell.toml";
  out.prismatic[1] = true;
  out.methods = {by};
  out.skipped = {{.line = 7, .what = "M8"}};
  return out;
}

TEST(SmoothJson, HasTheNamedFieldsInTheirUnits) {
  const auto json = nlohmann::json::parse(smooth_json(smoothed()));
  EXPECT_EQ(json["duration_s"], 12.5);
  EXPECT_EQ(json["lower_bound_s"], 11.0);
  EXPECT_EQ(json["max_tip_error_mm"], 0.019);
  EXPECT_EQ(json["max_axis_error_deg"], 0.01);
  EXPECT_EQ(json["blocks"], 16);
  EXPECT_EQ(json["samples"], 12501);
  EXPECT_EQ(json["plan_seconds"], 0.25);
  EXPECT_NEAR(json["microseconds_per_sample"].get<double>(), 2.0, 1e-9);
  EXPECT_EQ(json["tip"]["max_velocity_mm_per_s"], 49.0);
  EXPECT_EQ(json["tip"]["violations"], 1);
  ASSERT_EQ(json["joints"].size(), 2U);
  EXPECT_EQ(json["joints"][0]["max_jerk"], 99.0);
  EXPECT_EQ(json["joints"][0]["limit_jerk"], 100.0);
  EXPECT_EQ(json["joints"][0]["violations"], 7);
  EXPECT_EQ(json["joints"][0]["unit"], "rad");
  EXPECT_EQ(json["joints"][1]["unit"], "m");
  EXPECT_EQ(json["joints"][1]["max_tracking_error"], 2e-5);
  EXPECT_TRUE(json["joints"][1]["limit_jerk"].is_null());
  EXPECT_EQ(json["skipped"][0]["line"], 7);
  EXPECT_FALSE(json.contains("methods"));
  EXPECT_EQ(json["method"], "verified");
  EXPECT_EQ(json["joints"][0]["jerk"], nlohmann::json::parse(R"({"violations": 3, "at_s": 1.5, "block": 5})"));
  EXPECT_EQ(json["joints"][0]["velocity"]["violations"], 4);
  EXPECT_EQ(json["tip"]["velocity"]["violations"], 1);
  EXPECT_EQ(json["tip"]["share_of_feed"]["block"], 1);
  EXPECT_EQ(json["axis"]["error"]["violations"], 0);
  EXPECT_TRUE(json["gamma_deg"].is_null());
}

TEST(SmoothJson, ReportsMethodsSideBySideAndNothingAsNull) {
  SmoothedProgram two = smoothed();
  two.methods.push_back({.method = Method::paper_as_printed});
  two.methods.back().summary.duration_s = 13.0;
  const auto json = nlohmann::json::parse(smooth_json(two));
  ASSERT_EQ(json["methods"].size(), 2U);
  EXPECT_EQ(json["methods"][1]["method"], "paper-as-printed");
  EXPECT_EQ(json["methods"][1]["duration_s"], 13.0);
  EXPECT_TRUE(json["methods"][1]["lower_bound_s"].is_null());
  EXPECT_EQ(robomill::test::field_of([] { static_cast<void>(smooth_json({})); }), "methods");
}

TEST(SmoothJson, SaysHowTheFlangeTurns) {
  SmoothedProgram turning = smoothed();
  turning.gamma_rad = {-30.0 * units::deg, 45.0 * units::deg};
  EXPECT_EQ(nlohmann::json::parse(smooth_json(turning))["gamma_deg"], nlohmann::json::parse("[-30.0, 45.0]"));
}

TEST(SmoothJson, KnowsEachMethodByItsName) {
  for (const auto& [name, method] : method_names) EXPECT_EQ(value_in(method_names, name), method);
  EXPECT_FALSE(value_in(method_names, "fastest"));
}

}  // namespace smooth_json_test
}  // namespace robomill::path
