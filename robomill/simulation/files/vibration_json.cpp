#include "robomill/simulation/files/vibration_json.hpp"

#include <cstddef>

#include "robomill/base/units.hpp"
#include "robomill/signal/files/bands_json.hpp"
#include "robomill/signal/spectrum.hpp"

namespace robomill::simulation {
namespace {

using io::key;
using io::Row;
using io::Schema;
using io::Use;
using signal::BandView;

constexpr std::size_t most_runs = 2000;
constexpr std::array<const char*, 3> axis_names = {"x", "y", "z"};

Vibration::Curves curves_of(const Simulation::Columns& columns, double sample_rate_hz, double& run_s) {
  signal::Bands bands(axis_names.size(), most_runs);
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    const std::array<double, 3> row = {columns(i, 0), columns(i, 1), columns(i, 2)};
    bands.add(row);
  }
  Vibration::Curves out;
  for (std::size_t axis = 0; axis < axis_names.size(); ++axis) {
    const Eigen::VectorXd column = columns.col(static_cast<Eigen::Index>(axis));
    if (column.size() == 0 || !(column.cwiseAbs().maxCoeff() > 0.0)) continue;
    out.emplace_back(axis_names.at(axis), bands.band(axis));
  }
  run_s = static_cast<double>(bands.length()) / sample_rate_hz;
  return out;
}

std::optional<VibrationSpectrum> spectrum_of(const Simulation& result) {
  constexpr Eigen::Index least = 16;
  const Eigen::Index n = result.displacement_m.rows() / 2;
  if (n < least) return std::nullopt;
  VibrationSpectrum out{.from_s = static_cast<double>(result.displacement_m.rows() - n) / result.sample_rate_hz};
  for (std::size_t axis = 0; axis < axis_names.size(); ++axis) {
    Eigen::VectorXd last = result.displacement_m.col(static_cast<Eigen::Index>(axis)).tail(n);
    last.array() -= last.mean();
    if (!(last.cwiseAbs().maxCoeff() > 0.0)) continue;
    const signal::Spectrum spectrum = signal::amplitude_spectrum(last, result.sample_rate_hz);
    out.frequency_hz = spectrum.frequency_hz;
    out.amplitude_m.at(axis) = spectrum.amplitude;
  }
  return out.frequency_hz.size() > 0 ? std::optional(out) : std::nullopt;
}

Row<Vibration> curves_key(const std::string& name, Vibration::Curves Vibration::*curves, const std::string& meaning) {
  const double unit = io::key_unit(name).factor;
  return key(
      name,
      [curves, unit](const Vibration& vibration) {
        std::vector<std::pair<std::string, BandView>> out;
        for (const auto& [axis, band] : vibration.*curves) out.push_back({axis, {&band, unit}});
        return out;
      },
      signal::band_table(), meaning);
}

const Schema<VibrationSpectrum>& spectrum_table() {
  static const Schema<VibrationSpectrum> table(
      "vibration_spectrum", "amplitudes of the displacement about its mean in the second half of the time",
      [] {
        std::vector<Row<VibrationSpectrum>> rows = {
            key("from_s", &VibrationSpectrum::from_s, "begin of the record"),
            key("frequency_hz", &VibrationSpectrum::frequency_hz, "of the lines").exact()};
        for (std::size_t axis = 0; axis < axis_names.size(); ++axis) {
          rows.push_back(key(
                             std::string(axis_names.at(axis)) + "_um",
                             [axis](const VibrationSpectrum& spectrum) { return spectrum.amplitude_m.at(axis); },
                             "at each line")
                             .exact()
                             .optional());
        }
        return rows;
      }(),
      Use::written);
  return table;
}

}  // namespace

const Schema<Vibration>& vibration_table() {
  static const Schema<Vibration> table(
      "vibration", "what is recorded of a simulation for the page alone: by axis, where something happens",
      {curves_key("displacement_um", &Vibration::displacement_m, "of the tool against the workpiece"),
       curves_key("force_n", &Vibration::force_n, "on the tool"),
       key("run_s", &Vibration::run_s, "of one run of every band"),
       key("spectrum", &Vibration::spectrum, spectrum_table(), "none: too short, or nothing moves").nullable()},
      Use::written, 1);
  return table;
}

std::string vibration_json(const Simulation& result) {
  Vibration out{.spectrum = spectrum_of(result)};
  out.displacement_m = curves_of(result.displacement_m, result.sample_rate_hz, out.run_s);
  out.force_n = curves_of(result.force_n, result.sample_rate_hz, out.run_s);
  return io::dump(vibration_table().write(out));
}

}  // namespace robomill::simulation
