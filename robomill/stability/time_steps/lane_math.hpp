#pragma once
#include <Eigen/Core>
#include <cstddef>

#include "robomill/base/lanes.hpp"

/// Small sums and products of Lanes. 2 x 2 matrices are four Lanes, row by row.
namespace robomill::stability::detail {

inline void set(Lanes* to, std::size_t lane, const Eigen::Matrix2d& matrix) {
  to[0].v[lane] = matrix(0, 0);
  to[1].v[lane] = matrix(0, 1);
  to[2].v[lane] = matrix(1, 0);
  to[3].v[lane] = matrix(1, 1);
}

inline Lanes difference(const Lanes& a, const Lanes& b) {
  Lanes result = {};
  for (std::size_t l = 0; l < lane_count; ++l) result.v[l] = a.v[l] - b.v[l];
  return result;
}

inline void add_product(Lanes& sum, double a, const Lanes& b) {
  for (std::size_t l = 0; l < lane_count; ++l) sum.v[l] += a * b.v[l];
}

inline void add_product(Lanes& sum, const Lanes& a, const Lanes& b) {
  for (std::size_t l = 0; l < lane_count; ++l) sum.v[l] += a.v[l] * b.v[l];
}

/// sum += matrix vector, 2 x 2.
inline void add_product(const Lanes* matrix, const Lanes* vector, Lanes* sum) {
  for (std::size_t row = 0; row < 2; ++row) {
    for (std::size_t l = 0; l < lane_count; ++l) {
      sum[row].v[l] += matrix[2 * row].v[l] * vector[0].v[l] + matrix[2 * row + 1].v[l] * vector[1].v[l];
    }
  }
}

/// Takes complex numbers, Re z_1, Im z_1, Re z_2, …, times a factor each.
inline void turn(const Lanes* factor, std::size_t size, Lanes* z) {
  for (std::size_t k = 0; k < size; k += 2) {
    for (std::size_t l = 0; l < lane_count; ++l) {
      const double re = z[k].v[l];
      const double im = z[k + 1].v[l];
      z[k].v[l] = factor[k].v[l] * re - factor[k + 1].v[l] * im;
      z[k + 1].v[l] = factor[k].v[l] * im + factor[k + 1].v[l] * re;
    }
  }
}

}  // namespace robomill::stability::detail
