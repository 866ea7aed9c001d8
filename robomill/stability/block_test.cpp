// All that is asked of one block, in one call.
#include "robomill/stability/block.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robomill/base/error.hpp"
#include "testing/stability/problems.hpp"
#include "testing/stability/spatial_cases.hpp"

namespace robomill::stability {
namespace block_test {

using testing::rpm;
using testing::SpatialReference;

TEST(BlockStability, IsTheLimitMarginAndRadiusOfTheReferenceCuts) {
  for (const SpatialReference& known : testing::spatial_references()) {
    const double depth_m = 1e-3 * known.depth_mm;
    const BlockStability block = block_stability(known.problem, known.limit_speed_rpm * rpm, depth_m);
    const GainMargin margin = gain_margin(known.problem, {known.limit_speed_rpm * rpm, depth_m});
    EXPECT_NEAR(1e3 * block.limit.axial_depth_m, known.limit_mm, 1e-3 * known.limit_mm);
    EXPECT_NEAR(block.gain.gain, margin.gain, 1e-3 * margin.gain);
  }
}

}  // namespace block_test
}  // namespace robomill::stability
