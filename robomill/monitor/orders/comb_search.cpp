#include "robomill/monitor/orders/comb_search.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/monitor/orders/mains.hpp"

namespace robomill::monitor {
namespace {

constexpr double lowest_sought_hz = 15.0, highest_sought_hz = 500.0, step = 1.5e-3;
constexpr double highest_line_hz = 1500.0;
constexpr double search_memory_s = 1.0;
constexpr double comb_search_floor = 0.02;  // share of the energy that no comb explains
constexpr double credit = 4.0;              // of ln f
constexpr double margin = 4.0;
constexpr double related_width = 0.01;
constexpr double mains_width = 0.01;

// One is a multiple of the other: between these the credit decides.
bool related(double a_hz, double b_hz) {
  const double ratio = std::max(a_hz, b_hz) / std::min(a_hz, b_hz);
  return std::abs(ratio - std::round(ratio)) < related_width * ratio;
}

}  // namespace

CombSearch::CombSearch(double hop_s) : hop_s_(hop_s) {
  for (double hz = lowest_sought_hz; hz <= highest_sought_hz; hz *= 1.0 + step) {
    candidate_hz_.push_back(hz);
    credit_.push_back(credit * std::log(hz));
  }
  for (auto* of_each : {&place_, &held_, &here_}) of_each->resize(candidate_hz_.size());
  evidence_.resize(candidate_hz_.size());
}

void CombSearch::reset() noexcept {
  std::ranges::fill(evidence_, 0.0);
  found_hz_ = 0.0;
}

void CombSearch::observe(std::span<const float> power, const Spectrum& like) noexcept {
  const WindowEnergy energy = energy_of(power, like, highest_line_hz);
  if (energy.whole <= 0.0) return;
  const double forgets = std::exp(-hop_s_ / search_memory_s);
  const double weight = 2.0 * hop_s_ / like.seconds * energy.lines;
  for (std::size_t i = 0; i < place_.size(); ++i) place_[i] = static_cast<float>(candidate_hz_[i] / like.step_hz);
  std::ranges::fill(held_, 0.0F);
  std::size_t count = 0;
  for (int k = 1; (count = at_multiple(power, like.dip, place_, k, energy.last, here_)) > 0; ++k) {
    for (std::size_t i = 0; i < count; ++i) held_[i] += here_[i];
  }
  std::size_t best = 0;
  const auto total = [&](std::size_t i) { return evidence_[i] + credit_[i]; };
  for (std::size_t i = 0; i < candidate_hz_.size(); ++i) {
    const double chance = std::min(0.9, 1.5 / (candidate_hz_[i] * like.seconds));
    const double share = std::clamp((static_cast<double>(held_[i]) / energy.whole - chance) / (1.0 - chance), 0.0, 1.0);
    evidence_[i] = forgets * evidence_[i] - weight * std::log(1.0 + comb_search_floor - share);
    if (total(i) > total(best)) best = i;
  }
  double second = -1e9;
  for (std::size_t i = 0; i < candidate_hz_.size(); ++i) {
    if (total(i) > second && !related(candidate_hz_[i], candidate_hz_[best])) second = total(i);
  }
  const bool mains = std::ranges::any_of(
      mains_rotation_hz, [&](double hz) { return std::abs(candidate_hz_[best] / hz - 1.0) < mains_width; });
  found_hz_ = total(best) - second > margin && !mains ? candidate_hz_[best] : 0.0;
}

}  // namespace robomill::monitor
