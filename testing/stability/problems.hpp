#pragma once
#include <cmath>
#include <complex>
#include <initializer_list>
#include <numbers>
#include <vector>

#include "robomill/stability/lobes.hpp"
#include "testing/robot_modes.hpp"

/// Cuts that tests and benchmarks share.
namespace robomill::stability::testing {

inline constexpr double rpm = std::numbers::pi / 30.0;

/// One direction's mode as x = F / (m (ω² - s² …)): residue 1 / (2 i m ω_d).
inline modal::Mode mass_mode(Eigen::Index axis, double frequency_hz, double damping_ratio, double modal_mass_kg) {
  modal::Mode mode;
  mode.frequency_hz = frequency_hz;
  mode.damping_ratio = damping_ratio;
  const double size = 1.0 / std::sqrt(2.0 * modal_mass_kg * modal::pole(mode).imag());
  mode.left = Eigen::VectorXcd::Unit(2, axis) * size;
  mode.right = Eigen::VectorXcd::Unit(2, axis) * std::complex<double>(0.0, -size);
  return mode;
}

inline modal::ModalModel plane_model(std::initializer_list<modal::Mode> modes) {
  modal::ModalModel model;
  model.excitations = model.responses = {{.axis = modal::Axis::x}, {.axis = modal::Axis::y}};
  model.modes = modes;
  return model;
}

/// N = 2, Kt = 6e8, Kn = 2e8 N/m², 922 Hz, ζ = 0.011, m = 0.03993 kg in x, or in x and y; down-milling at a/D = ratio.
/// Source: the two-degree benchmark of [Insperger2004] and those who follow it.
inline LobesProblem benchmark(double ratio, int directions = 2) {
  LobesProblem p;
  p.milling.tool.teeth = 2;
  p.milling.tool.diameter_m = 0.01;
  p.milling.immersion = cutting::immersion(cutting::MillingDirection::down, ratio * 0.01, 0.01);
  p.milling.coefficients = {.tangential_n_per_m2 = 6e8, .radial_n_per_m2 = 2e8};
  p.dynamics = plane_model({mass_mode(0, 922.0, 0.011, 0.03993)});
  if (directions == 2) p.dynamics.modes.push_back(mass_mode(1, 922.0, 0.011, 0.03993));
  return p;
}

/// The milling robot of data/robot-modes.toml: D = 12 mm, 1.8 mm radial, up-milling, Kt = 712, Kr = 287 N/mm². N = 3 is
/// this problem's own: the source does not print it.
inline LobesProblem robot() {
  LobesProblem p;
  p.milling.tool.teeth = 3;
  p.milling.tool.diameter_m = 0.012;
  p.milling.immersion = cutting::immersion(cutting::MillingDirection::up, 1.8e-3, 0.012);
  p.milling.coefficients = {.tangential_n_per_m2 = 712e6, .radial_n_per_m2 = 287e6};
  p.dynamics = data::robot_modes();
  return p;
}

/// Of semi-discretization.
inline LobesOptions chart(double from_rpm, double to_rpm, double depth_m, int speeds, int depths, int intervals = 40) {
  LobesOptions o;
  o.method = Method::semi_discretization;
  o.spindle_speed_rad_per_s = {from_rpm * rpm, to_rpm * rpm};
  o.axial_depth_m = {0.0, depth_m};
  o.grid = {speeds, depths};
  o.intervals = intervals;
  return o;
}

struct Known {
  LobesProblem problem;
  double speed_rpm, depth_m, converged;
};

/// Converged spectral radii of one tooth period, eight digits.
inline std::vector<Known> known_points() {
  return {{benchmark(0.05), 5000, 0.2e-3, 0.70098118},
          {benchmark(0.05), 5000, 1e-3, 0.84047032},
          {benchmark(0.1), 5000, 0.2e-3, 0.74477499},
          {benchmark(0.1), 5000, 1e-3, 1.03111539},
          {benchmark(0.5), 5000, 0.2e-3, 1.18540555},
          {benchmark(0.5), 5000, 1e-3, 3.62871024},
          {benchmark(1.0), 5000, 0.2e-3, 2.13659148},
          {benchmark(1.0), 5000, 1e-3, 10.90390056},
          {benchmark(0.05, 1), 5000, 0.2e-3, 0.67803588},
          {benchmark(0.05, 1), 5000, 1e-3, 0.74950284},
          {benchmark(1.0, 1), 5000, 0.2e-3, 0.81974278},
          {benchmark(1.0, 1), 5000, 1e-3, 1.40647353},
          {robot(), 6500, 0.6e-3, 1.10584684},
          {robot(), 8000, 1.2e-3, 1.07595981},
          {robot(), 15000, 1.1e-3, 1.11946237}};
}

}  // namespace robomill::stability::testing
