#include "robomill/cutting/cut_limits.hpp"

#include <gtest/gtest.h>

#include <string>

#include "robomill/base/error.hpp"
#include "robomill/cutting/cutter.hpp"
#include "robomill/cutting/workpiece.hpp"

namespace robomill::cutting {
namespace cut_limits_test {

template <class Check>
std::string message_of(Check check) {
  try {
    check();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

TEST(CutLimits, NameFieldValueRuleAndCause) {
  const auto speed = [](double rpm) {
    return message_of([rpm] { require_spindle_speed("spindle_speed_rad_per_s", rpm * units::rpm); });
  };
  EXPECT_EQ(speed(1.0), "");
  EXPECT_EQ(speed(1e6), "");
  EXPECT_EQ(speed(0.0), "spindle_speed_rad_per_s = 0 rad/s; must be > 0");
  EXPECT_NE(speed(0.5).find("must be at least 1 rpm. No spindle cuts so slowly"), std::string::npos) << speed(0.5);
  EXPECT_NE(speed(1e9).find("must be at most 1,000,000 rpm. No spindle is so fast"), std::string::npos) << speed(1e9);
  const auto feed = [](double feed_m) {
    return message_of([feed_m] { require_feed_per_tooth("feed_per_tooth_m", feed_m); });
  };
  EXPECT_EQ(feed(0.0), "");
  EXPECT_EQ(feed(1e-4), "");
  EXPECT_NE(feed(-1e-4).find("must be >= 0"), std::string::npos) << feed(-1e-4);
  EXPECT_NE(feed(0.05).find("is too large for any cutter"), std::string::npos) << feed(0.05);
  EXPECT_EQ(message_of([] { require_pushing_radial(0.0); }), "");
  const std::string pulls = message_of([] { require_pushing_radial(-2e8); });
  EXPECT_NE(pulls.find("radial_n_per_m2 = -2e+08 N/m^2; must be >= 0"), std::string::npos) << pulls;
}

TEST(CutLimits, HoldForCuttersAndStock) {
  Cutter cutter = {.mill = {.teeth = 3, .diameter_m = 0.012}, .cutting_height_m = 24'000.0};
  const std::string high = message_of([&] { cutter.validate(); });
  EXPECT_NE(high.find("cutting_height_m = 24000 m; is too long for a cutter's edges"), std::string::npos) << high;
  const Stock stock = {.min_m = {0.0, 0.0, 0.0}, .max_m = {0.1, 0.1, 0.02}};
  const std::string fine = message_of([&] { Workpiece(stock, 1e-7); });
  EXPECT_NE(fine.find("must be at least 1 µm"), std::string::npos) << fine;
  const std::string many = message_of([&] { Workpiece(stock, 5e-6); });
  EXPECT_NE(many.find("dexel_m = 5e-06 m; would take about 20.2 GB of memory"), std::string::npos) << many;
  const Stock huge = {.min_m = {0.0, 0.0, 0.0}, .max_m = {1e4, 0.1, 0.02}};
  const std::string large = message_of([&] { Workpiece(huge, 2.5e-4); });
  EXPECT_NE(large.find("max_m = 10000 m; would take"), std::string::npos) << large;
}

}  // namespace cut_limits_test
}  // namespace robomill::cutting
