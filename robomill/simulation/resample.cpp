#include "robomill/simulation/resample.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace robomill::simulation::detail {
namespace {

using std::numbers::pi;

constexpr double places_per_period = 512.0;  // of the output, in the kernels' table
constexpr double half_periods = 33.5;  // of the output, on either side: the window's main lobe is then 0.12 of the rate
constexpr std::array nuttall = {0.355768, 0.487396, 0.144232, 0.012604};

/// A function with its first and second derivative.
struct Jet {
  double value, first, second;
};

/// sin(a t) / (π t) with a = π rate: passes frequencies below half the rate.
Jet sinc(double t, double rate) {
  const double a = pi * rate;
  const double x = a * t;
  if (std::abs(x) < 1e-2) {
    const double x2 = x * x;
    return {rate * (1.0 - x2 / 6.0 + x2 * x2 / 120.0), rate * a * (-x / 3.0 + x * x2 / 30.0),
            rate * a * a * (-1.0 / 3.0 + x2 / 10.0 - x2 * x2 / 168.0)};
  }
  const double s = std::sin(x), c = std::cos(x);
  return {rate * s / x, rate * a * (c / x - s / (x * x)),
          rate * a * a * (-s / x - 2.0 * c / (x * x) + 2.0 * s / (x * x * x))};
}

Jet window(double t, double half_s) {
  const double a = pi / half_s;
  Jet w = {0.0, 0.0, 0.0};
  for (std::size_t k = 0; k < nuttall.size(); ++k) {
    const double b = static_cast<double>(k) * a;
    w.value += nuttall[k] * std::cos(b * t);
    w.first -= nuttall[k] * b * std::sin(b * t);
    w.second -= nuttall[k] * b * b * std::cos(b * t);
  }
  return w;
}

}  // namespace

Resampler::Resampler(double step_s, double rate_hz, Eigen::Index rows, int directions)
    : displacement_m(Eigen::Matrix<double, Eigen::Dynamic, 3>::Zero(rows, 3)),
      acceleration_m_per_s2(displacement_m),
      force_n(displacement_m),
      step_s_(step_s),
      rate_hz_(rate_hz),
      directions_(static_cast<std::size_t>(directions)) {
  const double half_s = half_periods / rate_hz;
  half_ = static_cast<int>(std::ceil(half_s / step_s)) + 1;
  taps_ = 2 * static_cast<std::size_t>(half_);
  capacity_ = 4 * taps_;
  history_.assign(6 * capacity_, 0.0);
  // Zeros for the time before the first sample.
  filled_ = taps_;
  first_ = -static_cast<long long>(taps_);
  fractions_ = static_cast<std::size_t>(std::ceil(std::max(1.0, places_per_period * step_s * rate_hz)));
  value_.rows.assign((fractions_ + 1) * taps_, 0.0);
  second_.rows = value_.rows;
  // Tap k of fraction f weighs the sample at floor + 1 - half + k for an output at floor + f.
  for (std::size_t row = 0; row <= fractions_; ++row) {
    const double fraction = static_cast<double>(row) / static_cast<double>(fractions_);
    for (std::size_t k = 0; k < taps_; ++k) {
      const double t = (fraction - (static_cast<double>(k) + 1.0 - half_)) * step_s;
      if (std::abs(t) >= half_s) continue;
      const Jet s = sinc(t, rate_hz);
      const Jet w = window(t, half_s);
      value_.rows[row * taps_ + k] = step_s * s.value * w.value;
      second_.rows[row * taps_ + k] = step_s * (s.second * w.value + 2.0 * s.first * w.first + s.value * w.second);
    }
  }
  value_weights_.resize(taps_);
  second_weights_.resize(taps_);
  force_weights_.resize(taps_);
}

void Resampler::weights(const Kernel& kernel, double fraction, std::vector<double>& out) const {
  const double place = fraction * static_cast<double>(fractions_);
  const auto row = std::min(static_cast<std::size_t>(place), fractions_ - 1);
  const double r = place - static_cast<double>(row);
  const double* const p = kernel.rows.data() + row * taps_;
  const double* const q = p + taps_;
  for (std::size_t k = 0; k < taps_; ++k) out[k] = p[k] + r * (q[k] - p[k]);
}

void Resampler::emit() {
  const auto at = [](double position) {
    const double whole = std::floor(position);
    return std::pair(static_cast<long long>(whole), position - whole);
  };
  const auto sum = [](const std::vector<double>& w, const double* x) {
    return Eigen::Map<const Eigen::VectorXd>(w.data(), static_cast<Eigen::Index>(w.size()))
        .dot(Eigen::Map<const Eigen::VectorXd>(x, static_cast<Eigen::Index>(w.size())));
  };
  while (!done()) {
    const double position = static_cast<double>(next_) / (rate_hz_ * step_s_);
    const auto [whole, fraction] = at(position);
    // The mean force over the step that ended at n belongs half a step before it.
    const auto [force_whole, force_fraction] = at(position + 0.5);
    const long long begin = whole + 1 - half_ - first_;
    const long long force_begin = force_whole + 1 - half_ - first_;
    const long long end = static_cast<long long>(filled_);
    if (std::max(begin, force_begin) + static_cast<long long>(taps_) > end) return;
    weights(value_, fraction, value_weights_);
    weights(second_, fraction, second_weights_);
    weights(value_, force_fraction, force_weights_);
    const Eigen::Map<const Eigen::VectorXd> second(second_weights_.data(), static_cast<Eigen::Index>(taps_));
    // Against the sample in the middle: a displacement at rest then has no acceleration, to the last bit.
    const double total = second.sum();
    for (std::size_t c = 0; c < directions_; ++c) {
      const Eigen::Index column = static_cast<Eigen::Index>(c);
      const double* const q = channel(c) + begin;
      displacement_m(next_, column) = sum(value_weights_, q);
      acceleration_m_per_s2(next_, column) = sum(second_weights_, q) - total * q[half_ - 1];
      force_n(next_, column) = sum(force_weights_, channel(c + 3) + force_begin);
    }
    ++next_;
  }
}

void Resampler::push(const Eigen::Vector3d& displacement, const Eigen::Vector3d& force) {
  if (done()) return;
  if (filled_ == capacity_) {
    emit();
    const std::size_t keep = 2 * taps_;
    for (std::size_t c = 0; c < 6; ++c) {
      double* const x = history_.data() + c * capacity_;
      std::copy(x + (filled_ - keep), x + filled_, x);
    }
    first_ += static_cast<long long>(filled_ - keep);
    filled_ = keep;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    const Eigen::Index i = static_cast<Eigen::Index>(c);
    history_[c * capacity_ + filled_] = displacement(i);
    history_[(c + 3) * capacity_ + filled_] = force(i);
  }
  ++filled_;
  const double position = static_cast<double>(next_) / (rate_hz_ * step_s_);
  const double newest = static_cast<double>(first_ + static_cast<long long>(filled_) - 1);
  if (newest >= position + half_ + 1.0) emit();
}

}  // namespace robomill::simulation::detail
