#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/modal/frf.hpp"
#include "robomill/modal/modes.hpp"

// Method: robomill/modal/README.md, "Matrices to modes (`structure.hpp`)"

namespace robomill::modal {

/// M Ẍ + C Ẋ + K X = F with any real matrices: neither symmetric nor proportionally damped. The units are those of
/// translations; rows and columns of rotations carry the matching ones (kg m, kg m², …).
struct Structure {
  std::vector<Dof> dofs;              ///< length n, each once
  Eigen::MatrixXd mass_kg;            ///< M, n by n, invertible
  Eigen::MatrixXd damping_n_s_per_m;  ///< C, n by n
  Eigen::MatrixXd stiffness_n_per_m;  ///< K, n by n, not zero

  /// @throws InvalidInput naming the member if a shape is wrong, a value is not finite, a degree of freedom comes
  /// twice, M is
  ///         singular (condition above 1e12) or K is zero
  ROBOMILL_API void validate() const;
};

/// The n modes of a structure, by rising frequency, with the structure's degrees of freedom as excitations and
/// responses.
///
/// State space A Ẏ + B Y = [F; 0] with Y = [X; Ẋ], A = [C M; M 0], B = [K 0; 0 -M]. Right and left eigenvectors are
/// [ψR; λ ψR] and [ψL; λ ψL] for symmetric and other matrices alike; they are normalised so that Ψ_Lᵀ A Ψ_R = I, that
/// is ψLᵀ (C + 2 λ M) ψR = 1, and the freedom left is fixed as Mode says. Then
/// (-ω² M + iω C + K)⁻¹ = Σ_k ψR_k ψL_kᵀ / (iω - λ_k) + its conjugate pole's term, with Σ 2 Re(ψR ψLᵀ) = 0 and Σ 2 Re(λ
/// ψR ψLᵀ) = M⁻¹. Repeated poles are fine as long as their eigenvectors are independent.
/// @throws InvalidInput if the structure is not valid; if it has real poles (overdamped: a list of modes holds
/// conjugate
///         pairs only), or poles that do not decay (damping ratio <= 0); if poles coincide without eigenvectors of
///         their own (critical damping: eigenvectors worse conditioned than 1e10)
/// Source: [Ewins2000] for the state space; the normalisation for matrices that are not symmetric in
/// robomill/modal/README.md
[[nodiscard]] ROBOMILL_API ModalModel modes_of(const Structure& structure);

/// H(ω) = (-ω² M + iω C + K)⁻¹, all n² receptances, excitation by excitation (xx, yx, xy, yy).
/// @param frequency_hz  length m, strictly increasing, >= 0 [Hz]
/// @throws InvalidInput if the structure or the frequencies are not valid, or -ω² M + iω C + K is singular at a line
[[nodiscard]] ROBOMILL_API FrfSet receptance(const Structure& structure, const Eigen::VectorXd& frequency_hz);

}  // namespace robomill::modal
