#include "robomill/simulation/resolution.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace robomill::simulation::detail {
namespace {

constexpr double revolution = 2.0 * std::numbers::pi;
constexpr double steps_in_cut = 20.0;
constexpr double slice_lag_rad = 0.07;       // about 4 degrees
constexpr double slice_vibration_rad = 0.5;  // of the fastest mode while a slice's edge runs by
constexpr int most_slices = 200;

/// By how much of a step the worst tooth misses the nodes that another one left.
double misfit(const cutting::FlatEndMill& tool, int steps) {
  double worst = 0.0;
  for (int j = 0; j < tool.teeth; ++j) {
    const double position = tool.pitch(j) / revolution * steps;
    worst = std::max(worst, std::abs(position - std::round(position)));
  }
  return worst;
}

}  // namespace

Period period_of(const cutting::Milling& milling) {
  Period period;
  const cutting::SpeedVariation& swing = milling.speed_variation;
  if (swing.active()) {
    for (int m = 1; m <= 50; ++m) {
      const double turns = m * swing.frequency_ratio;
      if (turns > 0.5 && std::abs(turns - std::round(turns)) < 1e-9) {
        period.revolutions = m;
        return period;
      }
    }
    period.repeats = false;
    return period;
  }
  const cutting::FlatEndMill& tool = milling.tool;
  if (tool.has_equal_pitch() && tool.has_equal_helix() && tool.runout_m == 0.0) period.parts = tool.teeth;
  return period;
}

Resolution first_resolution(const MillingCut& cut, const SimulationOptions& options) {
  const cutting::FlatEndMill& tool = cut.milling.tool;
  double fastest = 0.0;
  for (const std::complex<double>& pole : cut.structure.pole) fastest = std::max(fastest, std::abs(pole));
  Resolution r;
  double steps = steps_per_natural_period * fastest / cut.spindle_speed_rad_per_s;
  steps = std::max(steps, steps_per_tooth * tool.teeth);
  const double least_speed = 1.0 - cut.milling.speed_variation.amplitude_ratio;
  steps = std::max(steps, steps_in_cut * revolution /
                              (cut.milling.immersion.exit_rad - cut.milling.immersion.entry_rad) / least_speed);
  steps = std::max(steps, steps_per_sample * options.sample_rate_hz * revolution / cut.spindle_speed_rad_per_s);
  const int multiple = 2 * tool.teeth;
  r.steps_per_revolution = multiple * static_cast<int>(std::ceil(std::min(steps, 1e7) / multiple));
  if (!tool.has_equal_pitch()) {
    int best = r.steps_per_revolution;
    for (int n = best; n <= r.steps_per_revolution * 5 / 4; n += 2) {
      if (misfit(tool, n) < misfit(tool, best) - 1e-9) best = n;
    }
    r.steps_per_revolution = best;
  }
  if (options.steps_per_revolution > 0) {
    r.steps_per_revolution = tool.teeth * ((options.steps_per_revolution + tool.teeth - 1) / tool.teeth);
  }
  double lag = 0.0;
  for (int j = 0; j < tool.teeth; ++j) lag = std::max(lag, std::abs(tool.lag_rad_per_m(j)) * cut.axial_depth_m);
  double most = slice_lag_rad;
  if (fastest > 0.0) most = std::min(most, slice_vibration_rad * cut.spindle_speed_rad_per_s / fastest);
  r.slices = std::clamp(static_cast<int>(std::ceil(std::min(lag / most, 1e6))), 1, most_slices);
  if (options.slices > 0) r.slices = options.slices;
  return r;
}

Resolution halved(const Resolution& resolution) {
  return {resolution.steps_per_revolution / 2, (resolution.slices + 1) / 2};
}

Resolution doubled(const Resolution& resolution) {
  return {resolution.steps_per_revolution * 2, resolution.slices > 1 ? resolution.slices * 2 : 1};
}

}  // namespace robomill::simulation::detail
