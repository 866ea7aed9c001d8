#include "robomill/monitor/advice.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/stability/peak_classification.hpp"

namespace robomill::monitor {
namespace {

constexpr double deviations = 3.0;  // within which a line is a mode's

// The comb has taken out what rotates with the spindle: the residual is chatter.
void name_mode(Advice& advice, double spindle_speed_rad_per_s, int teeth, const modal::ModalModel& modes,
               const modal::ModalModel& workpiece) {
  // The tolerance of explain() must stay below a quarter of rotation.
  const double most = 0.24 * spindle_speed_rad_per_s / units::revolution;
  const double tolerance = std::clamp(deviations * advice.std_hz, std::min(1.0, most), most);
  const stability::ExplainedPeak peak =
      stability::explain(
          {.frequency_hz = {advice.frequency_hz}, .spindle_speed_rad_per_s = spindle_speed_rad_per_s, .teeth = teeth},
          modes, {.tolerance_hz = tolerance, .multiples_removed = true}, workpiece)
          .peaks.front();
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

void choose(Advice& advice, const stability::LobesResult& lobes, const AdviceOptions& options) {
  const double deepest = lobes.axial_depth_m.size() > 0 ? lobes.axial_depth_m.maxCoeff() : 0.0;
  for (const stability::Limit& limit : lobes.limit) {
    const double speed = limit.spindle_speed_rad_per_s;
    if (speed < options.lowest_rad_per_s || speed > options.highest_rad_per_s) continue;
    const double depth = limit.status == stability::Limit::Status::found ? limit.axial_depth_m : deepest;
    if (!advice.best || depth > advice.best->axial_depth_m) {
      advice.best = stability::OperatingPoint{.spindle_speed_rad_per_s = speed, .axial_depth_m = depth};
    }
  }
}

}  // namespace

void AdviceOptions::validate() const {
  require_non_negative("lowest_rad_per_s", lowest_rad_per_s, "rad/s");
  require_positive("highest_rad_per_s", highest_rad_per_s, "rad/s");
  if (highest_rad_per_s <= lowest_rad_per_s) {
    throw InvalidInput("highest_rad_per_s", highest_rad_per_s, "rad/s", "must be above lowest_rad_per_s");
  }
  if (most_speeds < 1) throw InvalidInput("most_speeds", most_speeds, "", "must be at least 1");
}

Advice advise(double frequency_hz, double std_hz, double spindle_speed_rad_per_s, int teeth,
              const modal::ModalModel* modes, const stability::LobesResult* lobes, const AdviceOptions& options,
              const modal::ModalModel& workpiece) {
  options.validate();
  require_positive("frequency_hz", frequency_hz, "Hz");
  require_non_negative("std_hz", std_hz, "Hz");
  require_non_negative("spindle_speed_rad_per_s", spindle_speed_rad_per_s, "rad/s");
  if (teeth < 1) throw InvalidInput("teeth", teeth, "", "must be at least 1");
  Advice out;
  out.frequency_hz = out.lowest_hz = frequency_hz;
  out.std_hz = std_hz;
  if (modes != nullptr) {
    require_positive("spindle_speed_rad_per_s", spindle_speed_rad_per_s, "rad/s", "It separates the modes");
    name_mode(out, spindle_speed_rad_per_s, teeth, *modes, workpiece);
  }
  // Lobes far down lie close together: no more of them than can be distinguished from their neighbours.
  const double first = units::revolution * out.frequency_hz / teeth;
  const auto last = static_cast<int>(std::min(200.0, first / std::max(1.0, options.lowest_rad_per_s)));
  for (int k = 1; k <= last; ++k) {
    const double speed = first / k;
    if (speed < options.lowest_rad_per_s || speed > options.highest_rad_per_s) continue;
    out.speeds.push_back(
        {.lobe = k, .spindle_speed_rad_per_s = speed, .std_rad_per_s = units::revolution * out.std_hz / teeth / k});
  }
  const double present = spindle_speed_rad_per_s;
  std::ranges::sort(out.speeds, [&](const StableSpeed& a, const StableSpeed& b) {
    return std::abs(a.spindle_speed_rad_per_s - present) < std::abs(b.spindle_speed_rad_per_s - present);
  });
  if (out.speeds.size() > static_cast<std::size_t>(options.most_speeds)) {
    out.speeds.resize(static_cast<std::size_t>(options.most_speeds));
  }
  if (lobes != nullptr) choose(out, *lobes, options);
  return out;
}

}  // namespace robomill::monitor
