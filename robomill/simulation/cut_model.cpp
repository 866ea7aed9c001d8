#include "robomill/simulation/cut_model.hpp"

#include <cmath>
#include <numbers>

namespace robomill::simulation::detail {
namespace {

constexpr double revolution = 2.0 * std::numbers::pi;

}  // namespace

double Spindle::rotation(double time_s) const {
  const double mean = mean_rad_per_s * time_s;
  return steady() ? mean : mean + amplitude / ratio * (1.0 - std::cos(ratio * mean));
}

double Spindle::speed(double time_s) const {
  return steady() ? mean_rad_per_s : mean_rad_per_s * (1.0 + amplitude * std::sin(ratio * mean_rad_per_s * time_s));
}

CutModel milling_model(const cutting::Milling& milling, double spindle_speed_rad_per_s, double axial_depth_m,
                       const Resolution& resolution) {
  CutModel model;
  model.rings = resolution.slices;
  model.entry_rad = milling.immersion.entry_rad;
  model.exit_rad = milling.immersion.exit_rad;
  model.radius_m = 0.5 * milling.tool.diameter_m;
  model.feed_m_per_s = milling.feed_per_tooth_m * milling.tool.teeth * spindle_speed_rad_per_s / revolution;
  model.coefficients = milling.coefficients;
  model.damping = milling.process_damping;
  model.spindle = {spindle_speed_rad_per_s, milling.speed_variation.amplitude_ratio,
                   milling.speed_variation.frequency_ratio};
  model.steps_per_revolution = resolution.steps_per_revolution;
  const double thickness = axial_depth_m / resolution.slices;
  for (int i = 0; i < resolution.slices; ++i) {
    const double height = (i + 0.5) * thickness;
    for (int j = 0; j < milling.tool.teeth; ++j) {
      const double angle = milling.tool.standing_angle(j) - milling.tool.lag_rad_per_m(j) * height;
      Element element;
      element.standing_rad = angle - revolution * std::floor(angle / revolution);
      element.sine = std::sin(element.standing_rad);
      element.cosine = std::cos(element.standing_rad);
      element.radius_m = milling.tool.radius_deviation_m(j, height);
      element.width_m = thickness;
      element.ring = i;
      model.elements.push_back(element);
    }
  }
  return model;
}

}  // namespace robomill::simulation::detail
