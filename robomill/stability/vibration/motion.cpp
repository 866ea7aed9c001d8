#include "robomill/stability/vibration/motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "robomill/base/units.hpp"

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;

/// Displacement of mode k under a force e^{st}; zero at a pole.
template <int D>
Eigen::Matrix<Complex, D, 1> moved(const TipDynamicsIn<D>& tip, Eigen::Index k, Complex s,
                                   const Eigen::Matrix<Complex, D, 1>& force) {
  const Complex pole = tip.pole(k);
  if (std::abs(s - pole) < 1e-9 * std::abs(pole) || std::abs(s - std::conj(pole)) < 1e-9 * std::abs(pole)) {
    return Eigen::Matrix<Complex, D, 1>::Zero();
  }
  const Complex z = (tip.left.col(k).transpose() * force).value() / (s - pole);
  const Complex other = (tip.left.col(k).adjoint() * force).value() / (s - std::conj(pole));
  return tip.right.col(k) * z + tip.right.col(k).conjugate() * other;
}

/// A mode that the cut leaves alone: the eigenvector's entries Re z, Im z are complex, and so z and its conjugate part
/// ways.
double alone(const Eigen::VectorXcd& modal_state, Eigen::Index k) {
  const Complex i(0.0, 1.0);
  const Complex z = modal_state(2 * k) + i * modal_state(2 * k + 1);
  const Complex other = modal_state(2 * k) - i * modal_state(2 * k + 1);
  return 1e-6 * std::max(std::abs(z), std::abs(other));
}

/// Harmonics up to which a structure moves.
int last_harmonic(const Eigen::VectorXcd& pole, double period_s) {
  const double highest = 1.5 * pole.cwiseAbs().maxCoeff() + units::revolution / period_s;
  return static_cast<int>(std::min(highest * period_s / units::revolution, 5000.0)) + 1;
}

}  // namespace

BifurcationType kind_of(Complex multiplier) {
  if (std::abs(multiplier.imag()) > 1e-9 * std::abs(multiplier)) return BifurcationType::hopf;
  return multiplier.real() < 0.0 ? BifurcationType::flip : BifurcationType::fold;
}

template <int D>
MovedMode most_moved(const TipDynamicsIn<D>& tip, Complex s, const Eigen::Matrix<Complex, D, 1>& force) {
  MovedMode most;
  for (Eigen::Index k = 0; k < tip.pole.size(); ++k) {
    const double share = moved<D>(tip, k, s, force).norm();
    if (share <= most.displacement_m) continue;
    most = {.id = tip.id[static_cast<std::size_t>(k)],
            .frequency_hz = std::abs(tip.pole(k)) / units::revolution,
            .displacement_m = share};
  }
  return most;
}
template MovedMode most_moved<2>(const TipDynamicsIn<2>& tip, Complex s, const Eigen::Vector2cd& force);
template MovedMode most_moved<3>(const TipDynamicsIn<3>& tip, Complex s, const Eigen::Vector3cd& force);

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
  for (Eigen::Index k = 0; k < n; ++k) offer(alone(modal_state, k), k, tip.pole(k).imag());
  const int last = last_harmonic(tip.pole, period_s);
  for (int j = -last; j <= last; ++j) {
    const Complex s = growth + Complex(0.0, units::revolution * j / period_s);
    const Eigen::Vector2cd f = force(s);
    for (Eigen::Index k = 0; k < n; ++k) offer(moved<2>(tip, k, s, f).norm(), k, s.imag());
  }
  return best;
}

Motion strongest_line(const TipDynamicsIn<3>& tip, Complex multiplier, double period_s,
                      const Eigen::VectorXcd& modal_state, const std::function<Eigen::Vector3cd(Complex)>& force) {
  const Eigen::Index n = tip.pole.size();
  const Complex growth = std::log(multiplier) / period_s;
  Motion best;
  double greatest = 0.0;
  for (Eigen::Index k = 0; k < n; ++k) {
    if (alone(modal_state, k) <= greatest) continue;
    greatest = alone(modal_state, k);
    best = {.frequency_hz = tip.pole(k).imag() / units::revolution, .mode = tip.id[static_cast<std::size_t>(k)]};
  }
  const int last = last_harmonic(tip.pole, period_s);
  for (int j = -last; j <= last; ++j) {
    const Complex s = growth + Complex(0.0, units::revolution * j / period_s);
    const Eigen::Vector3cd f = force(s);
    Eigen::Vector3cd together = tip.compliance * f;
    Eigen::Index most = 0;
    double most_of_one = -1.0;
    for (Eigen::Index k = 0; k < n; ++k) {
      const Eigen::Vector3cd q = moved<3>(tip, k, s, f);
      together += q;
      if (q.norm() <= most_of_one) continue;
      most_of_one = q.norm();
      most = k;
    }
    if (together.norm() <= greatest) continue;
    greatest = together.norm();
    best = {.frequency_hz = std::abs(s.imag()) / units::revolution, .mode = tip.id[static_cast<std::size_t>(most)]};
  }
  return best;
}

}  // namespace robomill::stability::detail
