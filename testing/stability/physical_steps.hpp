#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/cutting/milling.hpp"

/// Parts of discretizations in physical coordinates, as published, that tests compare with; they share nothing with the
/// library's.
namespace robomill::stability::testing {

inline Eigen::MatrixXd exponential(const Eigen::MatrixXd& a) {
  const double norm = a.cwiseAbs().rowwise().sum().maxCoeff();
  const int halvings = std::max(0, static_cast<int>(std::ceil(std::log2(norm))) + 4);
  const Eigen::MatrixXd small = a / std::ldexp(1.0, halvings);
  Eigen::MatrixXd term = Eigen::MatrixXd::Identity(a.rows(), a.cols());
  Eigen::MatrixXd sum = term;
  for (int k = 1; k <= 16; ++k) {
    term = (term * small / k).eval();
    sum += term;
  }
  for (int i = 0; i < halvings; ++i) sum = (sum * sum).eval();
  return sum;
}

/// Mean of κ of all teeth over a time step, by Simpson's rule where a tooth cuts.
inline Eigen::Matrix2d mean_stiffness(const cutting::Milling& milling, double from, double to, double depth_m) {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (int j = -milling.tool.teeth; j < milling.tool.teeth; ++j) {
    const double standing = 2.0 * std::numbers::pi * j / milling.tool.teeth;
    const double a = std::max(from + standing, milling.immersion.entry_rad);
    const double b = std::min(to + standing, milling.immersion.exit_rad);
    if (b <= a) continue;
    const int count = 400;
    for (int i = 0; i <= count; ++i) {
      const double weight = (i == 0 || i == count ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * (b - a) / (3.0 * count);
      sum += cutting::directional_coefficients(milling.coefficients, a + (b - a) * i / count) * weight;
    }
  }
  return sum * depth_m / (to - from);
}

}  // namespace robomill::stability::testing
