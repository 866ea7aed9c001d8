#include "examples/first-lobes/hammer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/signal/fft.hpp"
#include "testing/robot_modes.hpp"

namespace robomill::examples {
namespace hammer_test {

using Complex = std::complex<double>;
using Eigen::Index;

Hammer quiet(modal::ResponseKind kind) {
  Hammer hammer;
  hammer.force_noise_n = 0.0;
  hammer.response_noise = 0.0;
  hammer.response = kind;
  hammer.record_s = 1.0;
  return hammer;
}

// The record at `factor` times its rate: zeros in the middle of its spectrum.
Eigen::VectorXd finer(const Eigen::VectorXd& x, Index factor) {
  const Eigen::VectorXcd half = signal::real_fft(x);
  Eigen::VectorXcd padded = Eigen::VectorXcd::Zero(x.size() * factor / 2 + 1);
  padded.head(half.size()) = half;
  return static_cast<double>(factor) * signal::inverse_real_fft(padded, x.size() * factor);
}

// Each mode obeys q' = λ q + L f. Under a force that is linear between samples h apart the step
// q -> e^z q + h (c0 f_j + c1 f_{j+1}), z = λh, c1 = (e^z - 1 - z)/z², c0 = (e^z - 1)/z - c1, is exact; x = 2 Re Σ R q.
Eigen::VectorXd displacement(const modal::ModalModel& model, Index excitation, Index response,
                             const Eigen::VectorXd& force_n, double step_s) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(force_n.size());
  for (const modal::Mode& mode : model.modes) {
    const Complex z = modal::pole(mode) * step_s;
    const Complex growth = std::exp(z);
    const Complex c1 = (growth - 1.0 - z) / (z * z);
    const Complex c0 = (growth - 1.0) / z - c1;
    Complex q = 0.0;
    for (Index j = 1; j < force_n.size(); ++j) {
      q = growth * q + step_s * mode.left(excitation) * (c0 * force_n(j - 1) + c1 * force_n(j));
      x(j) += 2.0 * (mode.right(response) * q).real();
    }
  }
  return x;
}

// Two ways to one answer: the spectrum's, and a march through time under the recorded force.
TEST(SimulateHit, AgreesWithTheModesMarchedThroughTime) {
  const modal::ModalModel model = data::robot_modes();
  const Hammer hammer = quiet(modal::ResponseKind::displacement);
  Random random(4);
  const modal::Hit hit = simulate_hit(model, model.excitations[1], hammer, random);
  constexpr Index factor = 64;
  const Eigen::VectorXd force_n = finer(hit.force_n, factor);
  for (Index i = 0; i < 2; ++i) {
    const Eigen::VectorXd marched =
        displacement(model, 1, i, force_n, 1.0 / (hammer.sample_rate_hz * static_cast<double>(factor)));
    const Eigen::VectorXd& samples = hit.responses[static_cast<std::size_t>(i)].samples;
    double difference = 0.0;
    for (Index j = 0; j < samples.size(); ++j)
      difference = std::max(difference, std::abs(samples(j) - marched(factor * j)));
    EXPECT_LT(difference, 3e-5 * samples.cwiseAbs().maxCoeff());
  }
}

TEST(SimulateHit, MakesAHalfSineOfThatHeightAndLength) {
  const modal::ModalModel model = data::robot_modes();
  Hammer hammer = quiet(modal::ResponseKind::acceleration);
  hammer.pulse_s = 3e-3;
  Random random(4);
  const modal::Hit hit = simulate_hit(model, model.excitations[0], hammer, random);
  EXPECT_EQ(hit.force_n.size(), 4096);
  EXPECT_EQ(hit.responses.size(), 2u);
  EXPECT_NEAR(hit.force_n.maxCoeff(), 200.0, 2.0);
  const double impulse_n_s = hit.force_n.sum() / hammer.sample_rate_hz;
  EXPECT_NEAR(impulse_n_s, 2.0 / std::numbers::pi * 200.0 * 3e-3, 1e-3 * impulse_n_s);
  EXPECT_LT(hit.force_n.head(150).cwiseAbs().maxCoeff(), 0.1);
}

TEST(SimulateHits, RepeatsWithItsSeedAndScatters) {
  const modal::ModalModel model = data::robot_modes();
  Hammer hammer;
  hammer.record_s = 0.5;
  const std::vector<modal::Hit> hits = simulate_hits(model, 5, 0.05, hammer, 9);
  const std::vector<modal::Hit> again = simulate_hits(model, 5, 0.05, hammer, 9);
  const std::vector<modal::Hit> other = simulate_hits(model, 5, 0.05, hammer, 10);
  ASSERT_EQ(hits.size(), 10u);
  double lowest = 1e9;
  double highest = 0.0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    EXPECT_TRUE((hits[i].force_n.array() == again[i].force_n.array()).all());
    EXPECT_TRUE((hits[i].responses[1].samples.array() == again[i].responses[1].samples.array()).all());
    EXPECT_FALSE((hits[i].force_n.array() == other[i].force_n.array()).all());
    lowest = std::min(lowest, hits[i].force_n.maxCoeff());
    highest = std::max(highest, hits[i].force_n.maxCoeff());
  }
  EXPECT_GT(highest - lowest, 10.0);
  EXPECT_EQ(hits[0].file, "hit_x_1.csv");
  EXPECT_EQ(hits[9].file, "hit_y_5.csv");
  EXPECT_EQ(hits[9].excitation, model.excitations[1]);
}

TEST(SimulateHit, RejectsAForceTheModelDoesNotKnow) {
  Random random(1);
  const modal::Dof z{.point = 0, .axis = modal::Axis::z};
  EXPECT_THROW(static_cast<void>(simulate_hit(data::robot_modes(), z, Hammer{}, random)), InvalidInput);
}

}  // namespace hammer_test
}  // namespace robomill::examples
