#include "robomill/monitor/orders/speed_tracker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace robomill::monitor {
namespace {

constexpr double speed_memory_s = 1.0;
constexpr double weight = 30.0;  // of the evidence, against the prior
constexpr int most_orders = 24, fewest_orders = 2;
constexpr float first_teeth_weight = 4.0F, teeth_weight = 2.0F;  // counts an order of tooth passing
constexpr double miscounted = 1e-4;                              // probability density of a measurement that is wrong
constexpr double faint = 100.0;      // of an order's energy, in the second strongest one's: a fainter one counts less
constexpr double peak_reach = 1.5;   // 1/T
constexpr double flank_reach = 1.0;  // 1/T
constexpr float flank = 0.15F;       // of a line's worth, where the peak beside it is ten times as strong
constexpr double agrees = 4.0;       // standard deviations

}  // namespace

SpeedTracker::SpeedTracker(const Setup& setup)
    : setup_(setup), prior_(size), ratio_(size), total_(size), worth_(setup.lines) {
  for (auto* of_each : {&evidence_, &sum_, &place_, &here_, &sorted_}) of_each->resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    const double x = (static_cast<double>(i) - static_cast<double>(side)) * step_ratio / setup.std_ratio;
    prior_[i] = -std::log1p(x * x);
    ratio_[i] = std::exp(x * setup.std_ratio);
  }
  reset();
}

void SpeedTracker::set_hint(double rotation_hz) noexcept {
  if (rotation_hz == hint_hz_) return;
  const double shift = hint_hz_ > 0.0 && rotation_hz > 0.0 ? std::log(rotation_hz / hint_hz_) / step_ratio : 1e9;
  hint_hz_ = rotation_hz;
  if (std::abs(shift) > static_cast<double>(side)) {
    reset();
    return;
  }
  // The candidates move with the hint, what was learnt of their speeds does not.
  const auto by = static_cast<std::ptrdiff_t>(std::lround(shift));
  for (std::size_t i = 0; i < size; ++i) {
    const std::ptrdiff_t from = static_cast<std::ptrdiff_t>(i) + by;
    const bool within = from >= 0 && from < static_cast<std::ptrdiff_t>(size);
    here_[i] = within ? evidence_[static_cast<std::size_t>(from)] : 0.0F;
  }
  evidence_.swap(here_);
}

void SpeedTracker::reset() noexcept {
  rotation_hz_ = hint_hz_;
  std_ratio_ = setup_.std_ratio;
  belief_ = seen_ = gathered_ = measured_hz_ = 0.0;
  std::ranges::fill(evidence_, 0.0F);
}

void SpeedTracker::measured(double rotation_hz, double std_ratio) noexcept {
  measured_hz_ = rotation_hz;
  measured_std_ratio_ = std::max(std_ratio, step_ratio);
}

void SpeedTracker::gather(std::span<const float> power, std::span<const float> floor, const Spectrum& like) noexcept {
  const double fastest_hz = hint_hz_ * std::exp(reach);
  const double highest_hz = static_cast<double>(power.size() - 1) * like.step_hz;
  const int orders = static_cast<int>(std::min<double>(most_orders, highest_hz / fastest_hz - 1.0));
  const double share = std::min(1.0, setup_.hop_s / speed_memory_s);
  gathered_ += share * (1.0 - gathered_);
  std::ranges::fill(sum_, 0.0F);
  if (orders < fewest_orders) return;
  const auto lines = std::min(power.size(), static_cast<std::size_t>(orders * fastest_hz / like.step_hz) + 3);
  lines_seen_ = lines;
  const auto beside = static_cast<std::size_t>(std::lround(flank_reach / (like.seconds * like.step_hz)));
  for (std::size_t i = 0; i < lines; ++i) {
    const float over = power[i] / (2.0F * floor[i] + 1e-30F);
    worth_[i] = 0.0F;
    if (over <= 1.0F) continue;
    const std::size_t from = i - std::min(i, beside);
    const std::size_t to = std::min(i + beside + 1, power.size());
    const float peak = std::ranges::max(power.subspan(from, to - from));
    worth_[i] = std::max(0.0F, std::min(1.0F, 0.5F * std::log10(over)) - flank * std::log10(peak / power[i]));
  }
  for (std::size_t i = 0; i < size; ++i) {
    place_[i] = static_cast<float>(hint_hz_ * ratio_[i] / like.step_hz);
  }
  float weights = 0.0F;
  for (int k = 1; k <= orders; ++k) {
    const bool of_teeth = setup_.teeth > 0 && k % setup_.teeth == 0;
    const float each = !of_teeth ? 1.0F : k == setup_.teeth ? first_teeth_weight : teeth_weight;
    weights += each;
    at_multiple(worth_, 0.0F, place_, k, lines - 1, here_);
    for (std::size_t i = 0; i < size; ++i) sum_[i] += each * here_[i];
  }
  for (std::size_t i = 0; i < size; ++i) {
    sum_[i] /= weights;
    evidence_[i] += static_cast<float>(share) * (sum_[i] - evidence_[i]);
  }
}

