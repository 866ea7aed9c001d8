#include "robomill/coupling/joint_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "robomill/base/lanes.hpp"
#include "robomill/base/random.hpp"
#include "robomill/coupling/joint_hybrid.hpp"
#include "testing/coupling/joints.hpp"

namespace robomill::coupling {
namespace joint_model_test {

using detail::JointModel;
using detail::JointValues;
using Eigen::Index;
using testing::joint_of;
using testing::model_of;
using testing::planted;
using testing::tip_with;
using testing::values_of;

// The short form against the coupling itself, from a joint that hardly holds to one that is nearly rigid.
TEST(JointModel, EqualsTheCoupling) {
  const Eigen::VectorXd frequency_hz = testing::hertz(501);
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    Joint joint = joint_of({std::pow(10.0, random.uniform(3.0, 12.0)), std::pow(10.0, random.uniform(-2.0, 4.0)),
                            std::pow(10.0, random.uniform(2.0, 12.0)), std::pow(10.0, random.uniform(-2.0, 4.0))});
    joint.cross_stiffness_n_per_rad =
        i % 2 == 0 ? 0.0
                   : random.uniform(-0.9, 0.9) *
                         std::sqrt(joint.translational_stiffness_n_per_m * joint.rotational_stiffness_n_m_per_rad);
    const modal::FrfSet expected = tip_with(testing::published_pair(), joint, frequency_hz);
    const JointModel model = model_of(testing::published_pair(), frequency_hz, joint.cross_stiffness_n_per_rad);
    JointModel::Response response;
    model.receptance(values_of(joint), response);
    for (Index line = 0; line < model.lines(); ++line) {
      const std::complex<double> found(response.real(line), response.imag(line));
      const std::complex<double> wanted = expected.frfs[0].receptance(line);
      ASSERT_LT(std::abs(found - wanted), 1e-9 * std::abs(wanted)) << i << " at " << frequency_hz(line) << " Hz";
    }
  }
}

TEST(JointModel, DerivativesAreThoseOfDifferences) {
  const JointModel model = model_of(testing::published_pair(), testing::hertz(5000));
  JointModel::Response at;
  JointModel::Response above;
  JointModel::Response below;
  model.sensitivity(planted, at);
  for (std::size_t i = 0; i < planted.size(); ++i) {
    const double step = 1e-5 * planted[i];
    JointValues moved = planted;
    moved[i] += step;
    model.receptance(moved, above);
    moved[i] -= 2.0 * step;
    model.receptance(moved, below);
    for (Index line = 0; line < model.lines(); line += 7) {
      const std::complex<double> slope((above.real(line) - below.real(line)) / (2.0 * step),
                                       (above.imag(line) - below.imag(line)) / (2.0 * step));
      const std::complex<double> along(at.along_real[i / 2](line), at.along_imag[i / 2](line));
      const std::complex<double> to_stiffness = i % 2 == 0 ? 1.0 : std::complex<double>(0.0, model.omega()(line));
      const double size = std::abs(std::complex<double>(at.real(line), at.imag(line)));
      ASSERT_NEAR(std::abs(slope + along * to_stiffness), 0.0, 1e-6 * std::abs(slope) + 1e-10 * size / planted[i])
          << i << " at line " << line;
    }
  }
}

TEST(JointModel, HasTheSameBitsWithoutWideVectors) {
  const JointModel model = model_of(testing::published_pair(), testing::hertz(1003));
  JointModel::Response wide;
  JointModel::Response narrow;
  model.sensitivity(planted, wide);
  const Kernels before = kernels();
  kernels() = Kernels::baseline;
  model.sensitivity(planted, narrow);
  kernels() = before;
  EXPECT_TRUE((wide.real == narrow.real).all());
  EXPECT_TRUE((wide.imag == narrow.imag).all());
  for (std::size_t j = 0; j < 2; ++j) EXPECT_TRUE((wide.along_imag[j] == narrow.along_imag[j]).all());
}

TEST(JointModel, ThinnedLinesStandDenseAtResonances) {
  const modal::FrfSet set = tip_with(testing::published_pair(), joint_of(planted), testing::hertz(5000));
  const Eigen::ArrayXd omega = set.frequency_hz.array();
  const std::vector<Index> lines = detail::thinned_lines(omega, set.frfs[0].receptance, 256);
  EXPECT_LE(lines.size(), 260U);
  EXPECT_GE(lines.size(), 200U);
  EXPECT_TRUE(std::ranges::is_sorted(lines));
  const double peak = testing::peak_hz(set.frequency_hz, set.frfs[0].receptance);
  const auto near = std::ranges::count_if(lines, [&](Index i) { return std::abs(set.frequency_hz(i) - peak) < 10.0; });
  EXPECT_GE(near, 10);
}

}  // namespace joint_model_test
}  // namespace robomill::coupling
