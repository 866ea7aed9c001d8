#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robomill/io/schema.hpp"
#include "robomill/signal/bands.hpp"
#include "robomill/simulation/simulation.hpp"

namespace robomill::simulation {

/// Amplitudes of the displacement about its mean, which is the static deflection, in the second half of the time.
struct VibrationSpectrum {
  double from_s = 0.0;
  Eigen::VectorXd frequency_hz = {};
  std::array<Eigen::VectorXd, 3> amplitude_m = {};  ///< x, y, z; empty: nothing happens in it
};

/// What a page shows of a simulation's columns: by axis, those in which something happens.
struct Vibration {
  using Curves = std::vector<std::pair<std::string, signal::Band>>;
  Curves displacement_m = {}, force_n = {};
  double run_s = 0.0;                              ///< of one run of the bands
  std::optional<VibrationSpectrum> spectrum = {};  ///< none: too short, or nothing moves
};
[[nodiscard]] const io::Schema<Vibration>& vibration_table();
[[nodiscard]] std::string vibration_json(const Simulation& result);

}  // namespace robomill::simulation
