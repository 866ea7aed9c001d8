#include "robomill/modal/modes.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "robomill/base/error.hpp"
#include "testing/modal/fit_cases.hpp"
#include "testing/robot_modes.hpp"

namespace robomill::modal {
namespace modes_test {

TEST(Normalise, KeepsTheResidueAndFixesTheFreedom) {
  Random random(3);
  for (int round = 0; round < 200; ++round) {
    Mode mode;
    mode.left.resize(1 + round % 3);
    mode.right.resize(1 + round % 4);
    for (std::complex<double>& v : mode.left) v = {1e-4 * random.normal(), 1e-4 * random.normal()};
    for (std::complex<double>& v : mode.right) v = {1e3 * random.normal(), 1e3 * random.normal()};
    const Eigen::MatrixXcd residue = mode.right * mode.left.transpose();
    normalise(mode);
    const Eigen::MatrixXcd after = mode.right * mode.left.transpose();
    EXPECT_LT((after - residue).norm(), 1e-13 * residue.norm());
    EXPECT_NEAR(mode.left.norm(), mode.right.norm(), 1e-13 * mode.left.norm());
    Eigen::Index largest = 0;
    const double size = mode.left.cwiseAbs().maxCoeff(&largest);
    EXPECT_EQ(mode.left(largest).imag(), 0.0);
    EXPECT_EQ(mode.left(largest).real(), size);
  }
}

TEST(Normalise, ZeroResidueAndFaults) {
  Mode mode;
  EXPECT_THROW(normalise(mode), InvalidInput);
  mode.left = Eigen::Vector2cd::Zero();
  mode.right = Eigen::Vector2cd::Ones();
  normalise(mode);
  EXPECT_EQ(mode.right.norm(), 0.0);
  mode.left(0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(normalise(mode), InvalidInput);
}

// (M s² + C s + K) H = I for one degree of freedom: λ from M, C, K and residue 1 / (2 i M ω_d).
TEST(Synthesize, OneDegreeOfFreedomSolvesItsEquationOfMotion) {
  const double mass = 2.5;
  const double omega = 2.0 * std::numbers::pi * 80.0;
  const double zeta = 0.03;
  Mode mode{.frequency_hz = 80.0, .damping_ratio = zeta, .left = Eigen::VectorXcd::Ones(1), .right = {}};
  const double damped = omega * std::sqrt(1.0 - zeta * zeta);
  mode.right = Eigen::VectorXcd::Constant(1, 1.0 / std::complex<double>(0.0, 2.0 * mass * damped));
  const ModalModel model{.excitations = {Dof{}}, .responses = {Dof{}}, .modes = {mode}};
  const FrfSet set = synthesize(model, Eigen::VectorXd::LinSpaced(200, 0.0, 300.0));
  ASSERT_EQ(set.frfs.size(), 1U);
  for (Eigen::Index i = 0; i < set.frequency_hz.size(); ++i) {
    const std::complex<double> s(0.0, 2.0 * std::numbers::pi * set.frequency_hz(i));
    const std::complex<double> dynamic = mass * (s * s + 2.0 * zeta * omega * s + omega * omega);
    EXPECT_LT(std::abs(dynamic * set.frfs.front().receptance(i) - 1.0), 1e-12);
  }
}

TEST(ModesFromMass, SolveTheirEquationsOfMotionByDirection) {
  const MassMode x{.frequency_hz = 922.0, .damping_ratio = 0.011, .modal_mass_kg = 0.03993};
  const MassMode y{.frequency_hz = 950.0, .damping_ratio = 0.02, .modal_mass_kg = 0.05};
  const FrfSet set = synthesize(modes_from_mass({x}, {y}), Eigen::VectorXd::LinSpaced(50, 700.0, 1200.0));
  for (const Frf& frf : set.frfs) {
    const bool direct = frf.name.response == frf.name.excitation;
    const MassMode& mode = frf.name.response.axis == Axis::x ? x : y;
    const double natural = 2.0 * std::numbers::pi * mode.frequency_hz;
    for (Eigen::Index i = 0; i < set.frequency_hz.size(); ++i) {
      const double omega = 2.0 * std::numbers::pi * set.frequency_hz(i);
      const std::complex<double> stiffness =
          mode.modal_mass_kg *
          std::complex<double>(natural * natural - omega * omega, 2.0 * mode.damping_ratio * natural * omega);
      if (direct) {
        EXPECT_LT(std::abs(frf.receptance(i) * stiffness - 1.0), 1e-12);
      } else {
        EXPECT_EQ(frf.receptance(i), 0.0);
      }
    }
  }
  EXPECT_EQ(modes_from_mass({x}, {}).responses.size(), 2U);
  EXPECT_EQ(modes_from_mass({x}, {}, {y}).modes[1].left.size(), 3);
  try {
    (void)modes_from_mass({x}, {y, {.frequency_hz = 100.0, .damping_ratio = 1.1, .modal_mass_kg = 1.0}});
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_EQ(error.parts().field, "y[2].damping_ratio");
  }
}

TEST(Synthesize, OrderNamesResidualsAndInvariance) {
  ModalModel model = data::robot_modes();
  const Eigen::VectorXd lines = Eigen::VectorXd::LinSpaced(50, 5.0, 1000.0);
  const FrfSet plain = synthesize(model, lines);
  const std::vector<std::string> names = {"xx", "yx", "xy", "yy"};
  ASSERT_EQ(plain.frfs.size(), names.size());
  for (std::size_t f = 0; f < names.size(); ++f) EXPECT_EQ(to_string(plain.frfs[f].name), names[f]);
  for (Mode& mode : model.modes) normalise(mode);
  model.residuals.push_back({.name = parse_frf_name("yx"), .mass = {0.5, 0.1}, .stiffness = {1e-7, 2e-8}});
  const FrfSet full = synthesize(model, lines);
  for (std::size_t f = 0; f < names.size(); ++f) {
    Eigen::VectorXcd expected = plain.frfs[f].receptance;
    if (names[f] == "yx") {
      for (Eigen::Index i = 0; i < lines.size(); ++i) {
        const double omega = 2.0 * std::numbers::pi * lines(i);
        expected(i) += std::complex<double>(1e-7, 2e-8) - std::complex<double>(0.5, 0.1) / (omega * omega);
      }
    }
    EXPECT_LT((full.frfs[f].receptance - expected).norm(), 1e-12 * expected.norm()) << names[f];
  }
}

TEST(Synthesize, RejectsFaults) {
  ModalModel model = data::robot_modes();
  const Eigen::Vector2d lines(0.0, 10.0);
  EXPECT_NO_THROW(static_cast<void>(synthesize(model, lines)));
  EXPECT_THROW(static_cast<void>(synthesize(model, Eigen::Vector2d(10.0, 5.0))), InvalidInput);
  EXPECT_THROW(static_cast<void>(synthesize(model, Eigen::VectorXd())), InvalidInput);
  model.residuals.push_back({.name = parse_frf_name("xx"), .mass = 1.0});
  EXPECT_THROW(static_cast<void>(synthesize(model, lines)), InvalidInput);
  model.modes.front().damping_ratio = -0.1;
  EXPECT_THROW(static_cast<void>(synthesize(model, Eigen::Vector2d(1.0, 2.0))), InvalidInput);
}

}  // namespace modes_test
}  // namespace robomill::modal
