#include "robomill/stability/uncertainty.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "testing/stability/problems.hpp"
#include "testing/stability/spatial_cases.hpp"

namespace robomill::stability {
namespace uncertainty_test {

using testing::benchmark;
using testing::rpm;

LobesOptions small_chart() {
  LobesOptions options;
  options.spindle_speed_rad_per_s = {5000 * rpm, 10000 * rpm};
  options.axial_depth_m = {0.0, 30e-3};
  options.grid = {5, 60};
  return options;
}

TEST(Uncertainty, NothingUncertainIsTheLimitItself) {
  Uncertainty none;
  none.grid = {5, 60};
  none.samples = 20;
  const UncertainLimits limits = uncertain_limits(benchmark(0.05), small_chart(), none);
  std::vector<double> speeds(limits.spindle_speed_rad_per_s.begin(), limits.spindle_speed_rad_per_s.end());
  const std::vector<Limit> exact = limit_depths(benchmark(0.05), small_chart(), speeds);
  for (Eigen::Index s = 0; s < 5; ++s) {
    ASSERT_EQ(exact[static_cast<std::size_t>(s)].status, Limit::Status::found);
    const double depth = exact[static_cast<std::size_t>(s)].axial_depth_m;
    EXPECT_EQ(limits.limit_5_percent_m(s), depth);
    EXPECT_EQ(limits.limit_95_percent_m(s), depth);
    for (Eigen::Index d = 0; d < limits.axial_depth_m.size(); ++d) {
      EXPECT_EQ(limits.chatter_probability(d, s), limits.axial_depth_m(d) >= depth ? 1.0 : 0.0);
    }
  }
}

// For a mode whose residue alone is uncertain, the limit is inversely proportional to it: the
// quantiles are those of 1 / normal.
TEST(Uncertainty, QuantilesOfAKnownDistribution) {
  Uncertainty residue;
  residue.grid = {2, 20};
  residue.samples = 4000;
  residue.residue_std_ratio = 0.05;
  LobesProblem problem = benchmark(0.05, 1);
  LobesOptions options = small_chart();
  options.grid = {2, 20};
  options.axial_depth_m = {0.0, 10e-3};
  const double exact = limit_depths(problem, options, {5000 * rpm}).front().axial_depth_m;
  const UncertainLimits limits = uncertain_limits(problem, options, residue);
  // A mode that knows its own is drawn with it.
  Uncertainty none = residue;
  none.residue_std_ratio = 0.3;
  problem.dynamics.modes[0].residue_std_ratio = 0.05;
  EXPECT_EQ(uncertain_limits(problem, options, none).limit_5_percent_m, limits.limit_5_percent_m);
  const double z = 1.6448536;
  EXPECT_NEAR(limits.limit_5_percent_m(0), exact / (1.0 + 0.05 * z), 3e-3 * exact);
  EXPECT_NEAR(limits.limit_50_percent_m(0), exact, 3e-3 * exact);
  EXPECT_NEAR(limits.limit_95_percent_m(0), exact / (1.0 - 0.05 * z), 5e-3 * exact);
}

// The limit is inversely proportional to the coefficients together, as it is to the residue: b ~ 1 / (K G).
TEST(Uncertainty, OneFactorMovesAllCoefficients) {
  Uncertainty factor;
  factor.grid = {2, 200};
  factor.samples = 4000;
  factor.coefficient_std_ratio = 0.3;
  LobesOptions options = small_chart();
  options.grid = {2, 20};
  options.axial_depth_m = {0.0, 10e-3};
  const LobesProblem problem = benchmark(0.05, 1);
  const double exact = limit_depths(problem, options, {5000 * rpm}).front().axial_depth_m;
  const UncertainLimits limits = uncertain_limits(problem, options, factor);
  const double z = 1.6448536;
  EXPECT_NEAR(limits.limit_5_percent_m(0), exact / (1.0 + 0.3 * z), 0.02 * exact);
  EXPECT_NEAR(limits.limit_50_percent_m(0), exact, 0.02 * exact);
  EXPECT_NEAR(limits.limit_95_percent_m(0), exact / (1.0 - 0.3 * z), 0.12 * exact);
  // Each for itself they compensate each other in part.
  Uncertainty own = factor;
  own.coefficient_std_ratio = 0.0;
  own.tangential_std_n_per_m2 = 0.3 * problem.milling.coefficients.tangential_n_per_m2;
  own.radial_std_n_per_m2 = 0.3 * problem.milling.coefficients.radial_n_per_m2;
  EXPECT_NE(uncertain_limits(problem, options, own).limit_5_percent_m, limits.limit_5_percent_m);
}

TEST(Uncertainty, ProbabilityRisesWithDepthAndOrdersQuantiles) {
  Uncertainty u;
  u.samples = 60;
  u.grid = {5, 60};
  u.tangential_std_n_per_m2 = 6e7;
  u.frequency_std_ratio = 0.01;
  u.damping_std_ratio = 0.2;
  const UncertainLimits limits = uncertain_limits(benchmark(0.05), small_chart(), u);
  for (Eigen::Index s = 0; s < 5; ++s) {
    EXPECT_LT(limits.limit_5_percent_m(s), limits.limit_50_percent_m(s));
    EXPECT_LT(limits.limit_50_percent_m(s), limits.limit_95_percent_m(s));
    for (Eigen::Index d = 1; d < limits.axial_depth_m.size(); ++d) {
      EXPECT_GE(limits.chatter_probability(d, s), limits.chatter_probability(d - 1, s));
    }
  }
}

TEST(Uncertainty, SameBitsAtAnyNumberOfThreads) {
  Uncertainty u;
  u.samples = 40;
  u.grid = {5, 60};
  u.damping_std_ratio = 0.2;
  u.radial_std_n_per_m2 = 2e7;
  set_thread_count(1);
  const UncertainLimits one = uncertain_limits(benchmark(0.05), small_chart(), u);
  set_thread_count(5);
  const UncertainLimits five = uncertain_limits(benchmark(0.05), small_chart(), u);
  set_thread_count(0);
  EXPECT_EQ(one.chatter_probability, five.chatter_probability);
  EXPECT_EQ(one.limit_5_percent_m, five.limit_5_percent_m);
  u.seed = 2;
  EXPECT_NE(one.limit_5_percent_m, uncertain_limits(benchmark(0.05), small_chart(), u).limit_5_percent_m);
}

TEST(Uncertainty, RejectsWhatCannotBe) {
  const auto field = [](auto change) -> std::string {
    Uncertainty u;
    u.samples = 100;
    change(u);
    try {
      u.validate();
    } catch (const InvalidInput& error) {
      return error.parts().field;
    }
    return "accepted";
  };
  EXPECT_EQ(field([](Uncertainty&) {}), "accepted");
  EXPECT_EQ(field([](Uncertainty& u) { u.samples = 0; }), "samples");
  EXPECT_EQ(field([](Uncertainty& u) { u.samples = 2'000'000; }), "samples");
  EXPECT_EQ(field([](Uncertainty& u) { u.coefficient_std_ratio = 1.5; }), "coefficient_std_ratio");
  EXPECT_EQ(field([](Uncertainty& u) { u.grid = {1, 20}; }), "grid");
  EXPECT_EQ(field([](Uncertainty& u) { u.tangential_std_n_per_m2 = -1.0; }), "tangential_std_n_per_m2");
  EXPECT_EQ(field([](Uncertainty& u) { u.radial_std_n_per_m2 = std::nan(""); }), "radial_std_n_per_m2");
  EXPECT_EQ(field([](Uncertainty& u) { u.frequency_std_ratio = 2.0; }), "frequency_std_ratio");
  EXPECT_EQ(field([](Uncertainty& u) { u.damping_std_ratio = 10.0; }), "damping_std_ratio");
  EXPECT_EQ(field([](Uncertainty& u) { u.residue_std_ratio = 5.0; }), "residue_std_ratio");
}

TEST(Uncertainty, DrawsTheCoefficientsOfACutInThreeDirections) {
  const LobesProblem problem = testing::spatial_references()[0].problem;
  LobesOptions options;
  options.spindle_speed_rad_per_s = {11500.0 * testing::rpm, 12000.0 * testing::rpm};
  options.axial_depth_m = {0.0, 0.6e-3};
  Uncertainty u;
  u.samples = 20;
  u.grid = {2, 13};
  u.tangential_std_n_per_m2 = 1e8;
  const UncertainLimits wide = uncertain_limits(problem, options, u);
  EXPECT_GT(wide.limit_95_percent_m(1), 1.02 * wide.limit_5_percent_m(1));
  u.tangential_std_n_per_m2 = 0.0;
  const UncertainLimits narrow = uncertain_limits(problem, options, u);
  EXPECT_EQ(narrow.limit_95_percent_m(1), narrow.limit_5_percent_m(1));
  EXPECT_NEAR(narrow.limit_50_percent_m(1), 0.3295839e-3, 2e-9);
}

}  // namespace uncertainty_test
}  // namespace robomill::stability
