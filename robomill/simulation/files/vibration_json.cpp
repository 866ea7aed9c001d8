#include "robomill/simulation/files/vibration_json.hpp"

#include <array>
#include <cstddef>

#include "robomill/base/units.hpp"
#include "robomill/signal/bands.hpp"
#include "robomill/signal/files/bands_json.hpp"
#include "robomill/signal/spectrum.hpp"

namespace robomill::simulation {
namespace {

constexpr std::size_t most_runs = 2000;
constexpr std::array<const char*, 3> axis_names = {"x", "y", "z"};

/// Columns over runs of time, those alone in which something happens.
io::Json columns_json(const Simulation::Columns& columns, double unit, double sample_rate_hz, double& run_s) {
  signal::Bands bands(axis_names.size(), most_runs);
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const std::array<double, 3> row = {columns(i, 0), columns(i, 1), columns(i, 2)};
    bands.add(row);
  }
  io::Json json = io::Json::object();
  for (std::size_t axis = 0; axis < axis_names.size(); ++axis) {
    const Eigen::VectorXd column = columns.col(static_cast<Eigen::Index>(axis));
    if (column.size() == 0 || !(column.cwiseAbs().maxCoeff() > 0.0)) continue;
    json[axis_names.at(axis)] = signal::band_json(bands.band(axis), unit);
  }
  run_s = static_cast<double>(bands.length()) / sample_rate_hz;
  return json;
}

/// About the mean, which is the static deflection. Null of a record that is too short for a spectrum.
io::Json spectrum_json(const Simulation& result) {
  constexpr Eigen::Index least = 16;
  const Eigen::Index n = result.displacement_m.rows() / 2;
  if (n < least) return nullptr;
  io::Json json = {
      {"from_s", io::number(static_cast<double>(result.displacement_m.rows() - n) / result.sample_rate_hz)}};
  for (std::size_t axis = 0; axis < axis_names.size(); ++axis) {
    Eigen::VectorXd last = result.displacement_m.col(static_cast<Eigen::Index>(axis)).tail(n);
    last.array() -= last.mean();
    if (!(last.cwiseAbs().maxCoeff() > 0.0)) continue;
    const signal::Spectrum spectrum = signal::amplitude_spectrum(last, result.sample_rate_hz);
    json["frequency_hz"] = io::numbers(spectrum.frequency_hz);
    json[std::string(axis_names.at(axis)) + "_um"] = io::numbers(spectrum.amplitude / units::um);
  }
  return json.contains("frequency_hz") ? json : io::Json();
}

}  // namespace

std::string vibration_json(const Simulation& result) {
  double run_s = 0.0;
  io::Json json;
  json["displacement_um"] = columns_json(result.displacement_m, units::um, result.sample_rate_hz, run_s);
  json["force_n"] = columns_json(result.force_n, 1.0, result.sample_rate_hz, run_s);
  json["run_s"] = io::number(run_s);
  json["spectrum"] = spectrum_json(result);
  return io::dump(json);
}

}  // namespace robomill::simulation
