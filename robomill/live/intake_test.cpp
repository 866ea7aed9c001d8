#include "robomill/live/intake.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numeric>
#include <thread>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"

namespace robomill::live {
namespace intake_test {

using std::chrono::milliseconds;
constexpr milliseconds no_wait{0};

std::vector<float> ramp(std::size_t from, std::size_t count) {
  std::vector<float> out(count);
  std::iota(out.begin(), out.end(), static_cast<float>(from));
  return out;
}

TEST(Intake, CutsBlocksOfAnySizeIntoHops) {
  HopQueue queue(1000);
  Intake intake(queue, 2, 8, false, [](std::uint64_t) { FAIL(); });
  Random random(1);
  std::size_t sent = 0;
  while (sent < 1600) {
    const std::size_t frames = std::min<std::size_t>(random.index(30), (1600 - sent) / 2);
    EXPECT_TRUE(intake.add(ramp(sent, 2 * frames)));
    sent += 2 * frames;
  }
  Hop hop;
  std::size_t at = 0;
  while (queue.pop(hop, no_wait) == HopQueue::Taken::hop) {
    ASSERT_EQ(hop.samples, ramp(at, 16));
    EXPECT_EQ(hop.frames_before, 0U);
    at += 16;
  }
  EXPECT_EQ(at, 1600U);
}

// Samples that come faster than they are processed: whole hops are left out, each is counted, and the next one says how
// many frames are missing.
TEST(Intake, LeavesWholeHopsOutAndSaysSo) {
  HopQueue queue(3);
  std::uint64_t dropped = 0;
  Intake intake(queue, 1, 10, false, [&](std::uint64_t hops) { dropped += hops; });
  intake.add(ramp(0, 50));  // five hops for three places
  EXPECT_EQ(dropped, 2U);
  Hop hop;
  for (std::size_t i = 0; i < 3; ++i) {
    ASSERT_EQ(queue.pop(hop, no_wait), HopQueue::Taken::hop);
    EXPECT_EQ(hop.samples, ramp(10 * i, 10));
  }
  intake.add(ramp(50, 10));
  ASSERT_EQ(queue.pop(hop, no_wait), HopQueue::Taken::hop);
  EXPECT_EQ(hop.samples, ramp(50, 10));
  EXPECT_EQ(hop.frames_before, 20U);
  EXPECT_TRUE(hop.dropped);
  intake.add(ramp(60, 10));
  ASSERT_EQ(queue.pop(hop, no_wait), HopQueue::Taken::hop);
  EXPECT_EQ(hop.frames_before, 0U);
  EXPECT_FALSE(hop.dropped);
}

TEST(HopQueue, SaysForHowLongNothingWasTaken) {
  HopQueue queue(3);
  const auto now = std::chrono::steady_clock::now;
  constexpr milliseconds later{5000};
  EXPECT_EQ(queue.stalled_s(now() + later), 0.0);  // there is nothing to do
  Hop hop{.samples = ramp(0, 1)};
  auto before = now();
  ASSERT_TRUE(queue.offer(hop));
  EXPECT_GE(queue.stalled_s(now() + later), 5.0);
  EXPECT_LE(queue.stalled_s(before + later), 5.0);
  before = now();
  ASSERT_EQ(queue.pop(hop, no_wait), HopQueue::Taken::hop);
  EXPECT_GE(queue.stalled_s(now() + later), 5.0);  // at work on it
  EXPECT_LE(queue.stalled_s(before + later), 5.0);
  ASSERT_EQ(queue.pop(hop, no_wait), HopQueue::Taken::nothing);
  EXPECT_EQ(queue.stalled_s(now() + later), 0.0);
}

// A fast thread against a slow one: every frame is received or reported as missing.
TEST(Intake, AccountsForEveryFrameBetweenThreads) {
  HopQueue queue(4);
  std::uint64_t dropped = 0;
  constexpr std::size_t hops = 5000, frames = 16;
  std::jthread writer([&] {
    Intake intake(queue, 1, frames, false, [&](std::uint64_t count) { dropped += count; });
    for (std::size_t i = 0; i < hops; ++i) intake.add(ramp(0, frames));
    queue.close();
  });
  std::uint64_t received = 0, missing = 0;
  Hop hop;
  while (queue.pop(hop, milliseconds(1000)) == HopQueue::Taken::hop) {
    received += hop.samples.size();
    missing += hop.frames_before;
  }
  writer.join();
  const std::uint64_t tail = dropped * frames - missing;  // dropped after the last that was received
  EXPECT_EQ(received + missing + tail, hops * frames);
  EXPECT_EQ(missing % frames, 0U);
}

TEST(Intake, ASourceThatCanWaitLosesNothing) {
  HopQueue queue(2);
  std::jthread writer([&] {
    Intake intake(queue, 1, 4, true, [](std::uint64_t) { FAIL(); });
    EXPECT_TRUE(intake.add(ramp(0, 402)));
    EXPECT_TRUE(intake.finish());
    queue.close();
  });
  std::vector<float> received;
  Hop hop;
  while (queue.pop(hop, milliseconds(10'000)) == HopQueue::Taken::hop) {
    received.insert(received.end(), hop.samples.begin(), hop.samples.end());
  }
  EXPECT_EQ(received, ramp(0, 402));
}

TEST(Intake, ClosingLetsAWaitingSourceGo) {
  HopQueue queue(1);
  bool open = true;
  {
    std::jthread writer([&] { open = Intake(queue, 1, 4, true, {}).add(ramp(0, 400)); });
    Hop hop;
    ASSERT_EQ(queue.pop(hop, milliseconds(10'000)), HopQueue::Taken::hop);
    queue.close();
  }
  EXPECT_FALSE(open);
}

TEST(Intake, FillsShortGapsAndLeavesLongOnesOut) {
  HopQueue queue(100);
  Intake intake(queue, 2, 4, false, {});
  intake.add(ramp(0, 6));  // three frames of four
  intake.gap(2, 10);
  intake.add(ramp(6, 6));
  Hop hop;
  ASSERT_EQ(queue.pop(hop, no_wait), HopQueue::Taken::hop);
  EXPECT_EQ(hop.samples[5], 5.0F);
  EXPECT_TRUE(std::isnan(hop.samples[6]) && std::isnan(hop.samples[7]));
  ASSERT_EQ(queue.pop(hop, no_wait), HopQueue::Taken::hop);
  EXPECT_TRUE(std::isnan(hop.samples[0]) && std::isnan(hop.samples[1]));
  EXPECT_EQ(hop.samples[2], 6.0F);
  intake.add(ramp(0, 2));
  intake.gap(1000, 10);
  intake.add(ramp(0, 8));
  ASSERT_EQ(queue.pop(hop, no_wait), HopQueue::Taken::hop);
  EXPECT_EQ(hop.frames_before, 1001U);  // with the frame that was waiting
  intake.add(ramp(0, 2));
  intake.restart();
  intake.add(ramp(0, 8));
  ASSERT_EQ(queue.pop(hop, no_wait), HopQueue::Taken::hop);
  EXPECT_TRUE(hop.restarted);
  EXPECT_EQ(hop.frames_before, 1U);
}

}  // namespace intake_test
}  // namespace robomill::live
