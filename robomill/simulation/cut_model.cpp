#include "robomill/simulation/cut_model.hpp"

#include <cmath>

#include "robomill/base/units.hpp"

namespace robomill::simulation::detail {
double Spindle::rotation(double time_s) const {
  const double mean = mean_rad_per_s * time_s;
  if (amplitude == 0.0) return schedule.empty() ? mean : mean_rad_per_s * schedule.before(time_s);
  return mean + amplitude / ratio * (1.0 - std::cos(ratio * mean));
}

double Spindle::speed(double time_s) const {
  if (amplitude == 0.0) return mean_rad_per_s * schedule.at(time_s);
  return mean_rad_per_s * (1.0 + amplitude * std::sin(ratio * mean_rad_per_s * time_s));
}

Resistance resistance(const Ring& ring, double tangential, double radial, double axial) {
  return {.tangential = tangential,
          .radial = radial * ring.lateral - axial * ring.axial,
          .axial = -radial * ring.axial - axial * ring.lateral};
}

Element& CutModel::add(double angle_rad, std::size_t ring) {
  Element& element = elements.emplace_back();
  element.standing_rad = angle_rad - units::revolution * std::floor(angle_rad / units::revolution);
  element.sine = std::sin(element.standing_rad);
  element.cosine = std::cos(element.standing_rad);
  element.ring = static_cast<int>(ring);
  return element;
}

CutModel milling_model(const cutting::Milling& milling, double spindle_speed_rad_per_s, double axial_depth_m,
                       const Resolution& resolution) {
  CutModel model;
  const cutting::FlatEndMill& tool = milling.tool;
  const cutting::ForceCoefficients& k = milling.coefficients;
  model.slices = resolution.slices;
  model.radius_m = 0.5 * tool.diameter_m;
  model.feed_m_per_s = milling.feed_per_tooth_m * tool.teeth * spindle_speed_rad_per_s / units::revolution;
  model.damping = milling.process_damping;
  model.spindle = {
      spindle_speed_rad_per_s, milling.speed_variation.amplitude_ratio, milling.speed_variation.frequency_ratio, {}};
  model.steps_per_revolution = resolution.steps_per_revolution;
  const Ring ring = {.entry_rad = milling.immersion.entry_rad,
                     .exit_rad = milling.immersion.exit_rad,
                     .bend_around_per_m = 0.5 / model.radius_m};
  model.rings.assign(static_cast<std::size_t>(resolution.slices), ring);
  model.elements.reserve(model.rings.size() * static_cast<std::size_t>(tool.teeth));
  const double thickness = axial_depth_m / resolution.slices;
  for (std::size_t i = 0; i < model.rings.size(); ++i) {
    const double height = (static_cast<double>(i) + 0.5) * thickness;
    for (int j = 0; j < tool.teeth; ++j) {
      Element& element = model.add(tool.standing_angle(j) - tool.lag_rad_per_m(j) * height, i);
      element.radius_m = tool.radius_deviation_m(j, height);
      element.width_m = thickness;
      element.chip = resistance(ring, k.tangential_n_per_m2, k.radial_n_per_m2, 0.0);
      element.edge = resistance(ring, k.tangential_edge_n_per_m, k.radial_edge_n_per_m, 0.0);
    }
  }
  return model;
}

}  // namespace robomill::simulation::detail
