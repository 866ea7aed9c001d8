// Cuts in three directions.
#include <gtest/gtest.h>

#include "testing/stability/problems.hpp"
#include "testing/stability/spatial_cases.hpp"

namespace robomill::stability {
namespace spatial_test {

using testing::rpm;
using testing::SpatialReference;


TEST(Spatial, HasTheRadiiOfAnIndependentSolver) {
  for (const SpatialReference& known : testing::spatial_references()) {
    const PointResult point = evaluate_point(known.problem, {}, {known.speed_rpm * rpm, 1e-3 * known.depth_mm});
    EXPECT_NEAR(point.spectral_radius, known.spectral_radius, 1e-6);
    EXPECT_LE(point.error_estimate, 1e-6);
  }
}

TEST(Spatial, HasTheLowestUnstableDepthsOfAnIndependentSolver) {
  for (const SpatialReference& known : testing::spatial_references()) {
    LobesOptions options;
    options.axial_depth_m = {0.0, 1.5e-3};
    options.grid = {2, 31};
    const Limit limit = limit_depths(known.problem, options, {known.limit_speed_rpm * rpm}).front();
    ASSERT_EQ(limit.status, Limit::Status::found);
    EXPECT_NEAR(1e3 * limit.axial_depth_m, known.limit_mm, 1e-5 * known.limit_mm);
    if (known.chatter_frequency_hz > 0.0) {
      EXPECT_NEAR(limit.chatter_frequency_hz, known.chatter_frequency_hz, 0.05);
    }
  }
}

}  // namespace spatial_test
}  // namespace robomill::stability
