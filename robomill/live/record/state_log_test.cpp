#include "robomill/live/record/state_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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

// Without samples the stream's time stands still: the clock's counts.
TEST(StateLog, CountsTimeWithoutSamplesByTheClock) {
  StateLog log;
  log.add(2.0, State::stable);
  log.silent(2.0, 1.0);
  log.silent(2.0, 2.2);
  log.add(2.025, State::stable);
  log.add(5.0, State::stable);
  ASSERT_EQ(log.stays().size(), 3U);
  EXPECT_EQ(log.stays()[1].state, State::blind);
  EXPECT_EQ(log.stays()[1].reason, BlindReason::no_signal);
  EXPECT_EQ(log.stays()[1].from_s, 2.0);
  ASSERT_EQ(log.times().size(), 2U);
  EXPECT_NEAR(log.times()[0].duration_s, 4.975, 1e-9);
  EXPECT_EQ(log.times()[1].reason, BlindReason::no_signal);
  EXPECT_NEAR(log.times()[1].duration_s, 3.2, 1e-9);
}

// The sender's numbers say later how long it was: that is not another reason, and not counted again.
TEST(StateLog, TimeWithoutSamplesIsNoGapOnTop) {
  for (const double gap_s : {3.0, 5.0}) {
    StateLog log;
    log.add(2.0, State::stable);
    log.silent(2.0, 3.2);
    log.leave_out(2.0);
    log.add(2.0 + gap_s, State::stable);
    log.leave_out(10.0);
    log.add(12.0, State::stable);
    ASSERT_EQ(log.times().size(), 3U);
    EXPECT_EQ(log.times()[1].reason, BlindReason::no_signal);
    EXPECT_NEAR(log.times()[1].duration_s, std::max(3.2, gap_s), 1e-9);
    EXPECT_EQ(log.times()[2].reason, BlindReason::gap);
    EXPECT_NEAR(log.times()[2].duration_s, 2.0, 1e-9);
  }
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
