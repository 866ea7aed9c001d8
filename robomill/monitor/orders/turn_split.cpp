#include "robomill/monitor/orders/turn_split.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "robomill/monitor/orders/hops.hpp"
#include "robomill/monitor/orders/thresholds.hpp"

namespace robomill::monitor {
namespace {

using namespace thresholds;

constexpr double enough_hz = 512.0, highest_sought_hz = 256.0;
constexpr double fitted = 0.49;                         // of the reduced rate: orders up to there
constexpr std::array longest_s = {1.0};                 // four turns at the lowest speed
constexpr double fewest_turns = 4.0, shortest_s = 0.4;  // of a window
constexpr double rise_s = 2.0, most_s = 1.0, lasting_s = 0.4;
// The quietest is forgotten, and hardly where a cut stands out of it. A stream that begins in a cut has none: where
// tooth passing holds the energy for a second, it is taken to be 12 dB lower.
constexpr double quiet_memory_s = 10.0, quiet_memory_in_cut_s = 600.0;
constexpr double begins_in_cut_s = 1.0, of_teeth = 0.5, quieter_by = 16.0;
constexpr std::size_t measured_each = 2;  // hops

// The speed is sought by the low multiples of rotation and of tooth passing, which hold most of forced vibration; by so
// much off the tracked one and the hint, and more until the tracker has seen some of the cut.
constexpr double low_of_rotation = 5.5, low_of_teeth = 3.5;
constexpr double speed_off = 0.03, speed_off_at_first = 0.05, at_first_s = 1.2, speed_step = 1.0025;

}  // namespace

TurnSplit::TurnSplit(double sample_rate_hz, std::size_t channels, double hop_s)
    : measured_each_s_(hop_s * measured_each),
      channels_(channels),
      spectra_(sample_rate_hz, channels, longest_s, enough_hz),
      x_(static_cast<std::size_t>(longest_s[0] * spectra_.rate_hz())),
      fft_(2 * std::bit_ceil(x_.size()), false),
      padded_(4 * std::bit_ceil(x_.size())),
      power_(padded_.size() / 2),
      line_(power_.size()),
      cos_(static_cast<std::size_t>(fitted * spectra_.rate_hz() / lowest_rotation_hz) + 1),
      sin_(cos_.size()),
      turn_cos_(cos_.size()),
      turn_sin_(cos_.size()),
      sums_(4 * cos_.size()),
      past_(hops_of(rise_s, measured_each_s_) + 1),
      stood_(hops_of(lasting_s, measured_each_s_)) {}

void TurnSplit::reset() noexcept {
  spectra_.reset();
  step({}, 0);
  skip_ = false;
}

double TurnSplit::ratio() const noexcept {
  return energy_ratio(now_.rest, now_.repeated);
}

double TurnSplit::settled_s() const noexcept {
  return rest_settled * window_s_;
}

double TurnSplit::lasting() const noexcept {
  return static_cast<double>(std::ranges::count(stood_, 1)) / static_cast<double>(stood_.size());
}

bool TurnSplit::holds() const noexcept {
  return measured_ > 0 && ratio() >= least_rest && holding() >= least_holding && rise() >= least_rest_rise &&
         repeating() >= least_repeating && staying() >= least_rest_staying && above_quiet() >= quiet_is_known &&
         repeating_above_quiet() >= least_repeating_above_quiet && loud_s() >= settled_s();
}

// Whole turns, an even number of them: the halves are whole turns, too.
std::span<float> TurnSplit::window(double rotation_hz) noexcept {
  const double turns = std::max(fewest_turns, 2.0 * std::ceil(0.5 * shortest_s * rotation_hz));
  const auto length = static_cast<std::size_t>(std::lround(turns / rotation_hz * spectra_.rate_hz()));
  return std::span(x_).first(std::min(x_.size(), length));
}

// Without offset and slope: these are no vibration.
void TurnSplit::fill(std::size_t channel, std::span<float> x) const noexcept {
  spectra_.last(channel, x);
  const auto n = static_cast<double>(x.size());
  const double middle = 0.5 * (n - 1.0);
  double sum = 0.0;
  double slope = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += static_cast<double>(x[i]);
    slope += static_cast<double>(x[i]) * (static_cast<double>(i) - middle);
  }
  slope /= n * (n * n - 1.0) / 12.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] -= static_cast<float>(sum / n + slope * (static_cast<double>(i) - middle));
  }
}

