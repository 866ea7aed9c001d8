#include "robomill/stability/chart/cost.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"
#include "robomill/stability/uncertainty.hpp"
#include "testing/support.hpp"

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

/// Of 15 µm, a helix of 30°.
LobesProblem with_runout(int teeth) {
  LobesProblem problem = example();
  problem.milling.tool.teeth = teeth;
  problem.milling.tool.helix_rad = 30.0 * units::deg;
  problem.milling.tool.runout_m = 15e-6;
  return problem;
}

std::vector<double> speeds_of(const std::array<double, 2>& rpm, int count) {
  std::vector<double> speeds;
  for (int i = 0; i < count; ++i) speeds.push_back((rpm[0] + (rpm[1] - rpm[0]) * i / (count - 1)) * units::rpm);
  return speeds;
}

void compute(const LobesProblem& problem, const LobesOptions& options) {
  static_cast<void>(compute_lobes(problem, options));
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
    const LobesProblem problem = example(one.highest_hz == 660.0 ? 620.0 : one.highest_hz);
    const double estimate =
        1e-9 *
        detail::cost_of_looks(problem, options, speeds_of(one.rpm, one.speeds), {.a_speed = one.looks}).operations;
    EXPECT_GT(estimate, one.seconds / 4.0) << one.rpm[0] << " rpm, " << one.highest_hz << " Hz";
    EXPECT_LT(estimate, one.seconds * 4.0) << one.rpm[0] << " rpm, " << one.highest_hz << " Hz";
  }
}

// Source: the same.
TEST(LobesCost, OfRunoutWithHelixIsNearWhatWasMeasured) {
  struct Case {
    std::array<double, 2> rpm;
    int teeth, speeds;
    double tolerance, looks, seconds;
  };
  const Case cases[] = {
      {{4000.0, 16000.0}, 4, 4, 1e-6, 21.5, 5.1},
      {{4000.0, 16000.0}, 2, 4, 1e-6, 8.0, 0.73},
      {{1000.0, 1100.0}, 4, 2, 1e-6, 24.5, 6.6},
      {{4000.0, 16000.0}, 4, 4, 1e-4, 8.25, 0.31},
  };
  for (const Case& one : cases) {
    LobesOptions options = chart(one.rpm[0], one.rpm[1]);
    options.tolerance = one.tolerance;
    const Cost cost =
        detail::cost_of_looks(with_runout(one.teeth), options, speeds_of(one.rpm, one.speeds), {.a_speed = one.looks});
    EXPECT_GT(1e-9 * cost.operations, one.seconds / 2.5) << one.teeth << " teeth, tolerance " << one.tolerance;
    EXPECT_LT(1e-9 * cost.operations, one.seconds * 2.5) << one.teeth << " teeth, tolerance " << one.tolerance;
  }
}

// Source: resident memory of robomill on one thread, less that of a small chart.
TEST(LobesCost, MemoryIsThatOfAThreadHoweverManyThereAre) {
  const auto held = [](const LobesProblem& problem, const LobesOptions& options) {
    return detail::cost_of_looks(problem, options, std::array{options.spindle_speed_rad_per_s[0]}, {}).least_bytes();
  };
  const LobesProblem runout = with_runout(4);
  EXPECT_NEAR(held(example(), chart(40, 44)), 215e6, 100e6);
  EXPECT_NEAR(held(runout, chart(4000, 16000)), 640e6, 300e6);
  LobesProblem slot = example(3000.0);
  slot.milling.immersion.entry_rad = 0.0;
  slot.milling.tool.helix_rad = 30.0 * units::deg;
  const double before[] = {held(example(), chart(40, 44)), held(runout, chart(4000, 16000)),
                           held(slot, chart(400, 420))};
  set_thread_count(64);
  EXPECT_EQ(held(example(), chart(40, 44)), before[0]);
  EXPECT_EQ(held(runout, chart(4000, 16000)), before[1]);
  EXPECT_EQ(held(slot, chart(400, 420)), before[2]);
  // Where 64 threads would hold too much, fewer do it.
  set_cost_limit({.bytes = 3.5 * held(example(), chart(4000, 16000))});
  EXPECT_NO_THROW(compute(example(), chart(4000, 16000)));
  set_cost_limit({.bytes = 0.5 * held(example(), chart(4000, 16000))});
  EXPECT_THROW(compute(example(), chart(4000, 16000)), InvalidInput);
  set_cost_limit({});
  set_thread_count(0);
}

