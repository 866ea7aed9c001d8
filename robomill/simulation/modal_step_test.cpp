#include "robomill/simulation/modal_step.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robomill/base/random.hpp"
#include "testing/simulation/cuts.hpp"

namespace robomill::simulation::detail {
namespace modal_step_test {

Eigen::MatrixXd exponential(const Eigen::MatrixXd& a) {
  const double norm = a.cwiseAbs().rowwise().sum().maxCoeff();
  const int halvings = std::max(0, static_cast<int>(std::ceil(std::log2(norm))) + 4);
  const Eigen::MatrixXd small = a / std::ldexp(1.0, halvings);
  Eigen::MatrixXd term = Eigen::MatrixXd::Identity(a.rows(), a.cols());
  Eigen::MatrixXd sum = term;
  for (int k = 1; k <= 16; ++k) {
    term = (term * small / k).eval();
    sum += term;
  }
  for (int i = 0; i < halvings; ++i) sum = (sum * sum).eval();
  return sum;
}

modal::TipModes random_modes(Random& random, Eigen::Index n) {
  modal::TipModes modes = testing::no_modes();
  modes.pole.resize(n);
  modes.right.resize(3, n);
  modes.left.resize(3, n);
  const auto complex = [&] { return std::complex<double>(random.normal(), random.normal()); };
  for (Eigen::Index k = 0; k < n; ++k) {
    modes.pole(k) = {-random.uniform(1.0, 300.0), random.uniform(10.0, 2e4)};
    for (Eigen::Index r = 0; r < 3; ++r) {
      modes.right(r, k) = complex();
      modes.left(r, k) = 1e-4 * complex();
    }
  }
  return modes;
}

// Identity: one exponential of modes and forces together, u' = (B - A)/h, gives the same step.
TEST(ModalStep, EqualsTheMatrixExponentialWithALinearForce) {
  for (int seed = 0; seed < 20; ++seed) {
    Random random(3, static_cast<std::uint64_t>(seed));
    const Eigen::Index n = 1 + static_cast<Eigen::Index>(random.index(4));
    const modal::TipModes modes = random_modes(random, n);
    const double h = std::pow(10.0, random.uniform(-7.0, -3.0));
    ModalStep<3> step(modes, h);
    const Eigen::Index size = 2 * n + 6;
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd state(size);
    for (Eigen::Index k = 0; k < n; ++k) {
      const std::complex<double> z(random.normal(), random.normal());
      step.set(static_cast<std::size_t>(k), z);
      state.segment<2>(2 * k) << z.real(), z.imag();
      a.block<2, 2>(2 * k, 2 * k) << modes.pole(k).real(), -modes.pole(k).imag(), modes.pole(k).imag(),
          modes.pole(k).real();
      a.block<1, 3>(2 * k, 2 * n) = modes.left.col(k).real().transpose();
      a.block<1, 3>(2 * k + 1, 2 * n) = modes.left.col(k).imag().transpose();
    }
    a.block<3, 3>(2 * n, 2 * n + 3).setIdentity();
    const Eigen::Vector3d from(random.normal(), random.normal(), random.normal());
    const Eigen::Vector3d to(random.normal(), random.normal(), random.normal());
    state.segment<3>(2 * n) = from;
    state.tail<3>() = (to - from) / h;
    const Eigen::VectorXd after = exponential(a * h) * state;

    const Eigen::Vector3d free = step.free_motion();
    const Eigen::Vector3d foreseen = free + step.gain_start() * from + step.gain_end() * to;
    step.finish(from, to);
    double scale = 1.0;
    for (Eigen::Index k = 0; k < n; ++k) {
      const std::complex<double> z = step.get(static_cast<std::size_t>(k));
      scale = std::max(scale, std::abs(z));
      EXPECT_NEAR(z.real(), after(2 * k), 1e-12 * scale);
      EXPECT_NEAR(z.imag(), after(2 * k + 1), 1e-12 * scale);
    }
    EXPECT_NEAR((step.displacement() - foreseen).norm(), 0.0, 1e-12 * foreseen.norm());
  }
}

// Source: x(t) = e^{-ζωt} (cos ω_d t + ζ/√(1-ζ²) sin ω_d t) for a release from 1 at rest.
TEST(ModalStep, DecaysFreelyAsTheClosedFormSays) {
  const double zeta = 0.05, omega = 2.0 * std::numbers::pi * 120.0, damped = omega * std::sqrt(1.0 - zeta * zeta);
  const double h = 3.7e-4;
  ModalStep<2> step(testing::one_mode(1, 120.0, zeta, 2.0), h);
  step.set(0, {1.0, -zeta * omega / damped});
  for (int i = 1; i <= 500; ++i) {
    const double y = step.free_motion()(1);
    const double t = i * h;
    const double expected =
        std::exp(-zeta * omega * t) * (std::cos(damped * t) + zeta * omega / damped * std::sin(damped * t));
    EXPECT_NEAR(y, expected, 1e-12);
  }
}

TEST(ModalStep, ASteadyForceBendsItByItsStaticCompliance) {
  const double omega = 2.0 * std::numbers::pi * 120.0;
  ModalStep<3> step(testing::one_mode(2, 120.0, 0.2, 2.0), 1e-3);
  const Eigen::Vector3d force(5.0, 7.0, 30.0);
  for (int i = 0; i < 1000; ++i) {
    static_cast<void>(step.free_motion());
    step.finish(force, force);
  }
  EXPECT_NEAR(step.displacement()(2), 30.0 / (2.0 * omega * omega), 1e-17);
  EXPECT_EQ(step.displacement()(0), 0.0);
}

}  // namespace modal_step_test
}  // namespace robomill::simulation::detail
