#include "robomill/modal/impact/hits_axis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "robomill/base/parallel.hpp"
#include "robomill/base/random.hpp"
#include "testing/robot_modes.hpp"

namespace robomill::modal {
namespace hits_axis_test {

using Complex = std::complex<double>;
using Eigen::Index;

// s² Σ_k R L / (s - λ) + conjugate, at any s.
Complex accelerance(const ModalModel& model, Index response, Index excitation, Complex s) {
  Complex sum = 0.0;
  for (const Mode& mode : model.modes) {
    const Complex residue = mode.right(response) * mode.left(excitation);
    sum += residue / (s - pole(mode)) + std::conj(residue) / (s - std::conj(pole(mode)));
  }
  return s * s * sum;
}

struct Shifted {
  Eigen::VectorXcd beside, on_axis;
};

Shifted shifted(Index response, Index excitation, double record_s, double decay_per_s, Index lines) {
  const ModalModel model = data::robot_modes();
  Shifted h{.beside = Eigen::VectorXcd(lines), .on_axis = Eigen::VectorXcd(lines)};
  for (Index k = 0; k < lines; ++k) {
    const double omega = 2.0 * std::numbers::pi * static_cast<double>(k) / record_s;
    h.beside(k) = accelerance(model, response, excitation, {decay_per_s, omega});
    h.on_axis(k) = accelerance(model, response, excitation, {0.0, omega});
  }
  return h;
}

double error(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b, Index from, Index to) {
  return (a - b).segment(from, to - from).norm() / b.segment(from, to - from).norm();
}

// Modes 1 and 2 lie 2 Hz apart; with records of 2 s that is four lines, and their half-power widths are less than one.
TEST(WithoutDecay, GivesBackTheAxisOfTheRobot) {
  const double record_s = 2.0;
  const double decay_per_s = 3.0 / record_s;
  for (Index i = 0; i < 2; ++i) {
    for (Index j = 0; j < 2; ++j) {
      const Shifted h = shifted(i, j, record_s, decay_per_s, 2000);
      const Eigen::VectorXcd back = without_decay(h.beside, 2.0 * std::numbers::pi / record_s, decay_per_s);
      EXPECT_GT(error(h.beside, h.on_axis, 30, 50), 0.2);
      EXPECT_LT(error(back, h.on_axis, 30, 50), 3e-4);
      EXPECT_LT(error(back, h.on_axis, 50, 200), 1e-6);
      EXPECT_LT(error(back, h.on_axis, 200, 2000), 1e-9);
    }
  }
}

TEST(WithoutDecay, CarriesNoiseBarelyFurther) {
  const double record_s = 2.0;
  const double decay_per_s = 3.0 / record_s;
  const Shifted h = shifted(0, 0, record_s, decay_per_s, 2000);
  Random random(5);
  const double noise = 1e-3 * h.on_axis.segment(200, 800).norm() / std::sqrt(800.0);
  Eigen::VectorXcd noisy = h.beside;
  for (Index k = 0; k < noisy.size(); ++k)
    noisy(k) += noise * Complex(random.normal(), random.normal()) / std::sqrt(2.0);
  const Eigen::VectorXcd back = without_decay(noisy, 2.0 * std::numbers::pi / record_s, decay_per_s);
  EXPECT_LT(error(back, h.on_axis, 200, 1000), 1.5e-3);
}

TEST(WithoutDecay, IsTheSameOnAnyNumberOfThreads) {
  const Shifted h = shifted(0, 1, 2.0, 1.5, 2000);
  set_thread_count(1);
  const Eigen::VectorXcd one = without_decay(h.beside, std::numbers::pi, 1.5);
  set_thread_count(3);
  const Eigen::VectorXcd three = without_decay(h.beside, std::numbers::pi, 1.5);
  set_thread_count(0);
  EXPECT_TRUE((one.array() == three.array()).all());
}

TEST(WithoutDecay, LeavesSilenceSilent) {
  EXPECT_EQ(without_decay(Eigen::VectorXcd::Zero(40), 1.0, 0.5).norm(), 0.0);
}

}  // namespace hits_axis_test
}  // namespace robomill::modal
