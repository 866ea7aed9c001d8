#include "robomill/simulation/files/simulation_files.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/append.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/mat.hpp"
#include "robomill/io/sample_source.hpp"

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

io::Json small_json(const SmallVibration& small) {
  if (small.status != SmallVibration::Status::found) return nullptr;
  return {{"spectral_radius", io::number(small.spectral_radius)},
          {"error_estimate", io::number(small.error_estimate)},
          {"multiplier", io::complex_number(small.multiplier)},
          {"period_s", io::number(small.period_s)}};
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

std::string simulation_json(const Simulation& result, double spindle_speed_rad_per_s, double axial_depth_m) {
  const bool chatters = result.chatter_frequency_hz > 0.0;
  io::Json json;
  json["spindle_speed_rpm"] = io::number(spindle_speed_rad_per_s / units::rpm);
  json["axial_depth_mm"] = io::number(axial_depth_m / units::mm);
  json["verdict"] = to_string(result.verdict);
  json["chatter_frequency_hz"] = chatters ? io::number(result.chatter_frequency_hz) : io::Json(nullptr);
  json["chatter_amplitude_um"] = chatters ? io::number(result.chatter_amplitude_m / units::um) : io::Json(nullptr);
  json["growth_per_period"] = io::number(result.growth_per_period);
  json["period_s"] = io::number(result.period_s);
  json["small_vibration"] = small_json(result.small);
  json["missed_share"] = io::number(result.missed_share);
  json["walls"] = io::Json::array();
  for (const Wall& wall : result.walls) {
    json["walls"].push_back({{"angle_deg", io::number(wall.angle_rad / units::deg)},
                             {"location_error_um", io::number(wall.location_error_m / units::um)},
                             {"least_location_error_um", io::number(wall.least_location_error_m / units::um)},
                             {"greatest_location_error_um", io::number(wall.greatest_location_error_m / units::um)},
                             {"ra_um", io::number(wall.ra_m / units::um)},
                             {"rz_um", io::number(wall.rz_m / units::um)}});
  }
  io::Json peak = io::Json::array(), mean = io::Json::array();
  const bool any = result.force_n.rows() > 0;
  for (Eigen::Index c = 0; c < 3; ++c) {
    peak.push_back(io::number(any ? result.force_n.col(c).cwiseAbs().maxCoeff() : 0.0));
    mean.push_back(io::number(any ? result.force_n.col(c).mean() : 0.0));
  }
  json["vibrating_peak_n"] = peak;
  json["vibrating_peak_force_n"] = io::number(result.vibrating_peak_force_n);
  json["mean_force_n"] = mean;
  json["samples"] = result.force_n.rows();
  json["sample_rate_hz"] = io::number(result.sample_rate_hz);
  json["steps_per_revolution"] = result.steps_per_revolution;
  json["slices"] = result.slices;
  json["error_estimate"] = io::number(result.error_estimate);
  json["resolved"] = result.resolved;
  json["diverged"] = result.diverged;
  json["seconds"] = io::number(result.seconds);
  return io::dump(json);
}

}  // namespace robomill::simulation
