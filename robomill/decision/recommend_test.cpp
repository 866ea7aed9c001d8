#include "robomill/decision/recommend.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::decision {
namespace recommend_test {

constexpr double pi = std::numbers::pi;
using Status = stability::Limit::Status;

DepthLimit chatter_at(double speed, double depth, double frequency_hz = 0.0, modal::ModeId mode = {}) {
  return {.chatter = {.spindle_speed_rad_per_s = speed,
                      .status = Status::found,
                      .axial_depth_m = depth,
                      .chatter_frequency_hz = frequency_hz,
                      .mode = mode}};
}

double depth_of(const DepthLimit& limit) {
  return limit.chatter.status == Status::found ? limit.chatter.axial_depth_m : 4e-3;
}

// A lobe-like curve: cusps where the phase is a whole number of turns, none above 4 mm.
DepthLimit lobe(double speed) {
  const double phase = 3000.0 / speed;
  const double depth = 0.5e-3 + 5e-3 * std::pow(std::sin(pi * phase), 8);
  return depth > 4e-3 ? DepthLimit{.chatter = {.spindle_speed_rad_per_s = speed}}
                      : chatter_at(speed, depth, 540.0, {7});
}

std::vector<DepthLimit> lobes() {
  std::vector<DepthLimit> limits;
  for (int i = 0; i <= 400; ++i) limits.push_back(lobe(400.0 + 3.0 * i));
  return limits;
}

RecommendOptions options() {
  RecommendOptions o;
  o.teeth = 3;
  o.radial_depth_m = 1.8e-3;
  o.feed_per_tooth_m = 1e-5;
  o.searched_depth_m = 4e-3;
  return o;
}

// The property that is promised: nowhere in the window does the depth come nearer than the margin to the limit.
TEST(Recommend, KeepsTheMarginOverTheSpeedWindow) {
  const Recommendation r = recommend(lobes(), options(), lobe);
  ASSERT_EQ(r.status, Recommendation::Status::found);
  ASSERT_EQ(r.alternatives.size(), 3U);
  std::vector<Operation> all = r.alternatives;
  all.push_back(*r.recommended);
  for (const Operation& op : all) {
    for (int i = -4; i <= 4; ++i) {
      const DepthLimit limit = lobe(op.spindle_speed_rad_per_s * (1.0 + 0.005 * i));
      EXPECT_LE(op.axial_depth_m, 0.8 * depth_of(limit) * (1 + 1e-12));
    }
    EXPECT_NEAR(op.removal_rate_m3_per_s, op.axial_depth_m * 1.8e-3 * 1e-5 * 3 * op.spindle_speed_rad_per_s / (2 * pi),
                1e-18);
  }
}

TEST(Recommend, NoOtherSpeedRemovesMore) {
  const std::vector<DepthLimit> limits = lobes();
  const Operation best = *recommend(limits, options(), lobe).recommended;
  for (const DepthLimit& centre : limits) {
    const double speed = centre.chatter.spindle_speed_rad_per_s;
    if (speed * 0.98 < 400.0 || speed * 1.02 > 1600.0) continue;
    double lowest = 4e-3;
    for (const DepthLimit& other : limits) {
      if (std::abs(other.chatter.spindle_speed_rad_per_s / speed - 1.0) <= 0.02) {
        lowest = std::min(lowest, depth_of(other));
      }
    }
    EXPECT_LE(0.8 * lowest * 1.8e-3 * 1e-5 * 3 * speed / (2 * pi), best.removal_rate_m3_per_s * 1.001);
  }
}

TEST(Recommend, AlternativesAreOtherSpeeds) {
  const Recommendation r = recommend(lobes(), options(), lobe);
  std::vector<double> speeds = {r.recommended->spindle_speed_rad_per_s};
  for (const Operation& op : r.alternatives) {
    EXPECT_LE(op.removal_rate_m3_per_s, r.recommended->removal_rate_m3_per_s);
    for (const double speed : speeds) EXPECT_GE(std::abs(op.spindle_speed_rad_per_s / speed - 1.0), 0.047);
    speeds.push_back(op.spindle_speed_rad_per_s);
  }
}

TEST(Recommend, ObeysCutterAndSpindle) {
  RecommendOptions o = options();
  o.machine.max_axial_depth_m = 0.1e-3;
  Operation op = *recommend(lobes(), o, lobe).recommended;
  EXPECT_EQ(op.limited_by, LimitedBy::cutter);
  EXPECT_DOUBLE_EQ(op.axial_depth_m, 0.1e-3);

  o = options();
  o.mean_torque_n_m = [](double depth_m) { return 1000.0 * depth_m; };
  o.machine.spindle = {{.spindle_speed_rad_per_s = 300.0, .torque_n_m = 0.2, .power_w = 1e6},
                       {.spindle_speed_rad_per_s = 2000.0, .torque_n_m = 0.2, .power_w = 1e6}};
  op = *recommend(lobes(), o, lobe).recommended;
  EXPECT_EQ(op.limited_by, LimitedBy::spindle_torque);
  EXPECT_NEAR(op.torque_n_m, 0.2, 1e-12);

  o.machine.spindle[0].torque_n_m = o.machine.spindle[1].torque_n_m = 1e6;
  o.machine.spindle[0].power_w = o.machine.spindle[1].power_w = 50.0;
  op = *recommend(lobes(), o, lobe).recommended;
  EXPECT_EQ(op.limited_by, LimitedBy::spindle_power);
  EXPECT_NEAR(op.power_w, 50.0, 1e-9);

  o = options();
  o.machine.min_spindle_speed_rad_per_s = 700.0;
  o.machine.max_spindle_speed_rad_per_s = 800.0;
  op = *recommend(lobes(), o, lobe).recommended;
  EXPECT_GE(op.spindle_speed_rad_per_s, 700.0);
  EXPECT_LE(op.spindle_speed_rad_per_s, 800.0);
}

// A finishing depth binds like any other limit: over the whole window, between the given speeds too.
TEST(Recommend, KeepsTheFinishingDepthOverTheWindow) {
  // Fine away from 900 rad/s, where tooth passing meets a mode.
  const auto finishing = [](double speed) {
    DepthLimit limit = lobe(speed);
    limit.finish = {.axial_depth_m = 1e-4 + 2e-3 * std::abs(speed / 900.0 - 1.0), .reason = LimitedBy::surface_error};
    return limit;
  };
  std::vector<DepthLimit> limits;
  for (const DepthLimit& limit : lobes()) limits.push_back(finishing(limit.chatter.spindle_speed_rad_per_s));
  const Recommendation r = recommend(limits, options(), finishing);
  ASSERT_EQ(r.status, Recommendation::Status::found);
  std::vector<Operation> all = r.alternatives;
  all.push_back(*r.recommended);
  int bound = 0;
  for (const Operation& op : all) {
    for (int i = -4; i <= 4; ++i) {
      const DepthLimit limit = finishing(op.spindle_speed_rad_per_s * (1.0 + 0.005 * i));
      EXPECT_LE(op.axial_depth_m, limit.finish.axial_depth_m * (1 + 1e-12));
      EXPECT_LE(op.axial_depth_m, 0.8 * depth_of(limit) * (1 + 1e-12));
    }
    if (op.limited_by == LimitedBy::surface_error) ++bound;
    EXPECT_GE(op.margin, 0.2 - 1e-12);
  }
  EXPECT_GT(bound, 0);
  EXPECT_LT(r.recommended->removal_rate_m3_per_s,
            recommend(lobes(), options(), lobe).recommended->removal_rate_m3_per_s);
}

TEST(Recommend, SaysFeedAndCuttingSpeed) {
  RecommendOptions o = options();
  EXPECT_EQ(recommend(lobes(), o, lobe).recommended->cutting_speed_m_per_s, 0.0);
  o.diameter_m = 12e-3;
  const Operation op = *recommend(lobes(), o, lobe).recommended;
  const double per_s = op.spindle_speed_rad_per_s / (2 * pi);
  EXPECT_NEAR(op.cutting_speed_m_per_s, pi * 12e-3 * per_s, 1e-12);
  EXPECT_NEAR(op.feed_m_per_s, 1e-5 * 3 * per_s, 1e-15);
  EXPECT_TRUE(std::isnan(op.surface_error_m));
}

// A minimum between two grid speeds, narrower than their distance, is found by looking closer.
TEST(Recommend, LooksBetweenTheGivenSpeeds) {
  std::vector<DepthLimit> limits;
  for (int i = 0; i <= 10; ++i) limits.push_back(chatter_at(1000.0 + 100.0 * i, 2e-3));
  const auto with_minimum = [](double speed) {
    const bool low = std::abs(speed / 100.0 - std::round(speed / 100.0)) > 1e-6;
    return chatter_at(speed, low ? 1e-3 : 2e-3, 0.0, {2});
  };
  const Operation op = *recommend(limits, options(), with_minimum).recommended;
  EXPECT_DOUBLE_EQ(op.axial_depth_m, 0.8e-3);
  EXPECT_EQ(op.mode.number, 2);
}

TEST(Recommend, SaysWhenNothingIsSafe) {
  const auto none = [](double speed) { return chatter_at(speed, 0.0); };
  std::vector<DepthLimit> limits = {none(100.0), none(101.0), none(200.0)};
  RecommendOptions o = options();
  o.machine.speed_window = 0.005;
  Recommendation r = recommend(limits, o, none);
  EXPECT_EQ(r.status, Recommendation::Status::no_safe_depth);
  EXPECT_FALSE(r.reason.empty());
  EXPECT_FALSE(r.recommended.has_value());
  o.machine.min_spindle_speed_rad_per_s = 1000.0;
  r = recommend(limits, o, none);
  EXPECT_NE(r.reason.find("spindle's range"), std::string::npos);
}

TEST(Recommend, RejectsBadInput) {
  EXPECT_THROW(static_cast<void>(recommend({}, options(), lobe)), InvalidInput);
  const auto field = [](const auto& change) {
    RecommendOptions o = options();
    change(o);
    return test::field_of([&] { static_cast<void>(recommend(lobes(), o, lobe)); });
  };
  EXPECT_EQ(field([](RecommendOptions& o) { o.teeth = 0; }), "teeth");
  EXPECT_EQ(field([](RecommendOptions& o) { o.machine.depth_margin = 1.0; }), "depth_margin");
  EXPECT_EQ(field([](RecommendOptions& o) { o.machine.speed_window = 0.5; }), "speed_window");
  EXPECT_EQ(field([](RecommendOptions& o) { o.machine.max_axial_depth_m = 12.0; }), "max_axial_depth_m");
  EXPECT_EQ(field([](RecommendOptions& o) {
              o.machine.min_spindle_speed_rad_per_s = 800.0;
              o.machine.max_spindle_speed_rad_per_s = 700.0;
            }),
            "max_spindle_speed_rad_per_s");
  // A curve is read from its lower speed to its higher one: in another order it would give nothing anywhere.
  EXPECT_EQ(field([](RecommendOptions& o) {
              o.machine.spindle = {{.spindle_speed_rad_per_s = 2000.0, .torque_n_m = 1.0, .power_w = 1e3},
                                   {.spindle_speed_rad_per_s = 300.0, .torque_n_m = 1.0, .power_w = 1e3}};
            }),
            "spindle[2].spindle_speed_rad_per_s");
}

}  // namespace recommend_test
}  // namespace robomill::decision