double TurnSplit::at_multiples(double rotation_hz, double highest_hz) const noexcept {
  const double step_hz = spectra_.rate_hz() / static_cast<double>(padded_.size());
  double sum = 0.0;
  for (double hz = rotation_hz; hz < highest_hz; hz += rotation_hz) {
    const double place = hz / step_hz;
    const auto k = static_cast<std::size_t>(place);
    const double part = place - static_cast<double>(k);
    sum += (1.0 - part) * static_cast<double>(power_[k]) + part * static_cast<double>(power_[k + 1]);
  }
  return sum;
}

// A speed that is off by a part in a hundred leaves orders that seem not to repeat.
double TurnSplit::best_speed(const Speed& speed, std::uint64_t bad_channels) noexcept {
  const std::span<float> x = window(speed.rotation_hz);
  std::ranges::fill(power_, 0.0F);
  for (std::size_t c = 0; c < channels_; ++c) {
    if ((bad_channels >> c & 1U) != 0) continue;
    fill(c, x);
    std::ranges::copy(x, padded_.begin());
    std::fill(padded_.begin() + static_cast<std::ptrdiff_t>(x.size()), padded_.end(), 0.0F);
    fft_.transform_real(padded_.data(), line_.data());
    for (std::size_t i = 1; i < line_.size(); ++i) power_[i] += std::norm(line_[i]);
  }
  const double low = speed.rotation_hz * std::max(low_of_rotation, low_of_teeth * speed.teeth);
  const double highest_hz = std::min({highest_sought_hz, fitted * spectra_.rate_hz(), low});
  const double off = loud_s_ < at_first_s ? speed_off_at_first : speed_off;
  const double last_hz = std::max(speed.rotation_hz, speed.hint_hz) * (1.0 + off);
  double best = speed.rotation_hz;
  double most = 0.0;
  for (double hz = std::min(speed.rotation_hz, speed.hint_hz) * (1.0 - off); hz <= last_hz; hz *= speed_step) {
    const double sum = at_multiples(hz, highest_hz);
    if (sum <= most) continue;
    most = sum;
    best = hz;
  }
  return std::max(lowest_rotation_hz, best);
}

void TurnSplit::project(std::span<const float> x, double rotation_hz, std::size_t orders) noexcept {
  const double angle = 2.0 * std::numbers::pi * rotation_hz / spectra_.rate_hz();
  for (std::size_t k = 0; k < orders; ++k) {
    const double of_order = angle * static_cast<double>(k + 1);
    turn_cos_[k] = static_cast<float>(std::cos(of_order));
    turn_sin_[k] = static_cast<float>(std::sin(of_order));
  }
  std::fill_n(cos_.begin(), orders, 1.0F);
  std::fill_n(sin_.begin(), orders, 0.0F);
  std::ranges::fill(sums_, 0.0F);
  for (std::size_t i = 0; i < x.size(); ++i) {
    float* sums = sums_.data() + (2 * i < x.size() ? 0 : 2 * cos_.size());
    for (std::size_t k = 0; k < orders; ++k) {
      sums[k] += x[i] * cos_[k];
      sums[cos_.size() + k] += x[i] * sin_[k];
      const float next = cos_[k] * turn_cos_[k] - sin_[k] * turn_sin_[k];
      sin_[k] = sin_[k] * turn_cos_[k] + cos_[k] * turn_sin_[k];
      cos_[k] = next;
    }
  }
}

