// The speed that is tracked about a hint, of sums of sines.
#include "robomill/monitor/orders/speed_tracker.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/monitor/orders/noise_floor.hpp"
#include "testing/monitor/tones.hpp"
#include "testing/support.hpp"

namespace speed_tracker_test {

using namespace robomill;
using namespace robomill::monitor;
using monitor::testing::cut_of;
using monitor::testing::power_of;
using monitor::testing::sum_of;
using monitor::testing::Tone;
using monitor::testing::usual_windows_s;

constexpr double rate_hz = 10240.0;
constexpr std::size_t hop = 256;

SpeedTracker tracker(double hint_hz, int teeth) {
  SpeedTracker out({.teeth = teeth, .lines = 8192});
  out.set_hint(hint_hz);
  return out;
}

/// Hop by hop, once the window is full.
/// @param pulses_hz  measured in each hop; 0: not;  @param sample_rate_hz  of x
void listen(SpeedTracker& speed, const std::vector<float>& x, double pulses_hz = 0.0, double sample_rate_hz = rate_hz) {
  Spectra spectra(sample_rate_hz, 1, usual_windows_s);
  const Spectrum& like = spectra.spectrum(0, 0);
  NoiseFloor floor(like.line.size());
  for (std::size_t at = 0; at + hop <= x.size(); at += hop) {
    spectra.push(std::span(x).subspan(at, hop), hop);
    if (spectra.past_s() < usual_windows_s.front()) continue;
    spectra.transform(0);
    const std::vector<float> power = power_of(like);
    if (pulses_hz > 0.0) speed.measured(pulses_hz, 1e-3);
    speed.step(power, floor.of(power, static_cast<std::size_t>(2.0 * speed.hint_hz() / like.step_hz)), like);
  }
}

/// A comb of all orders up to the 24th and noise, which bounded weights need.
std::vector<Tone> comb_of(double rotation_hz, int teeth, Random& random) {
  std::vector<Tone> out = cut_of(rotation_hz, teeth, random);
  for (int k = 2; k <= 12; ++k) out.push_back({k * rotation_hz, 0.05, random.uniform(0.0, 6.0)});
  return out;
}

TEST(SpeedTracker, FindsTheSpeedOfCombsAboutTheHint) {
  Random random(1);
  const int runs = test::seeds(200);
  for (int run = 0; run < runs; ++run) {
    const double rotation_hz = random.uniform(40.0, 250.0);
    const int teeth = 1 + static_cast<int>(random.index(5));
    const double off = random.uniform(-0.06, 0.06);
    SpeedTracker speed = tracker(rotation_hz * (1.0 + off), teeth);
    listen(speed, sum_of(comb_of(rotation_hz, teeth, random), rate_hz, 1.3, 0.05));
    EXPECT_NEAR(speed.rotation_hz() / rotation_hz, 1.0, 1.5e-3) << rotation_hz << " " << teeth << " " << off;
    EXPECT_GT(speed.belief(), 0.12) << rotation_hz << " " << teeth;
    EXPECT_GT(speed.seen(), 0.12);
    EXPECT_LT(speed.std_ratio(), 0.03);
  }
}

// However strong it is: its weight is bounded.
TEST(SpeedTracker, AStrongLineBesideTheCombDoesNotDrawIt) {
  Random random(2);
  for (const double order : {11.05, 7.07, 14.04, 9.5}) {
    for (const double amplitude : {1.0, 10.0, 100.0}) {
      SpeedTracker speed = tracker(81.0, 3);
      std::vector<Tone> tones = comb_of(80.0, 3, random);
      tones.push_back({order * 80.0, amplitude});
      listen(speed, sum_of(tones, rate_hz, 1.5, 0.02));
      EXPECT_NEAR(speed.rotation_hz(), 80.0, 0.15) << order << " " << amplitude;
    }
  }
}

// A speed 2 % off meets tooth passing at the flank of its lines, and with a high order the line that is no order.
TEST(SpeedTracker, TheFlanksOfToothPassingCountLessThanItsLines) {
  for (const double sample_rate_hz : {5120.0, 8000.0, 10240.0}) {
    for (const double foreign_hz : {517.0, 733.0, 881.0}) {
      SpeedTracker speed = tracker(50.0, 3);
      const std::vector<Tone> tones = {{150.0, 0.1}, {300.0, 0.1}, {foreign_hz, 0.02}};
      listen(speed, sum_of(tones, sample_rate_hz, 2.0, 0.002), 0.0, sample_rate_hz);
      EXPECT_NEAR(speed.rotation_hz(), 50.0, 0.1) << sample_rate_hz << " " << foreign_hz;
    }
  }
}

TEST(SpeedTracker, NoiseAndALoneLineGiveNoBelief) {
  for (const double amplitude : {0.0, 1.0}) {
    SpeedTracker speed = tracker(80.0, 3);
    listen(speed, sum_of(std::array{Tone{2011.0, amplitude}}, rate_hz, 1.3, 0.1));
    EXPECT_LT(speed.belief(), 0.12) << amplitude;
    EXPECT_NEAR(speed.rotation_hz(), 80.0, 0.05 * 80.0);
  }
}

TEST(SpeedTracker, AHintNearbyKeepsWhatWasLearnt) {
  for (const double hint_hz : {76.0, 79.0, 130.0, 40.0}) {
    Random random(3);
    SpeedTracker speed = tracker(81.0, 3);
    listen(speed, sum_of(comb_of(80.0, 3, random), rate_hz, 1.3, 0.05));
    speed.set_hint(hint_hz);
    listen(speed, sum_of(comb_of(80.0, 3, random), rate_hz, 0.35, 0.05));
    const bool near = std::abs(std::log(hint_hz / 81.0)) < SpeedTracker::reach;
    if (near) {
      EXPECT_NEAR(speed.rotation_hz(), 80.0, 0.1) << hint_hz;
    } else {
      EXPECT_NEAR(speed.rotation_hz(), hint_hz, 0.1501 * hint_hz);
    }
  }
}

TEST(SpeedTracker, AMeasurementWinsOverAWrongHintAndACombOverAWrongPulse) {
  Random random(4);
  SpeedTracker silent = tracker(88.0, 3);
  listen(silent, sum_of({}, rate_hz, 0.4, 0.1), 80.0);
  EXPECT_NEAR(silent.rotation_hz(), 80.0, 0.1);
  EXPECT_EQ(silent.belief(), 1.0);
  SpeedTracker speed = tracker(81.0, 3);
  listen(speed, sum_of(comb_of(80.0, 3, random), rate_hz, 1.5, 0.02));
  listen(speed, sum_of(comb_of(80.0, 3, random), rate_hz, 0.325, 0.02), 85.0);
  EXPECT_NEAR(speed.rotation_hz(), 80.0, 0.4);
}

// The orders at another speed than the tracked one show that speed; chatter beside the orders shows none.
TEST(SpeedTracker, AnOrderOfAnotherSpeedLeads) {
  Random random(8);
  const auto lead_of = [&](double now_hz, double line_hz, double amplitude) {
    SpeedTracker speed = tracker(81.0, 3);
    listen(speed, sum_of(comb_of(80.0, 3, random), rate_hz, 1.3, 0.05));
    std::vector<Tone> tones = comb_of(now_hz, 3, random);
    tones.push_back({line_hz, amplitude});
    Spectra spectra(rate_hz, 1, usual_windows_s);
    const std::vector<float> x = sum_of(tones, rate_hz, 0.35, 0.05);
    spectra.push(x, x.size());
    spectra.transform(0);
    const Spectrum& like = spectra.spectrum(0, 0);
    return speed.lead_of_an_order(line_hz, power_of(like), like);
  };
  for (const double now_hz : {74.0, 77.0, 83.0, 87.0}) {
    EXPECT_GT(lead_of(now_hz, 3.0 * now_hz, 2.0), 0.2) << now_hz;
    EXPECT_GT(lead_of(now_hz, 6.0 * now_hz, 5.0), 0.2) << now_hz;
  }
  for (const double order : {2.8, 3.2, 6.3, 6.5, 8.7, 9.4}) EXPECT_LT(lead_of(80.0, order * 80.0, 5.0), 0.0) << order;
  EXPECT_EQ(lead_of(80.0, 1.5 * 80.0, 5.0), -1.0);  // of no speed near the hint
}

TEST(SpeedTracker, WithoutAHintThereIsNone) {
  Random random(7);
  SpeedTracker speed = tracker(0.0, 3);
  listen(speed, sum_of(comb_of(80.0, 3, random), rate_hz, 0.5, 0.1));
  EXPECT_EQ(speed.rotation_hz(), 0.0);
  EXPECT_EQ(speed.belief(), 0.0);
}

TEST(SpeedTracker, SilenceAndHugeSignalsLeaveItFinite) {
  for (const double amplitude : {0.0, 1e-15, 1e12}) {
    for (const double hint_hz : {1e-3, 80.0, 3000.0}) {
      SpeedTracker speed = tracker(hint_hz, 0);
      listen(speed, sum_of(std::array{Tone{240.0, amplitude}}, rate_hz, 0.6));
      EXPECT_TRUE(std::isfinite(speed.rotation_hz()) && std::isfinite(speed.std_ratio())) << amplitude;
      EXPECT_NEAR(speed.rotation_hz(), hint_hz, 0.1501 * hint_hz);
      EXPECT_LE(speed.belief(), 1.0);
    }
  }
}

}  // namespace speed_tracker_test
