#include "robomill/stability/collocation/collocation.hpp"
#include "robomill/stability/collocation/milling_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "testing/stability/problems.hpp"
#include "testing/stability/time_domain_reference.hpp"
#include "testing/support.hpp"

namespace robomill::stability::detail {
namespace collocation_test {

using std::numbers::pi;
using test::seeds;
using testing::benchmark;
using testing::Known;
using testing::known_points;
using testing::robot;
using testing::rpm;

PointResult at(const LobesProblem& problem, double speed_rpm, double depth_m, double tolerance = 1e-6) {
  LobesOptions options;
  options.tolerance = tolerance;
  return evaluate_point(problem, options, {speed_rpm * rpm, depth_m});
}

double stepped(const LobesProblem& problem, double speed_rpm, double depth_m, int intervals) {
  LobesOptions options;
  options.method = Method::semi_discretization;
  options.intervals = intervals;
  return evaluate_point(problem, options, {speed_rpm * rpm, depth_m}).spectral_radius;
}

TEST(Collocation, ReachesTheKnownRadii) {
  for (const Known& known : known_points()) {
    const PointResult point = at(known.problem, known.speed_rpm, known.depth_m);
    EXPECT_NEAR(point.spectral_radius, known.converged, 1e-7) << known.speed_rpm;
    EXPECT_LE(point.error_estimate, 1e-6);
  }
}

// The estimate is the coarser level's error, so that it bounds that of the result.
TEST(Collocation, ErrorEstimateBoundsTheError) {
  for (const Known& known : known_points()) {
    const double converged = at(known.problem, known.speed_rpm, known.depth_m, 1e-10).spectral_radius;
    EXPECT_NEAR(converged, known.converged, 6e-9);
    for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
      const PointResult point = at(known.problem, known.speed_rpm, known.depth_m, tolerance);
      EXPECT_LE(point.error_estimate, tolerance * std::max(1.0, converged));
      EXPECT_LE(std::abs(point.spectral_radius - converged), point.error_estimate + 1e-12);
    }
  }
}

// Source: limits at a/D = 0.05, six digits.
TEST(Collocation, ReachesTheKnownLimits) {
  LobesOptions options;
  options.axial_depth_m = {0.0, 5e-3};
  options.grid = {2, 50};
  const std::vector<Limit> limits =
      limit_depths(benchmark(0.05), options, {5000 * rpm, 10000 * rpm, 15000 * rpm, 20000 * rpm});
  const double expected_m[] = {1.843802e-3, 1.486950e-3, 1.651214e-3, 3.250386e-3};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(limits[i].axial_depth_m, expected_m[i], 1e-8);
    EXPECT_EQ(limits[i].kind, i == 3 ? BifurcationType::flip : BifurcationType::hopf);
    EXPECT_LE(limits[i].error_estimate, 1e-6);
  }
}

// No depth: the slowest mode dies down by exp(-ζωT).
TEST(Collocation, NoDepthLeavesTheStructureAlone) {
  const double period_s = 60.0 / 5000.0 / 2.0;
  const double omega = 2.0 * pi * 922.0;
  EXPECT_NEAR(at(benchmark(0.1), 5000, 0.0).spectral_radius, std::exp(-0.011 * omega * period_s), 1e-12);
}

modal::ModalModel random_structure(Random& random) {
  modal::ModalModel model = testing::plane_model({});
  const std::size_t count = 1 + random.index(6);
  for (std::size_t k = 0; k < count; ++k) {
    modal::Mode mode = testing::mass_mode(0, random.uniform(20.0, 1500.0), random.uniform(0.005, 0.1), 1.0);
    const double size = std::sqrt(1.0 / (2.0 * random.uniform(0.05, 2.0) * modal::pole(mode).imag()));
    const auto entry = [&] { return size * std::complex<double>(random.normal(), random.normal()); };
    mode.left << entry(), entry();
    mode.right << entry(), entry();
    model.modes.push_back(mode);
  }
  if (random.index(3) == 0) {
    model.residuals.push_back({.name = modal::parse_frf_name("xx"), .stiffness = random.uniform(0.0, 3e-8)});
  }
  return model;
}

