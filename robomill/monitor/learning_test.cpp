// BlindReason::learning: what the default detector says before it can tell a stable cut from one that began in chatter.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/monitor/machine.hpp"
#include "robomill/monitor/monitor.hpp"
#include "testing/monitor/decisions.hpp"
#include "testing/monitor/signal.hpp"

namespace learning_test {

using namespace robomill;
using namespace robomill::monitor;
using monitor::testing::decisions_of;
using monitor::testing::first_alarm_s;
using monitor::testing::options_for;
using monitor::testing::SyntheticCut;
using monitor::testing::vibration;

/// Time of the first decision that is not learning; 1e9: none.
double learnt_s(const std::vector<Decision>& decisions) {
  const auto known =
      std::ranges::find_if(decisions, [](const Decision& d) { return d.reason != BlindReason::learning; });
  return known == decisions.end() ? 1e9 : known->time_s;
}

/// Each decision that is learning is blind, and none is once it is over.
void expect_learning_first(const std::vector<Decision>& decisions) {
  const double over_s = learnt_s(decisions);
  for (const Decision& d : decisions) {
    EXPECT_EQ(d.reason == BlindReason::learning, d.time_s < over_s) << d.time_s;
    EXPECT_EQ(d.state == State::blind, d.reason != BlindReason::none) << d.time_s;
    if (d.state == State::blind) {
      EXPECT_EQ(d.chatter_frequency_hz, 0.0) << d.time_s;
    }
  }
}

std::vector<float> noise(double seconds, double rms, double rate_hz = 10'240.0) {
  Random random(5);
  std::vector<float> out(static_cast<std::size_t>(seconds * rate_hz));
  for (float& x : out) x = static_cast<float>(rms * random.normal());
  return out;
}

/// Air, a hundredth of noise, until the tool enters.
std::vector<float> entering(const SyntheticCut& cut, double enters_s) {
  std::vector<float> x = vibration(cut);
  const std::vector<float> air = noise(cut.seconds, 0.01);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double in = std::clamp((static_cast<double>(i) / cut.sample_rate_hz - enters_s) / 0.05, 0.0, 1.0);
    x[i] = static_cast<float>(in * static_cast<double>(x[i])) + air[i];
  }
  return x;
}

/// One that shows nothing but a little noise.
std::shared_ptr<const Machine> learnt_from_air(const MonitorOptions& options) {
  MachineLearner learner(options);
  learner.begin(0.0);
  EXPECT_FALSE(learner.push(noise(4.0, 0.01)).has_value());
  return std::make_shared<const Machine>(learner.finish());
}

// Of three times tooth passing's amplitude it is not found at all where nothing calm was there before: nor is it
// stable.
TEST(Learning, AStreamThatBeginsInChatterIsNeverStable) {
  for (const double chatter : {0.7, 1.0, 3.0}) {
    for (const double hint_off : {0.0, 0.02, -0.02}) {
      const SyntheticCut cut{.chatter_hz = 683.0, .starts_s = -1.0, .chatter = chatter, .seconds = 2.5};
      const std::vector<Decision> decisions = decisions_of(options_for(cut, hint_off), vibration(cut));
      const double alarm_s = first_alarm_s(decisions);
      if (chatter <= 1.0) {
        EXPECT_GT(alarm_s, 0.0) << chatter << " " << hint_off;
      }
      for (const Decision& d : decisions) {
        if (alarm_s > 0.0 && d.time_s >= alarm_s) break;
        EXPECT_EQ(d.reason, BlindReason::learning) << chatter << " " << hint_off << " " << d.time_s;
      }
    }
  }
}

// Steady chatter that no test finds: it is a suspicion at most, and not stable, for as long as nothing calm was there.
TEST(Learning, ChatterThatIsNotFoundIsNotStableEither) {
  const SyntheticCut cut{.chatter_hz = 683.0, .starts_s = -1.0, .chatter = 0.4, .seconds = 4.0};
  const std::vector<Decision> decisions = decisions_of(options_for(cut), vibration(cut));
  if (first_alarm_s(decisions) < 0.0) {
    EXPECT_NEAR(learnt_s(decisions), 3.0, 0.03);
  }
  for (const Decision& d : decisions) {
    if (d.time_s < std::min(2.9, std::abs(first_alarm_s(decisions)))) {
      EXPECT_NE(d.state, State::stable) << d.time_s;
    }
  }
}

TEST(Learning, EndsSoonAfterTheToolEnters) {
  for (const double enters_s : {0.8, 1.5, 2.2}) {
    const SyntheticCut cut{.seconds = 4.0};
    const std::vector<Decision> decisions = decisions_of(options_for(cut), entering(cut, enters_s));
    expect_learning_first(decisions);
    EXPECT_GT(learnt_s(decisions), enters_s);
    EXPECT_LT(learnt_s(decisions), enters_s + 0.15);
    EXPECT_EQ(first_alarm_s(decisions), -1.0);
  }
}

