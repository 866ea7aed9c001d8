#pragma once
#include "robomill/base/lanes.hpp"
#include "robomill/coupling/section.hpp"

/// Spans of eight frequencies at a time. A complex number is two Lanes, real and imaginary part.
namespace robomill::coupling::detail {

struct ComplexLanes {
  Lanes re = {}, im = {};
};

/// A BeamElement; matrices row by row.
struct SpanLanes {
  ComplexLanes clamped[4], carry[4], stiffness[4];
};

/// Everything on the way from a section to its span. With C_i = cosh √q_i and T_i = sinh(√q_i) / √q_i of the two wave
/// numbers, q = (k h)², each C, T pair may carry a factor of its own, which cancels.
struct SpanWork {
  Section section;
  Lanes omega2 = {};                    ///< ω² [rad²/s²]
  ComplexLanes bending, rotary, shear;  ///< Λ, β_1, β
  ComplexLanes discriminant;            ///< ((β_1 - β) / 2)² + Λ
  ComplexLanes root;                    ///< (q_1 - q_2) / 2, its square root
  ComplexLanes q[2];                    ///< of the waves
  ComplexLanes cosine[2], sine[2];      ///< C_i, T_i
  ComplexLanes x;                       ///< T_1 C_2 - T_2 C_1
  SpanLanes span;                       ///< of the section
};

/// Λ, β_1, β and the discriminant from section and omega2.
void span_numbers(SpanWork& work);
/// q from root.
void span_waves(SpanWork& work);
/// cosine, sine and x by power series, for |q| <= 4.
void span_series(SpanWork& work);
/// span from all the others.
void span_matrices(SpanWork& work);

struct SpanJoin {
  SpanLanes front, back;  ///< front becomes the span of both, joined rigidly
};
void span_join(SpanJoin& join);

}  // namespace robomill::coupling::detail
