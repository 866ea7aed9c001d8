#pragma once
// Structures that the tests and benchmarks of fits share.
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>

#include "robomill/base/random.hpp"
#include "robomill/modal/modes.hpp"

namespace robomill::modal::cases {

inline constexpr double vector_unit = 1e-4;  // of the vectors below [sqrt(s/kg)]

struct PublishedMode {
  double frequency_hz, damping_percent;
  std::complex<double> left_x, left_y, right_x, right_y;
};

/// The eight modes of a robot with a milling spindle, as data/robot-modes.toml has them.
inline ModalModel robot() {
  static const std::array<PublishedMode, 8> table = {{
      {17.40, 1.27, {-0.52, 0.88}, {-92.57, 23.71}, {-1.13, -18.25}, {-8.9, 93.36}},
      {19.57, 2.23, {-41.87, 24.01}, {-0.025, -0.49}, {-118.74, 168.83}, {35.74, -40.36}},
      {49.86, 10.0, {51.08, 147.75}, {-0.47, 0.45}, {-149.35, 15.18}, {12.66, -25.99}},
      {53.51, 10.0, {0.66, -0.09}, {-94.27, -136.68}, {-34.35, -57.71}, {14.96, -155.42}},
      {57.77, 10.0, {-0.3, -0.77}, {-27.26, 163.60}, {15.67, -53.87}, {-58.20, -145.84}},
      {67.26, 10.0, {-105.83, -82.49}, {0.51, 0.49}, {-93.87, 88.52}, {12.15, -16.74}},
      {540.08, 0.68, {-0.81, 0.61}, {-317.91, -148.16}, {19.27, -26.45}, {173.44, 303.95}},
      {543.67, 2.1, {-246.87, 215.31}, {0.24, -0.32}, {-269.37, 275.61}, {36.20, 7.45}},
  }};
  ModalModel model{.excitations = {{.axis = Axis::x}, {.axis = Axis::y}},
                   .responses = {{.axis = Axis::x}, {.axis = Axis::y}},
                   .modes = {}};
  for (const PublishedMode& row : table) {
    Mode mode;
    mode.frequency_hz = row.frequency_hz;
    mode.damping_ratio = 0.01 * row.damping_percent;
    mode.left = vector_unit * Eigen::Vector2cd(row.left_x, row.left_y);
    mode.right = vector_unit * Eigen::Vector2cd(row.right_x, row.right_y);
    model.modes.push_back(mode);
  }
  return model;
}

/// 5 to 1,000 Hz, 0.25 Hz apart.
inline Eigen::VectorXd robot_lines() {
  return Eigen::VectorXd::LinSpaced(3981, 5.0, 1000.0);
}

/// Adds complex Gaussian noise e, E|e|² = (relative |H|)², to every line.
inline void add_noise(FrfSet& set, double relative, std::uint64_t seed) {
  Random random(seed);
  for (Frf& frf : set.frfs) {
    for (std::complex<double>& value : frf.receptance) {
      const double scale = relative * std::abs(value) / std::sqrt(2.0);
      const double re = random.normal();
      value += scale * std::complex<double>(re, random.normal());
    }
  }
}

}  // namespace robomill::modal::cases
