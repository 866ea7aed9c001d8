#include "robomill/monitor/orders/dominant_line.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/monitor/orders/hops.hpp"

namespace robomill::monitor {
namespace {

constexpr double keeps_ratio = 0.03, keeps_least_hz = 8.0, keeps_most_ratio = 0.08;
constexpr double window_s = 0.3;
constexpr std::size_t longest_gap = 4;  // hops without, after which it begins anew
constexpr double line_lobe = 2.0;       // 1/T, to each side, that a line shows
constexpr double resolved = 5.0;        // 1/T: multiples further apart can be left out, and lines between them be seen
constexpr int low_orders = 5;           // of rotation: unbalance and runout
constexpr int first_of_comb = 2, last_of_comb = 6;

}  // namespace

DominantLine::DominantLine(std::size_t lines, double hop_s)
    : hop_s_(hop_s), rest_(lines), frequencies_(kept_of), energies_(hops_of(past_s, hop_s)) {
  reset();
}

void DominantLine::reset() noexcept {
  std::ranges::fill(frequencies_, 0.0);
  std::ranges::fill(energies_, -1.0);
  at_ = energy_at_ = since_ = 0;
  gap_ = longest_gap + 1;
  frequency_hz_ = share_ = energy_ = since_energy_ = 0.0;
}

void DominantLine::leave_out(double frequency_hz, double off_hz, const Spectrum& like, std::size_t lines) noexcept {
  const double reach_hz = off_hz + line_lobe / like.seconds;
  const auto from = static_cast<std::size_t>(std::ceil(std::max(0.0, frequency_hz - reach_hz) / like.step_hz));
  const auto end = std::min(lines, static_cast<std::size_t>((frequency_hz + reach_hz) / like.step_hz) + 1);
  for (std::size_t i = from; i < end; ++i) rest_[i] = 0.0F;
}

void DominantLine::leave_out_forced(const Spectrum& like, std::size_t lines, const Forced& forced) noexcept {
  const double highest_hz = static_cast<double>(lines) * like.step_hz;
  // Where the teeth are not known, any multiple of rotation may be theirs.
  const double teeth_hz = forced.rotation_hz * std::max(1, forced.teeth);
  if (teeth_hz > resolved / like.seconds) {
    for (double hz = teeth_hz; hz - 0.5 * teeth_hz < highest_hz; hz += teeth_hz) {
      leave_out(hz, std::min(forced.off_ratio * hz, 0.5 * teeth_hz), like, lines);
    }
    for (int k = 1; forced.rotation_hz > resolved / like.seconds && k <= low_orders; ++k) {
      leave_out(k * forced.rotation_hz, k * forced.rotation_hz * forced.off_ratio, like, lines);
    }
  }
  for (int k = first_of_comb; forced.comb_hz > 0.0 && k <= last_of_comb; ++k) {
    leave_out(k * forced.comb_hz, 0.0, like, lines);
  }
}

void DominantLine::step(std::span<const float> power, const Spectrum& like, double whole, const Forced& forced,
                        bool full) noexcept {
  const std::size_t lines = power.size();
  std::ranges::copy(power, rest_.begin());
  std::fill_n(rest_.begin(), std::min(lines, like.first_line()), 0.0F);
  leave_out_forced(like, lines, forced);
  const auto rest = std::span(rest_).first(lines);
  const auto at = static_cast<std::size_t>(std::ranges::max_element(rest) - rest.begin());
  frequency_hz_ = share_ = energy_ = 0.0;
  const bool peak =
      rest[at] > 0.0F && at >= 2 && at + 2 < lines && power[at - 1] <= power[at] && power[at + 1] <= power[at];
  if (peak) {
    frequency_hz_ = like.peak_hz(at, static_cast<double>(power[at - 1]), static_cast<double>(power[at]),
                                 static_cast<double>(power[at + 1]));
    const auto beside = static_cast<std::size_t>(line_lobe / (like.seconds * like.step_hz));
    const std::size_t from = at > beside ? at - beside : 0;
    energy_ = sums_of(power.subspan(from, std::min(lines, at + beside + 1) - from)).plain * like.energy_share();
    share_ = energy_ / (whole + 1e-300);
  }
  follow(energy_, full);
}

void DominantLine::follow(double energy, bool full) noexcept {
  frequencies_[at_] = frequency_hz_;
  at_ = at_ + 1 == frequencies_.size() ? 0 : at_ + 1;
  energies_[energy_at_] = full ? energy : -1.0;
  energy_at_ = energy_at_ + 1 == energies_.size() ? 0 : energy_at_ + 1;
  if (share_ >= least_share) {
    if (gap_ > longest_gap) {
      since_ = 0;
      since_energy_ = 0.0;
    }
    gap_ = 0;
  } else {
    ++gap_;
  }
  ++since_;
  if (gap_ == 0 && since_ > hops_of(window_s, hop_s_)) {
    since_energy_ = since_energy_ == 0.0 ? energy : std::min(since_energy_, energy);
  }
}

int DominantLine::kept() const noexcept {
  if (frequency_hz_ <= 0.0) return 0;
  const double off_hz =
      std::min(std::max(keeps_least_hz, keeps_ratio * frequency_hz_), keeps_most_ratio * frequency_hz_);
  return static_cast<int>(
      std::ranges::count_if(frequencies_, [&](double hz) { return std::abs(hz - frequency_hz_) <= off_hz; }));
}

double DominantLine::rise() const noexcept {
  double least = -1.0;
  for (const double energy : energies_) {
    if (energy >= 0.0 && (least < 0.0 || energy < least)) least = energy;
  }
  return least < 0.0 ? 0.0 : energy_ / (least + 1e-300);
}

double DominantLine::rise_since() const noexcept {
  return since_energy_ > 0.0 ? energy_ / since_energy_ : 0.0;
}

}  // namespace robomill::monitor
