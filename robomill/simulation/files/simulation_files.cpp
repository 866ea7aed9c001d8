#include "robomill/simulation/files/simulation_files.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/mat.hpp"
#include "robomill/io/sample_source.hpp"
#include "robomill/io/system/append.hpp"

namespace robomill::simulation {
namespace {

struct Column {
  const char* name;
  Eigen::VectorXd values;
};

std::vector<Column> columns_of(const Simulation& result) {
  const Eigen::Index n = result.force_n.rows();
  Eigen::VectorXd time(n);
  for (Eigen::Index i = 0; i < n; ++i) time(i) = static_cast<double>(i) / result.sample_rate_hz;
  std::vector<Column> columns = {{"time_s", std::move(time)},
                                 {"x_m", result.displacement_m.col(0)},
                                 {"y_m", result.displacement_m.col(1)},
                                 {"ax_m_per_s2", result.acceleration_m_per_s2.col(0)},
                                 {"ay_m_per_s2", result.acceleration_m_per_s2.col(1)},
                                 {"fx_n", result.force_n.col(0)},
                                 {"fy_n", result.force_n.col(1)},
                                 {"fz_n", result.force_n.col(2)}};
  if (n > 0 && result.displacement_m.col(2).cwiseAbs().maxCoeff() > 0.0) {
    columns.push_back({"z_m", result.displacement_m.col(2)});
    columns.push_back({"az_m_per_s2", result.acceleration_m_per_s2.col(2)});
  }
  return columns;
}

std::string csv(const std::vector<Column>& columns) {
  std::string text;
  for (const Column& column : columns) text += std::string(text.empty() ? "" : ",") + column.name;
  text += '\n';
  for (Eigen::Index i = 0; i < columns.front().values.size(); ++i) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      io::append(text, "{}{:.9g}", c == 0 ? "" : ",", columns[c].values(i));
    }
    text += '\n';
  }
  return text;
}

void write_accelerations(const std::filesystem::path& path, const Simulation& result) {
  std::vector<float> samples;
  for (Eigen::Index i = 0; i < result.acceleration_m_per_s2.rows(); ++i) {
    samples.push_back(static_cast<float>(result.acceleration_m_per_s2(i, 0)));
    samples.push_back(static_cast<float>(result.acceleration_m_per_s2(i, 1)));
  }
  io::write_wav(path, samples, 2, result.sample_rate_hz);
}

using io::key;
using io::Row;
using io::Schema;
using io::Use;

const Schema<SmallVibration>& small_table() {
  static const Schema<SmallVibration> table(
      "small_vibration", "where a small vibration about the forced one goes",
      {key("spectral_radius", &SmallVibration::spectral_radius, "of one period"),
       key("error_estimate", &SmallVibration::error_estimate, "of the spectral radius").nullable(),
       key("multiplier", &SmallVibration::multiplier, "the largest, [re, im]"),
       key("period_s", &SmallVibration::period_s, "of the cut")},
      Use::written);
  return table;
}

const Schema<Wall>& wall_table() {
  static const Schema<Wall> table(
      "wall", "the wall that stays on the part; errors > 0: material is left",
      {key("angle_deg", &Wall::angle_rad, "0: where teeth enter, 180: where they leave"),
       key("location_error_um", &Wall::location_error_m, "mean over the heights"),
       key("least_location_error_um", &Wall::least_location_error_m, "least over the heights"),
       key("greatest_location_error_um", &Wall::greatest_location_error_m, "greatest over the heights"),
       key("ra_um", &Wall::ra_m, "mean roughness along the feed, of the roughest height"),
       key("rz_um", &Wall::rz_m, "highest to lowest, the same")},
      Use::written);
  return table;
}

