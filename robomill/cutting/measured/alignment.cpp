#include "robomill/cutting/measured/alignment.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numbers>

namespace robomill::cutting::detail {
namespace {

using std::numbers::pi;
constexpr Eigen::Index most_harmonics = 256;

}  // namespace

Eigen::Vector3cd harmonic(const Eigen::Matrix3Xd& force, Eigen::Index k) {
  Eigen::Vector3cd out = Eigen::Vector3cd::Zero();
  const auto steps = static_cast<double>(force.cols());
  for (Eigen::Index i = 0; i < force.cols(); ++i) {
    // k i modulo the steps: the angle stays exact.
    const auto turn = static_cast<double>((k * i) % force.cols()) / steps;
    out += force.col(i) * std::polar(1.0, -2.0 * pi * turn);
  }
  return out / steps;
}

Correlation::Correlation(const Eigen::Matrix3Xd& measured, const Eigen::Matrix3Xd& predicted) {
  const Eigen::Index count = std::min((measured.cols() - 1) / 2, most_harmonics);
  for (Eigen::Index k = 0; k <= count; ++k) {
    const Eigen::Vector3cd of_measured = harmonic(measured, k), of_predicted = harmonic(predicted, k);
    products_.emplace_back((k == 0 ? 1.0 : 2.0) * of_measured.conjugate() * of_predicted.transpose());
  }
}

double Correlation::of(int a, int b, double offset_rad) const {
  double out = 0.0;
  for (std::size_t k = 0; k < products_.size(); ++k) {
    out += (products_[k](a, b) * std::polar(1.0, static_cast<double>(k) * offset_rad)).real();
  }
  return out;
}

double Correlation::sum(const SignedAxes& axes, double offset_rad) const {
  double out = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int axis = axes[static_cast<std::size_t>(i)];
    out += of(std::abs(axis) - 1, i, offset_rad) * (axis > 0 ? 1.0 : -1.0);
  }
  return out;
}

std::pair<double, double> Correlation::best(double period_rad, const SignedAxes& axes) const {
  const int count =
      std::max(16, static_cast<int>(std::ceil(4.0 * static_cast<double>(products_.size()) * period_rad / (2.0 * pi))));
  const double step = period_rad / count;
  double best = -HUGE_VAL, at = 0.0;
  for (int i = 0; i < count; ++i) {
    const double value = sum(axes, i * step);
    if (value > best) {
      best = value;
      at = i * step;
    }
  }
  // Halving intervals about the best: the correlation is smooth within a step.
  for (double half = 0.5 * step; half > 1e-9; half *= 0.5) {
    for (const double to : {at - half, at + half}) {
      const double value = sum(axes, to);
      if (value > best) {
        best = value;
        at = to;
        break;
      }
    }
  }
  return {at - period_rad * std::floor(at / period_rad), best};
}

std::vector<SignedAxes> all_signed_axes() {
  std::vector<SignedAxes> out;
  SignedAxes order = {1, 2, 3};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      SignedAxes& axes = out.emplace_back(order);
      for (std::size_t i = 0; i < 3; ++i) {
        if ((signs >> i & 1) != 0) axes[i] = -axes[i];
      }
    }
  } while (std::ranges::next_permutation(order).found);
  return out;
}

}  // namespace robomill::cutting::detail
