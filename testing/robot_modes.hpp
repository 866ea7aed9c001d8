#pragma once
#include <array>
#include <complex>

#include "robomill/modal/modes.hpp"

namespace robomill::data {

/// The eight modes of data/robot-modes.toml, number by number, for tests and benchmarks that read no files.
/// Source: [RobotMillingChatter] table 4-4, vectors as printed times 1e-4 sqrt(s/kg).
[[nodiscard]] inline modal::ModalModel robot_modes() {
  struct Row {
    double frequency_hz, damping_ratio;
    std::complex<double> left_x, left_y, right_x, right_y;
  };
  static const std::array<Row, 8> rows{{
      {17.40, 0.0127, {-0.52e-4, 0.88e-4}, {-92.57e-4, 23.71e-4}, {-1.13e-4, -18.25e-4}, {-8.9e-4, 93.36e-4}},
      {19.57, 0.0223, {-41.87e-4, 24.01e-4}, {-0.025e-4, -0.49e-4}, {-118.74e-4, 168.83e-4}, {35.74e-4, -40.36e-4}},
      {49.86, 0.10, {51.08e-4, 147.75e-4}, {-0.47e-4, 0.45e-4}, {-149.35e-4, 15.18e-4}, {12.66e-4, -25.99e-4}},
      {53.51, 0.10, {0.66e-4, -0.09e-4}, {-94.27e-4, -136.68e-4}, {-34.35e-4, -57.71e-4}, {14.96e-4, -155.42e-4}},
      {57.77, 0.10, {-0.3e-4, -0.77e-4}, {-27.26e-4, 163.60e-4}, {15.67e-4, -53.87e-4}, {-58.20e-4, -145.84e-4}},
      {67.26, 0.10, {-105.83e-4, -82.49e-4}, {0.51e-4, 0.49e-4}, {-93.87e-4, 88.52e-4}, {12.15e-4, -16.74e-4}},
      {540.08, 0.0068, {-0.81e-4, 0.61e-4}, {-317.91e-4, -148.16e-4}, {19.27e-4, -26.45e-4}, {173.44e-4, 303.95e-4}},
      {543.67, 0.021, {-246.87e-4, 215.31e-4}, {0.24e-4, -0.32e-4}, {-269.37e-4, 275.61e-4}, {36.20e-4, 7.45e-4}},
  }};
  const modal::Dof x{.point = 0, .axis = modal::Axis::x};
  const modal::Dof y{.point = 0, .axis = modal::Axis::y};
  modal::ModalModel model;
  model.excitations = {x, y};
  model.responses = {x, y};
  for (const Row& row : rows) {
    modal::Mode mode;
    mode.frequency_hz = row.frequency_hz;
    mode.damping_ratio = row.damping_ratio;
    mode.left = Eigen::Vector2cd(row.left_x, row.left_y);
    mode.right = Eigen::Vector2cd(row.right_x, row.right_y);
    model.modes.push_back(mode);
  }
  return model;
}

}  // namespace robomill::data
