#include "robomill/base/parallel.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>
#include <vector>

namespace robomill {
namespace parallel_test {

class ParallelFor : public ::testing::TestWithParam<int> {
 protected:
  void SetUp() override { set_thread_count(GetParam()); }
  void TearDown() override { set_thread_count(0); }
};

TEST_P(ParallelFor, CoversEveryItemOnce) {
  for (const std::size_t n : {0U, 1U, 2U, 7U, 64U, 1000U}) {
    for (const std::size_t grain : {0U, 1U, 3U, 64U, 5000U}) {
      std::vector<int> visits(n, 0);
      parallel_for(n, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      EXPECT_EQ(visits, std::vector<int>(n, 1));
    }
  }
}

TEST_P(ParallelFor, PassesOnAnException) {
  const auto body = [](std::size_t begin, std::size_t) {
    if (begin == 17) throw std::runtime_error("seventeen");
  };
  EXPECT_THROW(parallel_for(100, 1, body), std::runtime_error);
}

TEST(ThreadLimit, HoldsForItsLifeAndNotForMore) {
  set_thread_count(8);
  {
    const ThreadLimit three(3);
    EXPECT_EQ(thread_count(), 3);
    {
      const ThreadLimit five(5);
      EXPECT_EQ(thread_count(), 3);
      const ThreadLimit none(0);
      EXPECT_EQ(thread_count(), 1);
    }
    EXPECT_EQ(thread_count(), 3);
    int others = 0;
    std::thread([&] { others = thread_count(); }).join();
    EXPECT_EQ(others, 8);
  }
  EXPECT_EQ(thread_count(), 8);
  set_thread_count(0);
}

INSTANTIATE_TEST_SUITE_P(Threads, ParallelFor, testing::Values(1, 2, 8));

}  // namespace parallel_test
}  // namespace robomill
