#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "robomill/stability/lobes.hpp"
#include "testing/stability/problems.hpp"
#include "testing/stability/time_domain_reference.hpp"

namespace robomill::stability {
namespace lobes_accuracy_test {

using testing::benchmark;
using testing::robot;
using testing::rpm;

double radius(const LobesProblem& problem, double speed_rpm, double depth_m, int intervals) {
  LobesOptions options;
  options.method = Method::semi_discretization;
  options.intervals = intervals;
  return evaluate_point(problem, options, {speed_rpm * rpm, depth_m}).spectral_radius;
}

struct Known {
  LobesProblem problem;
  double speed_rpm, depth_m, converged;
};

// Source: converged spectral radii of one tooth period, eight digits.
std::vector<Known> interrupted() {
  return {{benchmark(0.1), 5000, 0.2e-3, 0.74477499},  {benchmark(0.1), 5000, 0.5e-3, 0.84778557},
          {benchmark(0.1), 5000, 1.0e-3, 1.03111539},  {benchmark(0.05), 5000, 0.2e-3, 0.70098118},
          {benchmark(0.05), 5000, 1.0e-3, 0.84047032}, {robot(), 6500, 0.6e-3, 1.10584684},
          {robot(), 8000, 1.2e-3, 1.07595981},         {robot(), 15000, 1.1e-3, 1.11946237}};
}
std::vector<Known> continuous() {
  return {{benchmark(1.0), 5000, 0.2e-3, 2.13659148},
          {benchmark(1.0, 1), 5000, 0.2e-3, 0.81974278},
          {benchmark(1.0, 1), 5000, 0.5e-3, 1.07397559}};
}

// Where a tooth always cuts the error is a series in the square of the step: order 2, and Richardson's extrapolation
// gives all printed digits.
TEST(LobesAccuracy, ContinuousCutConvergesAtSecondOrderToTheKnownRadii) {
  for (const Known& known : continuous()) {
    const double coarse = radius(known.problem, known.speed_rpm, known.depth_m, 320);
    const double middle = radius(known.problem, known.speed_rpm, known.depth_m, 640);
    const double fine = radius(known.problem, known.speed_rpm, known.depth_m, 1280);
    EXPECT_NEAR(std::log2((coarse - known.converged) / (middle - known.converged)), 2.0, 0.01);
    EXPECT_NEAR(std::log2((middle - known.converged) / (fine - known.converged)), 2.0, 0.01);
    EXPECT_NEAR((4.0 * fine - middle) / 3.0, known.converged, 2e-8);
  }
}

// Entry and exit fall inside a step, at another place for each number of steps: the order is still 2 but the factor
// jumps, so that extrapolation gains less.
TEST(LobesAccuracy, InterruptedCutConvergesToTheKnownRadii) {
  for (const Known& known : interrupted()) {
    const double coarse = radius(known.problem, known.speed_rpm, known.depth_m, 40);
    const double fine = radius(known.problem, known.speed_rpm, known.depth_m, 1280);
    const double order = std::log2((coarse - known.converged) / (fine - known.converged)) / 5.0;
    EXPECT_NEAR(order, 2.0, 0.15) << known.converged;
    EXPECT_NEAR(fine, known.converged, 4e-5);
    const double finest = radius(known.problem, known.speed_rpm, known.depth_m, 2560);
    EXPECT_NEAR((4.0 * finest - fine) / 3.0, known.converged, 2.5e-7) << known.converged;
  }
}

TEST(LobesAccuracy, ErrorEstimateIsOfTheErrorsSize) {
  std::vector<Known> all = interrupted();
  for (const Known& known : continuous()) all.push_back(known);
  for (const Known& known : all) {
    LobesOptions options;
    options.method = Method::semi_discretization;
    const PointResult point = evaluate_point(known.problem, options, {known.speed_rpm * rpm, known.depth_m});
    const double error = std::abs(point.spectral_radius - known.converged);
    EXPECT_LT(error, 1.2 * point.error_estimate);
    EXPECT_GT(error, 0.6 * point.error_estimate);
  }
}

// Integration in time sees teeth enter and leave within its own steps and is of first order there.
TEST(LobesAccuracy, AgreesWithIntegrationInTime) {
  EXPECT_NEAR(testing::time_domain_radius(benchmark(1.0, 1), {5000 * rpm, 0.5e-3}, 800, 150), 1.07397559, 1e-6);
  EXPECT_NEAR(testing::time_domain_radius(benchmark(0.1), {5000 * rpm, 1e-3}, 800, 150), 1.03111539, 4e-4);
  EXPECT_NEAR(testing::time_domain_radius(robot(), {6500 * rpm, 0.6e-3}, 400, 200), 1.10584684, 4e-4);
}

TEST(LobesAccuracy, HelixAgreesWithIntegrationInTime) {
  LobesProblem helix = robot();
  helix.milling.tool.helix_rad = 0.7;
  const double expected = testing::time_domain_radius(helix, {6500 * rpm, 2e-3}, 400, 150, 20);
  EXPECT_NEAR(radius(helix, 6500, 2e-3, 640), expected, 3e-4);
  helix.milling.tool.helix_rad = 0.0;
  EXPECT_GT(std::abs(radius(helix, 6500, 2e-3, 640) - expected), 0.01);
}

TEST(LobesAccuracy, UnequalPitchAgreesWithIntegrationInTime) {
  LobesProblem unequal = benchmark(0.5);
  unequal.milling.tool.pitch_rad = {2.9, 2.0 * std::numbers::pi - 2.9};
  for (const double depth_m : {0.1e-3, 0.4e-3}) {
    const double expected = testing::time_domain_radius(unequal, {14000 * rpm, depth_m}, 400, 150);
    EXPECT_NEAR(radius(unequal, 14000, depth_m, 640), expected, 1e-4 * expected);
  }
}

}  // namespace lobes_accuracy_test
}  // namespace robomill::stability
