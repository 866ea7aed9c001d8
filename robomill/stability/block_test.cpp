// All that is asked of one block, in one call.
#include "robomill/stability/block.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "testing/stability/blocks.hpp"
#include "testing/stability/problems.hpp"
#include "testing/support.hpp"

namespace robomill::stability {
namespace block_test {

using test::seeds;
using testing::rpm;
using testing::SpatialReference;

TEST(BlockStability, IsTheLimitMarginAndRadiusOfTheReferenceCuts) {
  for (const SpatialReference& known : testing::spatial_references()) {
    const OperatingPoint point = {known.limit_speed_rpm * rpm, 1e-3 * known.depth_mm};
    const BlockStability block = block_stability(known.problem, point.spindle_speed_rad_per_s, point.axial_depth_m);
    const GainMargin margin = gain_margin(known.problem, point);
    const PointResult at = evaluate_point(known.problem, {}, point);
    ASSERT_EQ(block.limit.status, Limit::Status::found);
    EXPECT_NEAR(1e3 * block.limit.axial_depth_m, known.limit_mm, 3e-4 * known.limit_mm);
    EXPECT_NEAR(block.gain.gain, margin.gain, 1e-3 * margin.gain);
    EXPECT_NEAR(block.at.spectral_radius, at.spectral_radius, 2e-4 * at.spectral_radius);
    EXPECT_EQ(block.at.gain_margin, block.gain.gain);
    EXPECT_EQ(block.at.stable, at.stable);
    EXPECT_EQ(block.regime, Regime::regenerative);
    const BlockStability alone =
        block_stability(known.problem, point.spindle_speed_rad_per_s, point.axial_depth_m, {.margin = false});
    EXPECT_NEAR(alone.limit.axial_depth_m, block.limit.axial_depth_m, 2e-4 * block.limit.axial_depth_m);
    EXPECT_LT(alone.evaluations, block.evaluations);
    EXPECT_TRUE(std::isnan(alone.at.gain_margin));
    // Nothing is known of deviations.
    EXPECT_EQ(block.limit_5_percent_m, block.limit.axial_depth_m);
    EXPECT_EQ(block.limit_95_percent_m, block.limit.axial_depth_m);
    if (known.chatter_frequency_hz > 0.0) {
      EXPECT_NEAR(block.limit.chatter_frequency_hz, known.chatter_frequency_hz, 0.2);
    }
  }
}

// The search by few depths against the chart's, which looks at 200 of them: cuts of a robot's kind.
TEST(BlockStability, FindsTheLowestLimitThatAChartFinds) {
  int found = 0;
  int missed = 0;
  for (int seed = 0; seed < seeds(300); ++seed) {
    Random random(731, static_cast<std::uint64_t>(seed));
    const testing::BlockCase block = testing::block_case(random, 8);
    LobesOptions options;
    options.axial_depth_m = {block.depth_m / 16.0, 8.0 * block.depth_m};
    options.grid = {2, 200};
    options.tolerance = 1e-5;
    const Limit chart = limit_depths(block.problem, options, {block.spindle_speed_rad_per_s}).front();
    const BlockStability quick = block_stability(block.problem, block.spindle_speed_rad_per_s, block.depth_m);
    if (quick.limit.status == Limit::Status::found) {
      ++found;
      const double radius =
          evaluate_point(block.problem, {}, {block.spindle_speed_rad_per_s, quick.limit.axial_depth_m}).spectral_radius;
      const bool at_start = quick.limit.axial_depth_m <= options.axial_depth_m[0] * (1.0 + 1e-12);
      EXPECT_TRUE(at_start ? radius >= 1.0 : std::abs(radius - 1.0) < 3e-4) << seed << " " << radius;
    }
    const double expected_m =
        chart.status == Limit::Status::found ? chart.axial_depth_m : std::numeric_limits<double>::infinity();
    const double found_m = quick.limit.status == Limit::Status::found ? quick.limit.axial_depth_m
                                                                      : std::numeric_limits<double>::infinity();
    missed += found_m > expected_m * 1.01 ? 1 : 0;
  }
  EXPECT_GT(found, seeds(300) / 4);
  EXPECT_LE(missed, 1 + seeds(300) / 100);
}

// A flat end without helix: limit and margin are one thing, in the plane and in three directions.
TEST(BlockStability, OfThePlaneIsItsLimit) {
  LobesOptions options;
  options.axial_depth_m = {0.0, 4e-3};
  options.grid = {2, 81};
  for (const double speed_rpm : {5000.0, 9000.0, 14000.0}) {
    const Limit limit = limit_depths(testing::benchmark(0.3), options, {speed_rpm * rpm}).front();
    const BlockStability block = block_stability(testing::benchmark(0.3), speed_rpm * rpm, 0.7 * limit.axial_depth_m);
    EXPECT_NEAR(block.limit.axial_depth_m, limit.axial_depth_m, 3e-4 * limit.axial_depth_m);
    EXPECT_NEAR(block.gain.gain, 1.0 / 0.7, 1e-3);
    EXPECT_EQ(block.limit.kind, limit.kind);
    EXPECT_EQ(block.limit.mode, limit.mode);
  }
}

TEST(BlockStability, SaysWhereThereIsNoLimit) {
  LobesProblem stiff = testing::spatial_references()[0].problem;
  for (modal::Mode& mode : stiff.dynamics.modes) mode.right *= 1e-6;
  const BlockStability block = block_stability(stiff, 12000 * rpm, 0.3e-3);
  EXPECT_EQ(block.limit.status, Limit::Status::stable_in_range);
  EXPECT_EQ(block.gain.status, GainMargin::Status::unconditionally_stable);
  EXPECT_EQ(block.regime, Regime::stable);
  EXPECT_EQ(block.limit_5_percent_m, std::numeric_limits<double>::infinity());
  EXPECT_EQ(block.at.gain_margin, std::numeric_limits<double>::infinity());
  LobesProblem soft = testing::spatial_references()[0].problem;
  for (modal::Mode& mode : soft.dynamics.modes) mode.right *= 1e3;
  const BlockStability worst = block_stability(soft, 12000 * rpm, 0.3e-3);
  EXPECT_EQ(worst.gain.status, GainMargin::Status::below_range);
  ASSERT_EQ(worst.limit.status, Limit::Status::found);
  EXPECT_NEAR(worst.limit.axial_depth_m, 0.3e-3 / 16.0, 1e-9);
}

TEST(BlockStability, RejectsBadOptions) {
  const LobesProblem problem = testing::spatial_references()[0].problem;
  const auto field = [&](const BlockOptions& options, double speed, double depth_m) -> std::string {
    try {
      static_cast<void>(block_stability(problem, speed, depth_m, options));
    } catch (const InvalidInput& error) {
      return error.parts().field;
    }
    return "accepted";
  };
  EXPECT_EQ(field({.tolerance = 0.0}, 1000.0, 1e-3), "tolerance");
  EXPECT_EQ(field({.axial_depth_m = {2e-3, 1e-3}}, 1000.0, 1e-3), "axial_depth_m");
  EXPECT_EQ(field({.most_gain = 1.0}, 1000.0, 1e-3), "most_gain");
  EXPECT_EQ(field({}, 0.0, 1e-3), "spindle_speed_rad_per_s");
  EXPECT_EQ(field({}, 1000.0, 0.0), "axial_depth_m");
}

}  // namespace block_test
}  // namespace robomill::stability
