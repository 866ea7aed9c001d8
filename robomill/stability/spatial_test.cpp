// Cuts in three directions.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/stability/surface_error.hpp"
#include "robomill/stability/sweep.hpp"
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

// The border of stability is where the smallest gain is 1, and the gain scales the coefficients.
TEST(Spatial, GainMarginIsAFactorOnTheCoefficients) {
  for (const SpatialReference& known : testing::spatial_references()) {
    const OperatingPoint point{known.limit_speed_rpm * rpm, 1e-3 * known.limit_mm};
    EXPECT_NEAR(gain_margin(known.problem, point).gain, 1.0, 1e-5);
    LobesProblem scaled = known.problem;
    cutting::MillingCoefficients& k = scaled.spatial->coefficients;
    for (auto* of : {&k.tangential_n_per_m2, &k.radial_n_per_m2, &k.axial_n_per_m2}) of->front() *= 0.7;
    EXPECT_NEAR(gain_margin(scaled, point).gain, 1.0 / 0.7, 1e-5);
    EXPECT_LT(evaluate_point(scaled, {}, point).spectral_radius, 1.0);
  }
}

// Without helix the flat end's stiffness is linear in its depth: the two-direction limit is the gain.
TEST(Spatial, GainMarginOfAStraightFlatEndIsItsLimit) {
  LobesOptions options;
  options.axial_depth_m = {0.0, 4e-3};
  options.grid = {2, 81};
  for (const double speed_rpm : {5000.0, 9000.0, 14000.0}) {
    const Limit limit = limit_depths(testing::benchmark(0.3), options, {speed_rpm * rpm}).front();
    const double depth_m = 0.1e-3;
    EXPECT_NEAR(gain_margin(testing::benchmark(0.3), {speed_rpm * rpm, depth_m}).gain, limit.axial_depth_m / depth_m,
                1e-5 * limit.axial_depth_m / depth_m);
  }
}

/// The plane benchmark as a cut in three directions that happens to be flat.
LobesProblem spatial_benchmark(double ratio, double helix_rad) {
  const LobesProblem plane = testing::benchmark(ratio);
  SpatialMilling milling;
  milling.cutter.mill = plane.milling.tool;
  milling.cutter.mill.helix_rad = helix_rad;
  milling.cut = {.axial_depth_m = 1e-3, .radial_depth_m = ratio * 0.01, .direction = cutting::MillingDirection::down};
  milling.coefficients = {.tangential_n_per_m2 = {6e8}, .radial_n_per_m2 = {2e8}};
  LobesProblem problem;
  problem.spatial = milling;
  problem.dynamics = plane.dynamics;
  return problem;
}

TEST(Spatial, AnUprightFlatEndIsThatOfThePlane) {
  for (const double helix_rad : {0.0, 0.5}) {
    for (const double ratio : {0.05, 0.3, 1.0}) {
      LobesProblem plane = testing::benchmark(ratio);
      plane.milling.tool.helix_rad = helix_rad;
      const OperatingPoint point{5000.0 * rpm, 0.6e-3};
      const PointResult expected = evaluate_point(plane, {}, point);
      const PointResult found = evaluate_point(spatial_benchmark(ratio, helix_rad), {}, point);
      EXPECT_NEAR(found.spectral_radius, expected.spectral_radius, 3e-6 * expected.spectral_radius)
          << ratio << " " << helix_rad;
      EXPECT_NEAR(found.chatter_frequency_hz, expected.chatter_frequency_hz, 0.01);
    }
  }
}

TEST(Spatial, ASweepFindsWhereItsPointsAreStable) {
  LobesProblem problem = testing::spatial_references()[1].problem;
  problem.spatial->cut.axial_depth_m = 0.25e-3;
  SweepOptions options;
  options.parameter = SweptParameter::lead;
  options.range = {-0.4, 0.4};
  options.spindle_speed_rad_per_s = {11000 * rpm, 13000 * rpm};
  options.grid = {3, 17};
  options.points = {{12000 * rpm, 0.1}};
  const SweepResult sweep = compute_sweep(problem, options);
  int crossings = 0;
  for (std::size_t s = 0; s < sweep.stable.size(); ++s) {
    const double speed = sweep.spindle_speed_rad_per_s(static_cast<Eigen::Index>(s));
    const auto radius = [&](double lead) {
      LobesProblem leaning = problem;
      leaning.spatial->cut.lead_rad = lead;
      return evaluate_point(leaning, {}, {speed, problem.spatial->cut.axial_depth_m}).spectral_radius;
    };
    for (const StableInterval& interval : sweep.stable[s]) {
      EXPECT_LT(radius(0.5 * (interval.from + interval.to)), 1.0);
      for (const double end : {interval.from, interval.to}) {
        if (std::abs(end) > 0.4 - 1e-9) continue;
        EXPECT_NEAR(radius(end), 1.0, 3e-6);
        ++crossings;
      }
    }
  }
  EXPECT_GT(crossings, 0);
  ASSERT_EQ(sweep.points.size(), 1U);
  EXPECT_EQ(sweep.points[0].stable, sweep.points[0].gain_margin > 1.0);
}