/// Teeth, helix, pitch, immersion, structure: any.
LobesProblem random_problem(Random& random) {
  LobesProblem p;
  p.milling.tool.teeth = 1 + static_cast<int>(random.index(5));
  p.milling.tool.diameter_m = random.uniform(0.004, 0.04);
  if (random.index(2) == 0) p.milling.tool.helix_rad = random.uniform(-0.7, 0.7);
  p.milling.immersion.entry_rad = random.uniform(0.0, 0.9 * pi);
  p.milling.immersion.exit_rad = random.uniform(p.milling.immersion.entry_rad + 0.2, pi);
  p.milling.coefficients = {.tangential_n_per_m2 = random.uniform(2e8, 2e9),
                            .radial_n_per_m2 = random.uniform(0.0, 1e9)};
  p.feed_direction_rad = random.uniform(0.0, 2.0 * pi);
  p.dynamics = random_structure(random);
  if (random.index(3) == 0) {
    double sum = 0.0;
    for (int j = 0; j < p.milling.tool.teeth; ++j) {
      p.milling.tool.pitch_rad.push_back(random.uniform(0.7, 1.3));
      sum += p.milling.tool.pitch_rad.back();
    }
    for (double& pitch : p.milling.tool.pitch_rad) pitch *= 2.0 * pi / sum;
  }
  return p;
}

// Two methods that share neither steps nor weights: the difference falls with the square of the other one's step.
TEST(Collocation, AgreesWithSemiDiscretizationOnRandomCuts) {
  const int count = seeds(300);
  for (int seed = 0; seed < count; ++seed) {
    Random random(static_cast<std::uint64_t>(seed) + 77);
    const LobesProblem problem = random_problem(random);
    const double speed_rpm = random.uniform(1500.0, 20000.0);
    const double depth_m = random.uniform(0.0, 1.5e-3);
    const double collocated = at(problem, speed_rpm, depth_m).spectral_radius;
    const double coarse = stepped(problem, speed_rpm, depth_m, 160);
    const double fine = stepped(problem, speed_rpm, depth_m, 640);
    const double scale = 1.0 + collocated;
    EXPECT_NEAR(fine, collocated, 0.35 * std::abs(coarse - collocated) + 2e-5 * scale)
        << seed << ": " << coarse << " " << fine;
  }
}

// Two levels that were the same would agree without being right.
TEST(Collocation, EveryLevelIsFinerThanTheOneBefore) {
  for (const LobesProblem& problem : {benchmark(0.05), benchmark(1.0), robot()}) {
    const MillingModel model(problem);
    std::size_t before = 0;
    for (int level = 0; level <= last_level; ++level) {
      CollocationCase here;
      model.prepare({9000 * rpm, 1e-3}, mesh_level(level), here);
      const std::size_t nodes = here.mesh.pieces.size() * static_cast<std::size_t>(here.mesh.topology.nodes);
      EXPECT_GT(nodes, before);
      before = nodes;
    }
  }
}

// What is remembered of the nodes is chosen for speed; the result does not depend on it.
TEST(Collocation, WhatIsRememberedDoesNotMatter) {
  for (const LobesProblem& problem : {benchmark(0.1), robot()}) {
    const MillingModel chip(problem);
    const MillingModel whole(problem, MeshTopology::Form::whole);
    const MillingModel several(problem, MeshTopology::Form::several);
    const OperatingPoint point{7000 * rpm, 0.7e-3};
    Dominant a, b, c;
    CollocationEvaluator(chip, 1e-6).evaluate_at({&point, 1}, 4, {&a, 1});
    CollocationEvaluator(whole, 1e-6).evaluate_at({&point, 1}, 4, {&b, 1});
    CollocationEvaluator(several, 1e-6).evaluate_at({&point, 1}, 4, {&c, 1});
    EXPECT_NEAR(std::abs(a.multiplier), std::abs(b.multiplier), 1e-12);
    EXPECT_NEAR(std::abs(a.multiplier), std::abs(c.multiplier), 1e-12);
  }
}

