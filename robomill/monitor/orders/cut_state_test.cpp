// Whether the tool cuts, by energies that are given.
#include "robomill/monitor/orders/cut_state.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace cut_state_test {

using robomill::monitor::CutState;

constexpr double hop_s = 0.025;

/// Hops of one kind.
void pass(CutState& cut, double seconds, const CutState::Measured& each, bool chatter = false) {
  for (int k = 0; k < std::lround(seconds / hop_s); ++k) cut.step(each, chatter);
}

CutState::Measured air() {
  return {.energy = 1.0,
          .synchronous = 0.02,
          .whole = 1.0,
          .teeth = 0.01,
          .short_synchronous = 0.02,
          .rotation_hz = 80.0,
          .full = true};
}

CutState::Measured cutting(double energy = 100.0) {
  return {.energy = energy,
          .synchronous = 0.9 * energy,
          .whole = energy,
          .teeth = 0.8 * energy,
          .short_synchronous = 0.9 * energy,
          .rotation_hz = 80.0,
          .full = true};
}

TEST(CutState, KnowsTheAirAndTheCut) {
  CutState cut(hop_s);
  pass(cut, 1.0, air());
  EXPECT_NEAR(cut.above_quiet(), 1.0, 1e-12);
  EXPECT_LT(cut.cutting(), 1.0);
  EXPECT_LT(cut.anchored(), 1.0);
  pass(cut, 1.0, cutting());
  EXPECT_GT(cut.cutting(), 1.0);
  EXPECT_GT(cut.anchored(), 1.0);
  EXPECT_NEAR(cut.above_quiet(), 100.0 * std::exp(-0.1), 1.0);
  EXPECT_NEAR(cut.staying(), 1.0, 1e-12);
}

// The least energy is forgotten with 10 s.
TEST(CutState, ForgetsTheAirSlowly) {
  CutState cut(hop_s);
  pass(cut, 1.0, air());
  pass(cut, 10.0, cutting());
  EXPECT_NEAR(cut.quiet(), std::exp(1.0), 0.02);
  pass(cut, 60.0, cutting());
  EXPECT_NEAR(cut.quiet(), 100.0, 1e-9);
}

TEST(CutState, AnEntryBringsEnergyToTheOrders) {
  CutState cut(hop_s);
  pass(cut, 1.0, air());
  pass(cut, 0.1, cutting());
  EXPECT_LT(cut.entered_s(), 0.11);
  pass(cut, 1.0, cutting());
  EXPECT_GT(cut.entered_s(), 1.0);
  // Chatter grows as fast, beside them.
  CutState::Measured chatter = cutting(1000.0);
  chatter.synchronous = 95.0;
  chatter.teeth = 85.0;
  chatter.family = 800.0;
  pass(cut, 0.5, chatter);
  EXPECT_GT(cut.entered_s(), 1.5);
}

// In chatter the orders hold little of the energy, but what they held before: the speed is right. After a change of
// speed they hold next to nothing.
TEST(CutState, TheOrdersAnchorTheSpeedInChatterToo) {
  CutState cut(hop_s);
  pass(cut, 1.0, air());
  pass(cut, 1.5, cutting());
  CutState::Measured chatter = cutting(2000.0);
  chatter.synchronous = 80.0;
  chatter.teeth = 75.0;
  chatter.family = 1800.0;
  pass(cut, 0.5, chatter);
  EXPECT_GT(cut.anchored(), 1.0);
  CutState::Measured other_speed = cutting(100.0);
  other_speed.synchronous = other_speed.teeth = 1.0;
  other_speed.family = 80.0;
  other_speed.comb = 0.5;
  pass(cut, 0.5, other_speed);
  EXPECT_LT(cut.anchored(), 1.0);
}

// A comb that was found may be the machine's in air. The cut hides it: in chatter the orders of a cut hold more.
TEST(CutState, AFoundCombThatTheCutHidesIsNotItsOwn) {
  for (const bool given : {false, true}) {
    CutState cut(hop_s);
    pass(cut, 1.0, air());
    CutState::Measured idle = cutting(10.0);
    idle.given = given;
    pass(cut, 0.2, idle);
    CutState::Measured beside = cutting(5000.0);
    beside.synchronous = beside.teeth = 9.0;
    beside.family = 4000.0;
    beside.comb = 0.5;
    beside.given = given;
    pass(cut, 0.5, beside);
    EXPECT_EQ(cut.anchored() >= 1.0, given);
  }
}

TEST(CutState, LeavesWhereTheEnergyFalls) {
  CutState cut(hop_s);
  pass(cut, 2.0, cutting());
  pass(cut, hop_s, cutting(20.0));
  EXPECT_NEAR(cut.staying(), 0.2, 1e-12);
  pass(cut, 0.5, cutting(20.0));
  EXPECT_NEAR(cut.staying(), 1.0, 1e-12);
}

TEST(CutState, MeasuresWhatChangesWithinItsRings) {
  CutState cut(hop_s);
  pass(cut, 1.0, cutting());
  EXPECT_EQ(cut.swing(), 0.0);
  EXPECT_EQ(cut.speed_change(), 0.0);
  CutState::Measured other = cutting(110.0);
  other.rotation_hz = 82.0;
  pass(cut, hop_s, other);
  EXPECT_NEAR(cut.swing(), 9.0, 1e-9);
  EXPECT_NEAR(cut.speed_change(), 2.0 / 82.0, 1e-12);
  pass(cut, 1.0, other);
  EXPECT_EQ(cut.swing(), 0.0);
}

TEST(CutState, IsFiniteInSilenceAndAfterReset) {
  CutState cut(hop_s);
  pass(cut, 1.0, {.full = true});
  for (const double each : {cut.above_quiet(), cut.anchored(), cut.cutting(), cut.staying(), cut.swing()}) {
    EXPECT_TRUE(std::isfinite(each));
  }
  pass(cut, 1.0, cutting());
  cut.reset();
  EXPECT_EQ(cut.quiet(), 0.0);
  EXPECT_EQ(cut.swing(), 0.0);
}

}  // namespace cut_state_test
