#include "robomill/monitor/comb_cusum/cusum.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::monitor {
namespace {

constexpr double ratio = 6.0;            // q
constexpr double hops_to_alarm = 2.0;    // no hop adds more than this part of h
constexpr double slower_down = 4.0;      // a baseline is given up in no less than so many times the hops of an alarm
constexpr double euler = 0.5772;         // γ
constexpr double spread_of_noise = 0.9;  // s0: mean deviation of a log energy in steady noise, times 1.25
constexpr double unsure = 1.5;           // u
constexpr double first_hops = 4.0;       // that are learnt before any is judged
constexpr double freely = 8.0;           // hops that a baseline follows wherever they are
constexpr double falling_share = 0.25;   // of the evidence, from channels that fall: it rings off

}  // namespace

Cusum::Cusum(const Setup& setup)
    : lines_(setup.lines),
      channels_(setup.channels),
      threshold_(std::log(static_cast<double>(setup.lines) * 3600.0 / setup.hop_s / setup.false_alarms_per_hour)),
      slow_(setup.hop_s / setup.baseline_s),
      energy_(lines_ * channels_),
      mean_(lines_ * channels_),
      log_(lines_ * channels_),
      base_(lines_ * channels_),
      spread_(lines_ * channels_),
      z_(lines_ * channels_),
      up_(lines_),
      down_(lines_),
      sorted_(lines_) {
  relearn();
}

void Cusum::clear() noexcept {
  std::fill(up_.begin(), up_.end(), 0.0);
  std::fill(down_.begin(), down_.end(), 0.0);
}

void Cusum::relearn() noexcept {
  learnt_ = 0.0;
  std::fill(mean_.begin(), mean_.end(), 0.0);
  std::fill(spread_.begin(), spread_.end(), spread_of_noise);
  clear();
}

void Cusum::accept(std::size_t line) noexcept {
  for (std::size_t k = line > 2 ? line - 2 : 0; k <= std::min(line + 2, lines_ - 1); ++k) {
    up_[k] = down_[k] = 0.0;
    for (std::size_t i = k; i < log_.size(); i += lines_) {
      base_[i] = log_[i];
      mean_[i] = energy_[i];
    }
  }
}

double Cusum::measure(std::span<const double> energy, std::span<const double> taken) noexcept {
  double common = 1e9;
  for (std::size_t c = 0; c < channels_; ++c) {
    const std::size_t from = c * lines_;
    double mean = 0.0;
    for (std::size_t k = 0; k < lines_; ++k) mean += energy[from + k];
    const double floor = mean > 0.0 ? 1e-7 * mean / static_cast<double>(lines_) : 0.0;
    for (std::size_t i = from; i < from + lines_; ++i) {
      energy_[i] = energy[i] + floor;
      log_[i] = std::log(std::max(energy_[i], 1e-300));
      // A channel that is silent says nothing.
      z_[i] = mean == 0.0     ? -9.0
              : learnt_ > 0.0 ? (log_[i] - base_[i]) * std::min(1.0, spread_of_noise / spread_[i])
                              : 0.0;
    }
    std::copy_n(z_.begin() + static_cast<std::ptrdiff_t>(from), lines_, sorted_.begin());
    const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(lines_ / 2);
    std::nth_element(sorted_.begin(), middle, sorted_.end());
    if (mean > 0.0) common = std::min(common, *middle);
    for (std::size_t i = from; i < from + lines_; ++i) {
      z_[i] += std::log(std::max(1.0 - taken[i] / std::max(energy_[i], 1e-300), 0.01)) *
               std::min(1.0, spread_of_noise / spread_[i]);
    }
  }
  return common < 1e9 ? common : 0.0;
}

Cusum::Verdict Cusum::step(std::span<const double> energy, std::span<const double> taken,
                           std::span<const bool> falls) noexcept {
  Verdict out;
  out.common = measure(energy, taken);
  out.ready = learnt_ >= first_hops;
  const double off = std::max(0.0, out.common) + unsure / std::sqrt(std::max(1.0, learnt_));
  for (double& z : z_) z -= off;
  const double most = 1.001 * threshold_ / hops_to_alarm;  // so that so many hops are enough
  for (std::size_t k = 1; k + 1 < lines_; ++k) {
    double sum = 0.0;
    double less = 0.0;
    double all = 0.0;
    double falling = 0.0;
    for (std::size_t c = 0; out.ready && c < channels_; ++c) {
      const std::size_t i = c * lines_ + k;
      less += std::log(ratio) - (ratio - 1.0) * std::exp(std::min(log_[i] - base_[i] - euler, 8.0));
      const double rho = std::exp(std::min(z_[c * lines_ + k] - euler, 8.0));
      const double more = (1.0 - 1.0 / ratio) * rho - std::log(ratio);
      sum += std::min(more, most);
      const double evidence = std::clamp(more, 0.0, most);
      all += evidence;
      if (falls[c]) falling += evidence;
    }
    if (falling > falling_share * all) sum = std::min(sum, 0.0);
    up_[k] = std::clamp(up_[k] + std::min(sum, most), 0.0, 2.0 * threshold_);
    down_[k] = std::max(0.0, down_[k] + std::min(less, most / slower_down));
    if (up_[k] > out.score) {
      out.score = up_[k];
      out.line = k;
    }
  }
  out.height = -1e9;
  for (std::size_t c = 0; c < channels_; ++c) {
    if (height(c, out.line) > out.height) {
      out.height = height(c, out.line);
      out.channel = c;
    }
  }
  return out;
}

void Cusum::learn() noexcept {
  for (std::size_t k = 1; k + 1 < lines_; ++k) {
    if (down_[k] <= threshold_) continue;
    down_[k] = 0.0;
    for (std::size_t i = k; i < log_.size(); i += lines_) {
      base_[i] -= std::log(ratio);
      mean_[i] /= ratio;
    }
  }
  for (std::size_t i = 0; i < log_.size(); ++i) {
    if (energy_[i] <= 0.0) continue;
    if (learnt_ < freely) {
      // A log's mean takes long to settle where single values are near zero.
      mean_[i] += (energy_[i] - mean_[i]) / (learnt_ + 1.0);
      base_[i] = std::log(mean_[i]) - euler;
      continue;
    }
    // What is on its way up is not to become the baseline.
    const double share = up_[i % lines_] > 0.2 * threshold_ ? 0.2 : 1.0;
    const double d = log_[i] - base_[i];
    base_[i] += share * std::max(slow_, 1.0 / (learnt_ + 1.0)) * std::clamp(d, -2.0 * spread_[i], 2.0 * spread_[i]);
    // Of a normal variable the mean of |d| is σ √(2/π).
    spread_[i] += slow_ * (std::min(1.2533 * std::abs(d), 3.0 * spread_[i]) - spread_[i]);
  }
  learnt_ += 1.0;
}

}  // namespace robomill::monitor
