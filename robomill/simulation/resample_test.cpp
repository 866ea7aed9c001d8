#include "robomill/simulation/resample.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace robomill::simulation::detail {
namespace resample_test {

constexpr double pi = std::numbers::pi;

/// Feeds sines of this frequency: displacement of amplitude 1, force of amplitude 1 as its means over the steps.
Resampler fed(double step_s, double rate_hz, Eigen::Index rows, double frequency_hz) {
  Resampler r(step_s, rate_hz, rows);
  const double w = 2.0 * pi * frequency_hz;
  for (long n = 0; !r.done(); ++n) {
    const double t = static_cast<double>(n) * step_s;
    const double mean = w == 0.0 ? 1.0 : (std::cos(w * (t - step_s)) - std::cos(w * t)) / (w * step_s);
    const double q = w == 0.0 ? 1.0 : std::sin(w * t);
    r.push({q, 0.0, 2.0 * q}, {mean, 0.0, 0.0});
  }
  return r;
}

// The pass band as promised: up to 0.44 of the rate, whatever the ratio of the rates.
TEST(Resampler, KeepsThePassBand) {
  const double rate = 10240.0;
  for (const double ratio : {4.0, 7.31, 23.7}) {
    for (const double share : {0.003, 0.1, 0.3, 0.44}) {
      const double f = share * rate, w = 2.0 * pi * f;
      const Resampler r = fed(1.0 / (ratio * rate), rate, 400, f);
      double value = 0.0, second = 0.0, force = 0.0;
      for (Eigen::Index i = 100; i < 400; ++i) {
        const double expected = std::sin(w * static_cast<double>(i) / rate);
        value = std::max(value, std::abs(r.displacement_m(i, 0) - expected));
        second = std::max(second, std::abs(r.acceleration_m_per_s2(i, 0) + w * w * expected) / (w * w));
        force = std::max(force, std::abs(r.force_n(i, 0) - expected));
        EXPECT_DOUBLE_EQ(r.displacement_m(i, 2), 2.0 * r.displacement_m(i, 0));
      }
      // A mean over a step is the value times sin(x)/x, x = half the step's phase.
      const double droop = 1.0 - std::sin(pi * share / ratio) / (pi * share / ratio);
      EXPECT_LT(value, 1e-4) << ratio << " " << share;
      EXPECT_LT(second, 5e-4) << ratio << " " << share;
      EXPECT_LT(force, 1e-4 + droop) << ratio << " " << share;
    }
  }
}

TEST(Resampler, LetsNothingThroughAboveTheStopBand) {
  const double rate = 10240.0;
  for (const double share : {0.56, 0.8, 1.7}) {
    const Resampler r = fed(1.0 / (9.3 * rate), rate, 300, share * rate);
    const double w = 2.0 * pi * share * rate;
    EXPECT_LT(r.displacement_m.block(100, 0, 200, 1).cwiseAbs().maxCoeff(), 1e-4) << share;
    EXPECT_LT(r.acceleration_m_per_s2.block(100, 0, 200, 1).cwiseAbs().maxCoeff(), 2e-4 * w * w) << share;
  }
}

TEST(Resampler, WhatStandsStillHasNoAcceleration) {
  const Resampler r = fed(1.0 / 83000.0, 10240.0, 300, 0.0);
  EXPECT_LT(r.acceleration_m_per_s2.block(100, 0, 200, 1).cwiseAbs().maxCoeff(), 1e-4);  // of 1 m, against 1e9 m/s²
  EXPECT_LT((r.displacement_m.block(100, 0, 200, 1).array() - 1.0).abs().maxCoeff(), 1e-4);
}

}  // namespace resample_test
}  // namespace robomill::simulation::detail
