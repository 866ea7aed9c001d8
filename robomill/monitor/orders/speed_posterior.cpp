#include "robomill/monitor/orders/speed_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "robomill/monitor/orders/mains.hpp"

namespace robomill::monitor {
namespace {

constexpr double drift_ratio = 8e-4;     // of a Cauchy distribution, a hop
constexpr std::size_t drift_reach = 30;  // steps
constexpr std::size_t near_reach = 6;    // steps
constexpr double held_reach = 4.0;       // steps
constexpr double anew = 1e-3;            // a hop, to be drawn from the prior
constexpr double believable = 1e-15;
constexpr double known_within = 0.004;
constexpr double mains_ratio = 0.01, highest_of_mains_hz = 190.0, hint_of_mains_ratio = 0.01;
constexpr double miscounted = 1e-4;   // probability density of a measurement that is wrong
constexpr double unexplained = 0.02;  // share of the energy that a comb never explains
constexpr int low_of_teeth = 6, low_of_rotation = 1, low_of_unknown_teeth = 12;
constexpr double peak_reach = 0.5;  // 1/T

}  // namespace

SpeedPosterior::SpeedPosterior(const Setup& setup)
    : setup_(setup),
      prior_(size),
      belief_(size),
      drift_(drift_reach + 1),
      evidence_(size),
      wide_(size + 2 * drift_reach),
      ratio_(size) {
  for (auto* of_each : {&place_, &here_, &held_, &low_, &hum_, &shares_}) of_each->resize(size);
  double sum = 0.0;
  for (std::size_t i = 0; i < drift_.size(); ++i) {
    const double x = static_cast<double>(i) * step / drift_ratio;
    drift_[i] = 1.0 / (1.0 + x * x);
    sum += (i == 0 ? 1.0 : 2.0) * drift_[i];
  }
  for (double& p : drift_) p /= sum;
  sum = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    const double x = (static_cast<double>(i) - static_cast<double>(side)) * step / setup.std_ratio;
    prior_[i] = 1.0 / (1.0 + x * x);
    sum += prior_[i];
    ratio_[i] = std::exp((static_cast<double>(i) - static_cast<double>(side)) * step);
  }
  for (double& p : prior_) p /= sum;
  reset();
}

void SpeedPosterior::set_hint(double rotation_hz) noexcept {
  if (rotation_hz == hint_hz_) return;
  const double shift = hint_hz_ > 0.0 && rotation_hz > 0.0 ? std::log(rotation_hz / hint_hz_) / step : 1e9;
  hint_hz_ = rotation_hz;
  if (std::abs(shift) > static_cast<double>(side)) {
    reset();
    return;
  }
  // The candidates move with the hint, the speeds that were believed in do not.
  const auto by = static_cast<std::ptrdiff_t>(std::lround(shift));
  for (std::size_t i = 0; i < size; ++i) {
    const std::ptrdiff_t from = static_cast<std::ptrdiff_t>(i) + by;
    const bool within = from >= 0 && from < static_cast<std::ptrdiff_t>(size);
    wide_[drift_reach + i] = within ? belief_[static_cast<std::size_t>(from)] : anew * prior_[i];
  }
  std::copy_n(wide_.begin() + drift_reach, size, belief_.begin());
  held_place_ = -1.0;
}

void SpeedPosterior::reset() noexcept {
  rotation_hz_ = hint_hz_;
  std_ratio_ = setup_.std_ratio;
  share_ = known_ = lines_ = 0.0;
  held_place_ = -1.0;
  belief_ = prior_;
  std::ranges::fill(evidence_, 0.0);
}

double SpeedPosterior::candidate_hz(double place) const noexcept {
  return hint_hz_ * std::exp((place - static_cast<double>(side)) * step);
}

// Hum has a comb of its own, which shows while the spindle idles.
bool SpeedPosterior::of_the_mains(double rotation_hz) const noexcept {
  const auto near = [](double a_hz, double b_hz, double ratio) { return std::abs(a_hz - b_hz) < ratio * b_hz; };
  for (const double hz : mains_rotation_hz) {
    if (near(rotation_hz, hz, mains_ratio)) return !near(hint_hz_, hz, hint_of_mains_ratio);
  }
  return false;
}

void SpeedPosterior::predict(Motion motion) noexcept {
  if (motion != Motion::held)
    held_place_ = -1.0;
  else if (held_place_ < 0.0)
    held_place_ = static_cast<double>(std::ranges::max_element(belief_) - belief_.begin());
  const double fresh = motion == Motion::free ? anew : 0.0;
  const std::size_t reach_steps = motion == Motion::free ? drift_reach : near_reach;
  std::ranges::copy(belief_, wide_.begin() + drift_reach);
  for (std::size_t i = 0; i < size; ++i) belief_[i] *= drift_[0];
  for (std::size_t j = 1; j <= reach_steps; ++j) {
    const double* before = wide_.data() + drift_reach - j;
    const double* after = wide_.data() + drift_reach + j;
    const double share = drift_[j];
    for (std::size_t i = 0; i < size; ++i) belief_[i] += share * (before[i] + after[i]);
  }
  for (std::size_t i = 0; i < size; ++i) {
    const bool out = held_place_ >= 0.0 && std::abs(static_cast<double>(i) - held_place_) > held_reach;
    belief_[i] = out ? 1e-30 : (1.0 - fresh) * belief_[i] + fresh * prior_[i];
  }
  std::ranges::fill(evidence_, 0.0);
}