// The multiplier and its vector put back into a plain run over the period, written apart from the kernels.
TEST(Collocation, EigenvectorComesBackMultiplied) {
  Random random(5);
  for (int i = 0; i < 12; ++i) {
    LobesProblem problem = random_problem(random);
    if (i % 3 == 0) problem.milling.process_damping = {.indentation_n_per_m3 = 4e13, .wear_land_m = 5e-5};
    const MillingModel model(problem);
    const OperatingPoint point{random.uniform(3000.0, 15000.0) * rpm, random.uniform(0.1e-3, 1e-3)};
    CollocationCase here;
    model.prepare(point, mesh_level(3), here);
    CollocationMap map;
    const CollocationMap::Point mapped{&here, point.axial_depth_m};
    map.prepare(model.modes(), {&mapped, 1});
    Arnoldi arnoldi;
    Dominant found;
    arnoldi.find(map, {&found, 1});
    const Eigen::VectorXcd vector = arnoldi.vector(0);
    const NodeForces<2> run = trace<2>(here, point.axial_depth_m, vector);
    EXPECT_LT((run.end - found.multiplier * vector).norm(), 1e-9 * (1.0 + std::abs(found.multiplier))) << i;
  }
}

/// Modes as an arm and its tool have them: many that hardly fade within a tooth period, and close ones among them.
LobesProblem many_modes(Random& random, std::size_t count) {
  LobesProblem problem = random_problem(random);
  problem.dynamics.modes.clear();
  problem.dynamics.excitations = problem.dynamics.responses = {{.axis = modal::Axis::x}, {.axis = modal::Axis::y}};
  for (std::size_t k = 0; k < count; ++k) {
    double frequency_hz = 15.0 * std::pow(150.0, random.uniform(0.0, 1.0));
    if (k > 0 && random.index(3) == 0) {
      frequency_hz = problem.dynamics.modes.back().frequency_hz * random.uniform(1.0, 1.05);
    }
    const double damping_ratio = 0.003 * std::pow(30.0, random.uniform(0.0, 1.0));
    modal::Mode mode = testing::mass_mode(0, frequency_hz, damping_ratio, 1.0);
    const double size = std::sqrt(1.0 / (2.0 * random.uniform(0.1, 10.0) * modal::pole(mode).imag()));
    const auto entry = [&] { return size * std::complex<double>(random.normal(), 0.3 * random.normal()); };
    mode.left << entry(), entry();
    mode.right << entry(), entry();
    problem.dynamics.modes.push_back(mode);
  }
  return problem;
}

// Whatever is warmed up, taken over from a coarser level or passed through many periods at once.
TEST(Collocation, ManyModesHaveTheMultiplierOfTheWholeMatrix) {
  int unsettled = 0;
  for (int seed = 0; seed < seeds(300); ++seed) {
    // In 1585 a motion that fades a little quicker settles before the dominant one, among nine between 15 and 30 Hz.
    Random random(91, seed == 0 ? 1585 : static_cast<std::uint64_t>(seed));
    const LobesProblem problem = many_modes(random, 3 + random.index(30));
    const MillingModel model(problem);
    CollocationEvaluator evaluator(model, 1e-6);
    std::vector<OperatingPoint> points;
    for (std::size_t i = 0; i < 1 + random.index(lane_count); ++i) {
      const double depth_m = 1e-5 * std::pow(300.0, random.uniform(0.0, 1.0));
      points.push_back({random.uniform(2000.0, 20000.0) * rpm, depth_m});
    }
    std::vector<Outcome> outcomes(points.size());
    evaluator.evaluate(points, {.estimate = true}, outcomes);
    const CollocationCase& finest = evaluator.last_case();
    CollocationMap map;
    const CollocationMap::Point mapped{&finest, model.factor(points.front())};
    map.prepare(model.modes(), {&mapped, 1});
    Arnoldi whole({.full_matrix_only = true});
    Dominant expected;
    whole.find(map, {&expected, 1});
    if (expected.by != Dominant::By::full_matrix) {
      ++unsettled;
      continue;
    }
    const double share = model.reported_rad() / model.whole_rad();
    const double radius = std::pow(spectral_radius(expected), share);
    EXPECT_NEAR(outcomes.front().spectral_radius, radius, 1e-8 * std::max(1.0, radius)) << seed;
  }
  EXPECT_LE(unsettled, seeds(300) / 20);
}

