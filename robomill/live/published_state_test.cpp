#include "robomill/live/published_state.hpp"

#include <gtest/gtest.h>

namespace robomill::live {
namespace published_state_test {

void publish(PublishedState& state, bool overloaded) {
  state.begin(overloaded);
  state.end();
}

TEST(PublishedState, AStallIsPublishedOnce) {
  PublishedState state;
  ASSERT_TRUE(state.begin_stall());
  state.end_stall();
  EXPECT_FALSE(state.begin_stall());
  const PublishedState::Stall stall = state.take_stall();
  EXPECT_TRUE(stall.was);
  EXPECT_TRUE(stall.published);
  EXPECT_FALSE(state.take_stall().was);
  EXPECT_FALSE(state.take_doubt());
}

// What the session itself said last counts: a stall out of an overload is none of its own, one out of late chatter is.
TEST(PublishedState, AStallIsNewsUnlessTheSessionHasSaidSo) {
  PublishedState state;
  publish(state, true);
  EXPECT_FALSE(state.begin_stall());
  const PublishedState::Stall stall = state.take_stall();
  EXPECT_TRUE(stall.was);
  EXPECT_FALSE(stall.published);
  publish(state, false);
  EXPECT_TRUE(state.begin_stall());
}

// The session has gone on, and has published a state after the watchdog did.
TEST(PublishedState, WhatCameLastHolds) {
  PublishedState state;
  ASSERT_TRUE(state.begin_stall());
  state.end_stall();
  publish(state, false);
  const PublishedState::Stall stall = state.take_stall();
  EXPECT_TRUE(stall.was);
  EXPECT_FALSE(stall.published);
  EXPECT_FALSE(state.take_doubt());
}

// Which of two came last where they were published at once nobody knows.
TEST(PublishedState, TwoAtOnceAreInDoubt) {
  PublishedState hangs;  // in the middle of publishing
  hangs.begin(false);
  ASSERT_TRUE(hangs.begin_stall());
  hangs.end_stall();
  hangs.end();
  EXPECT_TRUE(hangs.take_stall().published);
  EXPECT_TRUE(hangs.take_doubt());
  EXPECT_FALSE(hangs.take_doubt());
  PublishedState woke;  // while the watchdog published
  ASSERT_TRUE(woke.begin_stall());
  publish(woke, false);
  woke.end_stall();
  EXPECT_TRUE(woke.take_doubt());
}

}  // namespace published_state_test
}  // namespace robomill::live
