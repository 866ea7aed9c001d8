// What is believed of the speed, of combs whose speed is known.
#include "robomill/monitor/orders/speed_posterior.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/monitor/orders/spectra.hpp"
#include "testing/monitor/tones.hpp"
#include "testing/support.hpp"

namespace speed_posterior_test {

using namespace robomill;
using namespace robomill::monitor;
using monitor::testing::cut_of;
using monitor::testing::power_of;
using monitor::testing::sum_of;
using monitor::testing::Tone;
using Motion = SpeedPosterior::Motion;

constexpr double rate_hz = 10240.0;
constexpr std::size_t hop = 256;

SpeedPosterior posterior(double hint_hz, int teeth) {
  SpeedPosterior out({.highest_hz = 0.5 * rate_hz, .teeth = teeth});
  out.set_hint(hint_hz);
  return out;
}

/// Hop by hop, once the windows are full.
void listen(SpeedPosterior& speed, const std::vector<float>& x, Motion motion = Motion::free) {
  Spectra spectra(rate_hz, 1);
  for (std::size_t at = 0; at + hop <= x.size(); at += hop) {
    spectra.push(std::span(x).subspan(at, hop), hop);
    if (spectra.past_s() < Spectra::windows_s.front()) continue;
    spectra.transform();
    speed.predict(motion);
    for (std::size_t w = 0; w < Spectra::windows_s.size(); ++w) {
      speed.observe(power_of(spectra.spectrum(w, 0)), spectra.spectrum(w, 0));
    }
    speed.conclude();
    speed.refine(power_of(spectra.spectrum(0, 0)), spectra.spectrum(0, 0));
  }
}

TEST(SpeedPosterior, FindsTheSpeedOfCombsAboutTheHint) {
  Random random(1);
  const int runs = test::seeds(400);
  for (int run = 0; run < runs; ++run) {
    const double rotation_hz = random.uniform(62.0, 300.0);  // none of the mains
    const int teeth = 1 + static_cast<int>(random.index(5));
    const double off = random.uniform(-0.1, 0.1);
    SpeedPosterior speed = posterior(rotation_hz * (1.0 + off), teeth);
    listen(speed, sum_of(cut_of(rotation_hz, teeth, random), rate_hz, 0.8, 0.1));
    EXPECT_NEAR(speed.rotation_hz() / rotation_hz, 1.0, 1e-3) << rotation_hz << " " << teeth << " " << off;
    EXPECT_GT(speed.known(), 0.6);
    EXPECT_LT(speed.std_ratio(), 0.02);
    EXPECT_GT(speed.share(), 0.7);
  }
}

TEST(SpeedPosterior, ALoneLineAtAHighOrderSaysNothing) {
  SpeedPosterior nothing = posterior(80.0, 3);
  for (int k = 0; k < 20; ++k) {
    nothing.predict(Motion::free);
    nothing.conclude();
  }
  for (const double hz : {1880.0, 2011.0, 3217.0}) {
    SpeedPosterior speed = posterior(80.0, 3);
    listen(speed, sum_of(std::array{Tone{hz}}, rate_hz, 0.8));
    EXPECT_LT(std::abs(speed.rotation_hz() / 80.0 - 1.0), 0.03);
    EXPECT_LT(speed.known(), nothing.known() + 0.2);
  }
}

// Without it the other comb is followed.
TEST(SpeedPosterior, HeldStaysWithItsComb) {
  for (const double ratio : {0.96, 1.013, 1.05}) {
    for (const Motion motion : {Motion::held, Motion::free}) {
      Random random(2);
      SpeedPosterior speed = posterior(81.0, 3);
      listen(speed, sum_of(cut_of(80.0, 3, random), rate_hz, 0.8, 0.1));
      EXPECT_NEAR(speed.rotation_hz(), 80.0, 0.08);
      listen(speed, sum_of(cut_of(80.0 * ratio, 3, random), rate_hz, 1.3, 0.1), motion);
      if (motion == Motion::held) {
        EXPECT_NEAR(speed.rotation_hz(), 80.0, 0.005 * 80.0) << ratio;
      } else {
        EXPECT_NEAR(speed.rotation_hz(), 80.0 * ratio, 1e-3 * 80.0) << ratio;
      }
    }
  }
}

TEST(SpeedPosterior, AHintNearbyKeepsWhatIsBelieved) {
  for (const double hint_hz : {72.0, 79.0, 91.0, 130.0, 40.0}) {
    Random random(3);
    SpeedPosterior speed = posterior(82.0, 3);
    listen(speed, sum_of(cut_of(80.0, 3, random), rate_hz, 0.8, 0.1));
    speed.set_hint(hint_hz);
    const bool near = std::abs(std::log(hint_hz / 82.0)) < SpeedPosterior::reach;
    speed.predict(Motion::free);
    speed.conclude();
    EXPECT_NEAR(speed.rotation_hz(), near ? 80.0 : hint_hz, near ? 0.08 : 1e-9);
    EXPECT_EQ(speed.known() > 0.7, near) << hint_hz;
  }
}

TEST(SpeedPosterior, AMeasurementWinsOverAWrongHint) {
  Random random(4);
  for (int run = 0; run < 20; ++run) {
    const double rotation_hz = random.uniform(20.0, 300.0);
    SpeedPosterior speed = posterior(rotation_hz * random.uniform(0.9, 1.1), 3);
    for (int k = 0; k < 10; ++k) {
      speed.predict(Motion::free);
      speed.observe(rotation_hz, 5e-4);
      speed.conclude();
    }
    EXPECT_NEAR(speed.rotation_hz() / rotation_hz, 1.0, 1e-3);
    EXPECT_GT(speed.known(), 0.9);
  }
}

TEST(SpeedPosterior, OnePulseTooManyDoesNotDrawItAway) {
  Random random(5);
  SpeedPosterior speed = posterior(81.0, 3);
  listen(speed, sum_of(cut_of(80.0, 3, random), rate_hz, 0.8, 0.1));
  speed.predict(Motion::near);
  speed.observe(85.0, 1e-3);
  speed.conclude();
  EXPECT_NEAR(speed.rotation_hz(), 80.0, 0.1);
}

// Where the hint says the mains' frequency, what stands there is the cut.
TEST(SpeedPosterior, AHintOfTheMainsFindsARotationThere) {
  Random random(6);
  SpeedPosterior cutting = posterior(50.1, 3);
  listen(cutting, sum_of(cut_of(50.0, 3, random), rate_hz, 1.3, 0.05));
  EXPECT_NEAR(cutting.rotation_hz(), 50.0, 0.05);
}

TEST(SpeedPosterior, WithoutAHintThereIsNone) {
  Random random(7);
  SpeedPosterior speed = posterior(0.0, 3);
  listen(speed, sum_of(cut_of(80.0, 3, random), rate_hz, 0.5, 0.1));
  speed.observe(80.0, 1e-3);
  speed.conclude();
  EXPECT_EQ(speed.rotation_hz(), 0.0);
  EXPECT_EQ(speed.known(), 0.0);
}

// Orders closer than a window tells apart say nothing, and looking for millions of them would take minutes:
// ctest's limit would show it.
TEST(SpeedPosterior, NothingIsLearntOfASpeedWhoseOrdersCannotBeToldApart) {
  Random random(8);
  for (const double hint_hz : {1e-3, 0.5, 4.9}) {
    SpeedPosterior speed = posterior(80.0, 3);
    listen(speed, sum_of(cut_of(80.0, 3, random), rate_hz, 0.8, 0.1));
    EXPECT_GT(speed.share(), 0.7);
    speed.set_hint(hint_hz);
    listen(speed, sum_of(cut_of(80.0, 3, random), rate_hz, 0.8, 0.1));
    EXPECT_NEAR(speed.rotation_hz(), hint_hz, 0.1 * hint_hz);
    EXPECT_EQ(speed.share(), 0.0) << hint_hz;
    EXPECT_LT(speed.known(), 0.4) << hint_hz;
  }
}

TEST(SpeedPosterior, SilenceAndHugeSignalsLeaveItFinite) {
  for (const double amplitude : {0.0, 1e-15, 1e12}) {
    SpeedPosterior speed = posterior(80.0, 0);
    listen(speed, sum_of(std::array{Tone{240.0, amplitude}}, rate_hz, 0.6));
    EXPECT_TRUE(std::isfinite(speed.rotation_hz()) && std::isfinite(speed.std_ratio())) << amplitude;
    EXPECT_NEAR(speed.rotation_hz(), 80.0, 0.15 * 80.0);
    EXPECT_LE(speed.known(), 1.0 + 1e-9);
  }
}

}  // namespace speed_posterior_test
