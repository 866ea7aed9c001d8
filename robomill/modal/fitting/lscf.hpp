#pragma once
#include <Eigen/Core>
#include <complex>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/modal/fitting/fit_kernel.hpp"

namespace robomill::modal::detail {

struct LscfOptions {
  int max_order = 40;
  double zeta_high = 0.4;
  double stable_frequency = 0.01, stable_damping = 0.05, stable_mac = 0.95;
};

/// A stable pole of one order, in units of FitData.
struct LscfPole {
  int order = 0;
  double omega = 0.0, zeta = 0.0;
  Eigen::VectorXcd left;   // length of excitations; all ones where the set is not complete
  Eigen::VectorXcd right;  // length of responses (of entries where the set is not complete); a shape, not scaled
  bool frequency_stable = false, damping_stable = false, vector_stable = false;
};

/// Poles of a right matrix fraction H = B A⁻¹ in z = exp(i (ω - ω_1) T) for rising orders, by the reduced normal
/// equations of the weighted linear least-squares problem [Peeters2004]. The lowest coefficient of A is fixed to 1,
/// which puts the poles of the noise outside the unit circle [Cauberghe2005]; only poles in the band with 0 < ζ <
/// zeta_high are given. A set where an FRF is missing is fitted with one common denominator.
[[nodiscard]] std::vector<LscfPole> lscf_poles(const FitData& data, const LscfOptions& options, Progress& progress);

/// Poles that stand still over the orders: followed from order to order, and stable in frequency and vector at a fifth
/// of them at least (and at three). Frequency and damping ratio are the medians of the upper half of the orders.
[[nodiscard]] std::vector<LscfPole> physical_poles(const std::vector<LscfPole>& diagram, const LscfOptions& options);

}  // namespace robomill::modal::detail
