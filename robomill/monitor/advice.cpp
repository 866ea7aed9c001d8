#include "robomill/monitor/advice.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/stability/peak_classification.hpp"

namespace robomill::monitor {
namespace {

constexpr double deviations = 3.0;  // within which a line is a mode's
// The force's harmonics fall at least as their number. Without this bound lines of 10 kHz would count as sidebands of
// modes of 500 Hz: they are as many as there are multiples of rotation.
constexpr int most_tooth_passings = 10;

struct Structure {
  const modal::ModalModel& modes;
  const modal::ModalModel& workpiece;
};

// The comb has taken out what rotates with the spindle: the residual is chatter.
stability::ExplainedPeak explained_peak(double line_hz, bool folded, double std_hz, double spindle_speed_rad_per_s,
                                        int teeth, const Structure& structure) {
  if (folded && line_hz > stability::MeasuredPeaks::highest_hz) return {};
  // The tolerance of explain() must stay below a quarter of rotation.
  const double most = 0.24 * spindle_speed_rad_per_s / units::revolution;
  stability::PeakClassificationOptions options{
      .tolerance_hz = std::clamp(deviations * std_hz, std::min(1.0, most), most), .multiples_removed = true};
  if (folded) options.most_rotations = most_tooth_passings * teeth;
  return stability::explain(
             {.frequency_hz = {line_hz}, .spindle_speed_rad_per_s = spindle_speed_rad_per_s, .teeth = teeth},
             structure.modes, options, structure.workpiece)
      .peaks.front();
}

void name_mode(Advice& advice, const stability::ExplainedPeak& peak) {
  advice.mode = peak.best.mode;
  advice.expected_hz = peak.best.mode_frequency_hz;
  if (std::isfinite(peak.chatter_frequency_hz)) {
    advice.frequency_hz = advice.lowest_hz = peak.chatter_frequency_hz;
  } else if (peak.state == stability::ExplainedPeak::State::ambiguous) {
    advice.frequency_hz = 0.0;
    for (const stability::Explanation& reading : peak.others) {
      if (reading.mode.known()) advice.lowest_hz = std::min(advice.lowest_hz, reading.mode_frequency_hz);
    }
  }
}

// Leaves of the frequencies that the line may have those that the modes explain, where they explain any.
void read_line(Advice& advice, double spindle_speed_rad_per_s, int teeth, const Structure& structure) {
  const bool known = advice.line_hz.size() == 1;
  std::vector<double> fitting_hz;
  stability::ExplainedPeak last;
  for (const double line_hz : advice.line_hz) {
    const bool folded = line_hz != advice.line_hz.front();
    const stability::ExplainedPeak peak =
        explained_peak(line_hz, folded, advice.std_hz, spindle_speed_rad_per_s, teeth, structure);
    if (!known && peak.state == stability::ExplainedPeak::State::unexplained) continue;
    fitting_hz.push_back(line_hz);
    last = peak;
  }
  if (!fitting_hz.empty()) advice.line_hz = std::move(fitting_hz);
  if (advice.line_hz.size() > 1) return;
  advice.frequency_hz = advice.lowest_hz = advice.line_hz.front();
  name_mode(advice, last);
}

/// A chart's depths over speed, on the line from one speed to the next.
struct Depths {
  std::vector<double> speed_rad_per_s;
  std::vector<double> depth_m;