// Kt against the motion turns a drill, Kr pushes it along its axis: with modes along z alone each lip regenerates as a
// turned shaft's edge [Tlusty1963].
TEST(Spatial, ADrillAlongItsAxisHasTheTurnedShaftsLimit) {
  const double mass = 0.5, zeta = 0.03, frequency = 700.0;
  cutting::Drill drill;
  drill.diameter_m = 0.012;
  drill.coefficients = {.tangential_n_per_m2 = 8e8, .radial_n_per_m2 = 5e8};
  LobesProblem problem;
  problem.drilling = drill;
  problem.dynamics = testing::spatial_model(
      {{frequency, zeta, mass, Eigen::Vector3d::UnitZ()}, {5000.0, 0.05, 50.0, Eigen::Vector3d::UnitX()}});
  const double omega = 2.0 * std::numbers::pi * frequency;
  // Two lips of b / sin p, each K_r sin² p along z.
  const double per_width = 2.0 * 5e8 * std::sin(0.5 * drill.point_angle_rad);
  const double limit_m = 2.0 * mass * omega * omega * zeta * (1.0 + zeta) / per_width;
  LobesOptions options;
  options.axial_depth_m = {0.0, 6.0 * limit_m};
  options.grid = {2, 49};
  double lowest = 1.0;
  for (double speed_rpm = 3000.0; speed_rpm < 4000.0; speed_rpm += 20.0) {
    const Limit limit = limit_depths(problem, options, {speed_rpm * rpm}).front();
    if (limit.status == Limit::Status::found) lowest = std::min(lowest, limit.axial_depth_m);
  }
  EXPECT_GE(lowest, limit_m * (1.0 - 1e-5));
  EXPECT_LT(lowest, 1.01 * limit_m);
}

TEST(Spatial, GainMarginKnowsWhereThereIsNone) {
  LobesProblem problem = testing::spatial_references()[0].problem;
  EXPECT_EQ(gain_margin(problem, {12000 * rpm, 0.0}).status, GainMargin::Status::unconditionally_stable);
  EXPECT_NEAR(evaluate_point(problem, {}, {12000 * rpm, 0.0}).spectral_radius,
              std::exp(-0.03 * 2.0 * std::numbers::pi * 850.0 * 0.0025), 1e-6);  // the slowest mode fades alone
  problem.dynamics = testing::spatial_model({{850.0, 1e-6, 1e-6, Eigen::Vector3d::UnitX()}});
  EXPECT_EQ(gain_margin(problem, {12000 * rpm, 1e-3}).status, GainMargin::Status::below_range);
}

TEST(Spatial, RejectsWhatItCannotJudge) {
  LobesProblem problem = testing::spatial_references()[0].problem;
  LobesOptions options;
  options.method = Method::semi_discretization;
  EXPECT_THROW(static_cast<void>(evaluate_point(problem, options, {1000.0, 1e-4})), InvalidInput);
  problem.spatial->cutter.mill.runout_m = 1e-5;
  EXPECT_THROW(problem.validate(), InvalidInput);
  problem = testing::spatial_references()[0].problem;
  problem.spatial->coefficients.tangential_n_per_m2 = {1500.0};
  EXPECT_THROW(static_cast<void>(evaluate_point(problem, {}, {1000.0, 1e-4})), InvalidInput);
  EXPECT_THROW(static_cast<void>(surface_point(problem, {1000.0, 1e-4})), InvalidInput);
  problem = testing::spatial_references()[0].problem;
  problem.spatial->modes_turn_with_tool = true;
  problem.workpiece_dynamics = problem.dynamics;
  EXPECT_THROW(problem.validate(), InvalidInput);
  problem = testing::benchmark(0.3);
  SweepOptions sweep;
  sweep.range = {0.0, 0.1};
  sweep.spindle_speed_rad_per_s = {500.0, 600.0};
  EXPECT_THROW(static_cast<void>(compute_sweep(problem, sweep)), InvalidInput);
}

}  // namespace spatial_test
}  // namespace robomill::stability
