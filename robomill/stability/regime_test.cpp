// What makes a cut chatter.
#include "robomill/stability/regime.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robomill/stability/peak_classification.hpp"
#include "testing/stability/problems.hpp"
#include "testing/stability/spatial_cases.hpp"

namespace robomill::stability {
namespace regime_test {

using testing::rpm;

// Two ways: the pieces of collocation, and Runge-Kutta's rule over the angle.
TEST(Regime, RadiusWithoutDelayIsThatOfIntegration) {
  const auto compare = [](const LobesProblem& problem, const OperatingPoint& point) {
    const ChatterMechanism known = chatter_mechanism(problem, point);
    const RegimeResult found = regime_at(problem, point, 1e-6);
    ASSERT_NE(found.regime, Regime::stable);
    EXPECT_NEAR(found.without_delay, known.without_delay, 1e-5 * known.without_delay);
    EXPECT_EQ(found.regime == Regime::mode_coupling, known.kind == ChatterMechanism::Kind::mode_coupling);
  };
  compare(testing::benchmark(0.3), {5000 * rpm, 1e-3});
  compare(testing::benchmark(1.0), {5000 * rpm, 1e-3});
  compare(testing::robot(), {6500 * rpm, 0.8e-3});
  LobesProblem uneven = testing::benchmark(0.5);
  uneven.milling.tool.pitch_rad = {3.0, 2.0 * std::numbers::pi - 3.0};
  compare(uneven, {5000 * rpm, 1.5e-3});
}

LobesProblem one_mode(double frequency_hz, double modal_mass_kg) {
  LobesProblem problem = testing::spatial_references()[0].problem;
  problem.dynamics = testing::spatial_model({{frequency_hz, 0.02, modal_mass_kg, Eigen::Vector3d(0.6, 0.8, 0.0)}});
  return problem;
}

// Less than half a wave between two teeth is the arm's own; many waves are a lower bound.
TEST(Regime, IsNamedByTheWavesBetweenTwoTeeth) {
  const auto at_first_unstable = [](const LobesProblem& problem, double speed_rpm) {
    OperatingPoint point = {speed_rpm * rpm, 1e-3};
    for (point.gain = 1.0; point.gain < 1e4; point.gain *= 1.2) {
      const PointResult result = evaluate_point(problem, {}, point);
      if (!result.stable) return std::pair(regime_at(problem, point), result.chatter_frequency_hz);
    }
    return std::pair(RegimeResult{}, 0.0);
  };
  for (const double speed_rpm : {2000.0, 6100.0, 12300.0}) {
    const auto [slow, slow_hz] = at_first_unstable(one_mode(20.0, 30.0), speed_rpm);
    if (slow.regime == Regime::stable) continue;
    EXPECT_NEAR(slow.waves_between_teeth, slow_hz * 30.0 / speed_rpm, 1e-9 + 1e-6 * slow.waves_between_teeth);
    EXPECT_EQ(slow.regime == Regime::low_frequency, slow.waves_between_teeth < 0.5 && slow.without_delay < 1.0);
    EXPECT_FALSE(slow.lower_bound);
  }
  const auto [fast, fast_hz] = at_first_unstable(one_mode(2000.0, 0.05), 2000.0);
  ASSERT_NE(fast.regime, Regime::stable);
  EXPECT_EQ(fast.lower_bound, fast_hz * 30.0 / 2000.0 > 3.0);
  EXPECT_TRUE(fast.lower_bound);
}

TEST(Regime, OfAStableCutIsNone) {
  const RegimeResult none = regime_at(testing::spatial_references()[0].problem, {12000 * rpm, 0.05e-3});
  EXPECT_EQ(none.regime, Regime::stable);
  EXPECT_EQ(to_string(none.regime), "none");
  EXPECT_EQ(to_string(Regime::mode_coupling), "mode-coupling");
  EXPECT_EQ(to_string(Regime::low_frequency), "low-frequency");
  EXPECT_EQ(to_string(Regime::regenerative), "regenerative");
}

}  // namespace regime_test
}  // namespace robomill::stability
