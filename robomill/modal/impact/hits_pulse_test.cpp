#include "robomill/modal/impact/hits_pulse.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::modal {
namespace hits_pulse_test {

using Eigen::Index;

constexpr Index length = 4096;

// A half sine of that height and base length; shorter or longer contact makes it narrower or wider.
void add_pulse(Eigen::VectorXd& force, double start, double base, double height) {
  for (Index j = 0; j < force.size(); ++j) {
    const double way = (static_cast<double>(j) - start) / base;
    if (way > 0.0 && way < 1.0) force(j) += height * std::sin(std::numbers::pi * way);
  }
}

// What real hammers add: noise, an offset, a slow swing of the handle, ringing after the pulse.
void add_nuisance(Eigen::VectorXd& force, double start, double base, double peak, Random& random) {
  const double noise = random.uniform(0.0, 0.003) * peak;
  const double offset = random.uniform(-0.02, 0.02) * peak;
  const double swing = random.uniform(0.0, 0.03) * peak;
  const double swing_period = random.uniform(20.0, 200.0) * base;
  const double phase = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double ringing = random.uniform(0.0, 0.01) * peak;
  const double ringing_period = random.uniform(0.4, 2.0) * base;
  const double ringing_time = random.uniform(1.0, 8.0) * base;
  for (Index j = 0; j < force.size(); ++j) {
    const double t = static_cast<double>(j);
    force(j) += offset + noise * random.normal() + swing * std::sin(2.0 * std::numbers::pi * t / swing_period + phase);
    const double after = t - start - base;
    if (after > 0.0) {
      force(j) += ringing * std::exp(-after / ringing_time) * std::sin(2.0 * std::numbers::pi * after / ringing_period);
    }
  }
}

TEST(FindPulse, MeasuresAHalfSine) {
  Eigen::VectorXd force = Eigen::VectorXd::Constant(length, 1.5);
  add_pulse(force, 399.5, 60.0, 200.0);
  const Pulse pulse = find_pulse(force);
  EXPECT_NEAR(pulse.offset_n, 1.5, 1e-12);
  EXPECT_NEAR(pulse.peak_n, 200.0, 0.1);
  EXPECT_NEAR(static_cast<double>(pulse.peak), 429.5, 1.0);
  EXPECT_NEAR(pulse.width, 40.0, 0.1);  // sin is above half on two thirds of its half period
  EXPECT_NEAR(static_cast<double>(pulse.first), 400.0, 2.0);
  EXPECT_NEAR(static_cast<double>(pulse.last), 459.0, 2.0);
  EXPECT_LT(pulse.second_ratio, 0.005);
}

TEST(FindPulse, OneHitIsOneHitWhateverSurroundsIt) {
  for (int seed = 0; seed < test::seeds(2000); ++seed) {
    Random random(11, static_cast<std::uint64_t>(seed));
    const double base = random.uniform(8.0, 90.0);
    const double start = random.uniform(1.0, 0.5 * static_cast<double>(length));
    const double peak = std::pow(10.0, random.uniform(0.0, 4.0));
    Eigen::VectorXd force = Eigen::VectorXd::Zero(length);
    add_pulse(force, start, base, peak);
    add_nuisance(force, start, base, peak, random);
    EXPECT_LT(find_pulse(force).second_ratio, 0.03) << "seed " << seed;
  }
}

TEST(FindPulse, SecondHitOfFivePercentIsSeen) {
  for (int seed = 0; seed < test::seeds(2000); ++seed) {
    Random random(12, static_cast<std::uint64_t>(seed));
    const double base = random.uniform(8.0, 90.0);
    const double start = random.uniform(400.0, 0.5 * static_cast<double>(length));
    const double peak = std::pow(10.0, random.uniform(0.0, 4.0));
    const double height = random.uniform(0.05, 0.9);
    // A hammer that comes back slowly stays a little longer.
    const double second_base = base * random.uniform(0.8, 1.6);
    const bool before = random.uniform() < 0.2;
    const double gap = random.uniform(0.5, 1.5) * base;
    const double second_start =
        before ? start - gap - second_base : start + base + (random.uniform() < 0.5 ? gap : 10.0 * gap);
    Eigen::VectorXd force = Eigen::VectorXd::Zero(length);
    add_pulse(force, start, base, peak);
    add_nuisance(force, start, base, peak, random);
    add_pulse(force, second_start, second_base, height * peak);
    const double ratio = find_pulse(force).second_ratio;
    EXPECT_GT(ratio, 0.03) << "seed " << seed << ", height " << height;
    EXPECT_LT(ratio, 1.3 * height + 0.02) << "seed " << seed;
  }
}

// After a real hit the sensor swings below zero by half a percent or so and comes back: no second hit.
TEST(FindPulse, ReboundBelowZeroIsNoHit) {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(length);
  add_pulse(force, 500.0, 55.0, 250.0);
  add_pulse(force, 556.0, 30.0, -1.3);
  add_pulse(force, 590.0, 20.0, 0.4);
  EXPECT_LT(find_pulse(force).second_ratio, 0.005);
}

TEST(FindPulse, StaysFiniteInNoise) {
  for (int seed = 0; seed < 20; ++seed) {
    Random random(14, static_cast<std::uint64_t>(seed));
    Eigen::VectorXd force(length);
    for (Index j = 0; j < length; ++j) force(j) = random.normal();
    const Pulse pulse = find_pulse(force);
    EXPECT_TRUE(std::isfinite(pulse.second_ratio) && std::isfinite(pulse.width));
    EXPECT_NEAR(pulse.noise_n, 1.0, 0.1);
  }
}

TEST(FindPulse, PullHasANegativePeak) {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(length);
  add_pulse(force, 500.0, 55.0, -250.0);
  EXPECT_NEAR(find_pulse(force).peak_n, -250.0, 0.5);
}

TEST(HasFlatTop, SeesClippingAndNothingElse) {
  for (int seed = 0; seed < test::seeds(2000); ++seed) {
    Random random(13, static_cast<std::uint64_t>(seed));
    const double frequency = random.uniform(0.001, 0.05);
    const double step = std::pow(10.0, random.uniform(-7.0, -3.5));  // the converter's
    Eigen::VectorXd x(length);
    for (Index j = 0; j < length; ++j) {
      const double t = static_cast<double>(j);
      x(j) = std::exp(-t / 1500.0) * std::sin(2.0 * std::numbers::pi * frequency * t);
      x(j) = step * std::round(x(j) / step);
    }
    EXPECT_FALSE(has_flat_top(x)) << "seed " << seed;
    const double limit = step * std::round(random.uniform(0.5, 0.8) * x.maxCoeff() / step);
    const Eigen::VectorXd clipped =
        seed % 2 == 0 ? Eigen::VectorXd(x.cwiseMin(limit)) : Eigen::VectorXd(x.cwiseMax(-limit));
    if ((clipped.array() == limit).count() + (clipped.array() == -limit).count() < 6) continue;
    EXPECT_TRUE(has_flat_top(clipped)) << "seed " << seed;
  }
}

TEST(HasFlatTop, RestIsNoClipping) {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(length);
  add_pulse(force, 500.0, 55.0, 250.0);
  EXPECT_FALSE(has_flat_top(force));
  EXPECT_TRUE(has_flat_top(force.cwiseMin(200.0)));
}

}  // namespace hits_pulse_test
}  // namespace robomill::modal
