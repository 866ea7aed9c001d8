// The simulation as judge of cuts in three directions: random cutters, postures, modes and cuts, two methods that share
// the engagement alone.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <optional>

#include "robomill/base/error.hpp"
#include "robomill/base/random.hpp"
#include "robomill/simulation/drilling.hpp"
#include "robomill/simulation/posture.hpp"
#include "testing/simulation/cuts.hpp"
#include "testing/support.hpp"

namespace robomill::simulation {
namespace spatial_agreement_test {

using std::numbers::pi;

struct Drawn {
  stability::LobesProblem problem;
  double speed_rpm = 0.0, depth_m = 0.0;
};

Eigen::Vector3d random_direction(Random& random) {
  return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}

/// Left and right differ in direction and phase: cross-coupled, neither symmetric nor proportionally damped.
modal::Mode random_mode(Random& random, double stiffness) {
  modal::Mode mode;
  mode.frequency_hz = random.uniform(150.0, 1500.0);
  mode.damping_ratio = random.uniform(0.01, 0.05);
  const double omega = 2.0 * pi * mode.frequency_hz;
  const double size = 1.0 / std::sqrt(2.0 * stiffness / (omega * omega) * modal::pole(mode).imag());
  const Eigen::Vector3d along = random_direction(random);
  const Eigen::Vector3d twisted = (along + 0.2 * random_direction(random)).normalized();
  mode.left = along.cast<std::complex<double>>() * size;
  mode.right = twisted * std::polar(size, -0.5 * pi + random.uniform(-0.15, 0.15));
  for (Eigen::Index i = 0; i < 3; ++i) mode.right(i) *= std::polar(1.0, random.uniform(-0.05, 0.05));
  return mode;
}

modal::ModalModel random_structure(Random& random) {
  modal::ModalModel model;
  model.excitations = model.responses = {{.axis = modal::Axis::x}, {.axis = modal::Axis::y}, {.axis = modal::Axis::z}};
  const std::size_t modes = 1 + random.index(4);
  for (std::size_t k = 0; k < modes; ++k) model.modes.push_back(random_mode(random, random.uniform(1e6, 6e6)));
  if (random.index(5) == 0) model.residuals = {{.name = modal::parse_frf_name("zz"), .stiffness = 5e-9}};
  return model;
}

cutting::Cutter random_cutter(Random& random) {
  cutting::Cutter cutter;
  cutting::FlatEndMill& mill = cutter.mill;
  mill.teeth = 1 + static_cast<int>(random.index(4));
  mill.diameter_m = random.uniform(0.006, 0.016);
  if (random.index(5) != 0) mill.helix_rad = random.uniform(0.1, 0.7);
  switch (random.index(4)) {
    case 0:
      cutter.kind = cutting::CutterKind::flat_end;
      break;
    case 1:
      cutter.kind = cutting::CutterKind::bull_nose;
      cutter.corner_radius_m = random.uniform(0.15, 0.4) * mill.diameter_m;
      break;
    default:
      cutter.kind = cutting::CutterKind::ball_end;
  }
  if (mill.teeth > 1 && random.index(4) == 0) {
    mill.pitch_rad.assign(static_cast<std::size_t>(mill.teeth), 2.0 * pi / mill.teeth);
    const double shift = random.uniform(0.02, 0.3) / mill.teeth;
    mill.pitch_rad.front() += shift;
    mill.pitch_rad.back() -= shift;
  }
  if (random.index(5) == 0) {
    mill.runout_m = random.uniform(5e-6, 4e-5);
    mill.runout_angle_rad = random.uniform(0.0, 2.0 * pi);
  }
  return cutter;
}

/// Depths around the border of stability. Nothing where the cut reaches the shank.
std::optional<Drawn> draw(std::uint64_t seed) {
  Random random(2026, seed);
  Drawn drawn;
  stability::SpatialMilling milling;
  milling.cutter = random_cutter(random);
  const double diameter = milling.cutter.mill.diameter_m;
  milling.cut.direction = static_cast<cutting::MillingDirection>(random.index(3));
  milling.cut.radial_depth_m = diameter * random.uniform(0.05, 0.6);
  if (random.index(4) != 0) {
    milling.cut.lead_rad = random.uniform(-0.4, 0.4);
    milling.cut.tilt_rad = random.uniform(-0.4, 0.4);
  }
  milling.coefficients = {.tangential_n_per_m2 = {random.uniform(7e8, 2e9)},
                          .radial_n_per_m2 = {random.uniform(2e8, 8e8)},
                          .axial_n_per_m2 = {random.uniform(5e7, 3e8) * (random.index(2) == 0 ? 1.0 : -1.0)}};
  if (random.index(3) == 0) milling.coefficients.radial_n_per_m2 = {1e8, -2e8, 6e8};
  milling.feed_per_tooth_m = 5e-5;
  milling.modes_turn_with_tool = random.index(2) == 0;
  drawn.problem.dynamics = random_structure(random);
  drawn.problem.feed_direction_rad = random.uniform(0.0, 2.0 * pi);
  drawn.speed_rpm = random.uniform(2500.0, 15000.0);
  drawn.depth_m = std::pow(10.0, random.uniform(-4.0, -2.5));
  if (random.index(12) == 0) {
    cutting::Drill drill;
    drill.lips = 1 + static_cast<int>(random.index(3));
    drill.diameter_m = diameter;
    drill.point_angle_rad = random.uniform(1.6, 2.6);
    drill.coefficients = {.tangential_n_per_m2 = 8e8, .radial_n_per_m2 = 3e8};
    drawn.depth_m = 0.3 * diameter * random.uniform(0.05, 1.0);
    drawn.problem.drilling = drill;
    return drawn;
  }
  milling.cut.axial_depth_m = drawn.depth_m;
  drawn.problem.spatial = milling;
  try {
    static_cast<void>(cutting::engage(milling.cutter, milling.cut));
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
  return drawn;
}

SmallVibration simulated(const Drawn& drawn) {
  const double speed = drawn.speed_rpm * testing::rpm;
  const modal::TipModes structure = stability::tip_modes(drawn.problem);
  if (drawn.problem.drilling) {
    DrillingCut cut;
    static_cast<cutting::Drill&>(cut) = *drawn.problem.drilling;
    cut.radial_width_m = drawn.depth_m;
    cut.feed_per_revolution_m = 1e-4;
    cut.structure = structure;
    cut.spindle_speed_rad_per_s = speed;
    return small_vibration(cut);
  }
  const stability::SpatialMilling& milling = *drawn.problem.spatial;
  PostureCut cut;
  cut.cutter = milling.cutter;
  cut.engagement = cutting::engage(milling.cutter, milling.cut,
                                   {.slices = milling.cutter.kind == cutting::CutterKind::ball_end ? 60 : 120});
  cut.coefficients = milling.coefficients;
  cut.motion = {.feed_per_tooth_m = milling.feed_per_tooth_m, .spindle_speed_rad_per_s = speed};
  cut.structure = milling.modes_turn_with_tool ? modal::turned(structure, cut.engagement.feed_from_tool) : structure;
  return small_vibration(cut);
}

TEST(SpatialAgreement, OfSmallVibrationAndFloquetTheoryOverRandomCuts) {
  int compared = 0, unstable = 0, drawn_cuts = 0;
  for (int seed = 0; seed < test::seeds(300); ++seed) {
    const std::optional<Drawn> drawn = draw(static_cast<std::uint64_t>(seed));
    if (!drawn) continue;
    ++drawn_cuts;
    const SmallVibration small = simulated(*drawn);
    const stability::PointResult point = stability::evaluate_point(drawn->problem, {.tolerance = 1e-5},
                                                                   {drawn->speed_rpm * testing::rpm, drawn->depth_m});
    const double expected = point.spectral_radius;
    if (expected > 1e6) continue;  // the simulation's snapshots overflow
    ASSERT_EQ(small.status, SmallVibration::Status::found) << seed;
    if (expected > 0.5 && expected < 3.0) {
      // Which tooth misses changes along the profile, where neither places a ring.
      const double share = drawn->problem.spatial && drawn->problem.spatial->cutter.mill.runout_m > 0.0 ? 0.02 : 2e-3;
      EXPECT_NEAR(small.spectral_radius, expected, share * expected + small.error_estimate) << seed;
    }
    if (std::abs(expected - 1.0) <= 0.03) continue;
    ++compared;
    unstable += expected > 1.0 ? 1 : 0;
    EXPECT_EQ(small.spectral_radius < 1.0, expected < 1.0) << seed;
  }
  EXPECT_GE(compared, drawn_cuts * 8 / 10);
  EXPECT_GE(unstable, compared / 5);
  EXPECT_LE(unstable, compared * 4 / 5);
}

}  // namespace spatial_agreement_test
}  // namespace robomill::simulation