  [[nodiscard]] double at(double speed) const {
    const auto above = std::ranges::lower_bound(speed_rad_per_s, speed);
    const auto k = static_cast<std::size_t>(above - speed_rad_per_s.begin());
    if (*above == speed) return depth_m[k];
    const double share = (speed - speed_rad_per_s[k - 1]) / (speed_rad_per_s[k] - speed_rad_per_s[k - 1]);
    return std::lerp(depth_m[k - 1], depth_m[k], share);
  }
  /// The lowest from one speed to another, as far as the chart has them; infinity: it has none.
  [[nodiscard]] double lowest(double from, double to) const {
    double out = std::numeric_limits<double>::infinity();
    if (speed_rad_per_s.empty()) return out;
    from = std::max(from, speed_rad_per_s.front());
    to = std::min(to, speed_rad_per_s.back());
    if (from > to) return out;
    out = std::min(at(from), at(to));
    const auto first = std::ranges::lower_bound(speed_rad_per_s, from);
    for (auto k = static_cast<std::size_t>(first - speed_rad_per_s.begin());
         k < speed_rad_per_s.size() && speed_rad_per_s[k] < to; ++k) {
      out = std::min(out, depth_m[k]);
    }
    return out;
  }
};

Depths limits_of(const stability::LobesResult& lobes) {
  const double deepest = lobes.axial_depth_m.size() > 0 ? lobes.axial_depth_m.maxCoeff() : 0.0;
  Depths out;
  for (const stability::Limit& limit : lobes.limit) {
    out.speed_rad_per_s.push_back(limit.spindle_speed_rad_per_s);
    out.depth_m.push_back(limit.status == stability::Limit::Status::found ? limit.axial_depth_m : deepest);
  }
  return out;
}

/// Empty where the depths are not known.
Depths vibration_of(const Depths& limits, const AdviceOptions& options) {
  if (options.vibration_depth_m.empty()) return {};
  return {.speed_rad_per_s = limits.speed_rad_per_s,
          .depth_m = {options.vibration_depth_m.begin(), options.vibration_depth_m.end()}};
}

// Lobes far down lie close together: no more of them than can be distinguished from their neighbours.
void add_speeds(Advice& advice, double present_rad_per_s, int teeth, const stability::LobesResult* lobes,
                const AdviceOptions& options) {
  const double first = units::revolution * advice.frequency_hz / teeth;
  const auto last = static_cast<int>(std::min(200.0, first / std::max(1.0, options.lowest_rad_per_s)));
  const Depths limits = lobes != nullptr ? limits_of(*lobes) : Depths();
  const Depths vibration = vibration_of(limits, options);
  // At least as deep is the cut that chatters; beyond the chart nothing is known of it.
  const double cut_m = limits.lowest(present_rad_per_s, present_rad_per_s);
  for (int k = 1; k <= last; ++k) {
    const double speed = first / k;
    if (speed < options.lowest_rad_per_s || speed > options.highest_rad_per_s) continue;
    const double kept_m = vibration.lowest(speed * (1.0 - options.speed_window), speed * (1.0 + options.speed_window));
    if (std::isfinite(cut_m) && kept_m < cut_m) {
      ++advice.vibrating_speeds;
      continue;
    }
    advice.speeds.push_back(
        {.lobe = k, .spindle_speed_rad_per_s = speed, .std_rad_per_s = units::revolution * advice.std_hz / teeth / k});
  }
  std::ranges::sort(advice.speeds, [&](const StableSpeed& a, const StableSpeed& b) {
    return std::abs(a.spindle_speed_rad_per_s - present_rad_per_s) <
           std::abs(b.spindle_speed_rad_per_s - present_rad_per_s);
  });
  constexpr std::size_t most_speeds = 6;
  if (advice.speeds.size() > most_speeds) advice.speeds.resize(most_speeds);
}

void choose(Advice& advice, const stability::LobesResult& lobes, const AdviceOptions& options) {
  const Depths limits = limits_of(lobes);
  const Depths vibration = vibration_of(limits, options);
  for (const double speed : limits.speed_rad_per_s) {
    if (speed < options.lowest_rad_per_s || speed > options.highest_rad_per_s) continue;
    const double from = speed * (1.0 - options.speed_window);
    const double to = speed * (1.0 + options.speed_window);
    const double stable_m = (1.0 - options.depth_margin) * limits.lowest(from, to);
    const double kept_m = vibration.lowest(from, to);
    const double depth_m = std::min(stable_m, kept_m);
    if (advice.best && depth_m <= advice.best->axial_depth_m) continue;
    advice.best = stability::OperatingPoint{.spindle_speed_rad_per_s = speed, .axial_depth_m = depth_m};
    advice.best_vibrates = kept_m < stable_m;
  }
}

}  // namespace

void AdviceOptions::validate() const {
  require_non_negative("lowest_rad_per_s", lowest_rad_per_s, "rad/s");
  require_positive("highest_rad_per_s", highest_rad_per_s, "rad/s");
  if (highest_rad_per_s <= lowest_rad_per_s) {
    throw InvalidInput("highest_rad_per_s", highest_rad_per_s, "rad/s", "must be above lowest_rad_per_s");
  }
  cutting::require_speed_window(speed_window);
  cutting::require_depth_margin(depth_margin);
  require_non_negative("unfiltered_sample_rate_hz", unfiltered_sample_rate_hz, "Hz");
}

Advice advise(double frequency_hz, double std_hz, double spindle_speed_rad_per_s, int teeth,
              const modal::ModalModel* modes, const stability::LobesResult* lobes, const AdviceOptions& options,
              const modal::ModalModel& workpiece) {
  options.validate();
  require_positive("frequency_hz", frequency_hz, "Hz");
  require_non_negative("std_hz", std_hz, "Hz");
  require_non_negative("spindle_speed_rad_per_s", spindle_speed_rad_per_s, "rad/s");
  if (teeth < 1) throw InvalidInput("teeth", teeth, "", "must be at least 1");
  if (!options.vibration_depth_m.empty() &&
      (lobes == nullptr || options.vibration_depth_m.size() != lobes->limit.size())) {
    throw InvalidInput("vibration_depth_m", "must have one depth a limit of the lobes");
  }
  Advice out;
  out.line_hz = {frequency_hz};
  out.std_hz = std_hz;
  if (const double rate_hz = options.unfiltered_sample_rate_hz; rate_hz > 0.0) {
    if (frequency_hz >= rate_hz) {
      throw InvalidInput("frequency_hz", frequency_hz, "Hz", "must be below unfiltered_sample_rate_hz",
                         "Samples show lines up to half their rate");
    }
    out.line_hz = {frequency_hz, rate_hz - frequency_hz, rate_hz + frequency_hz};
  }
  if (modes != nullptr) {
    require_positive("spindle_speed_rad_per_s", spindle_speed_rad_per_s, "rad/s", "It separates the modes");
    read_line(out, spindle_speed_rad_per_s, teeth, {*modes, workpiece});
  } else if (out.line_hz.size() == 1) {
    out.frequency_hz = out.lowest_hz = frequency_hz;
  }
  if (out.line_hz.size() > 1) return out;
  add_speeds(out, spindle_speed_rad_per_s, teeth, lobes, options);
  if (lobes != nullptr) choose(out, *lobes, options);
  return out;
}

}  // namespace robomill::monitor