// The matrix of what fades alike is formed up to 1,200 entries, and not where modes outlive a tooth.
TEST(LobesCost, MemoryOfAMatrixIsThatOfOneThatIsFormed) {
  const auto held = [](const LobesProblem& problem, double rpm) {
    return detail::cost_of_looks(problem, chart(rpm, 2.0 * rpm), std::array{rpm * units::rpm}, {}).least_bytes();
  };
  constexpr double largest_matrices = 20.0 * 1200.0 * 1200.0 * 8.0;
  EXPECT_GT(held(example(), 40.0), 0.7 * largest_matrices);
  EXPECT_LT(held(example(), 20.0), held(example(), 40.0));
  LobesProblem lasting = example();
  for (modal::Mode& mode : lasting.dynamics.modes) mode.damping_ratio = 1e-4;
  EXPECT_LT(held(lasting, 40.0), 0.3 * largest_matrices);
}

TEST(LobesCost, OneNumberTooFarIsRejectedBeforeAnythingIsComputed) {
  EXPECT_NO_THROW(compute(example(), chart(4000, 16000)));
  const std::string fast = test::rejection([] { compute(example(500e3), chart(100, 200)); });
  EXPECT_TRUE(fast.starts_with("modes[1].frequency_hz = 500000 Hz; would take about")) << fast;
  LobesOptions slow = chart(2, 4);
  slow.method = Method::multi_frequency;
  const std::string slowly = test::rejection([&] { compute(example(), slow); });
  EXPECT_TRUE(slowly.starts_with("spindle_speed_rad_per_s = 0.20944 rad/s; would take about")) << slowly;
  LobesOptions fine = chart(4000, 16000, 20000, 20000);
  fine.output = Output::map;
  const std::string finely = test::rejection([&] { compute(example(), fine); });
  EXPECT_TRUE(finely.starts_with("grid = 20000; would take about")) << finely;
  EXPECT_NE(finely.find("of memory"), std::string::npos) << finely;
  const Uncertainty many = {.samples = 1'000'000};
  EXPECT_EQ(test::field_of([&] { static_cast<void>(uncertain_limits(example(), chart(4000, 16000), many)); }),
            "samples");
}

TEST(LobesCost, NamesManyModesAndRunout) {
  LobesProblem many = example();
  for (int i = 0; i < 58; ++i) many.dynamics.modes.push_back(many.dynamics.modes.front());
  EXPECT_EQ(
      detail::cost_of_looks(many, chart(4000, 16000), speeds_of({4000, 16000}, 60), {.a_speed = 40.0}).dominant.field,
      "modes");
  EXPECT_EQ(test::field_of([] { compute(with_runout(4), chart(4000, 16000, 800)); }), "runout_m");
}

TEST(LobesCost, OfAPointBesideTheChartNamesThePoint) {
  LobesOptions options = chart(4000, 16000, 2, 2);
  options.method = Method::multi_frequency;
  options.points = {{.spindle_speed_rad_per_s = 2.0 * units::rpm, .axial_depth_m = 1e-3}};
  const std::string text = test::rejection([&] { compute(example(), options); });
  EXPECT_TRUE(text.starts_with("points.spindle_speed_rad_per_s = 0.20944 rad/s; would take about")) << text;
}

TEST(LobesCost, OfAPointThatHoldsTooMuchNamesThePoint) {
  LobesOptions options = chart(4000, 16000, 2000, 40);
  options.points = {{.spindle_speed_rad_per_s = 40.0 * units::rpm, .axial_depth_m = 1e-3}};
  set_cost_limit({.bytes = 1e8});
  EXPECT_EQ(test::field_of([&] { compute(example(), options); }), "points.spindle_speed_rad_per_s");
  set_cost_limit({});
}

TEST(LobesCost, NoModeVibratesAtAMegahertzAndNoSpindleStandsStill) {
  const auto said = [](const LobesOptions& options) { return test::rejection([&] { compute(example(), options); }); };
  EXPECT_THROW(static_cast<void>(example(1.01e6)), InvalidInput);
  EXPECT_NE(said(chart(0.9, 16000)).find("must be at least 1 rpm"), std::string::npos);
  EXPECT_NE(said(chart(4000, 2e6)).find("must be at most 1,000,000 rpm"), std::string::npos);
}

}  // namespace lobes_cost_test
}  // namespace robomill::stability