void SpeedPosterior::observe(std::span<const float> power, const Spectrum& like) noexcept {
  std::ranges::fill(shares_, 0.0F);
  if (hint_hz_ < lowest_rotation_hz) return;
  const WindowEnergy energy = energy_of(power, like, setup_.highest_hz);
  if (energy.whole <= 0.0) return;
  const int teeth = std::max(1, setup_.teeth);
  const int low_orders = setup_.teeth > 0 ? low_of_teeth * teeth : low_of_unknown_teeth;
  lines_ = std::max(0.0, energy.lines - 1.0);
  const double weight = 2.0 * setup_.hop_s / like.seconds;
  const auto believed = [](double p) { return p > believable; };
  const auto first = std::ranges::find_if(belief_, believed) - belief_.begin();
  const auto end = std::find_if(belief_.rbegin(), belief_.rend() - first, believed).base() - belief_.begin();
  const auto ratios = std::span(ratio_).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(end - first));
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    place_[i] = static_cast<float>(hint_hz_ * ratios[i] / like.step_hz);
    held_[i] = low_[i] = hum_[i] = 0.0F;
  }
  const auto places = std::span(place_).first(ratios.size());
  std::size_t count = 0;
  for (int k = 1; (count = at_multiple(power, places, k, energy.last, here_)) > 0; ++k) {
    // Beside hum only what stands above it speaks for a speed.
    for (std::size_t i = 0; i < count && k * hint_hz_ * ratios[i] < highest_of_mains_hz; ++i) {
      if (of_the_mains(hint_hz_ * ratios[i])) hum_[i] += std::exchange(here_[i], 0.0F);
    }
    for (std::size_t i = 0; i < count; ++i) held_[i] += here_[i];
    if (k > low_orders || (k % teeth != 0 && k > low_of_rotation)) continue;
    for (std::size_t i = 0; i < count; ++i) low_[i] += here_[i];
  }
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    const double chance = std::min(0.9, 1.5 / (hint_hz_ * ratios[i] * like.seconds));
    const double rest = std::max(1e-3 * energy.whole, energy.whole - static_cast<double>(hum_[i]));
    const double share = std::min(1.0, (static_cast<double>(held_[i]) / rest - chance) / (1.0 - chance));
    const double alone = std::min(1.0, static_cast<double>(low_[i]) / rest);
    const std::size_t candidate = static_cast<std::size_t>(first) + i;
    shares_[candidate] = static_cast<float>(share);
    evidence_[candidate] -= weight * (lines_ + alone) * std::log(1.0 + unexplained - std::max(0.0, share));
  }
}

void SpeedPosterior::observe(double rotation_hz, double std_ratio) noexcept {
  if (hint_hz_ <= 0.0 || rotation_hz <= 0.0) return;
  const double at = std::log(rotation_hz / hint_hz_) / step + static_cast<double>(side);
  const double width = std::max(1.0, std_ratio / step);
  for (std::size_t i = 0; i < size; ++i) {
    const double d = (static_cast<double>(i) - at) / width;
    evidence_[i] += std::log(std::exp(-0.5 * d * d) + miscounted);
  }
}

void SpeedPosterior::conclude() noexcept {
  if (hint_hz_ <= 0.0) return;
  const double most = *std::ranges::max_element(evidence_);
  double sum = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    belief_[i] *= std::exp(evidence_[i] - most);
    sum += belief_[i];
  }
  for (double& p : belief_) p /= sum;
  const auto best = static_cast<std::size_t>(std::ranges::max_element(belief_) - belief_.begin());
  double off = 0.0;
  if (best > 0 && best + 1 < size) {
    const double before = std::log(belief_[best - 1] + 1e-300);
    const double after = std::log(belief_[best + 1] + 1e-300);
    const double bend = before - 2.0 * std::log(belief_[best]) + after;
    if (bend < 0.0) off = std::clamp(0.5 * (before - after) / bend, -0.5, 0.5);
  }
  const double place = static_cast<double>(best) + off;
  rotation_hz_ = candidate_hz(place);
  double variance = 0.0;
  known_ = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    const double d = (static_cast<double>(i) - place) * step;
    variance += belief_[i] * d * d;
    if (std::abs(d) < known_within) known_ += belief_[i];
  }
  std_ratio_ = std::sqrt(variance);
  share_ = static_cast<double>(shares_[best]);
}

void SpeedPosterior::refine(std::span<const float> power, const Spectrum& like) noexcept {
  if (rotation_hz_ < lowest_rotation_hz) return;
  const auto last = std::min(power.size() - 2, static_cast<std::size_t>(setup_.highest_hz / like.step_hz));
  const double order_step = rotation_hz_ / like.step_hz;
  const double reach_lines = peak_reach / (like.seconds * like.step_hz);
  double sum = 0.0;
  double weight = 0.0;
  double k = 1.0;
  for (double at = order_step; at + 2.0 < static_cast<double>(last); at += order_step, k += 1.0) {
    auto near = static_cast<std::size_t>(std::lround(at));
    if (power[near + 1] > power[near]) ++near;
    if (power[near - 1] > power[near]) --near;
    if (power[near] < power[near - 1] || power[near] < power[near + 1]) continue;
    const double peak_hz = like.peak_hz(near, static_cast<double>(power[near - 1]), static_cast<double>(power[near]),
                                        static_cast<double>(power[near + 1]));
    if (std::abs(peak_hz / like.step_hz - at) > reach_lines) continue;
    sum += k * static_cast<double>(power[near]) * peak_hz;
    weight += k * k * static_cast<double>(power[near]);
  }
  if (weight > 0.0) rotation_hz_ = sum / weight;
}

}  // namespace robomill::monitor
