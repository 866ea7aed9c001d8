#pragma once
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "robomill/modal/modes.hpp"
#include "robomill/simulation/simulation.hpp"
#include "testing/stability/problems.hpp"

/// Cuts that this stage's tests and benchmarks share.
namespace robomill::simulation::testing {

using stability::testing::rpm;

inline modal::TipModes no_modes() {
  modal::TipModes none;
  none.pole.resize(0);
  none.right.resize(3, 0);
  none.left.resize(3, 0);
  none.compliance.setZero();
  return none;
}

inline modal::TipModes tip_of(const stability::LobesProblem& problem) {
  modal::TipModes modes = modal::tip_modes(problem.dynamics, problem.keep_modes, problem.feed_direction_rad);
  if (problem.workpiece_dynamics.modes.empty()) return modes;
  return modal::joined(
      modes, modal::tip_modes(problem.workpiece_dynamics, {}, problem.feed_direction_rad, modal::ModeOwner::workpiece));
}

inline MillingCut cut_of(const stability::LobesProblem& problem, double speed_rpm, double depth_m,
                         double feed_per_tooth_m = 5e-5) {
  MillingCut cut = {.milling = problem.milling,
                    .structure = tip_of(problem),
                    .spindle_speed_rad_per_s = speed_rpm * rpm,
                    .axial_depth_m = depth_m};
  if (cut.milling.feed_per_tooth_m == 0.0) cut.milling.feed_per_tooth_m = feed_per_tooth_m;
  return cut;
}

/// A cutter that cannot vibrate, N = 2, D = 10 mm, 0.05 mm a tooth, a third of the circle from 40°.
inline MillingCut rigid_cut() {
  MillingCut cut = {
      .milling = {}, .structure = no_modes(), .spindle_speed_rad_per_s = 3000.0 * rpm, .axial_depth_m = 2e-3};
  cut.milling.tool.teeth = 2;
  cut.milling.tool.diameter_m = 0.01;
  cut.milling.immersion = {.entry_rad = 0.7, .exit_rad = 2.5};
  cut.milling.coefficients = {
      .tangential_n_per_m2 = 6e8, .radial_n_per_m2 = 2e8, .tangential_edge_n_per_m = 9e3, .radial_edge_n_per_m = 4e3};
  cut.milling.feed_per_tooth_m = 5e-5;
  return cut;
}

/// m, ζ, ω_n of one direction; 0: x, 1: y, 2: z.
inline modal::TipModes one_mode(Eigen::Index axis, double frequency_hz, double damping_ratio, double mass_kg) {
  modal::TipModes modes = no_modes();
  const double omega = 2.0 * std::numbers::pi * frequency_hz;
  const double damped = omega * std::sqrt(1.0 - damping_ratio * damping_ratio);
  modes.pole.resize(1);
  modes.pole(0) = {-damping_ratio * omega, damped};
  modes.right = Eigen::Matrix3Xcd::Zero(3, 1);
  modes.left = Eigen::Matrix3Xcd::Zero(3, 1);
  modes.right(axis, 0) = 0.5;
  modes.left(axis, 0) = std::complex<double>(0.0, -1.0 / (mass_kg * damped));
  modes.id = {{1}};
  return modes;
}

/// Largest |exp(λτ)| of m (λ² + 2ζωλ + ω²) = -c (1 - exp(-λτ)), by Newton's method from a fan of starts.
inline double axial_radius(double mass, double zeta, double omega, double c, double delay) {
  double best = 0.0;
  for (int i = 0; i <= 400; ++i) {
    std::complex<double> root(0.0, omega * (0.02 + 2.5 * i / 400.0));
    const auto value = [&](std::complex<double> l) {
      return mass * (l * l + 2.0 * zeta * omega * l + omega * omega) + c * (1.0 - std::exp(-l * delay));
    };
    for (int k = 0; k < 60; ++k) {
      const std::complex<double> slope = mass * (2.0 * root + 2.0 * zeta * omega) + c * delay * std::exp(-root * delay);
      root -= value(root) / slope;
    }
    const double size = mass * omega * omega + c;
    if (std::abs(value(root)) < 1e-9 * size) best = std::max(best, std::exp(root.real() * delay));
  }
  return best;
}

}  // namespace robomill::simulation::testing
