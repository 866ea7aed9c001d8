#include "robomill/cutting/cut_limits.hpp"

#include <gtest/gtest.h>

#include <string>

#include "robomill/cutting/cutter.hpp"
#include "robomill/cutting/workpiece.hpp"
#include "testing/support.hpp"

namespace robomill::cutting {
namespace cut_limits_test {

using test::field_of;
using test::rejection;

TEST(CutLimits, NameFieldValueRuleAndCause) {
  const auto speed = [](double rpm) {
    return [rpm] { require_spindle_speed("spindle_speed_rad_per_s", rpm * units::rpm); };
  };
  EXPECT_EQ(field_of(speed(1.0)), "accepted");
  EXPECT_EQ(field_of(speed(1e6)), "accepted");
  EXPECT_EQ(rejection(speed(0.0)), "spindle_speed_rad_per_s = 0 rad/s; must be > 0");
  EXPECT_NE(rejection(speed(0.5)).find("must be at least 1 rpm. No spindle cuts so slowly"), std::string::npos);
  EXPECT_NE(rejection(speed(1e9)).find("must be at most 1,000,000 rpm. No spindle is so fast"), std::string::npos);
  const auto feed = [](double feed_m) { return [feed_m] { require_feed_per_tooth("feed_per_tooth_m", feed_m); }; };
  EXPECT_EQ(field_of(feed(0.0)), "accepted");
  EXPECT_EQ(field_of(feed(1e-4)), "accepted");
  EXPECT_NE(rejection(feed(-1e-4)).find("must be >= 0"), std::string::npos);
  EXPECT_NE(rejection(feed(0.05)).find("is too large for any cutter"), std::string::npos);
}

TEST(CutLimits, HoldForCuttersAndStock) {
  Cutter cutter = {.mill = {.teeth = 3, .diameter_m = 0.012}, .cutting_height_m = 24'000.0};
  const std::string high = rejection([&] { cutter.validate(); });
  EXPECT_NE(high.find("cutting_height_m = 24000 m; is too long for a cutter's edges"), std::string::npos) << high;
  const Stock stock = {.min_m = {0.0, 0.0, 0.0}, .max_m = {0.1, 0.1, 0.02}};
  const std::string fine = rejection([&] { Workpiece(stock, 1e-7); });
  EXPECT_NE(fine.find("must be at least 1 µm"), std::string::npos) << fine;
  const std::string many = rejection([&] { Workpiece(stock, 5e-6); });
  EXPECT_NE(many.find("dexel_m = 5e-06 m; would take about 20.2 GB of memory"), std::string::npos) << many;
  const Stock huge = {.min_m = {0.0, 0.0, 0.0}, .max_m = {1e4, 0.1, 0.02}};
  const std::string large = rejection([&] { Workpiece(huge, 2.5e-4); });
  EXPECT_NE(large.find("max_m = 10000 m; would take"), std::string::npos) << large;
  const Stock low = {.min_m = {-1e4, 0.0, 0.0}, .max_m = {0.1, 0.1, 0.02}};
  const std::string below = rejection([&] { Workpiece(low, 2.5e-4); });
  EXPECT_NE(below.find("min_m = -10000 m; would take"), std::string::npos) << below;
}

}  // namespace cut_limits_test
}  // namespace robomill::cutting
