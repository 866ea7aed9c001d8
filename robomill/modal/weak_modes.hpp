#pragma once
#include <cstddef>
#include <limits>

#include "robomill/modal/frf.hpp"
#include "robomill/modal/modes.hpp"

namespace robomill::modal {

/// Marks the modes that the FRFs do not bear out. A mode is weak where, over its half-power band f (1 ± ζ), in every
/// FRF
///   - ‖H_k‖ is within twice the scatter of the fit, the median line's |H_fit - H| there, or
///   - it bends a baseline: ζ > 0.1, and ‖H_k‖ below ζ ‖H‖, so that it makes no peak of its own, or
///   - it is vague and small: a deviation of ζ above ζ / 5 or of f above ζ f / 5, and ‖H_k‖ below a fifth of ‖H‖.
/// The marks that the modes had are overwritten.
/// @param frfs  that the modes were fitted to
/// @throws InvalidInput if the model or the set is not valid
void mark_weak_modes(ModalModel& model, const FrfSet& frfs);

/// The same of modes alone, whose own sum stands for H: the last of the three, and the second of modes that know their
/// deviations. Modes without deviations are taken as facts.
/// @throws InvalidInput if the model is not valid
void mark_weak_modes(ModalModel& model);

/// A mode as a mass on a spring.
struct ModalStiffness {
  double stiffness_n_per_m = std::numeric_limits<double>::quiet_NaN();  ///< k [N/m]
  double mass_kg = std::numeric_limits<double>::quiet_NaN();            ///< m [kg]
};

/// At the point and in the direction in which the mode moves most: m = 1 / (2 ω sqrt(1 - ζ²) ‖R‖ ‖L‖), k = m ω², R and
/// L of one point's translations that are both hit and measured. NaN where there are none or the mode does not move
/// there.
/// @param mode  of the model, from 0
/// @throws InvalidInput if the model is not valid
[[nodiscard]] ModalStiffness modal_stiffness(const ModalModel& model, std::size_t mode);

}  // namespace robomill::modal
