#include "robomill/live/block_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <vector>

#include "robomill/base/random.hpp"
#include "testing/support.hpp"

namespace robomill::live {
namespace block_order_test {

monitor::StreamBlock block(std::uint64_t number) {
  monitor::StreamBlock out;
  out.sequence = number;
  out.sample_rate_hz = 1.0;
  out.channels = 1;
  out.samples = {static_cast<float>(number)};
  return out;
}

struct Outcome {
  std::vector<std::uint64_t> given;
  std::uint64_t lost = 0, restarts = 0;
  OrderCounts counts;
};

Outcome outcome_of(const std::vector<std::uint64_t>& numbers) {
  BlockOrder order;
  std::vector<BlockOrder::Given> out;
  for (const std::uint64_t number : numbers) order.take(block(number), out);
  order.give_up(out);
  Outcome result;
  for (const BlockOrder::Given& given : out) {
    result.given.push_back(given.block.sequence);
    result.lost += given.lost_before;
    result.restarts += given.restarted ? 1 : 0;
  }
  result.counts = order.counts();
  return result;
}

using Numbers = std::vector<std::uint64_t>;

TEST(BlockOrder, GivesWhatComesInOrderAtOnce) {
  BlockOrder order;
  std::vector<BlockOrder::Given> out;
  for (std::uint64_t i = 5; i < 10; ++i) {
    order.take(block(i), out);
    EXPECT_EQ(out.size(), i - 4);
  }
  EXPECT_EQ(order.counts().lost, 0U);
}

TEST(BlockOrder, NoticesEachTrouble) {
  const Outcome lost = outcome_of({0, 1, 4, 5, 6, 7, 8, 9, 10});
  EXPECT_EQ(lost.given, (Numbers{0, 1, 4, 5, 6, 7, 8, 9, 10}));
  EXPECT_EQ(lost.counts.lost, 2U);
  const Outcome doubled = outcome_of({0, 1, 1, 2, 0, 3});
  EXPECT_EQ(doubled.given, (Numbers{0, 1, 2, 3}));
  EXPECT_EQ(doubled.counts.doubled, 2U);
  EXPECT_EQ(doubled.counts.late, 0U);
  const Outcome reordered = outcome_of({0, 2, 3, 1, 4});
  EXPECT_EQ(reordered.given, (Numbers{0, 1, 2, 3, 4}));
  EXPECT_EQ(reordered.counts.reordered, 1U);
  EXPECT_EQ(reordered.counts.lost, 0U);
  const Outcome late = outcome_of({0, 2, 3, 4, 5, 6, 1, 7});
  EXPECT_EQ(late.given, (Numbers{0, 2, 3, 4, 5, 6, 7}));
  EXPECT_EQ(late.counts.lost, 1U);
  EXPECT_EQ(late.counts.late, 1U);
}

TEST(BlockOrder, FollowsASenderThatBeginsAnew) {
  Numbers numbers;
  for (std::uint64_t i = 1000; i < 1100; ++i) numbers.push_back(i);
  for (std::uint64_t i = 0; i < 50; ++i) numbers.push_back(i);
  const Outcome far_back = outcome_of(numbers);
  EXPECT_EQ(far_back.restarts, 1U);
  EXPECT_EQ(far_back.given.size(), 149U);  // the first of the new ones might have been a late one
  EXPECT_EQ(far_back.given.back(), 49U);
  const Outcome near = outcome_of([] {
    Numbers n;
    for (std::uint64_t i = 0; i < 40; ++i) n.push_back(i);
    for (std::uint64_t i = 0; i < 60; ++i) n.push_back(i);
    return n;
  }());
  EXPECT_EQ(near.given.back(), 59U);
  const Outcome ahead = outcome_of({1, 2, 10'000'000, 10'000'001});
  EXPECT_EQ(ahead.restarts, 1U);
  EXPECT_EQ(ahead.counts.lost, 0U);
  EXPECT_EQ(ahead.given, (Numbers{1, 2, 10'000'000, 10'000'001}));
}

// Blocks lost, sent twice and changed with their neighbours, at random: each that came is given once, in order, and the
// counts say exactly what was done.
TEST(BlockOrder, AccountsForEveryBlock) {
  for (int seed = 0; seed < test::seeds(2000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const std::uint64_t first = random.index(1U << 30U);
    Numbers sent;
    std::set<std::uint64_t> came;
    std::uint64_t copies = 0;
    const std::uint64_t count = 50 + random.index(200);
    for (std::uint64_t i = 0; i < count; ++i) {
      const bool edge = i == 0 || i + 5 >= count;  // what is lost before the first or after the last is not seen
      if (!edge && random.uniform() < 0.1) continue;
      sent.push_back(first + i);
      came.insert(first + i);
      if (!edge && random.uniform() < 0.1) {
        sent.push_back(first + i);
        ++copies;
      }
    }
    for (std::size_t i = 1; i + 6 < sent.size(); ++i) {
      if (random.uniform() < 0.2) {
        std::swap(sent[i], sent[i + 1]);
        ++i;
      }
    }
    const Outcome result = outcome_of(sent);
    ASSERT_EQ(result.given, Numbers(came.begin(), came.end())) << seed;
    EXPECT_EQ(result.counts.lost, count - came.size()) << seed;
    EXPECT_EQ(result.lost, result.counts.lost) << seed;
    EXPECT_EQ(result.counts.doubled, copies) << seed;
    EXPECT_EQ(result.counts.late, 0U) << seed;
    EXPECT_EQ(result.counts.restarts, 0U) << seed;
  }
}

// Any numbers: between restarts what is given rises, and nothing is held back in the end.
TEST(BlockOrder, LivesThroughAnyNumbers) {
  for (int seed = 0; seed < test::seeds(2000); ++seed) {
    Random random(static_cast<std::uint64_t>(seed), 1);
    BlockOrder order;
    std::vector<BlockOrder::Given> out;
    const std::uint64_t taken = 300;
    for (std::uint64_t i = 0; i < taken; ++i) {
      const double kind = random.uniform();
      const std::uint64_t number = kind < 0.05  ? random.index(std::numeric_limits<std::uint64_t>::max())
                                   : kind < 0.1 ? std::numeric_limits<std::uint64_t>::max() - random.index(3)
                                                : random.index(500);
      order.take(block(number), out);
    }
    order.give_up(out);
    const OrderCounts& counts = order.counts();
    EXPECT_EQ(out.size() + counts.doubled + counts.late, taken) << seed;
    for (std::size_t i = 1; i < out.size(); ++i) {
      if (out[i].restarted || out[i - 1].block.sequence == std::numeric_limits<std::uint64_t>::max()) continue;
      ASSERT_EQ(out[i].block.sequence, out[i - 1].block.sequence + 1 + out[i].lost_before) << seed;
    }
  }
}

}  // namespace block_order_test
}  // namespace robomill::live