TEST(Learning, AStableCutAtAKnownSpeedIsACalm) {
  for (const double hint_off : {0.0, 0.02, -0.02}) {
    for (const double rotation_hz : {45.0, 80.0, 150.0}) {
      const SyntheticCut cut{.rotation_hz = rotation_hz, .noise = 0.05, .seconds = 3.5};
      const std::vector<Decision> decisions = decisions_of(options_for(cut, hint_off), vibration(cut));
      expect_learning_first(decisions);
      EXPECT_GT(learnt_s(decisions), 0.59) << rotation_hz << " " << hint_off;
      EXPECT_LT(learnt_s(decisions), 1.05) << rotation_hz << " " << hint_off;
      EXPECT_EQ(first_alarm_s(decisions), -1.0);
    }
  }
}

TEST(Learning, NoiseAloneTakesThreeSeconds) {
  const SyntheticCut cut{.seconds = 4.0};
  const std::vector<Decision> decisions = decisions_of(options_for(cut), noise(4.0, 1.0));
  expect_learning_first(decisions);
  EXPECT_NEAR(learnt_s(decisions), 3.0, 1e-3);
}

TEST(Learning, AMachineThatWasLearntIsACalm) {
  const SyntheticCut cut{.seconds = 2.0};
  MonitorOptions options = options_for(cut);
  options.machine = learnt_from_air(options);
  for (const std::vector<float>& x : {noise(2.0, 0.01), noise(2.0, 1.0), vibration(cut)}) {
    const std::vector<Decision> decisions = decisions_of(options, x);
    expect_learning_first(decisions);
    EXPECT_NEAR(learnt_s(decisions), 0.6, 1e-3);
  }
}

TEST(Learning, BeginsAnewAfterAReset) {
  const SyntheticCut cut{.noise = 0.05, .seconds = 1.5};
  const MonitorOptions options = options_for(cut);
  ChatterMonitor monitor(options);
  (void)monitor.push(vibration(cut));  // a calm is known
  for (int pass = 0; pass < 2; ++pass) {
    monitor.reset();
    const std::vector<float> x = noise(3.5, 1.0);
    std::vector<Decision> decisions;
    for (std::size_t at = 0; at + 256 <= x.size(); at += 256) {
      decisions.push_back(monitor.push(std::span(x).subspan(at, 256)));
    }
    expect_learning_first(decisions);
    EXPECT_NEAR(learnt_s(decisions), 3.0, 1e-3) << pass;
  }
}

TEST(Learning, OtherReasonsComeFirst) {
  const SyntheticCut cut{.seconds = 3.5};
  MonitorOptions options = options_for(cut);
  const std::vector<float> x = noise(3.5, 1.0);
  ChatterMonitor still(options);
  still.set_spindle_speed(0.0);
  EXPECT_EQ(still.push(std::span(x).first(256)).reason, BlindReason::standstill);
  options.spindle_speed_rad_per_s = 0.0;
  const std::vector<Decision> decisions = decisions_of(options, x);
  for (const Decision& d : decisions) {
    EXPECT_EQ(d.reason, d.time_s < 0.99 ? BlindReason::learning : BlindReason::speed_unknown) << d.time_s;
  }
}

// A second without a signal is none in which something was seen, nor are the eleven hops for which the channel is left
// out after it.
TEST(Learning, LostSamplesDoNotCount) {
  const SyntheticCut cut{.seconds = 5.0};
  std::vector<float> x = noise(5.0, 1.0);
  std::fill(x.begin() + 10'240, x.begin() + 20'480, std::numeric_limits<float>::quiet_NaN());
  constexpr double over_s = 3.0 + 1.0 + 11 * 0.025 - 0.01;
  for (const Decision& d : decisions_of(options_for(cut), x)) {
    if (d.time_s > 2.4) {
      EXPECT_EQ(d.reason, d.time_s < over_s ? BlindReason::learning : BlindReason::none) << d.time_s;
    }
    EXPECT_NE(d.state == State::stable && d.time_s < over_s, true) << d.time_s;
  }
}

TEST(Learning, ThePublishedDetectorHasNone) {
  MonitorOptions options = options_for(SyntheticCut{});
  options.kind = Kind::energy_entropy;
  options.threshold = 1e300;
  for (const Decision& d : decisions_of(options, noise(1.0, 1.0))) EXPECT_EQ(d.reason, BlindReason::none) << d.time_s;
}

}  // namespace learning_test
