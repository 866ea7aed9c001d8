// Cuts whose engagement is handed in.
#include <gtest/gtest.h>

#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/cutting/program_engagement.hpp"
#include "robomill/stability/collocation/given_engagement.hpp"
#include "robomill/stability/sweep.hpp"
#include "testing/stability/problems.hpp"
#include "testing/stability/spatial_cases.hpp"

namespace robomill::stability {
namespace given_engagement_test {

using testing::rpm;
using testing::SpatialReference;

LobesProblem given(const LobesProblem& problem, int rings) {
  LobesProblem out = problem;
  out.spatial->engagement = cutting::engage(problem.spatial->cutter, problem.spatial->cut, {.slices = rings});
  return out;
}

TEST(GivenEngagement, HasTheRadiiOfTheCutThatItIsOf) {
  for (const SpatialReference& known : testing::spatial_references()) {
    const LobesProblem problem = given(known.problem, 60);
    const double height_m = engaged_height_m(*problem.spatial->engagement);
    const PointResult point = evaluate_point(problem, {}, {known.speed_rpm * rpm, height_m});
    EXPECT_NEAR(point.spectral_radius, known.spectral_radius, 1e-3 * known.spectral_radius);
  }
}

}  // namespace given_engagement_test
}  // namespace robomill::stability
