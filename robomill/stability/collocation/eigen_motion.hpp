#pragma once
#include <Eigen/Core>
#include <complex>
#include <vector>

#include "robomill/stability/collocation/collocation_case.hpp"

// Derived in docs/theory/limit-sensitivity.md
namespace robomill::stability::detail {

/// Whether every node looks back to itself, one period before: equal teeth. A motion with the multiplier μ then has
/// q(t - τ) = q(t) / μ, and the period is a matrix of the modes alone, Ψ(ν), ν = 1 - 1/μ, with Ψ(ν) z = μ z:
/// piece by piece z' = E z + a ν W u, u = O z + a ν R u.
[[nodiscard]] bool looks_back_a_period(const MeshTopology& topology);

/// max |eigenvalue| of a period without the delayed displacement, F = K q; for any teeth.
/// @param factor  a
[[nodiscard]] double radius_without_delay(const CollocationCase& at, double factor);

/// A motion with its multiplier, forwards and adjoint.
struct EigenMotion {
  /// Of one piece; f and r are empty where nothing cuts.
  struct Piece {
    Eigen::VectorXcd start;    ///< z, length 2n
    Eigen::VectorXcd costate;  ///< yᵀ at the end of the piece, length 2n: y_start = Pᵀ y_end
    Eigen::VectorXcd force;    ///< f, per factor and ν, D p
    Eigen::VectorXcd seen;     ///< yᵀ W X times what u takes of q, D p
  };
  std::complex<double> multiplier = 0.0, nu = 0.0;
  double factor = 0.0;
  std::vector<Piece> pieces;
  std::complex<double> by_factor = 0.0;  ///< ∂(yᵀ Ψ z) / ∂(a ν)
  std::complex<double> scale = 0.0;      ///< yᵀ (I - ∂Ψ/∂μ) z: δμ = yᵀ δΨ z / scale
};

/// Of a case that looks back a period.
/// @param multiplier  of the period, as found
[[nodiscard]] EigenMotion eigen_motion(const CollocationCase& at, double factor, std::complex<double> multiplier);

}  // namespace robomill::stability::detail
