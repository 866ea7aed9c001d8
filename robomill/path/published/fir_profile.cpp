#include "robomill/path/published/fir_profile.hpp"

#include <array>
#include <cmath>

namespace robomill::path {

namespace {

// Σ_S (−1)^|S| (t − T_S)₊^p / (p! ΠT) for p = power, power − 1, … as many as asked for.
template <int N>
Eigen::Matrix<double, N, 1> truncated_powers(const Boxes& boxes, double t, int power) {
  Eigen::Matrix<double, N, 1> sum = Eigen::Matrix<double, N, 1>::Zero();
  double product = 1.0;
  for (int i = 0; i < boxes.count; ++i) product *= boxes.width_s[i];
  const unsigned subsets = 1U << static_cast<unsigned>(boxes.count);
  for (unsigned s = 0; s < subsets; ++s) {
    double left = t, sign = 1.0;
    for (int i = 0; i < boxes.count; ++i) {
      if ((s >> static_cast<unsigned>(i) & 1U) == 0U) continue;
      left -= boxes.width_s[i];
      sign = -sign;
    }
    if (left <= 0.0) continue;
    std::array<double, 6> term = {};  // left^p / p!
    term[0] = 1.0;
    for (int p = 1; p <= power; ++p)
      term[static_cast<std::size_t>(p)] = term[static_cast<std::size_t>(p - 1)] * left / p;
    for (int k = 0; k < N && k <= power; ++k) sum[k] += sign * term[static_cast<std::size_t>(power - k)];
  }
  return sum / product;
}

}  // namespace

Eigen::Vector4d share_at(const Boxes& boxes, double t_s) {
  const double whole = boxes.sum_s();
  if (t_s <= 0.0) return Eigen::Vector4d::Zero();
  if (t_s >= whole) return Eigen::Vector4d::UnitX();
  if (t_s <= 0.5 * whole) return truncated_powers<4>(boxes, t_s, boxes.count);
  const Eigen::Vector4d back = truncated_powers<4>(boxes, whole - t_s, boxes.count);
  return {1.0 - back[0], back[1], -back[2], back[3]};
}

double tail_s(const Boxes& filters, double tau_s) {
  const double whole = filters.sum_s();
  if (tau_s <= 0.0) return 0.0;
  // ∫ of the share from the far end: tail(τ) = τ − whole/2 + tail(whole − τ).
  if (tau_s > 0.5 * whole) return tau_s - 0.5 * whole + (tau_s < whole ? tail_s(filters, whole - tau_s) : 0.0);
  return truncated_powers<1>(filters, tau_s, filters.count + 1)[0];
}

double tail_time_s(const Boxes& filters, double tail) {
  const double half = 0.5 * filters.sum_s();
  if (!(tail < tail_s(filters, half))) return half;
  if (filters.count == 1) return std::sqrt(2.0 * filters.width_s[0] * tail);
  if (filters.count == 2) {
    const double longer = filters.width_s.head<2>().maxCoeff(), shorter = filters.width_s.head<2>().minCoeff();
    if (tail <= shorter * shorter / (6.0 * longer)) return std::cbrt(6.0 * longer * shorter * tail);
    return 0.5 * shorter + std::sqrt(2.0 * longer * tail - shorter * shorter / 12.0);
  }
  double low = 0.0, high = half;
  for (int i = 0; i < 100 && high - low > 1e-15 * half; ++i) {
    const double middle = 0.5 * (low + high);
    (tail_s(filters, middle) < tail ? low : high) = middle;
  }
  return low;
}

}  // namespace robomill::path
