#include "robomill/stability/chart/chart.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/stability/compare.hpp"
#include "testing/stability/problems.hpp"

namespace robomill::stability {
namespace chart_test {

using testing::benchmark;
using testing::robot;
using testing::rpm;

LobesOptions traced(double from_rpm, double to_rpm, double depth_m, int speeds, int depths) {
  LobesOptions options = testing::chart(from_rpm, to_rpm, depth_m, speeds, depths);
  options.method = Method::collocation;
  return options;
}

LobesProblem with_helix(double degrees) {
  LobesProblem problem = benchmark(0.05);
  problem.milling.tool.helix_rad = degrees * std::numbers::pi / 180.0;
  return problem;
}

// Helix closes flip lobes into islands, some of them a single cell in size. A few looks find what looking everywhere
// finds.
TEST(Chart, LosesNoIslandOfTheGrid) {
  for (const double helix : {30.0, 40.0}) {
    LobesOptions options = traced(8000, 24000, 0.03, 100, 100);
    const LobesResult some = compute_lobes(with_helix(helix), options);
    options.output = Output::both;
    const LobesResult all = compute_lobes(with_helix(helix), options);
    EXPECT_LT(some.evaluations, 0.7 * static_cast<double>(all.evaluations));
    ASSERT_EQ(some.boundary.size(), all.boundary.size());
    EXPECT_GE(some.boundary.back().curve, 3);
    for (std::size_t i = 0; i < all.boundary.size(); ++i) {
      EXPECT_NEAR(some.boundary[i].axial_depth_m, all.boundary[i].axial_depth_m, 1e-5);
      EXPECT_EQ(some.boundary[i].curve, all.boundary[i].curve);
      EXPECT_EQ(some.boundary[i].kind, all.boundary[i].kind);
    }
  }
}

// Speeds looked at one by one skip depths that look alike; every depth of the grid shows whether that loses a limit.
TEST(Chart, LimitsOfSpeedsAreThoseOfEveryDepth) {
  for (const double helix : {0.0, 30.0, 40.0}) {
    for (const int depths : {2, 30, 100}) {
      LobesOptions options = traced(8000, 24000, 0.03, 80, depths);
      options.output = Output::both;
      const LobesResult all = compute_lobes(with_helix(helix), options);
      const std::vector<double> speeds(all.spindle_speed_rad_per_s.begin(), all.spindle_speed_rad_per_s.end());
      const std::vector<Limit> limits = limit_depths(with_helix(helix), options, speeds);
      for (std::size_t i = 0; i < speeds.size(); ++i) {
        ASSERT_EQ(limits[i].status, all.limit[i].status) << helix << ' ' << depths << ' ' << speeds[i] / rpm;
        EXPECT_NEAR(limits[i].axial_depth_m, all.limit[i].axial_depth_m, 1e-5) << helix << ' ' << depths;
      }
    }
  }
}

TEST(Chart, CurvesRunFromCellToCell) {
  const LobesResult result = compute_lobes(robot(), traced(4000, 16000, 3e-3, 60, 50));
  ASSERT_GT(result.boundary.size(), 100U);
  EXPECT_EQ(result.uncertain, 0);
  for (std::size_t i = 1; i < result.boundary.size(); ++i) {
    const BoundaryPoint& a = result.boundary[i - 1];
    const BoundaryPoint& b = result.boundary[i];
    EXPECT_GE(b.curve, a.curve);
    EXPECT_LE(b.error_estimate, 1e-6);
    if (b.curve != a.curve) continue;
    EXPECT_LE(std::abs(b.spindle_speed_rad_per_s - a.spindle_speed_rad_per_s), 12000.0 / 59.0 * rpm * 1.0001);
    EXPECT_LE(std::abs(b.axial_depth_m - a.axial_depth_m), 3e-3 / 49.0 * 1.0001);
  }
  for (const Limit& limit : result.limit) {
    if (limit.status != Limit::Status::found) continue;
    const double below =
        evaluate_point(robot(), {}, {limit.spindle_speed_rad_per_s, 0.999 * limit.axial_depth_m}).spectral_radius;
    EXPECT_LT(below, 1.0);
  }
}

// No depth at all is the structure alone, also where a helix makes pieces as thin as the slice.
TEST(Chart, NothingIsUnstableWithoutDepth) {
  for (const double depth_m : {0.0, 1e-12, 1e-9, 1e-7}) {
    const double free = evaluate_point(benchmark(0.05), {}, {9000 * rpm, 0.0}).spectral_radius;
    EXPECT_NEAR(evaluate_point(with_helix(30.0), {}, {9000 * rpm, depth_m}).spectral_radius, free, 1e-4);
  }
}

TEST(FrequencyMethods, ChartFromModesIsThatOfCollocation) {
  LobesOptions options = traced(5000, 12000, 4e-3, 12, 20);
  options.tolerance = 1e-8;
  const LobesResult reference = compute_lobes(benchmark(0.1), options);
  options.method = Method::multi_frequency;
  const LobesResult result = compute_lobes(benchmark(0.1), options);
  EXPECT_EQ(to_string(result.method), "multi-frequency");
  EXPECT_FALSE(result.boundary.empty());
  for (std::size_t i = 0; i < 12; ++i) {
    ASSERT_EQ(result.limit[i].status, reference.limit[i].status);
    EXPECT_NEAR(result.limit[i].axial_depth_m, reference.limit[i].axial_depth_m, 1e-8);
    EXPECT_EQ(result.limit[i].kind, reference.limit[i].kind);
  }
  options.output = Output::map;
  EXPECT_THROW(static_cast<void>(compute_lobes(benchmark(0.1), options)), InvalidInput);
}

TEST(FrequencyMethods, TakeMeasuredFrfsWhereModesAreNeededElsewhere) {
  LobesProblem problem = benchmark(0.1);
  problem.measured = modal::synthesize(problem.dynamics, Eigen::VectorXd::LinSpaced(20001, 0.0, 5000.0));
  problem.dynamics = {};
  LobesOptions options = traced(5000, 12000, 4e-3, 5, 20);
  options.tolerance = 1e-8;
  EXPECT_THROW(static_cast<void>(compute_lobes(problem, options)), InvalidInput);
  options.method = Method::multi_frequency;
  const LobesResult measured = compute_lobes(problem, options);
  const LobesResult modes = compute_lobes(benchmark(0.1), options);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(measured.limit[i].axial_depth_m, modes.limit[i].axial_depth_m, 1e-8);
  }
  const OperatingPoint point{8000 * rpm, 0.5e-3};
  EXPECT_TRUE(evaluate_point(problem, options, {8000 * rpm, 1e-5}).stable);
  EXPECT_EQ(evaluate_point(problem, options, point).stable, evaluate_point(benchmark(0.1), {}, point).stable);

