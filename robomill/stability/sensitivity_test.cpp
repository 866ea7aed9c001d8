// What limits are sensitive to.
#include "robomill/stability/sensitivity.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/stability/block.hpp"
#include "robomill/stability/collocation/mode_sensitivity.hpp"
#include "testing/stability/blocks.hpp"
#include "testing/stability/problems.hpp"
#include "testing/stability/spatial_cases.hpp"
#include "testing/support.hpp"

namespace robomill::stability {
namespace sensitivity_test {

using testing::rpm;

// Two ways: eigenvectors of the period over the modes, and differences of radii found by Arnoldi's iteration.
void expect_both_ways(const LobesProblem& problem, const OperatingPoint& point) {
  const LimitSensitivity by_vectors = limit_sensitivity(problem, point);
  const auto by_differences = detail::mode_differences(problem, point, 4, 1e-6);
  ASSERT_EQ(by_vectors.modes.size(), by_differences.size());
  double size = 0.0;
  for (const auto& mode : by_differences) size = std::max({size, std::abs(mode.frequency), std::abs(mode.residue)});
  for (std::size_t k = 0; k < by_differences.size(); ++k) {
    EXPECT_NEAR(by_vectors.modes[k].frequency, by_differences[k].frequency, 1e-4 * size) << k;
    EXPECT_NEAR(by_vectors.modes[k].damping_ratio, by_differences[k].damping_ratio, 1e-4 * size) << k;
    EXPECT_NEAR(by_vectors.modes[k].residue, by_differences[k].residue, 1e-4 * size) << k;
  }
}

TEST(LimitSensitivity, OfEigenvectorsIsThatOfDifferences) {
  for (const auto& known : testing::spatial_references()) {
    expect_both_ways(known.problem, {known.limit_speed_rpm * rpm, 1e-3 * known.limit_mm});
  }
  expect_both_ways(testing::benchmark(0.3), {5000 * rpm, 0.4e-3});
  expect_both_ways(testing::benchmark(1.0), {9000 * rpm, 0.4e-3});
  expect_both_ways(testing::robot(), {6500 * rpm, 0.5e-3});
}

// Teeth that differ have no period of the modes alone: radii at both sides, which the limits of changed problems prove.
TEST(LimitSensitivity, OfUnequalPitchPredictsLimits) {
  LobesProblem problem = testing::benchmark(0.5);
  problem.milling.tool.pitch_rad = {3.0, 2.0 * std::numbers::pi - 3.0};
  LobesOptions options;
  options.axial_depth_m = {0.0, 3e-3};
  options.grid = {2, 61};
  options.tolerance = 1e-9;
  const auto limit_m = [&](const LobesProblem& p) {
    return limit_depths(p, options, {5000 * rpm}).front().axial_depth_m;
  };
  const double here_m = limit_m(problem);
  const LimitSensitivity found = limit_sensitivity(problem, {5000 * rpm, here_m});
  for (std::size_t k = 0; k < 2; ++k) {
    LobesProblem stiffer = problem, softer = problem;
    stiffer.dynamics.modes[k].frequency_hz *= 1.0 + 1e-5;
    softer.dynamics.modes[k].frequency_hz *= 1.0 - 1e-5;
    const double slope = std::log(limit_m(stiffer) / limit_m(softer)) / 2e-5;
    EXPECT_NEAR(-found.modes[k].frequency / found.depth, slope, 2e-3 * std::abs(slope)) << k;
  }
}

/// 5 and 95 % of the limits of problems that are drawn.
std::pair<double, double> sampled(const testing::BlockCase& block, int samples, std::uint64_t seed) {
  std::vector<double> limits;
  for (int i = 0; i < samples; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    LobesProblem drawn = block.problem;
    for (modal::Mode& mode : drawn.dynamics.modes) {
      mode.frequency_hz += random.normal() * mode.frequency_std_hz;
      mode.damping_ratio += random.normal() * mode.damping_ratio_std;
      mode.right *= 1.0 + random.normal() * mode.residue_std_ratio;
    }
    const BlockStability one =
        block_stability(drawn, block.spindle_speed_rad_per_s, block.depth_m, {.regime = false, .quantiles = false});
    limits.push_back(one.limit.status == Limit::Status::found ? one.limit.axial_depth_m : 1.0);
  }
  std::ranges::sort(limits);
  const auto at = [&](double share) { return limits[static_cast<std::size_t>(share * samples)]; };
  return {at(0.05), at(0.95)};
}

// A third of a robot's usual deviations, so that one lobe stays the lowest in most cuts.
TEST(LimitQuantiles, AreThoseOfSampling) {
  const int cuts = test::seeds(40);
  const int samples = 100;
  int near = 0;
  int judged = 0;
  for (std::uint64_t seed = 0; judged < cuts; ++seed) {
    Random random(811, seed);
    testing::BlockCase block = testing::block_case(random, 8);
    for (modal::Mode& mode : block.problem.dynamics.modes) {
      mode.frequency_std_hz *= 0.3;
      mode.damping_ratio_std *= 0.3;
      mode.residue_std_ratio *= 0.3;
    }
    const BlockStability first = block_stability(block.problem, block.spindle_speed_rad_per_s, block.depth_m);
    if (first.limit.status != Limit::Status::found || first.limit.axial_depth_m < block.depth_m / 8.0) continue;
    ++judged;
    EXPECT_LT(first.limit_5_percent_m, first.limit.axial_depth_m);
    EXPECT_GT(first.limit_95_percent_m, first.limit.axial_depth_m);
    const auto [low_m, high_m] = sampled(block, samples, 5000 + seed);
    const double sigmas = std::log(first.limit_95_percent_m / first.limit_5_percent_m);  // 3.3 of them
    const bool agrees = std::abs(std::log(first.limit_5_percent_m / low_m)) < 0.15 * sigmas + 0.01 &&
                        std::abs(std::log(first.limit_95_percent_m / high_m)) < 0.15 * sigmas + 0.01;
    near += agrees ? 1 : 0;
  }
  EXPECT_GE(near, cuts - std::max(1, cuts / 5));
}

}  // namespace sensitivity_test
}  // namespace robomill::stability
