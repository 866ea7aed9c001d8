#include "robomill/simulation/drilling.hpp"

#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/simulation/job.hpp"

namespace robomill::simulation {
namespace {

using namespace detail;

Job job_of(const DrillingCut& cut, const SimulationOptions& options) {
  cut.validate();
  options.validate();
  Job job;
  job.model_at = [&cut](const Resolution& resolution) { return drilling_model(cut, resolution.steps_per_revolution); };
  job.structure = cut.structure;
  job.period.parts = cut.runout_m == 0.0 ? cut.lips : 1;
  job.first.steps_per_revolution =
      first_steps(cut.structure, cut.spindle_speed_rad_per_s, {.teeth = cut.lips}, units::revolution, options);
  job.spindle_speed_rad_per_s = cut.spindle_speed_rad_per_s;
  job.feed_per_tooth_m = cut.feed_per_revolution_m / cut.lips;
  job.schedule = cut.schedule;
  return job;
}

}  // namespace

CutModel detail::drilling_model(const DrillingCut& cut, int steps_per_revolution) {
  CutModel model;
  const double half_angle = 0.5 * cut.point_angle_rad;
  const Ring cone = {.whole_circle = true, .lateral = std::cos(half_angle), .axial = std::sin(half_angle)};
  model.dimensions = 3;
  model.rings = {cone};
  model.radius_m = 0.5 * cut.diameter_m;
  model.feed_m_per_s = cut.feed_per_revolution_m * cut.spindle_speed_rad_per_s / units::revolution;
  model.feed_direction = -Eigen::Vector3d::UnitZ();
  model.spindle.mean_rad_per_s = cut.spindle_speed_rad_per_s;
  model.steps_per_revolution = steps_per_revolution;
  for (int j = 0; j < cut.lips; ++j) {
    Element& lip = model.add(units::revolution * j / cut.lips, 0);
    lip.radius_m = cut.runout_m * std::cos(lip.standing_rad) * cone.lateral;
    lip.width_m = cut.radial_width_m / cone.axial;
    lip.chip = resistance(cone, cut.coefficients.tangential_n_per_m2, cut.coefficients.radial_n_per_m2, 0.0);
    lip.edge = resistance(cone, cut.coefficients.tangential_edge_n_per_m, cut.coefficients.radial_edge_n_per_m, 0.0);
  }
  return model;
}

void DrillingCut::validate() const {
  Drill::validate();
  require_positive("radial_width_m", radial_width_m, "m");
  if (radial_width_m > 0.5 * diameter_m * (1.0 + 1e-12)) {
    throw InvalidInput("radial_width_m", radial_width_m, "m", "must be at most half the drill's diameter");
  }
  require_positive("feed_per_revolution_m", feed_per_revolution_m, "m");
  require_non_negative("runout_m", runout_m, "m");
  if (runout_m > 0.5 * diameter_m) throw InvalidInput("runout_m", runout_m, "m", "must be at most the drill's radius");
  cutting::require_spindle_speed("spindle_speed_rad_per_s", spindle_speed_rad_per_s);
  schedule.validate();
  require_damped(structure);
}

Simulation simulate(const DrillingCut& cut, const SimulationOptions& options, Progress& progress) {
  return detail::simulate(job_of(cut, options), options, progress);
}

SmallVibration small_vibration(const DrillingCut& cut, const SimulationOptions& options, Progress& progress) {
  return detail::small_vibration(job_of(cut, options), options, progress);
}

}  // namespace robomill::simulation