TurnSplit::Energies TurnSplit::measure(double rotation_hz, int teeth, std::uint64_t bad_channels) noexcept {
  const std::span<float> x = window(rotation_hz);
  const std::size_t half = (x.size() + 1) / 2;
  window_s_ = static_cast<double>(x.size()) / spectra_.rate_hz();
  const auto orders = std::min(cos_.size(), static_cast<std::size_t>(fitted * spectra_.rate_hz() / rotation_hz));
  const double scale = 4.0 / static_cast<double>(x.size());
  Energies out;
  std::array<double, 2> rest = {};
  for (std::size_t c = 0; c < channels_; ++c) {
    if ((bad_channels >> c & 1U) != 0) continue;
    fill(c, x);
    project(x, rotation_hz, orders);
    std::array<double, 2> energy = {sums_of(x.first(half)).squares / static_cast<double>(half),
                                    sums_of(x.subspan(half)).squares / static_cast<double>(x.size() - half)};
    out.whole += 0.5 * (energy[0] + energy[1]);
    const float* second = sums_.data() + 2 * cos_.size();
    for (std::size_t i = 0; i < 2 * cos_.size(); ++i) {
      // Of an order its amplitude in both halves, and in all: what is left of a half is Σ (x - fit)².
      const double a = scale * static_cast<double>(sums_[i]);
      const double b = scale * static_cast<double>(second[i]);
      const double both = 0.5 * (a + b);
      out.repeated += 0.5 * both * both;
      if (teeth > 1 && (i % cos_.size() + 1) % static_cast<std::size_t>(teeth) == 0) out.teeth += 0.5 * both * both;
      energy[0] -= both * a - 0.5 * both * both;
      energy[1] -= both * b - 0.5 * both * both;
    }
    for (std::size_t h = 0; h < 2; ++h) rest[h] += std::max(0.0, energy[h]);
  }
  // Of a line beside the orders so much is lost as they take of all that the window may hold.
  const double turns = window_s_ * rotation_hz;
  out.rest = 0.5 * (rest[0] + rest[1]) * turns / (turns - 1.0);
  out.holds = energy_ratio(rest[1], rest[0]);
  return out;
}

void TurnSplit::compare() noexcept {
  Energies most = now_;
  double least = now_.rest;
  for (std::size_t h = 1; h < std::min(measured_, past_.size()); ++h) {
    const Energies& then = past_[(measured_ - 1 - h) % past_.size()];
    least = std::min(least, then.rest);
    if (h > hops_of(most_s, measured_each_s_)) continue;
    most.repeated = std::max(most.repeated, then.repeated);
    most.whole = std::max(most.whole, then.whole);
  }
  rise_ = energy_ratio(now_.rest, least);
  repeating_ = energy_ratio(now_.repeated, most.repeated);
  staying_ = energy_ratio(now_.whole, most.whole);
  follow_quiet();
  above_quiet_ = energy_ratio(now_.whole, quiet_);
  repeating_above_quiet_ = energy_ratio(now_.repeated, quiet_);
  loud_s_ = above_quiet_ >= quiet_is_known ? loud_s_ + measured_each_s_ : 0.0;
}

void TurnSplit::follow_quiet() noexcept {
  const bool in_cut = quiet_ > 0.0 && now_.whole >= quiet_is_known * quiet_;
  const double memory_s = in_cut ? quiet_memory_in_cut_s : quiet_memory_s;
  quiet_ = quiet_ == 0.0 ? now_.whole : std::min(now_.whole, quiet_ * std::exp(measured_each_s_ / memory_s));
  if (level_s_ < 0.0) return;
  level_s_ = in_cut ? -1.0 : now_.teeth >= of_teeth * now_.whole ? level_s_ + measured_each_s_ : 0.0;
  if (level_s_ < begins_in_cut_s) return;
  quiet_ = now_.whole / quieter_by;
  level_s_ = -1.0;
}

void TurnSplit::step(const Speed& speed, std::uint64_t bad_channels) noexcept {
  if (speed.rotation_hz < lowest_rotation_hz) {
    now_ = {};
    measured_ = 0;
    level_s_ = window_s_ = loud_s_ = quiet_ = rise_ = repeating_ = staying_ = above_quiet_ = repeating_above_quiet_ =
        0.0;
    std::ranges::fill(stood_, 0);
    return;
  }
  skip_ = !skip_;
  const std::uint64_t all = ~std::uint64_t{0} >> (64U - channels_);
  if (skip_ || (~bad_channels & all) == 0) return;
  const double rotation_hz = best_speed(speed, bad_channels);
  if (spectra_.past_s() * spectra_.rate_hz() < static_cast<double>(window(rotation_hz).size())) return;
  now_ = measure(rotation_hz, speed.teeth, bad_channels);
  past_[measured_ % past_.size()] = now_;
  ++measured_;
  compare();
  stood_[measured_ % stood_.size()] = holds() ? 1 : 0;
}

}  // namespace robomill::monitor
