#include "robomill/live/path_actuator.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <thread>
#include <utility>
#include <vector>

#include "testing/allocations.hpp"
#include "testing/path/machine.hpp"
#include "testing/path/s_path.hpp"
#include "testing/path/trajectories.hpp"

namespace robomill::live {
namespace path_actuator_test {

using Kind = Command::Kind;
using State = path::PathInterpolator::State;

static_assert(noexcept(std::declval<PathActuator&>().next(std::declval<path::Sample&>())));
static_assert(noexcept(std::declval<PathActuator&>().apply(std::declval<const Command&>())));

struct Retracts final : PathActuator::Retract {
  void retract(double distance_m) noexcept override {
    ++times;
    last_m = distance_m;
  }
  int times = 0;
  double last_m = 0.0;
};

/// A tilt head on a straight line of 0.5 m at 50 mm/s.
struct Straight {
  explicit Straight(PathActuator::Retract* retract = nullptr)
      : machine(path::test::tilt_head_limits()),
        path(machine, path::test::published_options(path::Method::verified), {}, 0.0,
             (robot::Position6() << 0.0, 0.0, 0.15, 0.0, 0.0, 0.0).finished(), {.look_ahead_s = 40.0}),
        actuator(path, retract) {
    EXPECT_TRUE(path.push({.kind = program::Block::Kind::feed, .end = {.tip_m = {0.5, 0.0, 0.0}}, .duration_s = 10.0})
                    .accepted());
    EXPECT_TRUE(path.finish().accepted());
    run(1.0);
  }
  State run(double seconds) {
    State state = State::running;
    for (int i = 0; i < static_cast<int>(seconds / 0.001); ++i) {
      state = actuator.next(sample);
      speed_m_per_s = (sample.tip_m.x() - x_m) / 0.001;
      x_m = sample.tip_m.x();
    }
    return state;
  }
  path::test::TiltHead machine;
  path::PathInterpolator path;
  PathActuator actuator;
  path::Sample sample;
  double x_m = 0.0, speed_m_per_s = 0.0;
};

TEST(PathActuator, FeedFollowsWhatIsCommanded) {
  Straight s;
  EXPECT_NEAR(s.speed_m_per_s, 0.05, 5e-4);
  EXPECT_TRUE(s.actuator.apply({.kind = Kind::feed, .feed_override = 0.5}));
  s.run(0.5);
  EXPECT_NEAR(s.speed_m_per_s, 0.025, 5e-4);
  EXPECT_TRUE(s.actuator.apply({.kind = Kind::none, .feed_override = 0.1}));  // says why nothing is done, no more
  s.run(0.2);
  EXPECT_NEAR(s.speed_m_per_s, 0.025, 5e-4);
  s.actuator.set_operator_override(0.6);
  s.actuator.set_operator_override(std::numeric_limits<double>::quiet_NaN());
  s.run(0.5);
  EXPECT_NEAR(s.speed_m_per_s, 0.015, 5e-4);
  EXPECT_TRUE(s.actuator.apply({.kind = Kind::release}));
  s.run(0.5);
  EXPECT_NEAR(s.speed_m_per_s, 0.03, 5e-4);
}

// Chips stay at or below the programmed thickness, speed/feed at or above: a feed that falls goes first, one that rises
// follows the spindle.
TEST(PathActuator, FeedPerToothStaysWithTheSpindle) {
  Straight s;
  EXPECT_TRUE(s.actuator.apply(
      {.kind = Kind::spindle_speed, .spindle_speed_rad_per_s = 560.0, .feed_override = 0.8, .feed_first = true}));
  s.run(0.5);
  EXPECT_NEAR(s.speed_m_per_s, 0.04, 5e-4);
  EXPECT_TRUE(s.actuator.apply({.kind = Kind::spindle_speed, .spindle_speed_rad_per_s = 700.0, .feed_override = 1.0}));
  s.run(0.5);
  EXPECT_NEAR(s.speed_m_per_s, 0.04, 5e-4);  // nothing is known of the spindle
  for (const double measured : {560.0, 630.0, 700.0, 720.0}) {
    s.actuator.set_spindle_speed(measured);
    s.run(0.5);
    EXPECT_NEAR(s.speed_m_per_s, 0.05 * std::min(1.0, measured / 700.0), 5e-4) << measured;
  }
}

TEST(PathActuator, HoldsOnlyWithARetract) {
  Straight bare;
  EXPECT_FALSE(bare.actuator.apply({.kind = Kind::hold, .retract_m = 2e-3}));
  EXPECT_EQ(bare.run(0.5), State::running);
  EXPECT_NEAR(bare.speed_m_per_s, 0.05, 5e-4);

  Retracts retract;
  Straight s(&retract);
  EXPECT_FALSE(s.actuator.apply({.kind = Kind::hold}));
  EXPECT_EQ(s.run(0.3), State::running);
  ASSERT_TRUE(s.actuator.apply({.kind = Kind::hold, .retract_m = 2e-3}));
  EXPECT_EQ(s.actuator.next(s.sample), State::running);
  EXPECT_EQ(retract.times, 0);  // not while it moves
  EXPECT_EQ(s.run(1.0), State::holding);
  EXPECT_EQ(retract.times, 1);
  EXPECT_EQ(retract.last_m, 2e-3);
  // Whoever does not know that the tool is out of the cut does not set it going.
  s.path.resume();
  ASSERT_TRUE(s.actuator.apply({.kind = Kind::release}));
  EXPECT_EQ(s.run(0.5), State::holding);
  EXPECT_EQ(retract.times, 1);
  s.actuator.resume();
  EXPECT_EQ(s.run(1.0), State::running);
  EXPECT_NEAR(s.speed_m_per_s, 0.05, 5e-4);
  ASSERT_TRUE(s.actuator.apply({.kind = Kind::hold, .retract_m = 1e-3}));
  EXPECT_EQ(s.run(1.0), State::holding);
  EXPECT_EQ(retract.times, 2);
}

TEST(PathActuator, AllocatesNothing) {
  Retracts retract;
  Straight s(&retract);
  const Command reduce{.kind = Kind::feed, .feed_override = 0.5};
  const Command hold{.kind = Kind::hold, .retract_m = 1e-3};
  const std::size_t taken = test::allocations([&] {
    s.actuator.apply(reduce);
    s.run(0.2);
    s.actuator.set_spindle_speed(700.0);
    s.actuator.apply(hold);
    s.run(0.5);
    s.actuator.resume();
    s.run(0.2);
  });
  EXPECT_EQ(taken, 0U);
}

// One thread decides, the other runs the path: in the end the last command holds.
TEST(PathActuator, TakesCommandsFromAnotherThread) {
  Retracts retract;
  Straight s(&retract);
  std::atomic<bool> done{false};
  std::thread monitor([&] {
    for (int i = 0; i < 20'000; ++i) {
      s.actuator.apply({.kind = Kind::feed, .feed_override = i % 2 == 0 ? 0.5 : 0.7});
      if (i % 1000 == 500) s.actuator.apply({.kind = Kind::hold, .retract_m = 1e-3});
      if (i % 1000 == 700) s.actuator.resume();
      s.actuator.set_spindle_speed(700.0 + i % 7);
    }
    s.actuator.apply({.kind = Kind::release});
    s.actuator.resume();
    done = true;
  });
  while (!done) s.actuator.next(s.sample);
  monitor.join();
  State state = State::running;
  for (int i = 0; i < 20'000 && state != State::finished; ++i) state = s.actuator.next(s.sample);
  EXPECT_EQ(state, State::finished);
  EXPECT_NEAR(s.sample.tip_m.x(), 0.5, 1e-12);
}

}  // namespace path_actuator_test
}  // namespace robomill::live
