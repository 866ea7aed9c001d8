#pragma once
#include "robomill/base/lanes.hpp"
#include "robomill/coupling/section.hpp"

/// Beam elements of eight frequencies at a time. A complex number is two Lanes, real and imaginary part.
namespace robomill::coupling::detail {

struct ComplexLanes {
  Lanes re = {}, im = {};
};

/// A BeamElement; matrices row by row.
struct BeamElementLanes {
  ComplexLanes clamped[4], carry[4], stiffness[4];
};

/// Everything on the way from a section to its element. With C_i = cosh √q_i and T_i = sinh(√q_i) / √q_i of the two
/// wave numbers, q = (k h)², each C, T pair may carry a factor of its own, which cancels.
struct BeamElementWork {
  Section section;
  Lanes omega2 = {};                    ///< ω² [rad²/s²]
  ComplexLanes bending, rotary, shear;  ///< Λ, β_1, β
  ComplexLanes discriminant;            ///< ((β_1 - β) / 2)² + Λ
  ComplexLanes root;                    ///< (q_1 - q_2) / 2, its square root
  ComplexLanes q[2];                    ///< of the waves
  ComplexLanes cosine[2], sine[2];      ///< C_i, T_i
  ComplexLanes x;                       ///< T_1 C_2 - T_2 C_1
  BeamElementLanes element;             ///< of the section
};

/// Λ, β_1, β and the discriminant from section and omega2.
void beam_element_numbers(BeamElementWork& work);
/// q from root.
void beam_element_waves(BeamElementWork& work);
/// cosine, sine and x by power series, for |q| <= 4.
void beam_element_series(BeamElementWork& work);
/// element from all the others.
void beam_element_matrices(BeamElementWork& work);

struct BeamElementJoin {
  BeamElementLanes front, back;  ///< front becomes the element of both, joined rigidly
};
void beam_element_join(BeamElementJoin& join);

}  // namespace robomill::coupling::detail
