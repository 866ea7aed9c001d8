#include "robomill/base/cost.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "robomill/base/error.hpp"

namespace robomill {
namespace cost_test {

/// Puts the process' limit back.
class CostTest : public testing::Test {
 protected:
  ~CostTest() override { set_cost_limit({}); }
};

std::string message_of(const Cost& cost) {
  try {
    require_affordable(cost);
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

TEST_F(CostTest, IsRejectedAboveTheLimitWithEstimateLimitAndField) {
  const CostDriver grid = {.field = "grid", .value = 20000.0, .times_usual = 100.0};
  EXPECT_EQ(message_of({.operations = 6e11, .bytes = 2e9, .dominant = grid}), "");
  EXPECT_EQ(message_of({.operations = 1.2e12, .bytes = 1e6, .dominant = grid}),
            "grid = 20000; would take about 20 min of one core, more than 10 min. Change this number; if it is meant, "
            "--allow-large of the command line takes it");
  const std::string both = message_of({.operations = 3.6e14, .bytes = 3.3e9, .dominant = grid});
  EXPECT_NE(both.find("about 4 days of one core, more than 10 min and about 3.3 GB of memory, more than 2 GB"),
            std::string::npos)
      << both;
  EXPECT_NE(message_of({.operations = std::nan(""), .bytes = 0.0, .dominant = grid}), "");
  EXPECT_NE(message_of({.operations = std::numeric_limits<double>::infinity(), .bytes = 0.0, .dominant = grid}), "");
}

TEST_F(CostTest, FollowsTheLimitOfTheProcess) {
  const Cost cost = {.operations = 3e11, .bytes = 1e6, .dominant = {.field = "samples", .value = 2000.0}};
  EXPECT_EQ(message_of(cost), "");
  set_cost_limit({.operations = 1.2e11});
  EXPECT_NE(message_of(cost), "");
  set_cost_limit(no_cost_limit);
  EXPECT_EQ(message_of({.operations = 1e30, .bytes = 1e30, .dominant = {.field = "samples"}}), "");
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
