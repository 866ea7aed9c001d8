#include "robomill/stability/surface_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "robomill/base/error.hpp"
#include "testing/stability/problems.hpp"

namespace robomill::stability {
namespace surface_error_test {

using std::numbers::pi;
using testing::benchmark;
using testing::rpm;

LobesProblem fed(double ratio) {
  LobesProblem problem = benchmark(ratio);
  problem.milling.feed_per_tooth_m = 0.1e-3;
  return problem;
}

/// Equal teeth repeat each other, so that the steady motion has no part that regenerates: it is the structure's answer
/// to the steady force, summed over its harmonics.
double y_of_harmonics(const LobesProblem& problem, const OperatingPoint& point, double angle) {
  const cutting::Milling& m = problem.milling;
  const double pitch = 2.0 * pi / m.tool.teeth;
  const int samples = 1 << 12;
  const int harmonics = 3000;
  double y = 0.0;
  for (int h = 0; h <= harmonics; ++h) {
    std::complex<double> force = 0.0;
    for (int i = 0; i < samples; ++i) {
      const double rotation = pitch * (i + 0.5) / samples;
      double sum = 0.0;
      for (int j = 0; j < m.tool.teeth; ++j) {
        const double phi = rotation + j * pitch;
        if (phi < m.immersion.entry_rad || phi > m.immersion.exit_rad) continue;
        const double chip = m.feed_per_tooth_m * std::sin(phi);
        sum -= (m.coefficients.radial_n_per_m2 * std::cos(phi) - m.coefficients.tangential_n_per_m2 * std::sin(phi)) *
               chip;
      }
      force += sum * point.axial_depth_m * std::polar(1.0, -h * 2.0 * pi * (i + 0.5) / samples) / double(samples);
    }
    const double omega = h * m.tool.teeth * point.spindle_speed_rad_per_s;
    const double natural = 2.0 * pi * 922.0;
    const std::complex<double> receptance =
        1.0 / (0.03993 * std::complex<double>(natural * natural - omega * omega, 2.0 * 0.011 * natural * omega));
    y += (h == 0 ? 1.0 : 2.0) * (receptance * force * std::polar(1.0, h * 2.0 * pi * angle / pitch)).real();
    if (h > 60 && std::abs(receptance * force) < 1e-12) break;
  }
  return y;
}

TEST(SurfaceError, OfEqualTeethIsTheStructuresAnswerToTheSteadyForce) {
  for (const double speed_rpm : {5000.0, 9000.0}) {
    const LobesProblem problem = fed(0.1);
    const OperatingPoint point{speed_rpm * rpm, 0.3e-3};
    const SurfacePoint found = surface_point(problem, point);
    ASSERT_TRUE(found.stable);
    const double expected = y_of_harmonics(problem, point, pi);
    EXPECT_NEAR(found.surface_location_error_m, expected, 1e-3 * found.peak_to_peak_y_m);
  }
}

// Far below resonance the tool deflects as a spring; down-milling leaves the wall as the last of the chip, which is
// nothing, lets it: at the exit the force is that of the edge alone.
TEST(SurfaceError, SlowCutsBendTheToolAsASpring) {
  LobesProblem problem = fed(0.1);
  for (modal::Mode& mode : problem.dynamics.modes) mode.damping_ratio = 0.7;
  problem.milling.coefficients.radial_edge_n_per_m = 20e3;
  const OperatingPoint point{300 * rpm, 0.1e-3};
  const SurfacePoint found = surface_point(problem, point);
  ASSERT_TRUE(found.stable);
  const modal::Mode& mode = problem.dynamics.modes[1];
  const double compliance = -2.0 * (mode.right(1) * mode.left(1) / modal::pole(mode)).real();
  EXPECT_NEAR(found.surface_location_error_m, 20e3 * 0.1e-3 * compliance, 0.1 * 20e3 * 0.1e-3 * compliance);
}

TEST(SurfaceError, GrowsInProportionToTheFeed) {
  LobesProblem problem = fed(0.1);
  const OperatingPoint point{8000 * rpm, 0.3e-3};
  const double once = surface_point(problem, point).surface_location_error_m;
  problem.milling.feed_per_tooth_m *= 2.0;
  EXPECT_NEAR(surface_point(problem, point).surface_location_error_m, 2.0 * once, 1e-9 * std::abs(once));
}

TEST(SurfaceError, MapHoldsTheStablePointsAlone) {
  LobesOptions options;
  options.spindle_speed_rad_per_s = {5000 * rpm, 9000 * rpm};
  options.axial_depth_m = {0.0, 3e-3};
  const SurfaceMap map = surface_map(fed(0.1), options, {5, 6});
  int stable = 0, unstable = 0;
  for (Eigen::Index s = 0; s < 5; ++s) {
    for (Eigen::Index d = 0; d < 6; ++d) {
      const OperatingPoint at{map.spindle_speed_rad_per_s(s), map.axial_depth_m(d)};
      const SurfacePoint point = surface_point(fed(0.1), at);
      ++(point.stable ? stable : unstable);
      EXPECT_EQ(point.stable, std::isfinite(map.surface_location_error_m(d, s)));
      if (!point.stable) continue;
      EXPECT_NEAR(map.surface_location_error_m(d, s), point.surface_location_error_m, 1e-4 * point.peak_to_peak_y_m);
      EXPECT_GT(map.peak_to_peak_m(d, s), 0.0);
    }
  }
  EXPECT_GT(stable, 5);
  EXPECT_GT(unstable, 5);
}

// A slot has two walls: that with the greater error counts. A cut between two depths of stock has none.
TEST(SurfaceError, TakesTheWorseWallOfASlotAndNoneWithoutAWall) {
  LobesProblem slot = fed(1.0);
  slot.milling.tool.teeth = 3;  // of two teeth one stands at either wall at once: equal and opposite errors
  const OperatingPoint point{9000 * rpm, 0.05e-3};
  const SurfacePoint found = surface_point(slot, point);
  ASSERT_TRUE(found.stable);
  const double left = -y_of_harmonics(slot, point, 0.0);
  const double right = y_of_harmonics(slot, point, pi);
  EXPECT_NEAR(found.surface_location_error_m, std::abs(left) > std::abs(right) ? left : right,
              1e-3 * found.peak_to_peak_y_m);
  EXPECT_GT(std::abs(std::abs(left) - std::abs(right)), 0.01 * found.peak_to_peak_y_m);  // they can be distinguished

  LobesProblem between = fed(0.1);
  between.milling.immersion = {.entry_rad = 0.5, .exit_rad = 1.0};
  const SurfacePoint none = surface_point(between, point);
  ASSERT_TRUE(none.stable);
  EXPECT_TRUE(std::isnan(none.surface_location_error_m));
  EXPECT_GT(none.peak_deflection_m, 0.0);
  // Between cuts the tip may be further out than in them.
  const SurfacePoint light = surface_point(fed(0.1), {9000 * rpm, 0.2e-3});
  EXPECT_GE(light.peak_deflection_m, std::abs(light.surface_location_error_m));
  EXPECT_LT(light.peak_deflection_m, 2.0 * std::hypot(light.peak_to_peak_x_m, light.peak_to_peak_y_m));
}

// An eccentric cutter's teeth finish the wall differently; which tooth is called the first does not matter.
TEST(SurfaceError, CountsEveryTooth) {
  LobesProblem problem = fed(0.1);
  problem.milling.tool.runout_m = 20e-6;
  const OperatingPoint point{9000 * rpm, 0.2e-3};
  const SurfacePoint one = surface_point(problem, point);
  problem.milling.tool.runout_angle_rad += pi;  // the other of the two teeth
  const SurfacePoint other = surface_point(problem, point);
  ASSERT_TRUE(one.stable && other.stable);
  EXPECT_NEAR(one.surface_location_error_m, other.surface_location_error_m, 1e-6 * one.peak_to_peak_y_m);
  EXPECT_NEAR(one.peak_deflection_m, other.peak_deflection_m, 1e-6 * one.peak_deflection_m);
  EXPECT_GE(one.peak_deflection_m, 0.5 * std::max(one.peak_to_peak_x_m, one.peak_to_peak_y_m));
}

TEST(SurfaceError, NeedsAFeed) {
  EXPECT_THROW(static_cast<void>(surface_point(benchmark(0.1), {8000 * rpm, 1e-4})), InvalidInput);
}

}  // namespace surface_error_test
}  // namespace robomill::stability
