#include "robomill/monitor/orders/slow_line.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/monitor/orders/hops.hpp"

namespace robomill::monitor {
namespace {

constexpr double rise_s = 1.7, left_s = 1.0;
constexpr double line_reach = 1.5;    // 1/T, to each side, that a line shows
constexpr double offset_reach = 2.0;  // 1/T: below stands what a drifting offset leaves
constexpr double skirt_of = 0.5, nearest = 0.5;
constexpr double order_lobe = 1.5;  // 1/T, to each side of an order
constexpr double lasting_windows = 0.6, holding_windows = 0.5;
constexpr double lowest_order = 0.45;  // below axes and floors move

}  // namespace

SlowLine::SlowLine(const Spectrum& like, double highest_hz, double hop_s)
    : hop_s_(hop_s),
      highest_hz_(std::min(highest_hz, highest_line_hz)),
      lines_(std::min(like.line.size() - 1, static_cast<std::size_t>(highest_hz_ / like.step_hz) + 2)),
      rest_(lines_),
      hops_kept_(hops_of(rise_s + holding_windows * like.seconds, hop_s) + 2) {
  past_.resize(pairs() * hops_kept_);
  stood_.resize(hops_kept_);
  reset();
}

void SlowLine::reset() noexcept {
  hops_ = 0;
  frequency_hz_ = energy_ = synchronous_ = whole_ = holding_ = rise_ = left_of_it_ = 0.0;
}

double SlowLine::ratio() const noexcept {
  return energy_ / (synchronous_ + 1e-300);
}

double SlowLine::share() const noexcept {
  return energy_ / (whole_ + 1e-300);
}

double SlowLine::lasting() const noexcept {
  const std::size_t of = std::max<std::size_t>(1, hops_of(lasting_windows * seconds_, hop_s_));
  if (hops_ < of) return 0.0;
  double count = 0.0;
  for (std::size_t h = 1; h <= of; ++h) count += stood_[(hops_ - h) % hops_kept_] != 0 ? 1.0 : 0.0;
  return count / static_cast<double>(of);
}

void SlowLine::measure(std::span<const float> power, const Spectrum& like, double rotation_hz) noexcept {
  const double bin = like.seconds * like.step_hz;  // 1/T
  const double orders = rotation_hz / like.step_hz;
  const auto at_order = [&](double k) {
    const double place = k * orders;
    if (k < 1.0 || place >= static_cast<double>(used_ - 1)) return 0.0;
    const auto line = static_cast<std::size_t>(place);
    const double part = place - static_cast<double>(line);
    return (1.0 - part) * static_cast<double>(power[line]) + part * static_cast<double>(power[line + 1]);
  };
  synchronous_ = whole_ = energy_ = frequency_hz_ = 0.0;
  for (double k = 1.0; k * orders < static_cast<double>(used_ - 1); ++k) synchronous_ += at_order(k);
  std::size_t strongest = 0;
  for (std::size_t i = 0; i < used_; ++i) {
    const auto place = static_cast<double>(i);
    rest_[i] = 0.0F;
    if (place * bin <= offset_reach) continue;
    whole_ += static_cast<double>(power[i]);
    const double k = std::round(place / orders);
    const double off = (place - k * orders) * bin;
    if (std::abs(off) <= order_lobe || i < like.first_line() || place < lowest_order * orders) continue;
    const double other = off > 0.0 ? k + 1.0 : k - 1.0;
    const double apart = std::max(nearest, std::abs(place - other * orders) * bin);
    const double skirts = skirt_of * (at_order(k) / (off * off) + at_order(other) / (apart * apart));
    rest_[i] = std::max(0.0F, power[i] - static_cast<float>(skirts));
    if (rest_[i] > rest_[strongest]) strongest = i;
  }
  whole_ *= like.energy_share();
  if (rest_[strongest] <= 0.0F || strongest + 1 >= used_) return;
  frequency_hz_ = like.peak_hz(strongest, static_cast<double>(power[strongest - 1]),
                               static_cast<double>(power[strongest]), static_cast<double>(power[strongest + 1]));
  const auto beside = static_cast<std::size_t>(line_reach / bin);
  const std::size_t from = strongest - std::min(strongest, beside);
  energy_ = sums_of(std::span(rest_).subspan(from, std::min(used_, strongest + beside + 1) - from)).plain *
            like.energy_share();
}

// What stands at the line now, against what stood there before.
void SlowLine::compare(const Spectrum& like) noexcept {
  holding_ = rise_ = left_of_it_ = 0.0;
  const std::size_t half = hops_of(holding_windows * seconds_, hop_s_);
  if (frequency_hz_ <= 0.0 || hops_ < half + 1) return;
  const auto at = static_cast<std::size_t>(std::lround(frequency_hz_ / like.step_hz));
  const auto beside = static_cast<std::size_t>(line_reach / (like.seconds * like.step_hz));
  const std::size_t from = (at - std::min(at, beside)) / 2;
  const std::size_t count = std::min(pairs(), (at + beside) / 2 + 1) - from;
  const auto then = [&](std::size_t hops) {
    return sums_of(std::span(past_).subspan((hops_ - 1 - hops) % hops_kept_ * pairs() + from, count)).plain;
  };
  const double now = then(0);
  double most_of_half = 0.0;
  double most_of_second = 0.0;
  double least = now;
  for (std::size_t h = 1; h < std::min(hops_, hops_kept_); ++h) {
    const double before = then(h);
    if (h <= half) most_of_half = std::max(most_of_half, before);
    if (h <= hops_of(left_s, hop_s_)) most_of_second = std::max(most_of_second, before);
    least = std::min(least, before);
  }
  holding_ = now / (most_of_half + 1e-300);
  left_of_it_ = now / (most_of_second + 1e-300);
  rise_ = now / (least + 1e-300);
}

void SlowLine::step(std::span<const float> power, const Spectrum& like, double rotation_hz, bool full) noexcept {
  if (like.seconds != seconds_) reset();
  seconds_ = like.seconds;
  used_ = std::min({lines_, power.size(), static_cast<std::size_t>(highest_hz_ / like.step_hz) + 1});
  measure(power, like, rotation_hz);
  const auto kept = std::span(past_).subspan(hops_ % hops_kept_ * pairs(), pairs());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    kept[i] = (2 * i < used_ ? power[2 * i] : 0.0F) + (2 * i + 1 < used_ ? power[2 * i + 1] : 0.0F);
  }
  stood_[hops_ % hops_kept_] = static_cast<char>(full && ratio() >= least_ratio && share() >= least_share);
  ++hops_;
  compare(like);
}

}  // namespace robomill::monitor
