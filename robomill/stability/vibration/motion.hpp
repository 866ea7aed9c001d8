#pragma once
#include <complex>
#include <functional>

#include "robomill/stability/frequency_response.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/vibration/tip_dynamics.hpp"

namespace robomill::stability::detail {

/// How the motion that belongs to a multiplier looks.
struct Motion {
  double frequency_hz = 0.0;
  modal::ModeId mode = {};
};

/// Hopf unless the multiplier is real.
BifurcationType kind_of(std::complex<double> multiplier);

/// Under a force F e^{st}: the mode whose share of the displacement is greatest.
template <int D>
MovedMode most_moved(const TipDynamicsIn<D>& tip, std::complex<double> s,
                     const Eigen::Matrix<std::complex<double>, D, 1>& force);
extern template MovedMode most_moved<2>(const TipDynamicsIn<2>& tip, std::complex<double> s,
                                        const Eigen::Vector2cd& force);
extern template MovedMode most_moved<3>(const TipDynamicsIn<3>& tip, std::complex<double> s,
                                        const Eigen::Vector3cd& force);

/// The motion is a sum of harmonics exp(s_j t), s_j = (ln μ + 2πij) / T; the force has the coefficient F_j, mode k the
/// displacement R_k L_k^T F_j / (s_j - λ_k) + conjugate pole's term. Named are the mode and the harmonic whose
/// displacement is greatest.
/// @param modal_state  Re z_1, Im z_1, Re z_2, … at the start of the period, complex as the eigenvector's entries are
/// @param force        F_j of s_j: (1/T) ∫ F(t) exp(-s_j t) dt over a period
Motion find_motion(const TipDynamics& tip, std::complex<double> multiplier, double period_s,
                   const Eigen::VectorXcd& modal_state,
                   const std::function<Eigen::Vector2cd(std::complex<double>)>& force);

/// The same in three directions: the harmonic in which the tip moves most, residual compliance included, and the mode
/// that moves most in it.
Motion strongest_line(const TipDynamicsIn<3>& tip, std::complex<double> multiplier, double period_s,
                      const Eigen::VectorXcd& modal_state,
                      const std::function<Eigen::Vector3cd(std::complex<double>)>& force);

}  // namespace robomill::stability::detail
