#pragma once
#include <functional>
#include <vector>

#include "robomill/simulation/resolution.hpp"
#include "robomill/simulation/simulation.hpp"

namespace robomill::simulation::detail {

/// A cut made ready: how to model it at any resolution, and what its result is looked at for.
struct Job {
  std::function<CutModel(const Resolution&)> model_at;
  modal::TipModes structure;                                     ///< in the model's frame
  Eigen::Matrix3d feed_from_tool = Eigen::Matrix3d::Identity();  ///< of the result's frame from the model's
  Period period;
  Resolution first;
  double spindle_speed_rad_per_s = 0.0;
  double feed_per_tooth_m = 0.0;
  int teeth = 1;
  std::vector<double> walls;  ///< angles
  Schedule schedule;          ///< model_at leaves it out
};

[[nodiscard]] SmallVibration small_vibration(const Job& job, const SimulationOptions& options, Progress& progress);
[[nodiscard]] Simulation simulate(const Job& job, const SimulationOptions& options, Progress& progress);

/// Shapes that fit, finite numbers, and poles that die out. @throws InvalidInput
void require_damped(const modal::TipModes& structure);

}  // namespace robomill::simulation::detail