  // A part that moves, measured or as modes.
  const modal::ModalModel part = testing::plane_model({testing::mass_mode(1, 700.0, 0.02, 0.2)});
  LobesProblem with_modes = problem;
  with_modes.workpiece_dynamics = part;
  LobesProblem with_frfs = problem;
  with_frfs.workpiece_measured = modal::synthesize(part, problem.measured.frequency_hz);
  LobesProblem all_modes = benchmark(0.1);
  all_modes.workpiece_dynamics = part;
  const std::vector<double> speed = {7000 * rpm};
  LobesOptions collocated = options;
  collocated.method = Method::collocation;
  const double expected = limit_depths(all_modes, collocated, speed).front().axial_depth_m;
  EXPECT_NEAR(limit_depths(with_modes, options, speed).front().axial_depth_m, expected, 1e-8);
  EXPECT_NEAR(limit_depths(with_frfs, options, speed).front().axial_depth_m, expected, 1e-8);
}

TEST(Comparison, PutsEveryMethodBesideCollocation) {
  const MethodComparison comparison = compare_methods(robot(), traced(4000, 16000, 3e-3, 20, 100), 10);
  ASSERT_EQ(comparison.rows.size(), 6U);
  EXPECT_EQ(comparison.rows.front().method, Method::collocation);
  EXPECT_EQ(comparison.rows.front().worst_error, 0.0);
  for (const MethodRow& row : comparison.rows) {
    ASSERT_TRUE(row.rejection.empty()) << row.rejection;
    EXPECT_EQ(row.limits.size(), 10U);
    if (row.method == Method::zeroth_order) {
      EXPECT_LT(row.median_error, 0.1);
    } else {
      EXPECT_LT(row.worst_error, row.method == Method::multi_frequency ? 1e-5 : 0.05);
    }
  }
  LobesProblem runout = robot();
  runout.milling.feed_per_tooth_m = 1e-5;
  runout.milling.tool.runout_m = 3e-6;
  const MethodComparison rejected = compare_methods(runout, traced(4000, 16000, 3e-3, 20, 20), 2);
  EXPECT_FALSE(rejected.rows[1].rejection.empty());
}

}  // namespace chart_test
}  // namespace robomill::stability
