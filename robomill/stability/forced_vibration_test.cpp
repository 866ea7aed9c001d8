#include "robomill/stability/forced_vibration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/random.hpp"
#include "robomill/simulation/simulation.hpp"
#include "robomill/stability/surface_error.hpp"
#include "testing/stability/problems.hpp"
#include "testing/support.hpp"

namespace robomill::stability {
namespace forced_vibration_test {

using std::numbers::pi;
using testing::benchmark;
using testing::rpm;

LobesProblem two_modes(double first_hz, double second_hz, double second_kg) {
  LobesProblem p = benchmark(0.5);
  p.milling.feed_per_tooth_m = 0.08e-3;
  const std::vector<modal::MassMode> modes = {
      {.frequency_hz = first_hz, .damping_ratio = 0.03, .modal_mass_kg = 0.1},
      {.frequency_hz = second_hz, .damping_ratio = 0.03, .modal_mass_kg = second_kg}};
  p.dynamics = modal::modes_from_mass(modes, modes);
  return p;
}

/// Half the greatest peak to peak over the directions of the plane, in the last part of a signal.
double half_width(const simulation::Simulation& s, Eigen::Index from) {
  double widest = 0.0;
  for (int d = 0; d < 180; ++d) {
    const double angle = pi * d / 180;
    const Eigen::VectorXd along = std::cos(angle) * s.displacement_m.col(0) + std::sin(angle) * s.displacement_m.col(1);
    const Eigen::VectorXd last = along.tail(along.size() - from);
    widest = std::max(widest, last.maxCoeff() - last.minCoeff());
  }
  return 0.5 * widest;
}

// Another method: the cut in time, from rest until what began has died out. Helix, edge forces, runout, unequal pitch;
// without regeneration, which is what the harmonics leave out of teeth that differ.
TEST(ForcedVibration, IsThatOfTheCutInTime) {
  Random random(3);
  for (int seed = 0; seed < test::seeds(40); ++seed) {
    LobesProblem p = two_modes(random.uniform(400.0, 900.0), random.uniform(1000.0, 2000.0), random.uniform(0.02, 0.3));
    p.milling.tool.teeth = 2 + seed % 3;
    p.milling.tool.helix_rad = seed % 2 == 0 ? 0.0 : random.uniform(0.2, 0.7);
    p.milling.coefficients.tangential_edge_n_per_m = random.uniform(0.0, 3e4);
    p.milling.coefficients.radial_edge_n_per_m = random.uniform(0.0, 3e4);
    if (seed % 4 == 1) p.milling.tool.runout_m = 20e-6;
    if (seed % 4 == 2) {
      const double turn = 2.0 * pi / p.milling.tool.teeth;
      p.milling.tool.pitch_rad.assign(static_cast<std::size_t>(p.milling.tool.teeth), turn);
      p.milling.tool.pitch_rad.front() *= 0.9;
      p.milling.tool.pitch_rad.back() += 0.1 * turn;
    }
    const OperatingPoint point{random.uniform(3000.0, 15000.0) * rpm, random.uniform(0.1e-3, 3e-3)};
    const ForcedVibration found = ForcedResponse(p).at(point);
    const simulation::MillingCut cut = {.milling = p.milling,
                                        .structure = tip_modes(p),
                                        .spindle_speed_rad_per_s = point.spindle_speed_rad_per_s,
                                        .axial_depth_m = point.axial_depth_m};
    const simulation::Simulation in_time = simulation::simulate(
        cut, {.seconds = 0.4, .sample_rate_hz = 51200.0, .loss_of_contact = false, .regeneration = false});
    const double expected = half_width(in_time, in_time.displacement_m.rows() / 2);
    EXPECT_NEAR(found.amplitude_m, expected, 0.02 * expected) << "seed " << seed;
  }
}

// Equal teeth meet what the one before left with the same displacement: with regeneration a stable cut settles to the
// same motion.
TEST(ForcedVibration, OfEqualTeethIsTheSteadyMotion) {
  for (const double speed_rpm : {3100.0, 7000.0, 12500.0}) {
    LobesProblem p = two_modes(700.0, 1700.0, 0.05);
    p.milling.coefficients.tangential_edge_n_per_m = 1e4;
    const OperatingPoint point{speed_rpm * rpm, 0.1e-3};
    const SurfacePoint surface = surface_point(p, point);
    ASSERT_TRUE(surface.stable);
    const simulation::Simulation in_time =
        simulation::simulate({.milling = p.milling,
                              .structure = tip_modes(p),
                              .spindle_speed_rad_per_s = point.spindle_speed_rad_per_s,
                              .axial_depth_m = point.axial_depth_m},
                             {.seconds = 1.0, .sample_rate_hz = 51200.0});
    const double expected = half_width(in_time, in_time.displacement_m.rows() / 2);
    const ForcedVibration found = ForcedResponse(p).at(point);
    EXPECT_NEAR(found.amplitude_m, expected, 0.02 * expected);
    EXPECT_GE(found.amplitude_m, 0.49 * std::max(surface.peak_to_peak_x_m, surface.peak_to_peak_y_m));
  }
}

// Harmonics of the force here, the exact motion between its borders there.
TEST(ForcedVibration, OfAnUprightFlatEndInSpaceIsThatOfThePlane) {
  Random random(5);
  for (int seed = 0; seed < test::seeds(40); ++seed) {
    LobesProblem plane =
        two_modes(random.uniform(400.0, 900.0), random.uniform(1000.0, 2000.0), random.uniform(0.02, 0.3));
    plane.milling.tool.teeth = 1 + seed % 4;
    if (seed % 2 == 1) plane.milling.tool.helix_rad = random.uniform(0.2, 0.7);
    plane.milling.coefficients.tangential_edge_n_per_m = random.uniform(0.0, 3e4);
    const double radial_m = 0.5 * plane.milling.tool.diameter_m;
    const OperatingPoint point{random.uniform(3000.0, 15000.0) * rpm, random.uniform(0.1e-3, 3e-3)};
    LobesProblem space = plane;
    SpatialMilling& cut = space.spatial.emplace();
    cut.cutter.mill = plane.milling.tool;
    cut.cut = {
        .axial_depth_m = point.axial_depth_m, .radial_depth_m = radial_m, .direction = cutting::MillingDirection::down};
    const cutting::ForceCoefficients& k = plane.milling.coefficients;
    cut.coefficients = {.tangential_n_per_m2 = {k.tangential_n_per_m2},
                        .radial_n_per_m2 = {k.radial_n_per_m2},
                        .tangential_edge_n_per_m = {k.tangential_edge_n_per_m}};
    cut.feed_per_tooth_m = plane.milling.feed_per_tooth_m;
    const ForcedVibration a = ForcedResponse(plane).at(point);
    const ForcedVibration b = ForcedResponse(space).at(point);
    EXPECT_NEAR(b.amplitude_m, a.amplitude_m, 0.01 * a.amplitude_m) << seed;
    EXPECT_NEAR(b.harmonic_m, a.harmonic_m, 0.01 * a.harmonic_m) << seed;
    EXPECT_NEAR(b.mode_m, a.mode_m, 0.01 * a.mode_m) << seed;
    EXPECT_EQ(b.harmonic, a.harmonic) << seed;
    EXPECT_EQ(b.mode, a.mode) << seed;
    EXPECT_TRUE(b.of_tooth_passing);
    EXPECT_NEAR(b.frequency_hz, a.frequency_hz, 1e-9 * a.frequency_hz);
    EXPECT_NEAR(b.mode_frequency_hz, a.mode_frequency_hz, 1e-9 * a.mode_frequency_hz);
  }
}

// 6 × tooth passing stands within the width of a stiff mode, 2 × tooth passing beside a soft one moves the tip.
TEST(ForcedVibration, TheNearestModeIsNotTheOneThatMoves) {
  LobesProblem p = two_modes(2400.0, 6900.0, 0.3);
  p.milling.tool.teeth = 4;
  const double tooth_passing_hz = 6900.0 / 6.0;
  const ForcedVibration found = ForcedResponse(p).at({tooth_passing_hz / 4.0 * 2.0 * pi, 1e-3});
  EXPECT_TRUE(found.of_tooth_passing);
  EXPECT_EQ(found.harmonic, 2);
  EXPECT_NEAR(found.frequency_hz, 2300.0, 1e-9);
  EXPECT_TRUE(found.mode.number == 1 || found.mode.number == 3) << "one of the two at 2400 Hz";
  EXPECT_NEAR(found.mode_frequency_hz, 2400.0, 1e-6);
  EXPECT_GT(found.mode_m, 0.8 * found.harmonic_m);
  EXPECT_GE(found.amplitude_m, 0.5 * found.harmonic_m);
}

// Straight from FRFs the same, without a mode.
TEST(ForcedVibration, OfMeasuredFrfs) {
  const LobesProblem modes = two_modes(700.0, 1500.0, 0.1);
  LobesProblem measured = modes;
  measured.measured = modal::synthesize(modes.dynamics, Eigen::VectorXd::LinSpaced(8001, 0.0, 8000.0));
  measured.dynamics = {};
  const OperatingPoint point{9000 * rpm, 0.5e-3};
  const ForcedVibration a = ForcedResponse(modes).at(point);
  const ForcedVibration b = ForcedResponse(measured).at(point);
  EXPECT_NEAR(b.amplitude_m, a.amplitude_m, 0.01 * a.amplitude_m);
  EXPECT_EQ(b.harmonic, a.harmonic);
  EXPECT_FALSE(b.mode.known());
}

TEST(ForcedVibration, GrowsWithTheFeedAndNotWithoutForce) {
  LobesProblem p = two_modes(700.0, 1500.0, 0.1);
  const OperatingPoint point{9000 * rpm, 0.5e-3};
  const double once = ForcedResponse(p).at(point).amplitude_m;
  p.milling.feed_per_tooth_m *= 2.0;
  EXPECT_NEAR(ForcedResponse(p).at(point).amplitude_m, 2.0 * once, 1e-9 * once);
  p.milling.feed_per_tooth_m = 0.0;
  EXPECT_EQ(test::field_of([&] { ForcedResponse response(p); }), "feed_per_tooth_m");
}

}  // namespace forced_vibration_test
}  // namespace robomill::stability
