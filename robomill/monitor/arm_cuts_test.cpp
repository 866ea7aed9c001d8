// What the cuts of robot arms say of themselves is so. Seeds 1 to 20 of each sensor.
#include "testing/monitor/arm_cuts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <vector>

#include "robomill/signal/spectrum.hpp"
#include "robomill/stability/lobes.hpp"
#include "testing/monitor/arm_sensors.hpp"
#include "testing/monitor/score.hpp"
#include "testing/support.hpp"

namespace robomill::monitor::testing {
namespace arm_cuts_test {

using std::numbers::pi;

constexpr double rpm = pi / 30.0;

/// Every sensor has 20 seeds for tests; a tenth of them without ROBOMILL_FULL, two at least.
std::uint64_t last_seed() {
  return static_cast<std::uint64_t>(std::max(2, test::seeds(20)));
}

TEST(ArmCuts, AreWholeForEverySensor) {
  for (const auto& [name, sensor] : arm_sensor_names) {
    for (std::uint64_t seed = 1; seed <= last_seed(); ++seed) {
      const ArmCut c = draw_arm_cut(sensor, seed);
      const RecordedCut& r = c.recorded;
      const Truth& t = r.truth;
      EXPECT_EQ(r.kind, name);
      EXPECT_EQ(t.chatter, seed % 2 == 1) << name << seed;
      const std::size_t frames = r.samples.size() / static_cast<std::size_t>(r.channels);
      EXPECT_EQ(t.amplitude_m_per_s2.size(), frames) << name << seed;
      EXPECT_EQ(t.speed_rad_per_s.size(), frames) << name << seed;
      EXPECT_TRUE(std::ranges::all_of(r.samples, [](float v) { return std::isfinite(v); })) << name << seed;
      EXPECT_GE(r.teeth, 1);
      EXPECT_LE(r.teeth, 4);
      for (const float speed : t.speed_rad_per_s) {
        ASSERT_GT(static_cast<double>(speed), 290.0 * rpm) << name << seed;
        ASSERT_LT(static_cast<double>(speed), 3001.0 * rpm) << name << seed;
      }
      EXPECT_LE(std::abs(r.hint_rad_per_s / c.arm.speed_rad_per_s - 1.0), 0.05 + 1e-6) << name << seed;
      if (!t.chatter) continue;
      EXPECT_LE(t.start_s, t.t10_s) << name << seed;
      EXPECT_LT(t.t10_s + 0.5, t.end_s) << name << seed;
      EXPECT_LE(t.end_s, r.seconds() + 0.01) << name << seed;
      EXPECT_LT(t.displacement_hz, 100.0) << name << seed;
      EXPECT_LT(t.frequency_hz, 150.0) << name << seed;
      EXPECT_FALSE(t.lines_hz.empty()) << name << seed;
      for (const double line : t.lines_hz) EXPECT_LE(line, 0.5 * r.sample_rate_hz) << name << seed;
    }
  }
}

TEST(ArmCuts, ASeedIsACut) {
  for (const auto& [name, sensor] : arm_sensor_names) {
    const RecordedCut one = arm_cut(sensor, 2);
    EXPECT_EQ(one.samples, arm_cut(sensor, 2).samples) << name;
    EXPECT_NE(one.samples, arm_cut(sensor, 1002).samples) << name;
  }
}

/// How far the spectrum at a line stands above that beside it, in the channel where it does most.
double contrast(const RecordedCut& r, double line_hz, double from_s, double to_s) {
  const auto channels = static_cast<std::size_t>(r.channels);
  const auto rows = std::bit_floor(static_cast<std::size_t>((to_s - from_s) * r.sample_rate_hz));
  const auto from = static_cast<std::size_t>(to_s * r.sample_rate_hz) - rows;
  double most = 0.0;
  for (std::size_t c = 0; c < channels; ++c) {
    Eigen::VectorXd x(static_cast<Eigen::Index>(rows));
    for (std::size_t i = 0; i < rows; ++i) {
      x(static_cast<Eigen::Index>(i)) = static_cast<double>(r.samples[(from + i) * channels + c]);
    }
    const signal::Spectrum spectrum = signal::amplitude_spectrum(x, r.sample_rate_hz);
    double here = 0.0;
    std::vector<double> beside;
    for (Eigen::Index k = 0; k < spectrum.frequency_hz.size(); ++k) {
      const double off_hz = std::abs(spectrum.frequency_hz(k) - line_hz);
      if (off_hz < 1.0) here = std::max(here, spectrum.amplitude(k));
      if (off_hz < 8.0) beside.push_back(spectrum.amplitude(k));
    }
    most = std::max(most, here / quantile(beside, 0.5));
  }
  return most;
}

// Where contact is lost again and again the motion may be irregular, without a clear line.
TEST(ArmCuts, ChatterIsInTheRecording) {
  int cuts = 0, clear = 0;
  for (const auto& [name, sensor] : arm_sensor_names) {
    for (std::uint64_t seed = 1; seed <= last_seed(); seed += 2) {
      const RecordedCut r = arm_cut(sensor, seed);
      ++cuts;
      clear += contrast(r, r.truth.frequency_hz, r.truth.t10_s, r.truth.end_s) > 3.0 ? 1 : 0;
    }
  }
  EXPECT_GE(10 * clear, 9 * cuts) << clear << " of " << cuts;
}

// Three sensors of one cut: one truth, a tone of an axis in each of them, noise of their own.
TEST(ArmCuts, ThreeSensorsShowOneCut) {
  const RecordedCut one = arm_cut(ArmSensor::spindle_accelerometer, 1), all = arm_cut_of_three_sensors(1);
  EXPECT_EQ(all.channels, 6);
  EXPECT_EQ(all.sensors, (std::vector<int>{0, 0, 1, 1, 2, 2}));
  EXPECT_EQ(all.samples.size(), 3 * one.samples.size());
  EXPECT_EQ(all.truth.t10_s, one.truth.t10_s);
  for (int sensor = 0; sensor < 3; ++sensor) {
    RecordedCut alone = one;
    alone.samples.clear();
    for (std::size_t i = 0; i < all.samples.size(); i += 6) {
      for (std::size_t c = 0; c < 2; ++c)
        alone.samples.push_back(all.samples[i + 2 * static_cast<std::size_t>(sensor) + c]);
    }
    EXPECT_GT(contrast(alone, one.truth.displacement_hz, one.truth.t10_s, one.truth.end_s), 3.0) << sensor;
  }
}

// By a second method: collocation of the linear delay equation, without runout.
TEST(ArmCuts, LinearTheoryAgreesWithWhatIsPlanned) {
  int milled = 0;
  for (std::uint64_t seed = 1; seed <= 2 * last_seed() || milled == 0; ++seed) {
    Random random(seed, 11);
    const bool chatter = seed % 2 == 1;
    const ArmPlan arm = draw_arm_plan(chatter, random);
    if (arm.plan.drilling) continue;
    ++milled;
    stability::LobesProblem problem;
    problem.milling = arm.plan.milling.milling;
    problem.milling.tool.runout_m = 0.0;
    problem.dynamics = arm.dynamics;
    const double speed = arm.plan.milling.spindle_speed_rad_per_s;
    const stability::PointResult point =
        stability::evaluate_point(problem, {.tolerance = 1e-4}, {speed, arm.plan.milling.axial_depth_m});
    EXPECT_EQ(point.stable, !chatter) << seed << ": " << point.spectral_radius;
    const double growth_per_s = std::log(point.spectral_radius) * speed * problem.milling.tool.teeth / (2.0 * pi);
    EXPECT_NEAR(growth_per_s, arm.growth_per_s, 1.0 + 0.15 * std::abs(growth_per_s)) << seed;
  }
}

// What a low-pass does to tones, and to noise.
TEST(ArmCuts, TwoPolesPassWhatTheyShould) {
  const auto gain = [](double frequency_hz) {
    TwoPoles filter(100.0, 0.7, 10240.0);
    double most = 0.0;
    for (int i = 0; i < 20480; ++i) {
      const double y = filter.next(std::sin(2.0 * pi * frequency_hz * i / 10240.0));
      if (i > 10240) most = std::max(most, std::abs(y));
    }
    return most;
  };
  for (const double hz : {2.0, 50.0, 100.0, 200.0, 400.0}) {
    const double r = hz / 100.0, exact = 1.0 / std::hypot(1.0 - r * r, 1.4 * r);
    EXPECT_NEAR(gain(hz), exact, 0.02 * exact + 2e-3) << hz;
  }
  TwoPoles mode(20.0, 0.03, 1000.0);
  Random random(3);
  double square = 0.0;
  constexpr int count = 400000;
  for (int i = 0; i < count; ++i) square += std::pow(mode.next(random.normal()), 2) / count;
  EXPECT_NEAR(std::sqrt(square), mode.noise_gain(), 0.03 * mode.noise_gain());
}

// A controller's trace stands on a converter's steps and does not see the tool's modes.
TEST(ArmCuts, DrivesShowTheArmAlone) {
  for (const ArmSensor sensor : {ArmSensor::drive_current, ArmSensor::motor_torque}) {
    for (std::uint64_t seed = 1; seed <= last_seed(); ++seed) {
      const RecordedCut r = arm_cut(sensor, seed);
      EXPECT_LE(r.sample_rate_hz, 1000.0);
      EXPECT_GE(r.channels, 2);
      EXPECT_LE(r.channels, 6);
      for (const double line : r.truth.lines_hz) EXPECT_LT(line, 200.0) << seed;
      std::vector<float> values = r.samples;
      std::ranges::sort(values);
      const auto different = static_cast<std::size_t>(std::unique(values.begin(), values.end()) - values.begin());
      EXPECT_LT(different, r.samples.size() / 2) << seed;
    }
  }
}

}  // namespace arm_cuts_test
}  // namespace robomill::monitor::testing
