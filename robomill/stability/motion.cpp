#include "robomill/stability/motion.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/units.hpp"

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;

}  // namespace

BifurcationType kind_of(Complex multiplier) {
  if (std::abs(multiplier.imag()) > 1e-9 * std::abs(multiplier)) return BifurcationType::hopf;
  return multiplier.real() < 0.0 ? BifurcationType::flip : BifurcationType::fold;
}

Motion find_motion(const TipDynamics& tip, Complex multiplier, double period_s, const Eigen::VectorXcd& modal_state,
                   const std::function<Eigen::Vector2cd(Complex)>& force) {
  const Eigen::Index n = tip.pole.size();
  const Complex growth = std::log(multiplier) / period_s;
  Motion best;
  double greatest = 0.0;
  const auto offer = [&](double amplitude, Eigen::Index k, double frequency) {
    if (amplitude <= greatest) return;
    greatest = amplitude;
    best.mode = tip.id[static_cast<std::size_t>(k)];
    best.frequency_hz = std::abs(frequency) / units::revolution;
  };

  // A mode that the cut leaves alone: the eigenvector's entries Re z, Im z are complex, and so z and its conjugate part
  // ways.
  double alone = 0.0;
  for (Eigen::Index k = 0; k < n; ++k) {
    const Complex i(0.0, 1.0);
    const Complex z = modal_state(2 * k) + i * modal_state(2 * k + 1);
    const Complex other = modal_state(2 * k) - i * modal_state(2 * k + 1);
    const double amplitude = 1e-6 * std::max(std::abs(z), std::abs(other));
    alone = std::max(alone, amplitude);
    offer(amplitude, k, tip.pole(k).imag());
  }

  const double highest = 1.5 * tip.pole.cwiseAbs().maxCoeff() + units::revolution / period_s;
  const int last = static_cast<int>(std::min(highest * period_s / units::revolution, 5000.0)) + 1;
  for (int j = -last; j <= last; ++j) {
    const Complex s = growth + Complex(0.0, units::revolution * j / period_s);
    const Eigen::Vector2cd f = force(s);
    for (Eigen::Index k = 0; k < n; ++k) {
      const Complex pole = tip.pole(k);
      if (std::abs(s - pole) < 1e-9 * std::abs(pole) || std::abs(s - std::conj(pole)) < 1e-9 * std::abs(pole)) continue;
      const Complex z = (tip.left.col(k).transpose() * f).value() / (s - pole);
      const Complex other = (tip.left.col(k).adjoint() * f).value() / (s - std::conj(pole));
      const Eigen::Vector2cd q = tip.right.col(k) * z + tip.right.col(k).conjugate() * other;
      offer(q.norm(), k, s.imag());
    }
  }
  return best;
}

}  // namespace robomill::stability::detail