void SpeedTracker::conclude() noexcept {
  for (std::size_t i = 0; i < size; ++i) total_[i] = weight * static_cast<double>(evidence_[i]) + prior_[i];
  if (measured_hz_ > 0.0) {
    const double at = std::log(measured_hz_ / hint_hz_) / step_ratio + static_cast<double>(side);
    for (std::size_t i = 0; i < size; ++i) {
      const double d = (static_cast<double>(i) - at) * step_ratio / measured_std_ratio_;
      total_[i] += std::log(std::exp(-0.5 * d * d) + miscounted);
    }
  }
  const auto best = static_cast<std::size_t>(std::ranges::max_element(total_) - total_.begin());
  double off = 0.0;
  if (best > 0 && best + 1 < size) {
    const double bend = total_[best - 1] - 2.0 * total_[best] + total_[best + 1];
    if (bend < 0.0) off = std::clamp(0.5 * (total_[best - 1] - total_[best + 1]) / bend, -0.5, 0.5);
  }
  const double place = static_cast<double>(best) + off;
  rotation_hz_ = hint_hz_ * std::exp((place - static_cast<double>(side)) * step_ratio);
  double sum = 0.0;
  double variance = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    const double d = (static_cast<double>(i) - place) * step_ratio;
    const double p = std::exp(total_[i] - total_[best]);
    sum += p;
    variance += p * d * d;
  }
  std_ratio_ = std::sqrt(variance / sum);
  const auto above_median = [&](const std::vector<float>& of) {
    std::ranges::copy(of, sorted_.begin());
    const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(side);
    std::nth_element(sorted_.begin(), middle, sorted_.end());
    return static_cast<double>(of[best] - *middle);
  };
  belief_ = gathered_ > 0.0 ? above_median(evidence_) / gathered_ : 0.0;
  seen_ = above_median(sum_);
  if (measured_hz_ > 0.0 && std::abs(std::log(rotation_hz_ / measured_hz_)) < agrees * measured_std_ratio_) {
    belief_ = 1.0;
  }
  measured_hz_ = 0.0;
}

double SpeedTracker::lead_of_an_order(double line_hz, std::span<const float> power,
                                      const Spectrum& like) const noexcept {
  const double teeth_hz = hint_hz_ * std::max(1, setup_.teeth);
  const double first = std::ceil(line_hz / (teeth_hz * std::exp(reach)));
  const double last = std::min<double>(most_orders, line_hz / (teeth_hz * std::exp(-reach)));
  const auto highest = static_cast<double>(power.size() - 1);
  const auto at = [&](double hz) {
    return static_cast<double>(power[static_cast<std::size_t>(std::lround(hz / like.step_hz))]);
  };
  double most = -1.0;
  for (double k = std::max(1.0, first); k <= last; ++k) {
    const double other_hz = hint_hz_ * line_hz / (k * teeth_hz);
    double sum = 0.0;
    int orders = 0;
    while (orders < most_orders && (orders + 1) * std::max(other_hz, rotation_hz_) < highest * like.step_hz) {
      ++orders;
      sum += 0.5 * std::log10((at(orders * other_hz) + 1e-30) / (at(orders * rotation_hz_) + 1e-30));
    }
    if (orders > 0) most = std::max(most, sum / orders);
  }
  return most;
}

// By the median of the peaks within a line's width of the multiples: a lobe's top is too flat to read the speed
// off, and a chatter line that meets a multiple counts as one of some twenty.
void SpeedTracker::refine(std::span<const float> power, const Spectrum& like) noexcept {
  const double order_step = rotation_hz_ / like.step_hz;
  const double reach_lines = peak_reach / (like.seconds * like.step_hz);
  const auto last = static_cast<double>(lines_seen_) - 3.0;
  std::array<std::pair<double, double>, most_orders> read;  // f, weight
  std::size_t count = 0;
  double weights = 0.0;
  // The second strongest: the strongest may be a chatter line that meets a multiple.
  float first = 0.0F;
  float second = 0.0F;
  for (int k = 1; k <= most_orders && k * order_step < last; ++k) {
    const float here = power[static_cast<std::size_t>(std::lround(k * order_step))];
    second = std::max(second, std::min(first, here));
    first = std::max(first, here);
  }
  for (int k = 1; k <= most_orders && k * order_step < last; ++k) {
    const double at = k * order_step;
    auto near = static_cast<std::size_t>(std::lround(at));
    if (near < 2) continue;
    const auto beside = [&](double lines) { return std::abs(static_cast<double>(near) - at) < lines; };
    while (near + 2 < lines_seen_ && power[near + 1] > power[near] && beside(reach_lines)) ++near;
    while (near > 2 && power[near - 1] > power[near] && beside(reach_lines)) --near;
    if (power[near] < power[near - 1] || power[near] < power[near + 1]) continue;
    const double peak_hz = like.peak_hz(near, static_cast<double>(power[near - 1]), static_cast<double>(power[near]),
                                        static_cast<double>(power[near + 1]));
    const double worth = static_cast<double>(worth_[near]);
    const double weight =
        k * worth * worth * std::min(1.0, faint * static_cast<double>(power[near] / (second + 1e-30F)));
    if (std::abs(peak_hz / like.step_hz - at) > reach_lines || weight <= 0.0) continue;
    read.at(count++) = {peak_hz / k, weight};
    weights += weight;
  }
  std::sort(read.begin(), read.begin() + static_cast<std::ptrdiff_t>(count));
  double below = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    below += read.at(i).second;
    if (2.0 * below < weights) continue;
    rotation_hz_ = read.at(i).first;
    return;
  }
}

void SpeedTracker::step(std::span<const float> power, std::span<const float> floor, const Spectrum& like) noexcept {
  if (hint_hz_ <= 0.0) return;
  lines_seen_ = 0;
  gather(power, floor, like);
  const bool pulses = measured_hz_ > 0.0;
  conclude();
  if (pulses) return;
  refine(power, like);
  refine(power, like);  // more of them are near enough now
}

}  // namespace robomill::monitor
