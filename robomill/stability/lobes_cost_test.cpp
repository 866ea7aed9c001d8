#include "robomill/stability/lobes_cost.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/stability/uncertainty.hpp"

namespace robomill::stability {
namespace lobes_cost_test {

/// The cut of `robomill init lobes --example`: 60 degrees of the rotation.
LobesProblem example(double x_hz = 620.0, double y_hz = 660.0) {
  LobesProblem problem;
  problem.milling.tool = {.teeth = 3, .diameter_m = 0.012};
  problem.milling.immersion = {.entry_rad = 2.0 / 3.0 * std::numbers::pi, .exit_rad = std::numbers::pi};
  problem.milling.coefficients = {.tangential_n_per_m2 = 1.0414e9, .radial_n_per_m2 = 2.936e8};
  problem.milling.feed_per_tooth_m = 5e-5;
  problem.dynamics = modal::modes_from_mass({{.frequency_hz = x_hz, .damping_ratio = 0.03, .modal_mass_kg = 0.6}},
                                            {{.frequency_hz = y_hz, .damping_ratio = 0.03, .modal_mass_kg = 0.6}}, {});
  return problem;
}

LobesOptions chart(double from_rpm, double to_rpm, int speeds = 120, int depths = 40) {
  LobesOptions options;
  options.spindle_speed_rad_per_s = {from_rpm * units::rpm, to_rpm * units::rpm};
  options.axial_depth_m = {0.0, 0.006};
  options.grid = {speeds, depths};
  return options;
}

std::string rejection(const LobesProblem& problem, const LobesOptions& options) {
  try {
    static_cast<void>(compute_lobes(problem, options));
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

// Source: processor time of one core of a busy machine of two cores, 2.6 GHz; README.md, "Cost".
TEST(LobesCost, IsNearWhatWasMeasured) {
  struct Case {
    std::array<double, 2> rpm;
    int speeds;
    Method method;
    double highest_hz, looks, seconds;
  };
  const Case cases[] = {
      {{4000.0, 16000.0}, 120, Method::collocation, 660.0, 14.5, 0.03},
      {{400.0, 1600.0}, 120, Method::collocation, 660.0, 30.0, 0.18},
      {{40.0, 160.0}, 120, Method::collocation, 660.0, 25.0, 67.0},
      {{40.0, 41.0}, 2, Method::collocation, 660.0, 48.0, 8.9},
      {{10.0, 10.2}, 2, Method::collocation, 660.0, 38.0, 22.0},
      {{4000.0, 16000.0}, 120, Method::collocation, 20e3, 19.0, 0.4},
      {{4000.0, 16000.0}, 120, Method::collocation, 62e3, 19.0, 2.95},
      {{4000.0, 16000.0}, 120, Method::multi_frequency, 660.0, 1.0, 0.5},
      {{400.0, 410.0}, 2, Method::multi_frequency, 660.0, 1.0, 2.17},
      {{200.0, 201.0}, 2, Method::multi_frequency, 660.0, 1.0, 18.5},
      {{40.0, 160.0}, 120, Method::zeroth_order, 660.0, 1.0, 0.4},
  };
  for (const Case& one : cases) {
    LobesOptions options = chart(one.rpm[0], one.rpm[1]);
    options.method = one.method;
    std::vector<double> speeds;
    for (int i = 0; i < one.speeds; ++i) {
      speeds.push_back((one.rpm[0] + (one.rpm[1] - one.rpm[0]) * i / (one.speeds - 1)) * units::rpm);
    }
    const LobesProblem problem = example(one.highest_hz == 660.0 ? 620.0 : one.highest_hz);
    const double estimate = 1e-9 * detail::cost_of_looks(problem, options, speeds, {.a_speed = one.looks}).operations;
    EXPECT_GT(estimate, one.seconds / 4.0) << one.rpm[0] << " rpm, " << one.highest_hz << " Hz";
    EXPECT_LT(estimate, one.seconds * 4.0) << one.rpm[0] << " rpm, " << one.highest_hz << " Hz";
  }
}

TEST(LobesCost, OneNumberTooFarIsRejectedBeforeAnythingIsComputed) {
  EXPECT_EQ(rejection(example(), chart(4000, 16000)), "");
  const std::string fast = rejection(example(500e3), chart(100, 200));
  EXPECT_TRUE(fast.starts_with("modes[1].frequency_hz = 500000 Hz; would take about")) << fast;
  LobesOptions slow = chart(2, 4);
  slow.method = Method::multi_frequency;
  const std::string slowly = rejection(example(), slow);
  EXPECT_TRUE(slowly.starts_with("spindle_speed_rad_per_s = 0.20944 rad/s; would take about")) << slowly;
  LobesOptions fine = chart(4000, 16000, 20000, 20000);
  fine.output = Output::map;
  const std::string finely = rejection(example(), fine);
  EXPECT_TRUE(finely.starts_with("grid = 20000; would take about")) << finely;
  EXPECT_NE(finely.find("of memory"), std::string::npos) << finely;
  Uncertainty many = {.samples = 1'000'000};
  try {
    static_cast<void>(uncertain_limits(example(), chart(4000, 16000), many));
    ADD_FAILURE() << "a million samples";
  } catch (const InvalidInput& error) {
    EXPECT_EQ(error.parts().field, "samples") << error.what();
  }
}

TEST(LobesCost, OfAPointBesideTheChartNamesThePoint) {
  LobesOptions options = chart(4000, 16000, 2, 2);
  options.method = Method::multi_frequency;
  options.points = {{.spindle_speed_rad_per_s = 2.0 * units::rpm, .axial_depth_m = 1e-3}};
  const std::string text = rejection(example(), options);
  EXPECT_TRUE(text.starts_with("points.spindle_speed_rad_per_s = 0.20944 rad/s; would take about")) << text;
}

TEST(LobesCost, NoModeVibratesAtAMegahertzAndNoSpindleStandsStill) {
  EXPECT_THROW(static_cast<void>(example(1.01e6)), InvalidInput);
  EXPECT_NE(rejection(example(), chart(0.9, 16000)).find("must be at least 1 rpm"), std::string::npos);
  EXPECT_NE(rejection(example(), chart(4000, 2e6)).find("must be at most 1,000,000 rpm"), std::string::npos);
}

}  // namespace lobes_cost_test
}  // namespace robomill::stability
