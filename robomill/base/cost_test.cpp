#include "robomill/base/cost.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "robomill/base/parallel.hpp"
#include "testing/support.hpp"

namespace robomill {
namespace cost_test {

/// Puts the process' limit back.
class CostTest : public testing::Test {
 protected:
  ~CostTest() override { set_cost_limit({}); }
};

std::string rejected(const Cost& cost) {
  return test::rejection([&] { require_affordable(cost); });
}

TEST_F(CostTest, IsRejectedAboveTheLimitWithEstimateLimitAndField) {
  const CostDriver grid = {.field = "grid", .value = 20000.0, .times_usual = 100.0};
  EXPECT_NO_THROW(require_affordable({.operations = 6e11, .bytes = 2e9, .dominant = grid}));
  EXPECT_EQ(rejected({.operations = 1.2e12, .bytes = 1e6, .dominant = grid}),
            "grid = 20000; would take about 20 min of one core, more than 10 min. Change this number");
  const std::string both = rejected({.operations = 3.6e14, .bytes = 3.3e9, .dominant = grid});
  EXPECT_NE(both.find("about 4 days of one core, more than 10 min and about 3.3 GB of memory, more than 2 GB"),
            std::string::npos)
      << both;
  EXPECT_NE(rejected({.operations = std::nan(""), .bytes = 0.0, .dominant = grid}), "");
  EXPECT_NE(rejected({.operations = std::numeric_limits<double>::infinity(), .bytes = 0.0, .dominant = grid}), "");
}

TEST_F(CostTest, FollowsTheLimitOfTheProcessAndSaysHowItIsExceeded) {
  const Cost cost = {.operations = 3e11, .bytes = 1e6, .dominant = {.field = "samples", .value = 2000.0}};
  EXPECT_NO_THROW(require_affordable(cost));
  set_cost_limit({.operations = 1.2e11, .way_out = "--allow-large takes it"});
  EXPECT_TRUE(rejected(cost).ends_with("Change this number; if it is meant, --allow-large takes it")) << rejected(cost);
  set_cost_limit(no_cost_limit);
  EXPECT_NO_THROW(require_affordable({.operations = 1e30, .bytes = 1e30, .dominant = {.field = "samples"}}));
}

TEST_F(CostTest, TimesAndSizesAreNoPowersOfTen) {
  set_cost_limit({.operations = 1.0, .bytes = 1.0});
  EXPECT_EQ(above_limit({.operations = 99.4e9}).find("about 99 s of"), 0U);
  EXPECT_EQ(above_limit({.operations = 99.6e9}).find("about 1.7 min of"), 0U);
  EXPECT_EQ(above_limit({.operations = 99.6 * 60e9}).find("about 1.7 h of"), 0U);
  EXPECT_EQ(above_limit({.operations = 99.6 * 3600e9}).find("about 4 days of"), 0U);
  EXPECT_EQ(above_limit({.bytes = 999.7e6}).find("about 1 GB of"), 0U);
  EXPECT_EQ(above_limit({.bytes = 999.7e9}).find("about 1 TB of"), 0U);
  EXPECT_EQ(above_limit({}), "");
}

TEST_F(CostTest, FewerThreadsWorkWhereAllWouldHoldTooMuch) {
  set_thread_count(64);
  EXPECT_EQ(require_affordable({.bytes = 1e6, .bytes_a_thread = 1e6}), 64);
  EXPECT_EQ(require_affordable({.bytes = 1e9, .bytes_a_thread = 3e8}), 3);
  EXPECT_EQ(require_affordable({.bytes_a_thread = 2e9}), 1);
  const std::string alone = rejected({.bytes_a_thread = 2.1e9, .dominant = {.field = "grid", .value = 9.0}});
  EXPECT_TRUE(alone.starts_with("grid = 9; would take about 2.1 GB of memory, more than 2 GB")) << alone;
  set_cost_limit(no_cost_limit);
  EXPECT_EQ(require_affordable({.bytes_a_thread = 2.1e9}), 64);
  set_thread_count(0);
}

TEST_F(CostTest, BlamesWhatIsFarthestFromUsual) {
  const CostDriver most =
      dominant_of({{.times_usual = 100.0},
                   {.field = "grid", .times_usual = 2.0},
                   {.field = "modes[1].frequency_hz", .value = 1e5, .unit = "Hz", .times_usual = 9.0},
                   {.field = "samples", .times_usual = 9.0}});
  EXPECT_EQ(most.field, "modes[1].frequency_hz");
  EXPECT_EQ(most.value, 1e5);
  EXPECT_EQ(most.unit, "Hz");
}

}  // namespace cost_test
}  // namespace robomill
