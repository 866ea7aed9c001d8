#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/stability/lobes.hpp"
#include "testing/stability/problems.hpp"
#include "testing/stability/spatial_cases.hpp"
#include "testing/support.hpp"

namespace robomill::stability {
namespace columns_test {

using testing::benchmark;
using testing::robot;
using testing::rpm;

LobesOptions chart(double from_rpm, double to_rpm, double depth_m, int speeds, int depths) {
  LobesOptions options = testing::chart(from_rpm, to_rpm, depth_m, speeds, depths);
  options.method = Method::collocation;
  return options;
}

std::vector<double> speeds_rad_per_s(double from_rpm, double to_rpm, int count) {
  std::vector<double> speeds;
  for (int i = 0; i < count; ++i) speeds.push_back((from_rpm + (to_rpm - from_rpm) * i / (count - 1)) * rpm);
  return speeds;
}

/// Pictured limits against those at 1e-6 of the same depths, as a share of a step.
void expect_within_a_step(const LobesProblem& problem, LobesOptions options, const std::vector<double>& speeds,
                          double steps) {
  const std::vector<Limit> exact = limit_depths(problem, options, speeds);
  options.tolerance = 1e-4;
  options.limit_step_m = (options.axial_depth_m[1] - options.axial_depth_m[0]) / 256;
  const std::vector<Limit> drawn = limit_depths(problem, options, speeds);
  ASSERT_EQ(drawn.size(), exact.size());
  for (std::size_t i = 0; i < exact.size(); ++i) {
    ASSERT_EQ(drawn[i].status, exact[i].status) << speeds[i] / rpm;
    EXPECT_NEAR(drawn[i].axial_depth_m, exact[i].axial_depth_m, steps * options.limit_step_m) << speeds[i] / rpm;
    EXPECT_EQ(drawn[i].spindle_speed_rad_per_s, exact[i].spindle_speed_rad_per_s);
  }
}

TEST(PicturedLimits, LieWithinAStepOfTheExactOnes) {
  expect_within_a_step(benchmark(0.05), chart(5000, 25000, 0.01, 2, 97), speeds_rad_per_s(5000, 25000, 60), 0.3);
  expect_within_a_step(robot(), chart(4000, 16000, 3e-3, 2, 97), speeds_rad_per_s(4000, 16000, 60), 0.3);
  const testing::SpatialReference ball = testing::spatial_references().front();
  expect_within_a_step(ball.problem, chart(8000, 24000, 1.5e-3, 2, 33), speeds_rad_per_s(8000, 24000, 20), 0.3);
}

TEST(PicturedLimits, HaveModeFrequencyAndKind) {
  LobesOptions options = chart(4000, 16000, 3e-3, 2, 49);
  const std::vector<double> speeds = {6500 * rpm, 12000 * rpm};
  const std::vector<Limit> exact = limit_depths(robot(), options, speeds);
  options.limit_step_m = 3e-3 / 400;
  const std::vector<Limit> drawn = limit_depths(robot(), options, speeds);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_EQ(drawn[i].mode, exact[i].mode);
    EXPECT_EQ(drawn[i].kind, exact[i].kind);
    EXPECT_NEAR(drawn[i].chatter_frequency_hz, exact[i].chatter_frequency_hz, 1e-3 * exact[i].chatter_frequency_hz);
    EXPECT_TRUE(std::isnan(drawn[i].error_estimate));
  }
}

TEST(PicturedLimits, BeginAtTheLeastDepthWhereThatIsUnstable) {
  LobesOptions options = chart(5000, 5100, 0.01, 2, 20);
  options.axial_depth_m = {5e-3, 0.01};
  options.limit_step_m = 1e-4;
  const std::vector<Limit> drawn = limit_depths(benchmark(0.5), options, {5000 * rpm});
  EXPECT_EQ(drawn[0].status, Limit::Status::found);
  EXPECT_EQ(drawn[0].axial_depth_m, 5e-3);
}

TEST(LimitsAlone, AreThoseOfTheChart) {
  LobesOptions options = chart(4000, 16000, 3e-3, 20, 40);
  options.points = {{6500 * rpm, 0.6e-3}, {15000 * rpm, 0.1e-3}};
  const LobesResult whole = compute_lobes(robot(), options);
  options.output = Output::limits;
  const LobesResult alone = compute_lobes(robot(), options);
  EXPECT_TRUE(alone.boundary.empty());
  EXPECT_EQ(alone.spectral_radius.size(), 0);
  EXPECT_EQ(alone.spindle_speed_rad_per_s, whole.spindle_speed_rad_per_s);
  EXPECT_EQ(alone.period, whole.period);
  EXPECT_EQ(alone.uncertain, 0);
  ASSERT_EQ(alone.limit.size(), whole.limit.size());
  for (std::size_t i = 0; i < whole.limit.size(); ++i) {
    EXPECT_NEAR(alone.limit[i].axial_depth_m, whole.limit[i].axial_depth_m, 1e-5 * 3e-3);
  }
  const std::vector<Limit> own = limit_depths(robot(), options, {6500 * rpm, 15000 * rpm});
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(alone.points[i].spectral_radius, whole.points[i].spectral_radius);
    EXPECT_EQ(alone.points[i].limit_depth_m, own[i].axial_depth_m);
    EXPECT_EQ(whole.points[i].limit_depth_m, own[i].axial_depth_m);
    EXPECT_EQ(whole.points[i].stable, options.points[i].axial_depth_m < own[i].axial_depth_m);
  }
}

TEST(LimitsAlone, InTheFrequencyDomain) {
  LobesOptions options = chart(8000, 16000, 3e-3, 5, 20);
  options.method = Method::zeroth_order;
  options.points = {{12000 * rpm, 0.2e-3}};
  const LobesResult whole = compute_lobes(robot(), options);
  options.output = Output::limits;
  const LobesResult alone = compute_lobes(robot(), options);
  EXPECT_TRUE(alone.boundary.empty());
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(alone.limit[i].axial_depth_m, whole.limit[i].axial_depth_m);
  const double own_m = limit_depths(robot(), options, {12000 * rpm})[0].axial_depth_m;
  EXPECT_EQ(alone.points[0].limit_depth_m, own_m);
  EXPECT_EQ(whole.points[0].limit_depth_m, own_m);
}

TEST(LimitsAlone, RejectStepsTooFine) {
  LobesOptions options = chart(4000, 16000, 3e-3, 20, 40);
  for (const double step_m : {1e-8, -1e-3}) {
    options.limit_step_m = step_m;
    EXPECT_NE(
        test::rejection([&] { static_cast<void>(limit_depths(robot(), options, {6500 * rpm})); }).find("limit_step_m"),
        std::string::npos);
  }
}

}  // namespace columns_test
}  // namespace robomill::stability
