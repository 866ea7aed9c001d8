#include "robomill/simulation/resolution.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/units.hpp"

namespace robomill::simulation::detail {
namespace {

constexpr double steps_in_cut = 20.0;
constexpr double slice_lag_rad = 0.07;       // about 4 degrees
constexpr double slice_vibration_rad = 0.5;  // of the fastest mode while a slice's edge runs by
constexpr int most_slices = 200;

/// Of the structure's poles [rad/s].
double fastest(const modal::TipModes& structure) {
  double most = 0.0;
  for (const std::complex<double>& pole : structure.pole) most = std::max(most, std::abs(pole));
  return most;
}

/// By how much of a step the worst tooth misses the nodes that another one left.
double misfit(const cutting::FlatEndMill& teeth, int steps) {
  double worst = 0.0;
  for (int j = 0; j < teeth.teeth; ++j) {
    const double position = teeth.pitch(j) / units::revolution * steps;
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
  return period_of(milling.tool);
}

Period period_of(const cutting::FlatEndMill& teeth) {
  Period period;
  if (teeth.has_equal_teeth()) period.parts = teeth.teeth;
  return period;
}

int first_steps(const modal::TipModes& structure, double spindle_speed_rad_per_s, const cutting::FlatEndMill& teeth,
                double arc_rad, const SimulationOptions& options) {
  if (options.steps_per_revolution > 0) {
    return teeth.teeth * ((options.steps_per_revolution + teeth.teeth - 1) / teeth.teeth);
  }
  double steps = steps_per_natural_period * fastest(structure) / spindle_speed_rad_per_s;
  steps = std::max(steps, steps_per_tooth * teeth.teeth);
  steps = std::max(steps, steps_in_cut * units::revolution / arc_rad);
  steps = std::max(steps, steps_per_sample * options.sample_rate_hz * units::revolution / spindle_speed_rad_per_s);
  const int multiple = 2 * teeth.teeth;
  const int least = multiple * static_cast<int>(std::ceil(std::min(steps, 1e7) / multiple));
  if (teeth.has_equal_pitch()) return least;
  int best = least;
  for (int n = least; n <= least * 5 / 4; n += 2) {
    if (misfit(teeth, n) < misfit(teeth, best) - 1e-9) best = n;
  }
  return best;
}

Resolution first_resolution(const MillingCut& cut, const SimulationOptions& options) {
  const cutting::FlatEndMill& tool = cut.milling.tool;
  const double least_speed = 1.0 - cut.milling.speed_variation.amplitude_ratio;
  const double arc = (cut.milling.immersion.exit_rad - cut.milling.immersion.entry_rad) * least_speed;
  Resolution r;
  r.steps_per_revolution = first_steps(cut.structure, cut.spindle_speed_rad_per_s, tool, arc, options);
  double lag = 0.0;
  for (int j = 0; j < tool.teeth; ++j) lag = std::max(lag, std::abs(tool.lag_rad_per_m(j)) * cut.axial_depth_m);
  double most = slice_lag_rad;
  const double quickest = fastest(cut.structure);
  if (quickest > 0.0) most = std::min(most, slice_vibration_rad * cut.spindle_speed_rad_per_s / quickest);
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
