#include "robomill/base/progress.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "robomill/base/parallel.hpp"

namespace robomill {
namespace progress_test {

TEST(Progress, ReportsFromStartToEnd) {
  std::vector<double> fractions;
  Progress progress(
      [&](const std::string& task, double f) {
        EXPECT_EQ(task, "lobes");
        fractions.push_back(f);
      },
      nullptr);
  progress.start("lobes", 4);
  for (int i = 0; i < 4; ++i) progress.advance();
  EXPECT_EQ(fractions, (std::vector<double>{0.0, 0.25, 0.5, 0.75, 1.0}));
}

TEST(Progress, StopsParallelWork) {
  std::atomic<bool> stop{false};
  Progress progress({}, &stop);
  std::atomic<int> ran{0};
  const auto body = [&](std::size_t, std::size_t) {
    progress.advance();
    if (++ran == 10) stop = true;
  };
  EXPECT_THROW(parallel_for(100000, 1, body), Interrupted);
  EXPECT_LT(ran, 100000);
}

TEST(Progress, LastStepIsReportedFromAnyThread) {
  double last = 0.0;
  Progress progress([&](const std::string&, double f) { last = std::max(last, f); }, nullptr);
  progress.start("points", 1000);
  parallel_for(1000, 1, [&](std::size_t, std::size_t) { progress.advance(); });
  EXPECT_EQ(last, 1.0);
}

}  // namespace progress_test
}  // namespace robomill
