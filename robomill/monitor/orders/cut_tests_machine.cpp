// CutTests against a machine that was learnt, and what one is learnt from.
#include <algorithm>
#include <cmath>

#include "robomill/monitor/orders/cut_tests.hpp"

namespace robomill::monitor {
namespace {

double energy_in(std::span<const float> power, const Spectrum& like, MachineLines::Band band) noexcept {
  const auto line = [&](double hz) {
    return std::min(power.size(), static_cast<std::size_t>(std::ceil(hz / like.step_hz)));
  };
  const std::size_t from = std::max(like.first_line(), line(band.from_hz)), end = line(band.to_hz);
  return from < end ? sums_of(power.subspan(from, end - from)).plain * like.energy_share() : 0.0;
}

}  // namespace

// A line beside the orders against what stands beside them; another one, whichever it is, against everything.
void CutTests::ask_what_is_new() noexcept {
  if (!machine_.known()) return;
  const double rotation_hz = follows() ? speed_.rotation_hz() : 0.0;
  for (Explanation& why : why_) {
    const double hz = why.conditions > 0 ? reading_hz(why.test) : 0.0;
    if (why.conditions == 0) continue;
    const bool of_orders = why.test == Test::growth || why.test == Test::ratio || why.test == Test::family;
    const Window& window = windows_[window_of(why.test)];
    const double apart_hz = rotation_hz > 0.0 ? std::abs(hz - rotation_hz * std::round(hz / rotation_hz)) : 0.0;
    const bool beside = of_orders && apart_hz * window.like().seconds > ResidualLines::main_lobe;
    const MachineLines::Band band = MachineLines::band(hz);
    const double now =
        beside ? window.lines.between(band.from_hz, band.to_hz) : energy_in(window.power, window.like(), band);
    why.ask(Quantity::line_new, hz > 0.0 ? now / (machine_.shown(hz, rotation_hz, beside) + 1e-300) : 0.0,
            MachineLines::least_new);
  }
}

CutTests::Shown CutTests::shown() const noexcept {
  const Window &fast = windows_[s_0_15], &slow = windows_[s_0_3];
  return {.seconds = fast_.past_s(),
          .energy = energy_,
          .rotation_hz = follows() ? speed_.rotation_hz() : 0.0,
          .fast = fast.power,
          .slow = slow.power,
          .spectra = &fast_,
          .bad_channels = bad_channels_};
}

void CutTests::show(std::span<double> all, std::span<double> beside) const noexcept {
  std::ranges::fill(all, 0.0);
  std::ranges::fill(beside, 0.0);
  const Window& fast = windows_[s_0_15];
  const Spectrum& like = fast.like();
  for (std::size_t i = like.first_line(); i < fast.power.size(); ++i) {
    const auto cell = static_cast<std::size_t>(static_cast<double>(i) * like.step_hz / Machine::cell_hz);
    all[std::min(all.size() - 1, cell)] += static_cast<double>(fast.power[i]) * like.energy_share();
  }
  if (follows()) windows_[near_].lines.share_out(Machine::cell_hz, beside);
}

}  // namespace robomill::monitor
