#include "robomill/simulation/drilling.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/simulation/job.hpp"

namespace robomill::simulation {
namespace {

using namespace detail;

constexpr double revolution = 2.0 * std::numbers::pi;

CutModel model_of(const DrillingCut& cut, int steps_per_revolution) {
  CutModel model;
  const double half_angle = 0.5 * cut.point_angle_rad;
  model.whole_circle = true;
  model.lateral = std::cos(half_angle);
  model.axial = std::sin(half_angle);
  model.radius_m = 0.5 * cut.diameter_m;
  model.feed_m_per_s = cut.feed_per_revolution_m * cut.spindle_speed_rad_per_s / revolution;
  model.coefficients = cut.coefficients;
  model.spindle.mean_rad_per_s = cut.spindle_speed_rad_per_s;
  model.steps_per_revolution = steps_per_revolution;
  for (int j = 0; j < cut.lips; ++j) {
    Element lip;
    lip.standing_rad = revolution * j / cut.lips;
    lip.sine = std::sin(lip.standing_rad);
    lip.cosine = std::cos(lip.standing_rad);
    lip.width_m = cut.radial_width_m / model.axial;
    model.elements.push_back(lip);
  }
  return model;
}

int first_steps(const DrillingCut& cut, const SimulationOptions& options) {
  double fastest = 0.0;
  for (const std::complex<double>& pole : cut.structure.pole) fastest = std::max(fastest, std::abs(pole));
  double steps = std::max(steps_per_natural_period * fastest / cut.spindle_speed_rad_per_s, steps_per_tooth * cut.lips);
  steps = std::max(steps, steps_per_sample * options.sample_rate_hz * revolution / cut.spindle_speed_rad_per_s);
  if (options.steps_per_revolution > 0) steps = options.steps_per_revolution;
  const int multiple = options.steps_per_revolution > 0 ? cut.lips : 2 * cut.lips;
  return multiple * static_cast<int>(std::ceil(std::min(steps, 1e7) / multiple));
}

Job job_of(const DrillingCut& cut, const SimulationOptions& options) {
  cut.validate();
  options.validate();
  Job job;
  job.model_at = [&cut](const Resolution& resolution) { return model_of(cut, resolution.steps_per_revolution); };
  job.structure = cut.structure;
  job.period.parts = cut.lips;
  job.first.steps_per_revolution = first_steps(cut, options);
  job.spindle_speed_rad_per_s = cut.spindle_speed_rad_per_s;
  job.feed_per_tooth_m = cut.feed_per_revolution_m / cut.lips;
  return job;
}

}  // namespace

void DrillingCut::validate() const {
  if (lips < 1 || lips > 20) throw InvalidInput("lips", lips, "", "must lie between 1 and 20", "Drills have two");
  require_positive("diameter_m", diameter_m, "m");
  if (diameter_m > 1.0) throw InvalidInput("diameter_m", diameter_m, "m", "is too large for a drill");
  if (!(point_angle_rad > 0.1 && point_angle_rad <= std::numbers::pi * (1.0 + 1e-12))) {
    throw InvalidInput("point_angle_rad", point_angle_rad, "rad", "must lie between 6 and 180 degrees",
                       "118 degrees is usual");
  }
  require_positive("radial_width_m", radial_width_m, "m");
  if (radial_width_m > 0.5 * diameter_m * (1.0 + 1e-12)) {
    throw InvalidInput("radial_width_m", radial_width_m, "m", "must be at most half the drill's diameter");
  }
  require_positive("feed_per_revolution_m", feed_per_revolution_m, "m");
  coefficients.validate();
  require_turning(spindle_speed_rad_per_s);
  require_damped(structure);
}

Simulation simulate(const DrillingCut& cut, const SimulationOptions& options, Progress& progress) {
  return detail::simulate(job_of(cut, options), options, progress);
}

SmallVibration small_vibration(const DrillingCut& cut, const SimulationOptions& options, Progress& progress) {
  return detail::small_vibration(job_of(cut, options), options, progress);
}

}  // namespace robomill::simulation
