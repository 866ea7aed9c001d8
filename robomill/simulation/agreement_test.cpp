// The simulation as judge of the lobes: random cuts, two methods that share no code.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robomill/base/random.hpp"
#include "testing/simulation/cuts.hpp"
#include "testing/support.hpp"

namespace robomill::simulation {
namespace agreement_test {

using std::numbers::pi;

struct Drawn {
  stability::LobesProblem problem;
  double speed_rpm = 0.0, depth_m = 0.0;
};

modal::Mode random_mode(Random& random, double stiffness) {
  const double frequency = random.uniform(150.0, 1500.0);
  const double omega = 2.0 * pi * frequency;
  modal::Mode mode =
      stability::testing::mass_mode(0, frequency, random.uniform(0.01, 0.05), stiffness / (omega * omega));
  // Turned in the plane, a little twisted, and not quite symmetric.
  const double angle = random.uniform(0.0, pi), twist = random.uniform(-0.2, 0.2), phase = random.uniform(-0.15, 0.15);
  const std::complex<double> left = mode.left(0), right = mode.right(0) * std::polar(1.0, phase);
  mode.left << left * std::cos(angle), left * std::sin(angle);
  mode.right << right * std::cos(angle + twist), right * std::sin(angle + twist);
  return mode;
}

/// Every feature of a cut by itself and with others; depths around the border of stability.
Drawn draw(std::uint64_t seed) {
  Random random(2024, seed);
  Drawn drawn;
  stability::LobesProblem& p = drawn.problem;
  cutting::Milling& milling = p.milling;
  milling.tool.teeth = 1 + static_cast<int>(random.index(4));
  milling.tool.diameter_m = random.uniform(0.008, 0.02);
  milling.feed_per_tooth_m = 6e-5;
  const double width = random.uniform(0.4, 1.8);
  milling.immersion.entry_rad = random.index(2) == 0 ? 0.0 : random.uniform(0.0, pi - width);
  milling.immersion.exit_rad = milling.immersion.entry_rad + width;
  if (random.index(5) == 0) milling.immersion = {0.0, pi};
  milling.coefficients = {.tangential_n_per_m2 = random.uniform(5e8, 1e9), .radial_n_per_m2 = random.uniform(1e8, 4e8)};
  p.feed_direction_rad = random.uniform(0.0, 2.0 * pi);
  p.dynamics = stability::testing::plane_model({});
  const std::size_t modes = 1 + random.index(3);
  for (std::size_t k = 0; k < modes; ++k) p.dynamics.modes.push_back(random_mode(random, random.uniform(2e6, 8e6)));
  if (random.index(4) == 0) {
    p.workpiece_dynamics = stability::testing::plane_model({random_mode(random, random.uniform(4e6, 2e7))});
  }
  if (random.index(4) == 0) p.dynamics.residuals = {{.name = modal::parse_frf_name("xx"), .stiffness = 5e-9}};
  if (random.index(3) == 0) milling.tool.helix_rad = random.uniform(0.1, 0.7);
  if (milling.tool.teeth > 1 && random.index(3) == 0) {
    milling.tool.pitch_rad.assign(static_cast<std::size_t>(milling.tool.teeth), 2.0 * pi / milling.tool.teeth);
    const double shift = random.uniform(0.02, 0.3) / milling.tool.teeth;
    milling.tool.pitch_rad.front() += shift;
    milling.tool.pitch_rad.back() -= shift;
  }
  if (random.index(5) == 0) {
    milling.tool.runout_m = random.uniform(5e-6, 6e-5);
    milling.tool.runout_angle_rad = random.uniform(0.0, 2.0 * pi);
  }
  if (random.index(5) == 0) milling.process_damping = {.indentation_n_per_m3 = 3e13, .wear_land_m = 5e-5};
  if (random.index(6) == 0) {
    milling.speed_variation = {.amplitude_ratio = random.uniform(0.05, 0.3), .frequency_ratio = 0.5};
  }
  drawn.speed_rpm = random.uniform(2500.0, 15000.0);
  drawn.depth_m = std::pow(10.0, random.uniform(-3.2, -2.0));
  return drawn;
}

/// Floquet theory's |multiplier| of the simulation's own period: of a swinging speed the lobes give it per revolution.
double floquet_radius(const Drawn& drawn, double period_s) {
  const stability::PointResult point =
      stability::evaluate_point(drawn.problem, {}, {drawn.speed_rpm * testing::rpm, drawn.depth_m});
  const double turns = period_s * drawn.speed_rpm / 60.0;
  return turns > 1.5 ? std::pow(point.spectral_radius, turns) : point.spectral_radius;
}

// Both judge the same equation; 200 points reach from dead stable to multipliers of thousands.
TEST(Agreement, OfSmallVibrationAndFloquetTheoryOverRandomCuts) {
  int compared = 0, unstable = 0;
  for (int seed = 0; seed < test::seeds(200); ++seed) {
    const Drawn drawn = draw(static_cast<std::uint64_t>(seed));
    const MillingCut cut = testing::cut_of(drawn.problem, drawn.speed_rpm, drawn.depth_m);
    const SmallVibration small = small_vibration(cut);
    ASSERT_EQ(small.status, SmallVibration::Status::found) << seed;
    const double expected = floquet_radius(drawn, small.period_s);
    const cutting::Milling& milling = drawn.problem.milling;
    if (milling.tool.runout_m == 0.0) {
      EXPECT_NEAR(small.spectral_radius, expected, 2e-3 * expected + small.error_estimate) << seed;
    }
    if (std::abs(expected - 1.0) <= 0.03) continue;
    ++compared;
    unstable += expected > 1.0 ? 1 : 0;
    EXPECT_EQ(small.spectral_radius < 1.0, expected < 1.0) << seed;
  }
  EXPECT_GE(compared, test::seeds(200) * 9 / 10);
  EXPECT_GE(unstable, compared / 4);
  EXPECT_LE(unstable, compared * 3 / 4);
}

// The full cut, which may lose contact. It may settle on a periodic motion that its linear part does not know (a
// multiplier beyond +1 leads to another motion of the same period), or be kept chattering by teeth that miss: that
// happens in 1 of 100 of these cuts.
TEST(Agreement, OfTheFullCutsVerdictAndFloquetTheoryOverRandomCuts) {
  int compared = 0, differ = 0;
  for (int seed = 0; seed < test::seeds(100); ++seed) {
    const Drawn drawn = draw(static_cast<std::uint64_t>(seed));
    const MillingCut cut = testing::cut_of(drawn.problem, drawn.speed_rpm, drawn.depth_m);
    const Simulation full = simulate(cut, {.seconds = 0.5, .sample_rate_hz = 4096.0});
    const double expected = floquet_radius(drawn, full.period_s);
    if (std::abs(expected - 1.0) <= 0.03) continue;
    ++compared;
    const bool agrees = full.verdict == (expected < 1.0 ? Verdict::stable : Verdict::chatter);
    differ += agrees ? 0 : 1;
  }
  EXPECT_LE(differ, compared / 50);
}

}  // namespace agreement_test
}  // namespace robomill::simulation
