#include "robomill/simulation/simulation.hpp"

#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/simulation/job.hpp"

namespace robomill::simulation {
namespace {

using namespace detail;
using std::numbers::pi;

Job job_of(const MillingCut& cut, const SimulationOptions& options) {
  cut.validate();
  options.validate();
  Job job;
  job.model_at = [&cut](const Resolution& resolution) {
    return milling_model(cut.milling, cut.spindle_speed_rad_per_s, cut.axial_depth_m, resolution);
  };
  job.structure = cut.structure;
  job.period = period_of(cut.milling);
  job.first = first_resolution(cut, options);
  job.spindle_speed_rad_per_s = cut.spindle_speed_rad_per_s;
  job.feed_per_tooth_m = cut.milling.feed_per_tooth_m;
  job.teeth = cut.milling.tool.teeth;
  job.schedule = cut.schedule;
  if (cut.milling.feed_per_tooth_m > 0.0 && cut.axial_depth_m > 0.0 && !cut.schedule.active()) {
    if (cut.milling.immersion.entry_rad == 0.0) job.walls.push_back(0.0);
    if (cut.milling.immersion.exit_rad >= pi * (1.0 - 1e-9)) job.walls.push_back(pi);
  }
  return job;
}

}  // namespace

std::string_view to_string(Verdict verdict) {
  return verdict == Verdict::stable ? "stable" : verdict == Verdict::chatter ? "chatter" : "undecided";
}

void MillingCut::validate() const {
  milling.validate();
  cutting::require_spindle_speed("spindle_speed_rad_per_s", spindle_speed_rad_per_s);
  require_non_negative("axial_depth_m", axial_depth_m, "m");
  if (axial_depth_m > 0.5) {
    throw InvalidInput("axial_depth_m", axial_depth_m, "m", "is deeper than any milling cut",
                       "Are the units mixed up?");
  }
  schedule.validate();
  if (!schedule.speed.empty() && milling.speed_variation.active()) {
    throw InvalidInput("schedule.speed", "must be empty where the speed swings");
  }
  require_damped(structure);
}

void SimulationOptions::validate() const {
  // Samples, and steps at the fastest spindle, that an index holds.
  constexpr double most_s = 1e7;
  require_positive("seconds", seconds, "s");
  if (seconds > most_s) {
    throw InvalidInput("seconds", seconds, "s", "must be at most 1e7 s", "No cut takes a hundred days");
  }
  require_positive("sample_rate_hz", sample_rate_hz, "Hz");
  if (sample_rate_hz > 1e7) throw InvalidInput("sample_rate_hz", sample_rate_hz, "Hz", "must be at most 10 MHz");
  if (seconds * sample_rate_hz < 1.0) {
    throw InvalidInput("sample_rate_hz", sample_rate_hz, "Hz", "must give at least one sample in the simulated time");
  }
  if (steps_per_revolution != 0 && (steps_per_revolution < 20 || steps_per_revolution > 10000000)) {
    throw InvalidInput("steps_per_revolution", steps_per_revolution, "", "must be 0 or lie between 20 and 10,000,000");
  }
  if (slices < 0 || slices > 2000) throw InvalidInput("slices", slices, "", "must lie between 0 and 2000");
  if (!(tolerance > 0.0 && tolerance < 1.0)) {
    throw InvalidInput("tolerance", tolerance, "", "must lie between 0 and 1");
  }
}

SmallVibration small_vibration(const MillingCut& cut, const SimulationOptions& options, Progress& progress) {
  return detail::small_vibration(job_of(cut, options), options, progress);
}

Simulation simulate(const MillingCut& cut, const SimulationOptions& options, Progress& progress) {
  require_positive("feed_per_tooth_m", cut.milling.feed_per_tooth_m, "m", "Without feed nothing is cut");
  return detail::simulate(job_of(cut, options), options, progress);
}

}  // namespace robomill::simulation