LobesProblem three_teeth() {
  LobesProblem problem = benchmark(0.3);
  problem.milling.tool.teeth = 3;
  problem.milling.feed_per_tooth_m = 0.1e-3;
  return problem;
}

struct InTime {
  int steps = 800;  ///< in a mean tooth period
  int periods = 60, slices = 1, teeth_a_period = 0;
  double reported_periods = 1.0;  ///< periods of the spectral radius in that of the integration
  double relative = 5e-4;
};

/// By integration in time, which shares nothing with collocation; it is of first order where teeth enter and leave
/// within its steps.
void expect_as_in_time(const LobesProblem& problem, double speed_rpm, double depth_m, const InTime& how) {
  const double seen = testing::time_domain_radius(problem, {speed_rpm * rpm, depth_m}, how.steps, how.periods,
                                                  how.slices, how.teeth_a_period);
  const PointResult found = at(problem, speed_rpm, depth_m);
  EXPECT_NEAR(std::pow(found.spectral_radius, how.reported_periods), seen, how.relative * seen);
  EXPECT_LE(found.error_estimate, 1e-6 * std::max(1.0, found.spectral_radius));
}

TEST(Collocation, UnequalPitchAsInTime) {
  LobesProblem problem = three_teeth();
  problem.milling.tool.pitch_rad = {110.0 * pi / 180.0, 115.0 * pi / 180.0, 135.0 * pi / 180.0};
  expect_as_in_time(problem, 8000, 0.6e-3, {.teeth_a_period = 3});
}

TEST(Collocation, UnequalHelixAsInTime) {
  LobesProblem problem = three_teeth();
  problem.milling.tool.tooth_helix_rad = {0.6, 0.5, 0.7};
  expect_as_in_time(problem, 8000, 2e-3,
                    {.steps = 200, .periods = 40, .slices = 40, .teeth_a_period = 3, .relative = 1.5e-3});
}

TEST(Collocation, RunoutAsInTime) {
  LobesProblem problem = three_teeth();
  problem.milling.tool.runout_m = 60e-6;
  problem.milling.tool.runout_angle_rad = 0.4;
  expect_as_in_time(problem, 8000, 0.6e-3, {.teeth_a_period = 3});
}

TEST(Collocation, ProcessDampingAsInTime) {
  LobesProblem problem = benchmark(1.0);
  const double without = at(problem, 3000, 0.3e-3).spectral_radius;
  problem.milling.process_damping = {.indentation_n_per_m3 = 4e13, .wear_land_m = 6e-5};
  expect_as_in_time(problem, 3000, 0.3e-3, {.relative = 1e-5});
  EXPECT_LT(at(problem, 3000, 0.3e-3).spectral_radius, 0.9 * without);
}

TEST(Collocation, SpeedVariationAsInTime) {
  LobesProblem problem = benchmark(1.0);
  problem.milling.speed_variation = {.amplitude_ratio = 0.2, .frequency_ratio = 0.5};
  expect_as_in_time(problem, 6000, 0.3e-3,
                    {.steps = 400, .periods = 40, .teeth_a_period = 4, .reported_periods = 2.0, .relative = 1e-5});
}

