#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>

#include "robomill/modal/fit.hpp"
#include "testing/modal/fit_cases.hpp"

namespace robomill::modal {
namespace fit_report_test {

// Modes of 2 % damping at 80 and 110 Hz, 50 to 150 Hz.
FrfSet two_modes(double noise) {
  ModalModel model{.excitations = {Dof{}}, .responses = {Dof{}}, .modes = {}};
  for (const double frequency_hz : {80.0, 110.0}) {
    model.modes.push_back({.frequency_hz = frequency_hz,
                           .damping_ratio = 0.02,
                           .left = Eigen::VectorXcd::Ones(1),
                           .right = Eigen::VectorXcd::Constant(1, {0.0, -0.25 / (std::numbers::pi * frequency_hz)})});
  }
  FrfSet set = synthesize(model, Eigen::VectorXd::LinSpaced(401, 50.0, 150.0));
  cases::add_noise(set, noise, 4);
  return set;
}

std::string all_of(const std::vector<std::string>& warnings) {
  std::string text;
  for (const std::string& warning : warnings) text += warning + "\n";
  return text;
}

// Noise of a share of |H| on every line is what any fit leaves.
TEST(FitError, IsDoubtfulFromFivePercentAndUnusableFromTwenty) {
  const FitResult good = fit_modes(two_modes(0.02), {});
  EXPECT_LT(good.relative_error, doubtful_fit_error);
  EXPECT_TRUE(good.usable());
  EXPECT_EQ(all_of(good.warnings).find("differ"), std::string::npos);

  const FitResult doubtful = fit_modes(two_modes(0.1), {});
  EXPECT_GT(doubtful.relative_error, doubtful_fit_error);
  EXPECT_TRUE(doubtful.usable());
  EXPECT_NE(all_of(doubtful.warnings).find("The fit differs from the FRFs by"), std::string::npos);

  FitResult unusable = fit_modes(two_modes(0.4), {});
  EXPECT_GT(unusable.relative_error, unusable_fit_error);
  EXPECT_FALSE(unusable.usable());
  EXPECT_NE(all_of(unusable.warnings).find("The modes do not describe the FRFs"), std::string::npos);
  unusable.accepted = true;
  EXPECT_TRUE(unusable.usable());
}

TEST(FitBounds, ModesThatStandThereAreNamed) {
  const FitResult free = fit_modes(two_modes(0.02), {.modes = 2});
  EXPECT_TRUE(free.at_bounds.empty());

  const FitResult damped = fit_modes(two_modes(0.02), {.modes = 2, .max_damping_ratio = 0.01});
  ASSERT_FALSE(damped.at_bounds.empty());
  for (const ModeAtBound& at : damped.at_bounds) {
    EXPECT_EQ(at.bound, FitBound::damping);
    EXPECT_DOUBLE_EQ(damped.model.modes[static_cast<std::size_t>(at.mode - 1)].damping_ratio, 0.01);
  }
  EXPECT_NE(all_of(damped.warnings).find("bound of the damping ratio, 0.01"), std::string::npos);

  // The swarm has a bound of its own, which is the one to loosen.
  FitOptions swarm{.method = FitMethod::pso, .modes = 2};
  swarm.pso_max_damping_ratio = 0.01;
  swarm.pso_max_iterations = 50;
  const FitResult by_swarm = fit_modes(two_modes(0.02), swarm);
  ASSERT_FALSE(by_swarm.at_bounds.empty());
  EXPECT_EQ(std::string(to_string(by_swarm.at_bounds[0].bound)), "pso_max_damping_ratio");

  // The second mode lies outside: what is asked for beyond the first ends at the edge.
  const FitResult cut = fit_modes(two_modes(0.0), {.band_high_hz = 105.0, .modes = 2, .residuals = false});
  ASSERT_EQ(cut.at_bounds.size(), 1U);
  EXPECT_EQ(cut.at_bounds[0].mode, 2);
  EXPECT_EQ(cut.at_bounds[0].bound, FitBound::band_high);
  EXPECT_EQ(cut.bounds_of(2), std::vector<FitBound>{FitBound::band_high});
  EXPECT_NE(all_of(cut.warnings).find("stands at the upper end of the band"), std::string::npos);
}

}  // namespace fit_report_test
}  // namespace robomill::modal
