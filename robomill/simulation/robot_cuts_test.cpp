// The cuts of [RobotMillingChatter] by the lobes and by the simulation. Its spectra name 324.99 Hz, three rotations, as
// chatter; docs/errata.md has how its cuts are read.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "robomill/stability/lobes.hpp"
#include "testing/simulation/cuts.hpp"

namespace robomill::simulation {
namespace robot_cuts_test {

using stability::Limit;
using testing::rpm;

/// Two teeth and a feed along the modes' y: the reading that docs/errata.md infers.
stability::LobesProblem as_read() {
  stability::LobesProblem problem = stability::testing::robot();
  problem.milling.tool.teeth = 2;
  problem.feed_direction_rad = 0.5 * std::numbers::pi;
  return problem;
}

// 6,500 rpm stands beneath a lobe of period doubling that begins 2 % above it: from 6,650 rpm on the limit is that of
// 2.5 times tooth passing, and 324.99 Hz is 1.5 times.
TEST(RobotCuts, DoubleTheirPeriodTwoPercentAbove6500Rpm) {
  stability::LobesOptions options;
  options.axial_depth_m = {0.0, 5e-3};
  options.grid = {2, 100};
  const std::vector<Limit> limits = limit_depths(as_read(), options, {6500.0 * rpm, 6600.0 * rpm, 6650.0 * rpm});
  EXPECT_EQ(limits[0].kind, stability::BifurcationType::hopf);
  EXPECT_NEAR(1e3 * limits[0].axial_depth_m, 0.59, 0.005);
  EXPECT_EQ(limits[1].kind, stability::BifurcationType::hopf);
  EXPECT_EQ(limits[2].kind, stability::BifurcationType::flip);
  const double tooth_passing_hz = 6650.0 / 60.0 * 2.0;
  EXPECT_NEAR(limits[2].chatter_frequency_hz / tooth_passing_hz, 2.5, 1e-6);
  // The simulation, which shares no code with the lobes.
  const SmallVibration small = small_vibration(testing::cut_of(as_read(), 6650.0, 0.8e-3, 1e-5));
  ASSERT_EQ(small.status, SmallVibration::Status::found);
  EXPECT_LT(small.multiplier.real(), -1.0);
  EXPECT_NEAR(small.multiplier.imag(), 0.0, 1e-3);
}

/// Amplitude of the acceleration in x at a multiple of rotation, over the last whole revolutions [m/s²].
double amplitude(const Simulation& cut, double rotation_hz, int multiple) {
  const auto samples = static_cast<Eigen::Index>(std::lround(40.0 / rotation_hz * cut.sample_rate_hz));
  const Eigen::VectorXd x = cut.acceleration_m_per_s2.col(0).tail(samples);
  std::complex<double> sum = 0.0;
  for (Eigen::Index i = 0; i < samples; ++i) {
    const double turn = multiple * rotation_hz * static_cast<double>(i) / cut.sample_rate_hz;
    sum += x(i) * std::polar(1.0, -2.0 * std::numbers::pi * turn);
  }
  return 2.0 * std::abs(sum) / static_cast<double>(samples);
}

// Three rotations are no multiple of two teeth's passing. Period doubling puts a line there, and so does runout in a
// cut that does not chatter: the peak alone does not distinguish the two.
TEST(RobotCuts, PeriodDoublingAndRunoutBothPutALineAtThreeRotations) {
  const double speed_rpm = 6650.0, rotation_hz = speed_rpm / 60.0;
  const SimulationOptions options = {.seconds = 3.0, .sample_rate_hz = 240.0 * rotation_hz / 4.0};
  const auto lines = [&](double depth_m, double runout_m) {
    MillingCut cut = testing::cut_of(as_read(), speed_rpm, depth_m, 1e-5);
    cut.milling.tool.runout_m = runout_m;
    const Simulation done = simulate(cut, options);
    return std::array<double, 2>{amplitude(done, rotation_hz, 2), amplitude(done, rotation_hz, 3)};
  };
  const auto [quiet_tooth, quiet_three] = lines(0.2e-3, 0.0);
  const auto [doubled_tooth, doubled_three] = lines(0.8e-3, 0.0);
  const auto [runout_tooth, runout_three] = lines(0.2e-3, 3e-6);
  EXPECT_LT(quiet_three, 0.01 * quiet_tooth);
  EXPECT_GT(doubled_three, 0.2 * doubled_tooth);
  EXPECT_GT(runout_three, 0.2 * runout_tooth);
}

}  // namespace robot_cuts_test
}  // namespace robomill::simulation
