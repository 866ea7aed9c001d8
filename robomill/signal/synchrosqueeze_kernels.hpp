#pragma once
// What a column of the synchrosqueezed transform does line by line, in lanes.
#include <cstddef>
#include <cstdint>

#include "robomill/base/lanes.hpp"

namespace robomill::signal {

inline constexpr std::size_t max_cosines = 4;  // of Blackman–Harris
inline constexpr std::size_t band_reach = 8;
inline constexpr std::size_t far_groups = 48;

/// Lines of the sliding transform, u_k = Σ_{j=0}^{N-1} x_{n-j} e^{2πik(j+1)/N}: one sample on.
struct Slide {
  double *re, *im;
  const double *turn_re, *turn_im;  // e^{2πik/N}
  double input;                     // the newest sample less the one that leaves
  std::size_t groups;               // of eight lines
};
void slide(Slide& a);

/// Coefficients v = ±V_g, and the line to which each goes: k - Re(a/v)/2, rounded, where a = ±(N/(π f_s)) V_g'/i with
/// the same sign.
struct Squeeze {
  const double *re, *im;  // the sliding transform at line 0; lines before and after are read
  const double *line, *weight;
  double mix[max_cosines], slope[max_cosines];  // of lines k ± j, signs of neighbouring lines in them
  std::size_t terms;                            // 1 + neighbours on a side
  double threshold_squared, last_line;
  double *v_re, *v_im, *a_re, *a_im;  // a: read by reassign alone
  double* target;                     // line + rounding_shift
  double* share;                      // weight × Re v
  std::size_t groups;
  // Bands: lines edge[b] … edge[b + 1] - 1. What moves by no more than band_reach lines is added to sums[b], lane by
  // lane, where b runs over those in reach of the group, lowest … highest; the others are marked in `far`, a number a
  // lane for each far_groups groups, by adding 2^(g % far_groups).
  std::size_t bands = 0;  // 0: no sums
  const double* edge = nullptr;
  const std::uint8_t *lowest = nullptr, *highest = nullptr;
  Lanes* sums = nullptr;
  Lanes* far = nullptr;
};
/// From the sliding transform.
void squeeze(Squeeze& a);
/// From v and a as they stand.
void reassign(Squeeze& a);

/// Adding it to a number of size < 2^51 rounds that to the nearest integer, which then stands in the lowest bits.
inline constexpr double rounding_shift = 6755399441055744.0;

}  // namespace robomill::signal
