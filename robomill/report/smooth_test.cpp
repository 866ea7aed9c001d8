#include "robomill/report/smooth.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "robomill/report/json.hpp"
#include "robomill/report/report.hpp"
#include "robomill/report/smooth_sample.hpp"
#include "testing/support.hpp"

namespace robomill::report {
namespace {

using nlohmann::json;

TEST(SmoothReport, NumbersAreTheStructsInShopUnits) {
  const Smooth smooth = sample_smooth();
  const json data = json::parse(smooth_json(smooth).dump());
  EXPECT_EQ(data["tip_tolerance_mm"], 0.05);
  EXPECT_EQ(data["blocks"], 12);
  ASSERT_EQ(data["methods"].size(), 3U);
  const auto& method = data["methods"][0];
  const Motion& motion = smooth.methods[0].motion;
  const auto runs = static_cast<std::size_t>(motion.tip_speed_m_per_s.low.size());
  ASSERT_EQ(method["motion"]["time_s"].size(), 2 * runs);
  EXPECT_NEAR(method["motion"]["tip_speed_mm_per_s"][2 * 99 + 1].get<double>(), motion.tip_speed_m_per_s.high[99] * 1e3,
              1e-3);
  EXPECT_EQ(method["motion"]["joints"][0]["unit"], "mm");
  EXPECT_EQ(method["motion"]["joints"][4]["unit"], "°");
  EXPECT_NEAR(method["motion"]["joints"][4]["max_velocity"].get<double>(), 0.3 * 57.29577951, 1e-4);
  EXPECT_NEAR(method["motion"]["joints"][1]["jerk"][30].get<double>(), motion.joints[1].jerk.low[15] * 1e3,
              1e-5 * std::abs(motion.joints[1].jerk.low[15] * 1e3) + 1e-9);
  EXPECT_EQ(method["uses"][1]["unit"], "mm");
  EXPECT_EQ(method["uses"][2]["unit"], "°/s");
  EXPECT_NEAR(method["uses"][1]["share"].get<double>(), 0.42, 1e-5);
  EXPECT_EQ(data["corners"][0]["corner_paths"].size(), 3U);
  EXPECT_EQ(data["corners"][0]["radius_mm"], 0.6);
}

TEST(SmoothReport, AMotionOfFewSamplesIsDrawnSampleBySample) {
  Smooth smooth = sample_smooth();
  Motion& motion = smooth.methods[0].motion;
  const auto shorten = [](signal::Band& band) {
    band.low = band.low.head(50).eval();
    band.high = band.low;
  };
  shorten(motion.tip_speed_m_per_s);
  shorten(motion.axis_speed_rad_per_s);
  for (JointMotion& joint : motion.joints) {
    for (signal::Band* band : {&joint.velocity, &joint.acceleration, &joint.jerk, &joint.tracking_error})
      shorten(*band);
  }
  motion.run_s = 0.001;
  const json data = json::parse(smooth_json(smooth).dump())["methods"][0]["motion"];
  ASSERT_EQ(data["time_s"].size(), 50U);
  EXPECT_EQ(data["time_s"][7], 0.007);
  EXPECT_EQ(data["joints"][2]["jerk"].size(), 50U);
}

template <class Change>
std::string rejected(Change&& change) {
  static const Smooth sample = sample_smooth();
  Smooth smooth = sample;
  change(smooth);
  return test::field_of([&] { smooth.validate(); });
}

TEST(SmoothReport, ValidateNamesTheMember) {
  EXPECT_EQ(rejected([](Smooth&) {}), "accepted");
  EXPECT_EQ(rejected([](Smooth& s) { s.methods.clear(); }), "methods");
  EXPECT_EQ(rejected([](Smooth& s) { s.tip_tolerance_m = 0.0; }), "tip_tolerance_m");
  EXPECT_EQ(rejected([](Smooth& s) { s.program_m(1, 2) = missing; }), "program_m");
  EXPECT_EQ(rejected([](Smooth& s) { s.methods[1].motion.run_s = 0.0; }), "methods[1].motion.run_s");
  EXPECT_EQ(rejected([](Smooth& s) { s.methods[0].motion.joints[2].jerk.low.resize(3); }),
            "methods[0].motion.joints[2].jerk.low");
  EXPECT_EQ(rejected([](Smooth& s) { s.methods[0].motion.joints[2].tracking_error = {}; }), "accepted");
  EXPECT_EQ(rejected([](Smooth& s) { s.methods[0].motion.tip_speed_at_m_per_s.resize(1); }),
            "methods[0].motion.tip_speed_at_m_per_s");
  EXPECT_EQ(rejected([](Smooth& s) { s.methods[0].uses[0].order = 4; }), "uses.order");
  EXPECT_EQ(rejected([](Smooth& s) { s.corners[1].tip_m.pop_back(); }), "corners[1].tip_m");
  EXPECT_EQ(rejected([](Smooth& s) { s.corners[1].radius_m = missing; }), "corners[1].radius_m");
  EXPECT_EQ(rejected([](Smooth& s) { s.corners[0].program_m(0, 0) = std::numeric_limits<double>::infinity(); }),
            "corners[0].program_m");
}

}  // namespace
}  // namespace robomill::report
