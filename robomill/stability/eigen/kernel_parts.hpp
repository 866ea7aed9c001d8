#pragma once
#include "robomill/base/lanes.hpp"

/// What kernels are put together from. Each works on the lanes that one register holds, from `lane` on.
namespace robomill::stability::detail {

#define CORE ROBOMILL_KERNEL_CORE

/// The lanes at hand of one operand.
CORE V& at(Lanes& operand, std::size_t lane) {
  return *reinterpret_cast<V*>(operand.v + lane);
}
CORE const V& at(const Lanes& operand, std::size_t lane) {
  return *reinterpret_cast<const V*>(operand.v + lane);
}
#define L(operand) at<V>(operand, lane)

/// Solves matrix X = right in place of right, m x m and m x columns, without pivots: for matrices near enough to 1.
CORE void eliminate(std::size_t m, std::size_t columns, Lanes* matrix, Lanes* right, std::size_t lane) {
  for (std::size_t k = 0; k < m; ++k) {
    const V inverse = 1.0 / L(matrix[k * m + k]);
    for (std::size_t c = k + 1; c < m; ++c) L(matrix[k * m + c]) *= inverse;
    for (std::size_t c = 0; c < columns; ++c) L(right[k * columns + c]) *= inverse;
    for (std::size_t r = k + 1; r < m; ++r) {
      const V factor = L(matrix[r * m + k]);
      for (std::size_t c = k + 1; c < m; ++c) L(matrix[r * m + c]) -= factor * L(matrix[k * m + c]);
      for (std::size_t c = 0; c < columns; ++c) L(right[r * columns + c]) -= factor * L(right[k * columns + c]);
    }
  }
  for (std::size_t k = m; k-- > 0;) {
    for (std::size_t r = 0; r < k; ++r) {
      const V factor = L(matrix[r * m + k]);
      for (std::size_t c = 0; c < columns; ++c) L(right[r * columns + c]) -= factor * L(right[k * columns + c]);
    }
  }
}

/// z <- factor z, mode by mode; real and imaginary parts side by side.
CORE void coast(std::size_t modal, const Lanes* factor, Lanes* z, std::size_t lane) {
  for (std::size_t k = 0; k < modal; k += 2) {
    const V re = L(z[k]);
    const V im = L(z[k + 1]);
    L(z[k]) = L(factor[k]) * re - L(factor[k + 1]) * im;
    L(z[k + 1]) = L(factor[k + 1]) * re + L(factor[k]) * im;
  }
}

/// out = block in, block stored as [row / 4][column][row % 4]; out has room for rows in fours.
CORE void multiply(std::size_t rows, std::size_t columns, const Lanes* block, const Lanes* in, Lanes* out,
                   std::size_t lane) {
  for (std::size_t r = 0; r < rows; r += 4) {
    V sum0 = {}, sum1 = {}, sum2 = {}, sum3 = {};
    for (std::size_t c = 0; c < columns; ++c) {
      const V x = L(in[c]);
      sum0 += L(block[0]) * x;
      sum1 += L(block[1]) * x;
      sum2 += L(block[2]) * x;
      sum3 += L(block[3]) * x;
      block += 4;
    }
    L(out[r]) = sum0;
    L(out[r + 1]) = sum1;
    L(out[r + 2]) = sum2;
    L(out[r + 3]) = sum3;
  }
}

}  // namespace robomill::stability::detail
