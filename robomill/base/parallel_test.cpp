#include "robomill/base/parallel.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
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

INSTANTIATE_TEST_SUITE_P(Threads, ParallelFor, testing::Values(1, 2, 8));

}  // namespace parallel_test
}  // namespace robomill
