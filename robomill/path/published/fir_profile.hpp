#pragma once
// A velocity pulse through moving averages, as an exact piecewise polynomial; docs/theory/fir-smoothing.md.
#include <Eigen/Core>

namespace robomill::path {

/// Boxes of unit area in series: a pulse and up to three moving averages, in any order of length.
struct Boxes {
  static constexpr int room = 4;
  Eigen::Vector4d width_s = Eigen::Vector4d::Zero();  ///< > 0, `count` of them
  int count = 0;

  void add(double width) { width_s[count++] = width; }
  [[nodiscard]] double sum_s() const { return width_s.head(count).sum(); }
};

/// Convolution of the boxes, integrated once: what share of the way is done at time t, with its first three
/// derivatives; 0 before t = 0 and 1 after the boxes' sum. Derivatives of an order above the number of boxes are given
/// as 0, though they hold impulses.
///     s(t) = Σ_S (−1)^|S| (t − T_S)₊^m / (m! ΠT),  T_S the sum of the widths in the subset S of the m boxes
[[nodiscard]] Eigen::Vector4d share_at(const Boxes& boxes, double t_s);

/// Way left (or done) at unit speed, τ before the end (after the beginning) of a long pulse behind filters [s]: their
/// convolution integrated twice, Σ_S (−1)^|S| (τ − T_S)₊^(m+1) / ((m+1)! ΠT).
[[nodiscard]] double tail_s(const Boxes& filters, double tau_s);

/// Its inverse: τ in [0, half the filters' sum]; half the sum where the tail there is no longer than asked for.
[[nodiscard]] double tail_time_s(const Boxes& filters, double tail);

}  // namespace robomill::path
