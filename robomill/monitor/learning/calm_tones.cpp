#include "robomill/monitor/learning/calm_tones.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "robomill/monitor/learning/calm_cells.hpp"

namespace robomill::monitor {
namespace {

constexpr double above_noise = 16.0;  // of the power
constexpr double floor_hz = 100.0;    // over which the noise's is taken
constexpr double near_order = 2.0;    // 1/T: an order's own
constexpr double least_tone_share = 0.05;
constexpr std::size_t most_tones = 20;

}  // namespace

void CalmTones::add(const CutTests::Shown& shown) {
  const std::span<const float> power = shown.slow;
  const Spectrum& like = shown.spectra->spectrum(0, 0);
  if (!floor_) floor_ = std::make_unique<NoiseFloor>(power.size());
  const std::span<const float> floor = floor_->of(power, static_cast<std::size_t>(floor_hz / like.step_hz));
  std::size_t cell_before = seen_.size();
  double strongest = 0.0;
  for (std::size_t i = std::max<std::size_t>(1, like.first_line()); i + 1 < power.size(); ++i) {
    const double here = power[i];
    if (here <= power[i - 1] || here < power[i + 1] || here < above_noise * static_cast<double>(floor[i])) continue;
    const double hz = like.peak_hz(i, power[i - 1], here, power[i + 1]);
    const double order = shown.rotation_hz > 0.0 ? hz / shown.rotation_hz : 0.5;
    if (std::abs(order - std::round(order)) * shown.rotation_hz * like.seconds < near_order && shown.rotation_hz > 0.0)
      continue;
    const auto cell = static_cast<std::size_t>(hz / Machine::cell_hz);
    if (cell >= seen_.size()) continue;
    Seen& seen = seen_[cell];
    if (cell == cell_before) {
      if (here <= strongest) continue;
    } else {
      ++seen.hops;
      seen.frequency_sum_hz += hz;
    }
    seen.power_sum += cell == cell_before ? here - strongest : here;
    cell_before = cell;
    strongest = here;
  }
}

// A tone at the border of two cells stands in both.
std::vector<LearntTone> CalmTones::found(int hops) const {
  std::vector<LearntTone> out;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const auto at = [&](std::size_t cell) { return cell < seen_.size() ? seen_[cell] : Seen{}; };
    const Seen here = at(i), before = at(i - 1), after = at(i + 1);
    if (here.power_sum <= before.power_sum || here.power_sum < after.power_sum) continue;
    Seen sum = here;
    for (const Seen& beside : {before, after}) {
      const double apart_hz =
          beside.hops > 0 ? beside.frequency_sum_hz / beside.hops - here.frequency_sum_hz / here.hops : 1e9;
      if (std::abs(apart_hz) > 0.5 * Machine::cell_hz) continue;
      sum.hops += beside.hops;
      sum.frequency_sum_hz += beside.frequency_sum_hz;
      sum.power_sum += beside.power_sum;
    }
    const double share = std::min(1.0, static_cast<double>(sum.hops) / std::max(1, hops));
    if (share < least_tone_share) continue;
    out.push_back({.frequency_hz = rounded(sum.frequency_sum_hz / sum.hops),
                   .level = rounded(std::sqrt(0.5 * sum.power_sum / sum.hops)),
                   .share = rounded(share)});
  }
  std::ranges::sort(out, std::greater<>(), &LearntTone::level);
  if (out.size() > most_tones) out.resize(most_tones);
  return out;
}

}  // namespace robomill::monitor
