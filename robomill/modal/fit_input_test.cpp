#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/modal/fit.hpp"
#include "testing/modal/fit_cases.hpp"
#include "testing/robot_modes.hpp"
#include "testing/support.hpp"

namespace robomill::modal {
namespace fit_input_test {

using Eigen::Index;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool warns_of(const FitResult& result, const std::string& text) {
  return std::any_of(result.warnings.begin(), result.warnings.end(),
                     [&](const std::string& warning) { return warning.find(text) != std::string::npos; });
}

// Two modes of a passive structure in one direction, 50 to 150 Hz.
ModalModel two_modes() {
  ModalModel model{.excitations = {Dof{}}, .responses = {Dof{}}, .modes = {}};
  for (const double frequency_hz : {80.0, 110.0}) {
    const double omega = 2.0 * std::numbers::pi * frequency_hz;
    Mode mode{.frequency_hz = frequency_hz,
              .damping_ratio = 0.02,
              .left = Eigen::VectorXcd::Ones(1),
              .right = Eigen::VectorXcd(1)};
    mode.right(0) = {0.0, -0.5 / omega};
    model.modes.push_back(mode);
  }
  return model;
}

FrfSet two_mode_frf(double noise = 0.01, Index lines = 401) {
  FrfSet set = synthesize(two_modes(), Eigen::VectorXd::LinSpaced(lines, 50.0, 150.0));
  cases::add_noise(set, noise, 4);
  return set;
}

FrfSet robot_without(const std::vector<std::string>& names) {
  FrfSet set = synthesize(data::robot_modes(), cases::robot_lines());
  cases::add_noise(set, 0.02, 1);
  std::erase_if(set.frfs, [&](const Frf& frf) {
    return std::find(names.begin(), names.end(), to_string(frf.name)) != names.end();
  });
  return set;
}

TEST(FitParts, FrfsThatShareNothingAreFittedApart) {
  const FrfSet set = robot_without({"xy", "yx"});
  const FitResult both = fit_modes(set, {});
  EXPECT_TRUE(warns_of(both, "yx, xy not measured: taken as zero"));
  const FitResult only_y = fit_modes(robot_without({"xx", "xy", "yx"}), {});
  std::vector<Mode> in_y;
  for (const Mode& mode : both.model.modes) {
    EXPECT_EQ(mode.left(0) * mode.right(1), 0.0);
    EXPECT_EQ(mode.left(1) * mode.right(0), 0.0);
    if (mode.left(1) != 0.0) in_y.push_back(mode);
  }
  ASSERT_EQ(in_y.size(), only_y.model.modes.size());
  for (std::size_t k = 0; k < in_y.size(); ++k) {
    EXPECT_NEAR(in_y[k].frequency_hz, only_y.model.modes[k].frequency_hz, 1e-9 * in_y[k].frequency_hz);
    EXPECT_NEAR(in_y[k].damping_ratio, only_y.model.modes[k].damping_ratio, 1e-9);
  }
}

TEST(FitParts, ExactlySoManyModesOverAllParts) {
  const FrfSet set = robot_without({"xy", "yx"});
  for (const int modes : {2, 7, 9}) {
    const FitResult result = fit_modes(set, {.modes = modes});
    EXPECT_EQ(static_cast<int>(result.model.modes.size()), modes);
  }
  EXPECT_THROW(static_cast<void>(fit_modes(set, {.modes = 1})), InvalidInput);
}

TEST(FitParts, AMissingFrfFollowsFromTheOthers) {
  // Left vectors that both excitations feel, so that three FRFs determine the fourth.
  ModalModel truth = data::robot_modes();
  Random random(2);
  for (Mode& mode : truth.modes)
    mode.left = 1e-2 * Eigen::Vector2cd(random.uniform(0.5, 1.0), random.uniform(0.5, 1.0));
  FrfSet set = synthesize(truth, cases::robot_lines());
  const Frf xy = set.frfs[2];
  set.frfs.erase(set.frfs.begin() + 2);
  const FitResult result = fit_modes(set, {});
  EXPECT_TRUE(warns_of(result, "xy not measured: follows"));
  const FrfSet fitted = synthesize(result.model, set.frequency_hz);
  EXPECT_LT((fitted.find(xy.name)->receptance - xy.receptance).norm(), 1e-6 * xy.receptance.norm());
}

TEST(FitParts, AZeroFrfCountsAsNotMeasured) {
  FrfSet set = robot_without({"xy", "yx"});
  set.frfs.push_back({.name = parse_frf_name("zz"), .receptance = Eigen::VectorXcd::Zero(set.frequency_hz.size())});
  const FitResult result = fit_modes(set, {});
  EXPECT_TRUE(warns_of(result, "H_zz is zero"));
  EXPECT_EQ(result.by_frf.size(), 3U);
  EXPECT_LT(result.relative_error, 0.022);
  set.frfs.erase(set.frfs.begin(), set.frfs.begin() + 2);
  EXPECT_THROW(static_cast<void>(fit_modes(set, {})), InvalidInput);
}

TEST(FitOrder, ExactlySoManyModes) {
  const FrfSet set = robot_without({});
  double before = 1.0;
  for (const int modes : {1, 4, 6, 8, 10}) {
    const FitResult result = fit_modes(set, {.modes = modes});
    EXPECT_EQ(static_cast<int>(result.model.modes.size()), modes);
    EXPECT_LT(result.relative_error, before);
    before = result.relative_error;
  }
  EXPECT_EQ(fit_modes(set, {.max_modes = 3}).model.modes.size(), 3U);
}

TEST(FitOrder, NoiseAloneHoldsNoModes) {
  FrfSet set = two_mode_frf();
  Random random(6);
  for (std::complex<double>& h : set.frfs.front().receptance) h = {random.normal(), random.normal()};
  const FitResult result = fit_modes(set, {});
  EXPECT_TRUE(result.model.modes.empty());
  EXPECT_EQ(result.status, FitResult::Status::not_converged);
  EXPECT_TRUE(warns_of(result, "No mode"));
}

TEST(FitWeights, TheNoisyHalfOfTheBandCountsLess) {
  // White noise on one half of the band only, known or not: the known deviation must give the better dampings'
  // deviations.
  FrfSet set = two_mode_frf(0.0);
  Random random(8);
  Frf& frf = set.frfs.front();
  frf.deviation = Eigen::VectorXd(set.frequency_hz.size());
  frf.coherence = frf.deviation;
  const double size = frf.receptance.cwiseAbs().maxCoeff();
  for (Index i = 0; i < frf.deviation.size(); ++i) {
    frf.deviation(i) = size * (set.frequency_hz(i) > 100.0 ? 0.1 : 0.001);
    const double ratio = std::pow(frf.deviation(i) / std::abs(frf.receptance(i)), 2);
    frf.coherence(i) = 1.0 / (1.0 + ratio);
    const double re = random.normal();
    frf.receptance(i) += frf.deviation(i) / std::numbers::sqrt2 * std::complex<double>(re, random.normal());
  }
  const FitResult deviation = fit_modes(set, {.modes = 2});
  const FitResult coherence = fit_modes(set, {.modes = 2, .weighting = Weighting::coherence});
  const FitResult none = fit_modes(set, {.modes = 2, .weighting = Weighting::none});
  EXPECT_EQ(deviation.weighting, Weighting::deviation);
  EXPECT_EQ(coherence.weighting, Weighting::coherence);
  EXPECT_NEAR(deviation.model.modes[0].frequency_hz, 80.0, 4.0 * deviation.model.modes[0].frequency_std_hz);
  EXPECT_LT(deviation.model.modes[0].frequency_std_hz, 0.1 * none.model.modes[0].frequency_std_hz);
  EXPECT_NEAR(coherence.model.modes[0].frequency_std_hz, deviation.model.modes[0].frequency_std_hz,
              0.2 * deviation.model.modes[0].frequency_std_hz);
}

TEST(FitWeights, AutomaticTakesWhatThereIs) {
  FrfSet set = two_mode_frf();
  EXPECT_EQ(fit_modes(set, {}).weighting, Weighting::estimated);
  EXPECT_THROW(static_cast<void>(fit_modes(set, {.weighting = Weighting::coherence})), InvalidInput);
  EXPECT_THROW(static_cast<void>(fit_modes(set, {.weighting = Weighting::deviation})), InvalidInput);
  set.frfs.front().coherence = Eigen::VectorXd::Ones(set.frequency_hz.size());  // of one hit
  EXPECT_EQ(fit_modes(set, {}).weighting, Weighting::estimated);
  set.frfs.front().coherence(3) = 0.9;
  EXPECT_EQ(fit_modes(set, {}).weighting, Weighting::coherence);
}

TEST(FitResultIs, TheSameAgainAndIndependentOfTheUnit) {
  const FrfSet set = two_mode_frf();
  FrfSet scaled = set;
  scaled.frfs.front().receptance *= 1024.0;
  const FitResult a = fit_modes(set, {});
  const FitResult b = fit_modes(set, {});
  const FitResult c = fit_modes(scaled, {});
  ASSERT_EQ(a.model.modes.size(), 2U);
  ASSERT_EQ(c.model.modes.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(a.model.modes[k].frequency_hz, b.model.modes[k].frequency_hz);
    EXPECT_EQ(a.model.modes[k].right, b.model.modes[k].right);
    EXPECT_NEAR(a.model.modes[k].frequency_hz, c.model.modes[k].frequency_hz, 1e-6);
    EXPECT_NEAR(a.model.modes[k].damping_ratio_std, c.model.modes[k].damping_ratio_std,
                1e-4 * a.model.modes[k].damping_ratio_std);
  }
  EXPECT_FALSE(warns_of(a, "passive"));
}

TEST(FitResultIs, FreeOfTheExponentialWindow) {
  const double decay_per_s = 6.0;
  ModalModel windowed = two_modes();
  for (Mode& mode : windowed.modes) {
    const std::complex<double> lambda = pole(mode) - decay_per_s;
    mode.frequency_hz = std::abs(lambda) / (2.0 * std::numbers::pi);
    mode.damping_ratio = -lambda.real() / std::abs(lambda);
  }
  const FrfSet set = synthesize(windowed, Eigen::VectorXd::LinSpaced(401, 50.0, 150.0));
  const FitResult result = fit_modes(set, {.exponential_decay_per_s = decay_per_s});
  const ModalModel truth = two_modes();
  ASSERT_EQ(result.model.modes.size(), truth.modes.size());
  for (std::size_t k = 0; k < truth.modes.size(); ++k) {
    EXPECT_NEAR(result.model.modes[k].frequency_hz, truth.modes[k].frequency_hz, 1e-7);
    EXPECT_NEAR(result.model.modes[k].damping_ratio, truth.modes[k].damping_ratio, 1e-9);
  }
  EXPECT_TRUE(warns_of(fit_modes(set, {.exponential_decay_per_s = 1000.0}), "decays no faster than the window"));
}

TEST(FitResultIs, MadeOfTheBandAlone) {
  FrfSet set = two_mode_frf();
  const FitResult result = fit_modes(set, {.band_low_hz = 60.1, .band_high_hz = 95.0});
  EXPECT_EQ(result.band_low_hz, 60.25);
  EXPECT_EQ(result.band_high_hz, 95.0);
  EXPECT_EQ(result.lines, 140);
  ASSERT_EQ(result.model.modes.size(), 1U);
  EXPECT_NEAR(result.model.modes[0].frequency_hz, 80.0, 0.05);
  ASSERT_EQ(result.model.residuals.size(), 1U);  // the mode at 110 Hz
  // A line at 0 Hz has no mass residual and is left out.
  set.frequency_hz(0) = 0.0;
  EXPECT_EQ(fit_modes(set, {}).lines, 400);
}

TEST(FitResultIs, StoppedByItsCaller) {
  const std::atomic<bool> stop = true;
  Progress progress({}, &stop);
  EXPECT_THROW(static_cast<void>(fit_modes(two_mode_frf(), {}, progress)), Interrupted);
}

TEST(FitInput, RejectsBadOptions) {
  const FrfSet set = two_mode_frf();
  const std::vector<std::function<void(FitOptions&)>> faults = {
      [](FitOptions& o) { o.band_low_hz = -1.0; },
      [](FitOptions& o) { o.band_low_hz = nan; },
      [](FitOptions& o) { o.band_low_hz = 200.0; },
      [](FitOptions& o) { o.band_high_hz = 10.0; },
      [](FitOptions& o) { o.band_high_hz = nan; },
      [](FitOptions& o) { o.band_low_hz = 100.0, o.band_high_hz = 100.0; },
      [](FitOptions& o) { o.band_low_hz = 100.0, o.band_high_hz = 101.0; },
      [](FitOptions& o) { o.band_low_hz = 100.1, o.band_high_hz = 100.2; },
      [](FitOptions& o) { o.modes = -1; },
      [](FitOptions& o) { o.modes = 200; },
      [](FitOptions& o) { o.modes = 201; },
      [](FitOptions& o) { o.max_modes = 0; },
      [](FitOptions& o) { o.max_damping_ratio = 0.0; },
      [](FitOptions& o) { o.max_damping_ratio = nan; },
      [](FitOptions& o) { o.exponential_decay_per_s = -1.0; },
      [](FitOptions& o) { o.exponential_decay_per_s = nan; },
      [](FitOptions& o) { o.lscf_max_order = 1; },
      [](FitOptions& o) { o.stable_frequency = 0.0; },
      [](FitOptions& o) { o.stable_damping = nan; },
      [](FitOptions& o) { o.stable_mac = 1.5; },
      [](FitOptions& o) { o.pso_particles = 1; },
      [](FitOptions& o) { o.pso_max_iterations = 0; },
      [](FitOptions& o) { o.pso_frequency_half_width = 1.0; },
      [](FitOptions& o) { o.pso_max_damping_ratio = 10.0; },
      [](FitOptions& o) { o.pso_inertia_start = 1.1; },
      [](FitOptions& o) { o.pso_inertia_end = 0.95; },
      [](FitOptions& o) { o.pso_inertia_iterations = 0; },
      [](FitOptions& o) { o.pso_cognitive = -1.0; },
      [](FitOptions& o) { o.pso_cognitive = 1e6; },
      [](FitOptions& o) { o.pso_social = 101.0; },
      [](FitOptions& o) { o.pso_social = nan; },
      [](FitOptions& o) { o.pso_velocity_fraction = 1.1; },
  };
  for (std::size_t i = 0; i < faults.size(); ++i) {
    FitOptions options;
    faults[i](options);
    EXPECT_THROW(static_cast<void>(fit_modes(set, options)), InvalidInput) << "fault " << i;
  }
}

TEST(FitInput, RejectsBadFrfs) {
  EXPECT_THROW(static_cast<void>(fit_modes({}, {})), InvalidInput);
  EXPECT_THROW(static_cast<void>(fit_modes(two_mode_frf(0.01, 10), {})), InvalidInput);
  FrfSet set = two_mode_frf();
  set.frfs.front().receptance(7) = nan;
  EXPECT_THROW(static_cast<void>(fit_modes(set, {})), InvalidInput);
  const auto too_few = [] { static_cast<void>(fit_modes(two_mode_frf(0.01, 30), {.modes = 14})); };
  EXPECT_NE(test::rejection(too_few).find("needs at least 32 lines; the band holds 30"), std::string::npos);
}

TEST(FitInput, SurvivesOddFrfs) {
  // Uneven lines.
  ModalModel truth = two_modes();
  Eigen::VectorXd lines(200);
  for (Index i = 0; i < lines.size(); ++i) lines(i) = 50.0 * std::pow(3.0, static_cast<double>(i) / 199.0);
  const FitResult uneven = fit_modes(synthesize(truth, lines), {});
  ASSERT_EQ(uneven.model.modes.size(), 2U);
  EXPECT_NEAR(uneven.model.modes[1].frequency_hz, 110.0, 1e-7);
  // A mode narrower than a line, and few lines.
  truth.modes[0].damping_ratio = 1e-4;
  const FitResult narrow = fit_modes(synthesize(truth, Eigen::VectorXd::LinSpaced(101, 50.0, 150.0)), {});
  ASSERT_EQ(narrow.model.modes.size(), 2U);
  EXPECT_NEAR(narrow.model.modes[0].damping_ratio, 1e-4, 1e-7);
  const FitResult few = fit_modes(two_mode_frf(0.0, 16), {});
  EXPECT_EQ(few.model.modes.size(), 2U);
  // One value on every line: a spring, and no mode.
  FrfSet spring = two_mode_frf();
  spring.frfs.front().receptance.setConstant(1e-6);
  EXPECT_TRUE(fit_modes(spring, {}).model.modes.empty());
  // An outlier a hundred times the largest value.
  FrfSet outlier = two_mode_frf();
  outlier.frfs.front().receptance(200) = 100.0 * outlier.frfs.front().receptance.cwiseAbs().maxCoeff();
  EXPECT_NO_THROW(static_cast<void>(fit_modes(outlier, {})));
}

}  // namespace fit_input_test
}  // namespace robomill::modal
