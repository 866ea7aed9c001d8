#include "robomill/monitor/orders/comb_search.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::monitor {
namespace {

constexpr double lowest_hz = 15.0, highest_hz = 500.0, step = 1.5e-3;
constexpr double highest_line_hz = 1500.0;
constexpr double memory_s = 1.0;
constexpr double offset_guard = 2.5;  // 1/T, from 0
constexpr double unexplained = 0.02;
constexpr double peaked = 0.53;  // ∫h⁴/(∫h²)²
constexpr double most_lines = 20.0;
constexpr double credit = 4.0;  // of ln f
constexpr double margin = 4.0;
constexpr double beside = 0.01;
constexpr double mains_ratio = 0.01;

// One is a multiple of the other: between these the credit decides.
bool related(double a_hz, double b_hz) {
  const double ratio = std::max(a_hz, b_hz) / std::min(a_hz, b_hz);
  return std::abs(ratio - std::round(ratio)) < beside * ratio;
}

}  // namespace

CombSearch::CombSearch(double hop_s) : hop_s_(hop_s) {
  for (double hz = lowest_hz; hz <= highest_hz; hz *= 1.0 + step) candidate_hz_.push_back(hz);
  evidence_.resize(candidate_hz_.size());
}

void CombSearch::reset() noexcept {
  std::ranges::fill(evidence_, 0.0);
  found_hz_ = 0.0;
}

void CombSearch::observe(std::span<const float> power, const Spectrum& like) noexcept {
  const auto last = std::min(power.size() - 2, static_cast<std::size_t>(highest_line_hz / like.step_hz));
  const auto first = static_cast<std::size_t>(offset_guard / (like.seconds * like.step_hz)) + 1;
  double sum = 0.0;
  double squares = 1e-300;
  for (std::size_t i = first; i <= last; ++i) {
    const auto p = static_cast<double>(power[i]);
    sum += p;
    squares += p * p;
  }
  if (sum <= 0.0) return;
  const double lines = std::clamp(sum * sum / squares * like.seconds * like.step_hz * peaked, 0.0, most_lines);
  const double whole = sum * like.energy_share();
  const double forgets = std::exp(-hop_s_ / memory_s);
  const double weight = 2.0 * hop_s_ / like.seconds * lines;
  std::size_t best = 0;
  const auto total = [&](std::size_t i) { return evidence_[i] + credit * std::log(candidate_hz_[i]); };
  for (std::size_t i = 0; i < candidate_hz_.size(); ++i) {
    const double order_step = candidate_hz_[i] / like.step_hz;
    float held = 0.0F;
    for (double at = order_step; at < static_cast<double>(last); at += order_step) {
      const auto k = static_cast<std::size_t>(at);
      const auto part = static_cast<float>(at - static_cast<double>(k));
      held += power[k] + part * (power[k + 1] - power[k]);
    }
    const double chance = std::min(0.9, 1.5 / (candidate_hz_[i] * like.seconds));
    const double share = std::clamp((static_cast<double>(held) / whole - chance) / (1.0 - chance), 0.0, 1.0);
    evidence_[i] = forgets * evidence_[i] - weight * std::log(1.0 + unexplained - share);
    if (total(i) > total(best)) best = i;
  }
  double second = -1e9;
  for (std::size_t i = 0; i < candidate_hz_.size(); ++i) {
    if (!related(candidate_hz_[i], candidate_hz_[best])) second = std::max(second, total(i));
  }
  const bool mains = std::ranges::any_of(std::array{25.0, 30.0, 50.0, 60.0}, [&](double hz) {
    return std::abs(candidate_hz_[best] / hz - 1.0) < mains_ratio;
  });
  found_hz_ = total(best) - second > margin && !mains ? candidate_hz_[best] : 0.0;
}

}  // namespace robomill::monitor
