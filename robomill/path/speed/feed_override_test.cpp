#include "robomill/path/speed/feed_override.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::path {
namespace feed_override_test {

constexpr double period_s = 0.001;

// ds/dθ = 1 − α min(s, 1)² by differences, and the inverse.
TEST(FeedOverride, RunsThroughThetaAsItsDifferentialEquationSays) {
  for (double s = 0.01; s < 1.5; s += 0.0137) {
    const double theta = theta_of(s);
    EXPECT_NEAR(override_of(theta), s, 1e-12);
    if (std::abs(s - 1.0) < 1e-3) continue;
    const double d = 1e-5, below = std::min(s, 1.0);
    EXPECT_NEAR((override_of(theta + d) - override_of(theta - d)) / (2.0 * d),
                1.0 - override_limits::alpha * below * below, 1e-9);
  }
  EXPECT_EQ(override_of(0.0), 0.0);
  EXPECT_NEAR(theta_of(1.0), std::atanh(std::sqrt(0.9)) / std::sqrt(0.9), 1e-12);
}

/// A demand that a plan may have: with every share of the limits up to what it is allowed, some channels still.
Demand random_demand(Random& random, const ChannelLimits& limits, double velocity, double acceleration, double jerk) {
  Demand out;
  for (std::size_t k = 0; k < channel_count; ++k) {
    if (random.uniform() < 0.3) continue;
    const auto share = [&] { return random.uniform() < 0.4 ? 1.0 : random.uniform(); };
    out.velocity[k] = velocity * share() * limits.velocity[k];
    out.acceleration[k] = acceleration * share() * limits.acceleration[k];
    out.jerk[k] = jerk * share() * limits.jerk[k];
  }
  return out;
}

ChannelLimits random_limits(Random& random) {
  ChannelLimits out;
  for (std::size_t k = 0; k < channel_count; ++k) {
    out.velocity[k] = std::exp(random.uniform(-4.0, 2.0));
    out.acceleration[k] = out.velocity[k] * std::exp(random.uniform(0.5, 4.0));
    out.jerk[k] = out.acceleration[k] * std::exp(random.uniform(1.0, 5.0));
  }
  return out;
}

// The chain rule put back: at any override up to the cap, any |θ̇| <= r and |θ̈| <= κ r², whatever the signs.
TEST(FeedOverride, AStretchKeepsEveryLimitWhateverItDoesWithin) {
  Random random(3);
  int capped = 0, fast = 0;
  for (int i = 0; i < 3000; ++i) {
    const ChannelLimits limits = random_limits(random);
    const double over = random.uniform() < 0.3 ? random.uniform(1.0, 2.5) : random.uniform(0.3, 1.0);
    const Demand demand = random_demand(random, limits, 0.998 * std::min(over, 1.0), 0.88 * over, 0.8 * over);
    const Stretch stretch = stretch_of(demand, limits, 100.0);
    ASSERT_GT(stretch.slope, 0.0);
    capped += stretch.cap < 1.0 ? 1 : 0;
    fast += stretch.cap > 1.0 ? 1 : 0;
    for (int j = 0; j < 60; ++j) {
      const double s = stretch.cap * (j < 20 ? 1.0 : random.uniform());
      const double first = stretch.slope * (random.uniform() < 0.5 ? 1.0 : random.uniform(-1.0, 1.0));
      const double second =
          override_limits::kappa * stretch.slope * stretch.slope * (random.uniform() < 0.5 ? 1.0 : -1.0);
      const double below = std::min(s, 1.0), g = 1.0 - override_limits::alpha * below * below;
      const double by_theta = s < 1.0 ? -2.0 * override_limits::alpha * s * g : 0.0;  // dg/dθ
      const double ds = g * first, dds = g * second + by_theta * first * first;
      for (std::size_t k = 0; k < channel_count; ++k) {
        for (const double side : {1.0, -1.0}) {
          const double v = side * demand.velocity[k], a = demand.acceleration[k], q = demand.jerk[k];
          EXPECT_LE(std::abs(v) * s, limits.velocity[k]);
          EXPECT_LE(std::abs(a * s * s + v * ds), limits.acceleration[k]);
          EXPECT_LE(std::abs(q * s * s * s + side * 3.0 * a * s * ds + v * dds), limits.jerk[k]) << s;
          EXPECT_LE(std::abs(q * s * s * s - side * 3.0 * a * s * ds + v * dds), limits.jerk[k]) << s;
        }
      }
    }
  }
  EXPECT_GT(capped, 300);
  EXPECT_GT(fast, 300);
}

TEST(FeedOverride, ApproachesAnyTargetWithinItsBoundsAndRestsThere) {
  Random random(5);
  for (int i = 0; i < 2000; ++i) {
    const double slope = std::exp(random.uniform(-1.0, 4.5)), jerk = override_limits::kappa * slope * slope;
    OverrideState at{.theta = random.uniform(0.0, 4.0)};
    for (int leg = 0; leg < 3; ++leg) {
      const double target = random.uniform(0.0, 4.0);
      const bool from_rest = at.speed == 0.0;
      const double from = at.theta;
      const int cut = leg < 2 ? static_cast<int>(random.index(200)) : 1'000'000;
      for (int n = 0; n < cut && (at.theta != target || at.speed != 0.0); ++n) {
        const OverrideState next = approach(at, target, slope, period_s);
        ASSERT_LE(std::abs(next.speed), std::max(slope, std::abs(at.speed)) * (1.0 + 1e-12));
        ASSERT_LE(std::abs(next.speed - at.speed), jerk * period_s * (1.0 + 1e-12));
        ASSERT_NEAR(next.theta - at.theta, 0.5 * (at.speed + next.speed) * period_s, 2e-12);
        if (from_rest) {
          ASSERT_GE(next.theta, std::min(from, target) - 1e-9);
          ASSERT_LE(next.theta, std::max(from, target) + 1e-9);
        }
        at = next;
        ASSERT_LT(n, 200'000);
      }
    }
    EXPECT_EQ(at.speed, 0.0);
  }
}

// What travel_s() promises against the brake that is run, period by period.
TEST(FeedOverride, TravelBoundsWhatTheBrakeTakes) {
  Random random(7);
  double worst = 0.0;
  int feasible = 0;
  double lag = -9.0;
  for (int i = 0; i < 20'000; ++i) {
    const double slope = std::exp(random.uniform(0.0, 4.6));
    const OverrideState from{.theta = random.uniform(0.0, 6.0), .speed = random.uniform(-1.0, 1.0) * slope};
    const double base = random.uniform() < 0.5 ? 0.0 : random.uniform(0.0, from.theta);
    const double until = random.uniform() < 0.3 ? base : random.uniform(base, std::max(base, from.theta));
    const double promised_s = travel_s(from, base, until, slope, period_s);
    if (!std::isfinite(promised_s)) continue;
    ++feasible;
    double sum = 0.0, to_until = 0.0;
    OverrideState at = from;
    for (int n = 0; at.theta != base || at.speed != 0.0; ++n) {
      const OverrideState next = approach(at, base, slope, period_s);
      sum += passed_s(at, next, period_s);
      ASSERT_GE(next.theta, base - 1e-9);
      if (next.theta > until + 1e-12) to_until = sum;
      at = next;
      ASSERT_LT(n, 100'000);
    }
    lag = std::max(lag, (to_until - promised_s) / (period_s * override_of(from.peak(slope))));
    EXPECT_LE(to_until, promised_s) << from.theta << ' ' << from.speed / slope << ' ' << base << ' ' << until;
    if (until == base && sum > 0.05) worst = std::max(worst, promised_s / sum);
  }
  EXPECT_GT(feasible, 8'000);
  EXPECT_LT(worst, 1.25);
}

// The reserve pays by its logarithm: the way from full override to rest at full slope is 1.92 and not 10.
TEST(FeedOverride, StopsFromFullFeedInAboutTwiceTheTimeOfAnUnplannedStop) {
  ChannelLimits limits;
  limits.velocity.fill(1.0);
  limits.acceleration.fill(5.0);
  limits.jerk.fill(5000.0);
  Demand demand;
  demand.velocity[2] = 0.998;
  demand.acceleration[2] = 0.87 * 5.0;
  const Stretch stretch = stretch_of(demand, limits, 100.0);
  OverrideState at{.theta = theta_of(1.0)};
  int periods = 0;
  for (; at.theta > 0.0; ++periods) at = approach(at, 0.0, stretch.slope, period_s);
  const double shortest_s = 1.0 / 5.0;
  EXPECT_LT(periods * period_s, 2.6 * shortest_s);
  EXPECT_GT(periods * period_s, shortest_s);
}

}  // namespace feed_override_test
}  // namespace robomill::path
