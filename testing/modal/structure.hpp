#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/modal/frf.hpp"
#include "robomill/modal/modes.hpp"

namespace robomill::modal::testing {

/// M Ẍ + C Ẋ + K X = F with any real matrices: neither symmetric nor proportionally damped. The units are those of
/// translations; rows and columns of rotations carry the matching ones (kg m, kg m², …).
struct Structure {
  std::vector<Dof> dofs;              ///< length n, each once
  Eigen::MatrixXd mass_kg;            ///< M, n by n, invertible
  Eigen::MatrixXd damping_n_s_per_m;  ///< C, n by n
  Eigen::MatrixXd stiffness_n_per_m;  ///< K, n by n, not zero
};

/// The n modes of a structure, by rising frequency, with the structure's degrees of freedom as excitations and
/// responses.
///
/// State space A Ẏ + B Y = [F; 0] with Y = [X; Ẋ], A = [C M; M 0], B = [K 0; 0 -M]. Right and left eigenvectors are
/// [ψR; λ ψR] and [ψL; λ ψL] for symmetric and other matrices alike, because the lower block row of each eigenproblem
/// only says so (M invertible). They are normalised so that Ψ_Lᵀ A Ψ_R = I, that is ψLᵀ (C + 2 λ M) ψR = 1, and the
/// freedom left is fixed as Mode says. Then (-ω² M + iω C + K)⁻¹ = Σ_k ψR_k ψL_kᵀ / (iω - λ_k) + its conjugate pole's
/// term, with Σ 2 Re(ψR ψLᵀ) = 0, Σ 2 Re(λ ψR ψLᵀ) = M⁻¹ and −Σ 2 Re(ψR ψLᵀ/λ) = K⁻¹. Repeated poles are fine as long
/// as their eigenvectors are independent.
/// @throws std::invalid_argument if a pole is real or does not decay, or poles coincide without eigenvectors of their
///         own (critical damping: eigenvectors worse conditioned than 1e10)
/// Source: [Ewins2000] for the state space
[[nodiscard]] ModalModel modes_of(const Structure& structure);

}  // namespace robomill::modal::testing
