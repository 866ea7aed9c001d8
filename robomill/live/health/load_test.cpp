#include "robomill/live/health/load.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <thread>

#include "robomill/live/health/watchdog.hpp"

namespace robomill::live {
namespace load_test {

using std::chrono::milliseconds;

/// Hops of 25 ms that come by the clock, and of which each takes so long, one after the other.
class Line {
 public:
  explicit Line(bool by_clock = true) : load_(by_clock, 0.3) {}
  void stalled() { load_.stalled(); }
  /// @param ahead_ms  that the hop was there before its time, and that the next one is
  void hop(double takes_ms, bool dropped = false, double ahead_ms = 0.0, double next_ahead_ms = 0.0) {
    const double came_ms = 25.0 * static_cast<double>(hops_) - ahead_ms;
    clock_ms_ = std::max(clock_ms_, came_ms);
    const bool drained = clock_ms_ < 25.0 * static_cast<double>(hops_ + 1) - next_ahead_ms;
    load_.take({.samples = {}, .dropped = dropped, .arrived = at(came_ms)}, 25e-3 * static_cast<double>(hops_), drained,
               at(clock_ms_));
    clock_ms_ += takes_ms;
    ++hops_;
  }
  [[nodiscard]] const Load& load() const { return load_; }

 private:
  static Load::Clock::time_point at(double ms) {
    return Load::Clock::time_point(std::chrono::hours(1)) + std::chrono::microseconds(static_cast<long>(1e3 * ms));
  }
  Load load_;
  std::size_t hops_ = 0;
  double clock_ms_ = 0.0;
};

TEST(Load, IsOverloadedWhereDecisionsAreASecondLate) {
  Line line;
  for (int i = 0; i < 100; ++i) line.hop(20.0);
  EXPECT_FALSE(line.load().overloaded());
  EXPECT_LT(line.load().behind_s(), 0.1);
  for (int i = 0; i < 39; ++i) line.hop(50.0);
  EXPECT_FALSE(line.load().overloaded());
  for (int i = 0; i < 3; ++i) line.hop(50.0);
  EXPECT_TRUE(line.load().overloaded());
  EXPECT_NEAR(line.load().behind_s(), 1.0, 0.1);
  // Less than a second late is not caught up.
  for (int i = 0; i < 20; ++i) line.hop(1.0);
  EXPECT_TRUE(line.load().overloaded());
  for (int i = 0; i < 30; ++i) line.hop(1.0);
  EXPECT_FALSE(line.load().overloaded());
}

// A decision that takes three seconds makes those after it late, and a short one none.
TEST(Load, CatchesUp) {
  Line line;
  line.hop(3000.0);
  line.hop(1.0);
  EXPECT_TRUE(line.load().overloaded());
  EXPECT_NEAR(line.load().behind_s(), 2.975, 0.01);
  int hops = 0;
  for (; line.load().overloaded() && hops < 1000; ++hops) line.hop(1.0);
  EXPECT_NEAR(hops, (3000 - 100) / 24, 3);
  line.hop(500.0);
  for (int i = 0; i < 50; ++i) {
    line.hop(1.0);
    EXPECT_FALSE(line.load().overloaded());
  }
}

// Two seconds at once, then nothing for two: late are they, but not the decisions. Nor are those on a recording.
TEST(Load, SamplesThatComeInBurstsAreNoOverload) {
  Line line;
  for (int burst = 0; burst < 3; ++burst) {
    for (int i = 0; i < 80; ++i) {
      line.hop(0.3, false, 25.0 * i, i == 79 ? 0.0 : 25.0 * (i + 1));
      EXPECT_FALSE(line.load().overloaded());
    }
  }
  Line recording(false);
  for (int i = 0; i < 100; ++i) recording.hop(500.0);
  EXPECT_FALSE(recording.load().overloaded());
}

// Until the longest window holds no hole.
TEST(Load, HopsThatWereLeftOutAreAnOverload) {
  for (const bool by_clock : {true, false}) {
    Line line(by_clock);
    for (int i = 0; i < 10; ++i) line.hop(1.0);
    line.hop(1.0, true);
    for (int i = 0; i < 11; ++i) {
      EXPECT_TRUE(line.load().overloaded()) << i;
      line.hop(1.0);
    }
    line.hop(1.0);
    line.hop(1.0);
    EXPECT_FALSE(line.load().overloaded());
  }
}

// A fast pipe keeps the queue full to its end. While all was stopped its samples were not late.
TEST(Load, EndsWhereTheQueueNeverEmpties) {
  const auto at = [](double seconds) {
    return Load::Clock::time_point(std::chrono::hours(1)) + std::chrono::microseconds(std::lround(1e6 * seconds));
  };
  Load load(true, 0.3);
  double now_s = 0.0, stream_s = 0.0;
  const auto take = [&] {
    const double arrived_s = now_s;
    now_s += 1e-3;
    stream_s += 25e-3;
    load.take({.samples = {}, .arrived = at(arrived_s)}, stream_s, false, at(now_s));
  };
  for (int i = 0; i < 100; ++i) take();
  EXPECT_FALSE(load.overloaded());
  now_s += 1000.0;
  load.stalled();
  EXPECT_TRUE(load.overloaded());
  take();
  EXPECT_FALSE(load.overloaded());
  EXPECT_LT(load.behind_s(), 0.1);
}

// Of samples that came by the clock meanwhile: a stall takes nothing from what is late.
TEST(Load, AStallMakesLiveSamplesLate) {
  Line line;
  for (int i = 0; i < 10; ++i) line.hop(1.0);
  line.hop(3000.0);
  line.stalled();
  line.hop(1.0);
  EXPECT_TRUE(line.load().overloaded());
  EXPECT_NEAR(line.load().behind_s(), 2.975, 0.01);
}

TEST(Watchdog, SaysThatNothingIsTaken) {
  HopQueue queue(3);
  std::atomic<int> begun{0}, looked{0};
  std::atomic<int> ahead_s{10};
  std::atomic<double> stalled_s{0.0};
  const Watchdog watchdog(
      queue,
      [&](double more_s, bool begins) {
        stalled_s = (begins ? 0.0 : stalled_s.load()) + more_s;
        if (begins) ++begun;
      },
      [&] {
        ++looked;
        return Watchdog::Clock::now() + std::chrono::seconds(ahead_s);
      });
  const auto wait_for = [](auto&& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (!condition() && std::chrono::steady_clock::now() < end) std::this_thread::sleep_for(milliseconds(5));
    return condition();
  };
  const auto look_twice = [&] {
    const int before = looked;
    return wait_for([&] { return looked >= before + 2; });
  };
  ASSERT_TRUE(look_twice());
  EXPECT_EQ(begun, 0);  // there is nothing to take
  Hop hop{.samples = {1.0F}};
  ASSERT_TRUE(queue.offer(hop));
  ASSERT_TRUE(wait_for([&] { return stalled_s >= 10.0; }));
  ahead_s = 20;
  ASSERT_TRUE(wait_for([&] { return stalled_s >= 20.0; }));
  EXPECT_EQ(begun, 1);
  ASSERT_EQ(queue.pop(hop, milliseconds(0)), HopQueue::Taken::hop);
  ahead_s = -3600;  // it was taken just now, and is worked on
  ASSERT_TRUE(look_twice());
  ahead_s = 10;
  ASSERT_TRUE(wait_for([&] { return begun == 2; }));
}

}  // namespace load_test
}  // namespace robomill::live