std::vector<Row<Simulation>> found_keys() {
  return {key("verdict", &Simulation::verdict, verdict_names, "of the last half of the time"),
          key(
              "chatter_frequency_hz", [](const Simulation& s) { return io::if_positive(s.chatter_frequency_hz); },
              "strongest motion that is no harmonic of rotation; none: stable")
              .nullable(),
          key(
              "chatter_amplitude_um",
              [](const Simulation& s) {
                return s.chatter_frequency_hz > 0.0 ? std::optional(s.chatter_amplitude_m) : std::nullopt;
              },
              "of it")
              .nullable(),
          key("growth_per_period", &Simulation::growth_per_period, "of what is not periodic; 0: too short").nullable(),
          key("period_s", &Simulation::period_s, "of the cut: a tooth's, or a revolution or more").nullable(),
          key(
              "small_vibration",
              [](const Simulation& s) { return s.small.status == SmallVibration::Status::found ? &s.small : nullptr; },
              small_table(), "none: not found, or nothing vibrates")
              .nullable(),
          key("missed_share", &Simulation::missed_share, "of the time in which an edge in the cut touches nothing")
              .nullable(),
          key("walls", &Simulation::walls, wall_table(), "none without feed, or where there was too little time")};
}

std::vector<Row<Simulation>> force_keys() {
  const auto by_axis = [](const Simulation& s, auto&& of_column) {
    Eigen::VectorXd out = Eigen::VectorXd::Zero(3);
    for (Eigen::Index c = 0; c < 3 && s.force_n.rows() > 0; ++c) out(c) = of_column(s.force_n.col(c));
    return out;
  };
  return {key(
              "vibrating_peak_n",
              [by_axis](const Simulation& s) {
                return by_axis(s, [](const auto& column) { return column.cwiseAbs().maxCoeff(); });
              },
              "largest |force| on the tool in x, y, z"),
          key("vibrating_peak_force_n", &Simulation::vibrating_peak_force_n, "largest force, entry included"),
          key(
              "mean_force_n",
              [by_axis](const Simulation& s) { return by_axis(s, [](const auto& column) { return column.mean(); }); },
              "mean in x, y, z"),
          key(
              "samples", [](const Simulation& s) { return s.force_n.rows(); }, "of the output"),
          key("sample_rate_hz", &Simulation::sample_rate_hz, "of the output"),
          key("steps_per_revolution", &Simulation::steps_per_revolution, "of the integration"),
          key("slices", &Simulation::slices, "along the axis"),
          key("error_estimate", &Simulation::error_estimate, "of the displacement over the first revolutions, relative")
              .nullable(),
          key("resolved", &Simulation::resolved, "error_estimate is within the tolerance"),
          key("diverged", &Simulation::diverged, "the displacement reached 1 m; the columns end there"),
          key("seconds", &Simulation::seconds, "computing time")};
}

}  // namespace

void write_simulation(const std::filesystem::path& path, const Simulation& result) {
  switch (io::format_of(path)) {
    case io::Format::csv:
      io::write_file(path, csv(columns_of(result)));
      return;
    case io::Format::mat: {
      std::vector<io::MatVariable> variables;
      for (const Column& column : columns_of(result)) variables.push_back({column.name, column.values});
      io::write_mat(path, variables);
      return;
    }
    case io::Format::wav:
      write_accelerations(path, result);
      return;
    default:
      throw InvalidInput(path.string(), "a simulation is written as .csv, .mat, .wav or .json");
  }
}

const Schema<SimulationView>& simulation_table() {
  static const Schema<SimulationView> table(
      "simulation", "what the simulation of a cut found",
      [] {
        const auto of_result = [](const std::vector<Row<Simulation>>& rows) {
          return io::keys_of<SimulationView>(
              rows, [](const SimulationView& view) -> const Simulation& { return *view.simulation; });
        };
        std::vector<Row<SimulationView>> rows = {
            key("spindle_speed_rpm", &SimulationView::spindle_speed_rad_per_s, "spindle speed"),
            key("axial_depth_mm", &SimulationView::axial_depth_m, "axial depth")};
        add_rows(rows, of_result(found_keys()));
        add_rows(rows, of_result(force_keys()));
        return rows;
      }(),
      Use::written, 1);
  return table;
}

std::string simulation_json(const Simulation& result, double spindle_speed_rad_per_s, double axial_depth_m) {
  return io::dump(simulation_table().write(
      {.simulation = &result, .spindle_speed_rad_per_s = spindle_speed_rad_per_s, .axial_depth_m = axial_depth_m}));
}

}  // namespace robomill::simulation