// Runout on a cutter with helix: slices, finer with each level.
TEST(Collocation, RunoutWithHelixAsInTime) {
  LobesProblem problem = three_teeth();
  problem.milling.tool.runout_m = 40e-6;
  problem.milling.tool.helix_rad = 0.4;
  LobesOptions options;
  options.tolerance = 1e-4;
  const PointResult found = evaluate_point(problem, options, {8000 * rpm, 1e-3});
  const double seen = testing::time_domain_radius(problem, {8000 * rpm, 1e-3}, 200, 40, 32, 3);
  EXPECT_NEAR(found.spectral_radius, seen, 5e-3 * seen);
}

// The part's receptance adds to the tool's: half of it on either side is the same as all of it on one.
TEST(Collocation, WorkpieceThatMovesAddsToTheTool) {
  LobesProblem split = benchmark(0.3);
  for (modal::Mode& mode : split.dynamics.modes) {
    mode.left *= std::sqrt(0.5);
    mode.right *= std::sqrt(0.5);
  }
  split.workpiece_dynamics = split.dynamics;
  const PointResult found = at(split, 7000, 0.4e-3);
  EXPECT_NEAR(found.spectral_radius, at(benchmark(0.3), 7000, 0.4e-3).spectral_radius, 1e-9);
  LobesProblem moved = benchmark(0.3);
  moved.workpiece_dynamics = testing::plane_model({testing::mass_mode(1, 300.0, 0.02, 0.05)});
  const PointResult part = at(moved, 3000, 0.4e-3);
  EXPECT_EQ(part.mode, (modal::ModeId{1, modal::ModeOwner::workpiece}));
}

// A cutter whose teeth stand true cuts as one without the wish for it; a very small runout changes nothing.
TEST(Collocation, SmallRunoutIsNone) {
  LobesProblem problem = three_teeth();
  const double tooth = at(problem, 8000, 0.6e-3).spectral_radius;
  problem.milling.tool.runout_m = 1e-12;
  const double revolution = at(problem, 8000, 0.6e-3).spectral_radius;
  EXPECT_NEAR(revolution, tooth * tooth * tooth, 1e-6);
}

// So far out that one tooth alone cuts: a cutter of one tooth, with the delay of a revolution.
TEST(Collocation, GreatRunoutLeavesOneTooth) {
  LobesProblem many = benchmark(0.3);
  many.milling.feed_per_tooth_m = 0.05e-3;
  many.milling.tool.runout_m = 0.2e-3;
  LobesProblem one = benchmark(0.3);
  one.milling.tool.teeth = 1;
  EXPECT_NEAR(at(many, 7000, 0.6e-3).spectral_radius, at(one, 7000, 0.6e-3).spectral_radius, 1e-9);
}

TEST(Collocation, SameBitsWhateverVectorsTheMachineHas) {
  LobesProblem uneven = robot();
  uneven.milling.tool.helix_rad = 0.5;
  uneven.milling.tool.pitch_rad = {110.0 * pi / 180.0, 115.0 * pi / 180.0, 135.0 * pi / 180.0};
  const Kernels best = best_kernels();
  for (const LobesProblem& problem : {robot(), uneven}) {
    std::vector<double> radii;
    for (const Kernels variant : {Kernels::baseline, Kernels::avx2, Kernels::avx512}) {
      if (static_cast<int>(variant) > static_cast<int>(best)) continue;
      kernels() = variant;
      radii.push_back(at(problem, 7000, 0.7e-3).spectral_radius);
    }
    kernels() = best;
    for (const double radius : radii) EXPECT_EQ(std::memcmp(&radius, radii.data(), sizeof radius), 0);
  }
}

TEST(Collocation, RejectsASwingThatNeverComesRound) {
  LobesProblem problem = benchmark(0.3);
  problem.milling.speed_variation = {.amplitude_ratio = 0.1, .frequency_ratio = 0.1 * pi};
  EXPECT_THROW(static_cast<void>(at(problem, 7000, 1e-4)), InvalidInput);
}

}  // namespace collocation_test
}  // namespace robomill::stability::detail
