#pragma once
#include <Eigen/Core>

#include "robomill/base/export.hpp"
#include "robomill/modal/frf.hpp"
#include "robomill/modal/modes.hpp"

// Method: robomill/modal/README.md, "Comparing modes and FRFs (`mac.hpp`)"

namespace robomill::modal {

/// Modal assurance criterion of two complex vectors: MAC = |aᴴ b|² / (aᴴa · bᴴb), in [0, 1]; 1 where one is a complex
/// multiple of the other. A zero vector is like no other: 0.
/// @param a, b  length n
/// @throws InvalidInput if the lengths differ, are zero, or a value is not finite
/// Source: [Allemang2003]
[[nodiscard]] ROBOMILL_API double mac(const Eigen::Ref<const Eigen::VectorXcd>& a,
                                      const Eigen::Ref<const Eigen::VectorXcd>& b);

/// MAC between the residues R Lᵀ of every mode of a (rows) and of b (columns). The residue is what is physical of a
/// mode of a structure that need not be symmetric, and its MAC is that of the right vectors times that of the left
/// ones.
/// @throws InvalidInput if a model is not valid, or their degrees of freedom are not the same in the same order
[[nodiscard]] ROBOMILL_API Eigen::MatrixXd mac(const ModalModel& a, const ModalModel& b);

/// Frequency response assurance criterion of two FRFs over the same lines: FRAC = |Σ conj(H) G|² / (Σ |H|² · Σ |G|²),
/// the MAC over frequency, in [0, 1]. It sees shape and not scale: read it beside the relative error. One number for
/// each FRF of `measured`, in its order, against the FRF of the same name in `synthesised`.
/// @throws InvalidInput if a set is not valid, the frequencies differ, or `synthesised` lacks an FRF
/// Source: [Heylen1996]
[[nodiscard]] ROBOMILL_API Eigen::VectorXd frac(const FrfSet& measured, const FrfSet& synthesised);

}  // namespace robomill::modal
