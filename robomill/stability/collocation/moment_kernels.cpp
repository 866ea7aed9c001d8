#include "robomill/stability/collocation/moment_kernels.hpp"

#include <array>

#include "robomill/stability/eigen/kernel_parts.hpp"

namespace robomill::stability::detail {
namespace {

constexpr int series = 12;  // terms: the remainder is below rounding
constexpr auto over_products = [] {
  std::array<std::array<double, 2>, series> table{};  // 1 / (k (k + 1)) and 1 / (k (k - 1)), k = 2, 4, …
  for (int i = 0; i < series; ++i) {
    const double k = 2.0 * (i + 1);
    table[static_cast<std::size_t>(i)] = {1.0 / (k * (k + 1.0)), 1.0 / (k * (k - 1.0))};
  }
  return table;
}();

/// sin and cos of |x| <= π/2 by their series.
CORE void turn(const V& x, V& sine, V& cosine) {
  const V square = x * x;
  V s = V{} + 1.0;
  V c = V{} + 1.0;
  for (std::size_t i = series; i-- > 0;) {
    s = 1.0 - square * s * over_products[i][0];
    c = 1.0 - square * c * over_products[i][1];
  }
  sine = x * s;
  cosine = c;
}

CORE void add_moments_core(MomentArguments& a, std::size_t lane) {
  const V middle = L(a.middle);
  const V half = L(a.half);
  for (std::size_t q = 0; q < a.points; ++q) {
    const double away = 2.0 * a.node[q] - 1.0;
    V s;
    V c;
    turn<V>(L(a.half_rad) * away, s, c);
    const V c2 = c * c - s * s;
    const V s2 = 2.0 * c * s;
    const V weight = 2.0 * half * a.weight[q];
    const V twice_re = L(a.second[0]) * c2 - L(a.second[1]) * s2;
    const V twice_im = L(a.second[0]) * s2 + L(a.second[1]) * c2;
    V k[spatial_entries];
    k[0] = 0.5 * weight * (L(a.mean[0]) - twice_re);
    k[1] = 0.5 * weight * (twice_im + L(a.mean[1]));
    k[2] = weight * (L(a.column[0]) * s + L(a.column[1]) * c);
    k[3] = 0.5 * weight * (twice_im - L(a.mean[1]));
    k[4] = 0.5 * weight * (L(a.mean[0]) + twice_re);
    k[5] = weight * (L(a.column[0]) * c - L(a.column[1]) * s);
    k[6] = weight * (L(a.row[0]) * s + L(a.row[1]) * c);
    k[7] = weight * (L(a.row[0]) * c - L(a.row[1]) * s);
    k[8] = weight * L(a.axial);
    // P_m by their recurrence.
    const V t = 2.0 * (middle + half * away) - 1.0;
    V before = V{} + 1.0;
    V here = t;
    for (std::size_t e = 0; e < spatial_entries; ++e) L(a.sum[e * a.count]) += k[e];
    for (std::size_t m = 1; m < a.count; ++m) {
      for (std::size_t e = 0; e < spatial_entries; ++e) L(a.sum[e * a.count + m]) += k[e] * here;
      const double order = static_cast<double>(m);
      const double next = 1.0 / (order + 1.0);
      const V after = ((2.0 * order + 1.0) * next) * t * here - (order * next) * before;
      before = here;
      here = after;
    }
  }
}

}  // namespace

ROBOMILL_KERNEL(add_moments, MomentArguments)

}  // namespace robomill::stability::detail
