#include "robomill/monitor/orders/slow_line.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::monitor {
namespace {

constexpr double offset_reach = 2.0;  // 1/T: below stands what a drifting offset leaves
constexpr double skirt_of = 0.5, nearest = 0.5;
constexpr double order_lobe = 1.5;     // 1/T, to each side of an order
constexpr double lowest_order = 0.45;  // below axes and floors move

}  // namespace

SlowLine::SlowLine(const Spectrum& like, double highest_hz)
    : highest_hz_(std::min(highest_hz, highest_line_hz)),
      rest_(std::min(like.line.size() - 1, static_cast<std::size_t>(highest_hz_ / like.step_hz) + 2)) {}

void SlowLine::step(std::span<const float> power, const Spectrum& like, double rotation_hz) noexcept {
  const std::size_t used =
      std::min({rest_.size(), power.size(), static_cast<std::size_t>(highest_hz_ / like.step_hz) + 1});
  const double bin = like.seconds * like.step_hz;  // 1/T
  const double orders = rotation_hz / like.step_hz;
  const auto at_order = [&](double k) {
    const double place = k * orders;
    if (k < 1.0 || place >= static_cast<double>(used - 1)) return 0.0;
    return static_cast<double>(like.power_at(power, place));
  };
  std::size_t strongest = 0;
  for (std::size_t i = 0; i < used; ++i) {
    const auto place = static_cast<double>(i);
    rest_[i] = 0.0F;
    if (place * bin <= offset_reach || i < like.first_line() || place < lowest_order * orders) continue;
    const double k = std::round(place / orders);
    const double off = (place - k * orders) * bin;
    if (std::abs(off) <= order_lobe) continue;
    const double other = off > 0.0 ? k + 1.0 : k - 1.0;
    const double apart = std::max(nearest, std::abs(place - other * orders) * bin);
    const double skirts = skirt_of * (at_order(k) / (off * off) + at_order(other) / (apart * apart));
    rest_[i] = std::max(0.0F, power[i] - static_cast<float>(skirts));
    if (rest_[i] > rest_[strongest]) strongest = i;
  }
  frequency_hz_ = 0.0;
  if (rest_[strongest] <= 0.0F || strongest + 1 >= used) return;
  frequency_hz_ = like.peak_hz(strongest, static_cast<double>(power[strongest - 1]),
                               static_cast<double>(power[strongest]), static_cast<double>(power[strongest + 1]));
}

}  // namespace robomill::monitor
