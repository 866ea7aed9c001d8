#include "robomill/modal/fitting/lscf.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robomill/modal/fit.hpp"
#include "testing/modal/fit_cases.hpp"

namespace robomill::modal {
namespace lscf_test {

using Eigen::Index;

// Four modes, one in each quarter of the band 100 to 500 Hz; two excitations, three responses.
ModalModel four_quarters() {
  Random random(12);
  ModalModel model{.excitations = {{.axis = Axis::x}, {.axis = Axis::y}},
                   .responses = {{.axis = Axis::x}, {.axis = Axis::y}, {.axis = Axis::z}},
                   .modes = {}};
  for (const double frequency_hz : {130.0, 270.0, 350.0, 480.0}) {
    Mode mode{.frequency_hz = frequency_hz,
              .damping_ratio = random.uniform(0.01, 0.03),
              .left = Eigen::VectorXcd(2),
              .right = Eigen::VectorXcd(3)};
    for (std::complex<double>& v : mode.left) v = {random.normal(), random.normal()};
    for (std::complex<double>& v : mode.right) v = {1e-4 * random.normal(), 1e-4 * random.normal()};
    normalise(mode);
    model.modes.push_back(mode);
  }
  return model;
}

FrfSet measured(double noise) {
  FrfSet set = synthesize(four_quarters(), Eigen::VectorXd::LinSpaced(801, 100.0, 500.0));
  cases::add_noise(set, noise, 9);
  return set;
}

TEST(Lscf, FindsEveryPoleOfCleanFrfs) {
  const ModalModel truth = four_quarters();
  const FitResult result = fit_modes(measured(0.0), {.method = FitMethod::lscf, .modes = 4});
  ASSERT_EQ(result.model.modes.size(), 4U);
  EXPECT_EQ(result.status, FitResult::Status::converged);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(result.model.modes[k].frequency_hz, truth.modes[k].frequency_hz, 1e-6 * truth.modes[k].frequency_hz);
    EXPECT_NEAR(result.model.modes[k].damping_ratio, truth.modes[k].damping_ratio, 1e-4 * truth.modes[k].damping_ratio);
  }
  EXPECT_LT(result.relative_error, 1e-4);
}

TEST(Lscf, AgreesWithTheHybridFitOnNoisyFrfs) {
  const FrfSet set = measured(0.01);
  const FitResult linear = fit_modes(set, {.method = FitMethod::lscf});
  const FitResult hybrid = fit_modes(set, {});
  ASSERT_EQ(linear.model.modes.size(), 4U);
  ASSERT_EQ(hybrid.model.modes.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    const Mode& a = linear.model.modes[k];
    const Mode& b = hybrid.model.modes[k];
    EXPECT_NEAR(a.frequency_hz, b.frequency_hz, 1e-3 * b.frequency_hz);
    EXPECT_NEAR(a.damping_ratio, b.damping_ratio, 0.05 * b.damping_ratio);
    const Eigen::MatrixXcd residue = b.right * b.left.transpose();
    EXPECT_LT((a.right * a.left.transpose() - residue).norm(), 0.05 * residue.norm());
  }
  EXPECT_GE(linear.relative_error, hybrid.relative_error);
  EXPECT_NEAR(hybrid.relative_error, 0.01, 0.001);
}

TEST(Lscf, DiagramShowsThePolesStandStill) {
  const FitResult result = fit_modes(measured(0.01), {.method = FitMethod::lscf});
  for (const Mode& mode : result.model.modes) {
    int stable = 0;
    int orders = 0;
    int last = 0;
    for (const StabilisationPoint& point : result.stabilisation) {
      EXPECT_GT(point.damping_ratio, 0.0);
      EXPECT_LT(point.damping_ratio, 0.4);
      if (point.order != last) ++orders;
      last = point.order;
      const bool same = std::abs(point.frequency_hz - mode.frequency_hz) < 0.01 * mode.frequency_hz;
      stable += same && point.frequency_stable && point.damping_stable && point.vector_stable ? 1 : 0;
    }
    EXPECT_GT(stable, orders / 3) << mode.frequency_hz;
  }
}

TEST(Lscf, OneCommonDenominatorWhereAnFrfIsMissing) {
  FrfSet set = measured(0.01);
  set.frfs.erase(set.frfs.begin() + 1);
  const FitResult result = fit_modes(set, {.method = FitMethod::lscf, .modes = 4});
  const ModalModel truth = four_quarters();
  ASSERT_EQ(result.model.modes.size(), 4U);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(result.model.modes[k].frequency_hz, truth.modes[k].frequency_hz, 2e-3 * truth.modes[k].frequency_hz);
  }
  EXPECT_LT(result.relative_error, 0.05);
}

// Asked for more than stand out, it says that it has not found them.
TEST(Lscf, SaysThatThereAreNotSoMany) {
  const FitResult result = fit_modes(measured(0.05), {.method = FitMethod::lscf, .modes = 30});
  EXPECT_LT(result.model.modes.size(), 30U);
  EXPECT_EQ(result.status, FitResult::Status::not_converged);
}

}  // namespace lscf_test
}  // namespace robomill::modal
