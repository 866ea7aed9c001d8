#include "robomill/live/record/state_log.hpp"

#include <gtest/gtest.h>

#include <map>

#include "robomill/base/random.hpp"

namespace robomill::live {
namespace state_log_test {

using monitor::BlindReason;
using monitor::State;

// Property: the stays of each state sum to its time, and all of them to the time of the run.
TEST(StateLog, TimesAreThoseOfTheStays) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    StateLog log;
    double time_s = 0.0;
    for (int i = 0; i < 300; ++i) {
      time_s += random.uniform(0.0, 1.0);
      log.add(time_s, static_cast<State>(random.index(4)), static_cast<BlindReason>(1 + random.index(4)));
    }
    std::map<std::pair<State, BlindReason>, double> by_stays;
    for (const Stay& stay : log.stays()) by_stays[{stay.state, stay.reason}] += stay.to_s - stay.from_s;
    double all = 0.0;
    for (const StateTime& time : log.times()) {
      EXPECT_NEAR(time.duration_s, (by_stays[{time.state, time.reason}]), 1e-9);
      EXPECT_EQ(time.reason == BlindReason::none, time.state != State::blind);
      all += time.duration_s;
    }
    EXPECT_NEAR(all, time_s, 1e-9);
  }
}

TEST(StateLog, TheFirstStateAlsoHoldsBeforeIt) {
  StateLog log;
  log.add(2.0, State::blind, BlindReason::no_signal);
  ASSERT_EQ(log.stays().size(), 1U);
  EXPECT_EQ(log.stays()[0].from_s, 0.0);
  EXPECT_EQ(log.stays()[0].reason, BlindReason::no_signal);
  log.add(3.0, State::blind, BlindReason::clipped);
  log.add(2.5, State::stable);  // time does not run back
  log.add(4.0, State::stable, BlindReason::gap);
  ASSERT_EQ(log.stays().size(), 3U);
  EXPECT_EQ(log.stays()[1].from_s, 3.0);
  EXPECT_EQ(log.stays()[2].from_s, 3.0);
  EXPECT_EQ(log.stays()[2].to_s, 4.0);
}

TEST(StateLog, CountsTheTimeOfStaysThatItDoesNotList) {
  StateLog log;
  for (int i = 0; i <= 6000; ++i) log.add(i, i % 2 == 0 ? State::stable : State::chatter);
  EXPECT_EQ(log.stays().size(), 2000U);
  EXPECT_EQ(log.unlisted(), 4001U);
  for (const StateTime& time : log.times()) EXPECT_EQ(time.duration_s, 3000.0);
}

}  // namespace state_log_test
}  // namespace robomill::live
