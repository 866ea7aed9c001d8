#include "robomill/decision/finish.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/stability/surface_error.hpp"
#include "testing/stability/problems.hpp"
#include "testing/support.hpp"

namespace robomill::decision {
namespace finish_test {

using stability::testing::rpm;

stability::LobesProblem fed() {
  stability::LobesProblem problem = stability::testing::benchmark(0.1);
  problem.milling.feed_per_tooth_m = 0.1e-3;
  return problem;
}

stability::SurfacePoint surface(double speed, double depth_m) {
  return stability::surface_point(fed(), {speed, depth_m});
}

// What is promised: it holds at the depth found and at shallower ones, and not 3 % deeper.
TEST(FinishDepth, IsTheGreatestThatKeepsTheLimit) {
  for (const double speed_rpm : {7000.0, 8800.0}) {
    const double speed = speed_rpm * rpm;
    constexpr double deepest_m = 0.5e-3;
    const double most_m = std::abs(surface(speed, deepest_m).surface_location_error_m);
    ASSERT_TRUE(std::isfinite(most_m));
    const FinishLimits limits = {.max_surface_error_m = 0.4 * most_m};
    const FinishDepth found = finish_depth(fed(), speed, deepest_m, limits);
    EXPECT_EQ(found.reason, LimitedBy::surface_error);
    ASSERT_GT(found.axial_depth_m, 0.0);
    ASSERT_LT(found.axial_depth_m, deepest_m);
    for (const double part : {0.25, 0.5, 0.75, 1.0}) {
      EXPECT_LE(std::abs(surface(speed, part * found.axial_depth_m).surface_location_error_m),
                limits.max_surface_error_m);
    }
    EXPECT_GT(std::abs(surface(speed, 1.03 * found.axial_depth_m).surface_location_error_m),
              limits.max_surface_error_m);
  }
}

TEST(FinishDepth, ADeflectionIsALimitOfItsOwn) {
  const double speed = 8000.0 * rpm;
  const double deflection_m = surface(speed, 0.5e-3).peak_deflection_m;
  const FinishDepth found = finish_depth(fed(), speed, 0.5e-3, {.max_deflection_m = 0.5 * deflection_m});
  EXPECT_EQ(found.reason, LimitedBy::deflection);
  EXPECT_LE(surface(speed, found.axial_depth_m).peak_deflection_m, 0.5 * deflection_m);
  EXPECT_GT(surface(speed, 1.03 * found.axial_depth_m).peak_deflection_m, 0.5 * deflection_m);
}

TEST(FinishDepth, NothingLimitsARoughingCut) {
  EXPECT_TRUE(std::isinf(finish_depth(fed(), 8000.0 * rpm, 0.5e-3, {}).axial_depth_m));
  EXPECT_TRUE(std::isinf(finish_depth(fed(), 8000.0 * rpm, 0.5e-3, {.max_surface_error_m = 1.0}).axial_depth_m));
}

TEST(FinishDepth, RejectsWhatItCannotJudge) {
  const auto rejected = [](const stability::LobesProblem& problem, const FinishLimits& limits) {
    return test::field_of([&] { require_finishable(problem, limits); });
  };
  EXPECT_EQ(rejected(fed(), {.max_surface_error_m = 1e-5}), "accepted");
  EXPECT_EQ(rejected(fed(), {.max_surface_error_m = -1e-5}), "max_surface_error_m");
  EXPECT_EQ(rejected(fed(), {.max_deflection_m = NAN}), "max_deflection_m");
  stability::LobesProblem middle = fed();
  middle.milling.immersion = {.entry_rad = 0.5, .exit_rad = 2.5};
  EXPECT_EQ(rejected(middle, {.max_surface_error_m = 1e-5}), "max_surface_error_m");
  EXPECT_EQ(rejected(middle, {.max_deflection_m = 1e-5}), "accepted");
  stability::LobesProblem measured = fed();
  measured.measured.frfs.resize(1);
  EXPECT_EQ(rejected(measured, {.max_deflection_m = 1e-5}), "finishing");
}

}  // namespace finish_test
}  // namespace robomill::decision
