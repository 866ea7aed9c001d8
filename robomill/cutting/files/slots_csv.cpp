#include "robomill/cutting/files/slots_csv.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/files/coefficients_toml.hpp"
#include "robomill/io/csv.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/json.hpp"
#include "robomill/io/table.hpp"

namespace robomill::cutting {
namespace {

struct Column {
  const char* key;
  const char* member;
  double factor;
  double& (*value)(SlotForce&);
};
constexpr std::array<Column, 6> columns = {{
    {"feed_per_tooth_mm", "feed_per_tooth_m", units::mm, [](SlotForce& s) -> double& { return s.feed_per_tooth_m; }},
    {"axial_depth_mm", "axial_depth_m", units::mm, [](SlotForce& s) -> double& { return s.axial_depth_m; }},
    {"spindle_speed_rpm", "spindle_speed_rad_per_s", units::rpm,
     [](SlotForce& s) -> double& { return s.spindle_speed_rad_per_s; }},
    {"fx_n", "", 1.0, [](SlotForce& s) -> double& { return s.mean_force_n.x(); }},
    {"fy_n", "", 1.0, [](SlotForce& s) -> double& { return s.mean_force_n.y(); }},
    {"fz_n", "", 1.0, [](SlotForce& s) -> double& { return s.mean_force_n.z(); }},
}};
constexpr std::string_view may_be_missing = "spindle_speed_rpm";

void check_columns(const io::TextTable& table) {
  std::vector<std::string> known;
  known.reserve(columns.size());
  for (const Column& column : columns) known.emplace_back(column.key);
  table.require_known(known);
  for (const std::string& name : known) {
    if (!table.column(name) && name != may_be_missing) {
      throw InvalidInput(table.where, fmt::format("has no column {}", name));
    }
  }
}

SlotForce read_row(const io::TextTable& table, const io::TextTable::Row& row) {
  SlotForce slot;
  for (const Column& column : columns) {
    const std::string_view text = table.text(row, column.key);
    if (text.empty() && column.key == may_be_missing) continue;
    const std::optional<double> number = io::parse_cell(text);
    if (!number || !std::isfinite(*number)) {
      throw table.reject(row, column.key, text.empty() ? "is empty" : "must be a finite number");
    }
    column.value(slot) = *number * column.factor;
  }
  try {
    slot.validate();
  } catch (const InvalidInput& error) {
    for (const Column& column : columns) {
      if (error.parts().field == column.member) {
        throw table.reject(row, column.key, error.parts().rule, error.parts().hint);
      }
    }
    throw;
  }
  return slot;
}

struct Named {
  const char* name;
  const CoefficientPair* pair;
};
template <class Fit>
std::array<Named, 3> pairs_of(const Fit& fit) {
  return {{{"tangential", &fit.tangential}, {"radial", &fit.radial}, {"axial", &fit.axial}}};
}

/// Each pair's numbers under the keys of coefficients.toml.
template <class Fit>
io::Json values_of(const Fit& fit, double CoefficientPair::*cutting, double CoefficientPair::*edge) {
  io::Json out = io::Json::object();
  for (const auto& [name, pair] : pairs_of(fit))
    out[fmt::format("{}_n_per_mm2", name)] = io::number(pair->*cutting / units::n_per_mm2);
  for (const auto& [name, pair] : pairs_of(fit))
    out[fmt::format("{}_edge_n_per_mm", name)] = io::number(pair->*edge / units::n_per_mm);
  return out;
}
template <class Fit>
io::Json deviations_of(const Fit& fit) {
  return values_of(fit, &CoefficientPair::cutting_deviation_n_per_m2, &CoefficientPair::edge_deviation_n_per_m);
}
template <class Fit>
io::Json coefficients_of(const Fit& fit) {
  return values_of(fit, &CoefficientPair::cutting_n_per_m2, &CoefficientPair::edge_n_per_m);
}

template <class Fit>
io::Json of_each(const Fit& fit, double CoefficientPair::*value) {
  io::Json out = io::Json::object();
  for (const auto& [name, pair] : pairs_of(fit)) out[name] = io::number(pair->*value);
  return out;
}

io::Json vector_json(const Eigen::Vector3d& v) {
  return {io::number(v.x()), io::number(v.y()), io::number(v.z())};
}

/// A slot as the file has it, and how far its force is from the fit's.
io::Json residual_json(const SlotForce& slot, std::size_t line, const Eigen::Vector3d& residual_n) {
  return {{"line", line},
          {"feed_per_tooth_mm", io::number(slot.feed_per_tooth_m / units::mm)},
          {"axial_depth_mm", io::number(slot.axial_depth_m / units::mm)},
          {"spindle_speed_rpm", io::positive(slot.spindle_speed_rad_per_s, units::rpm)},
          {"force_n", vector_json(slot.mean_force_n)},
          {"residual_n", vector_json(residual_n)}};
}

io::Json identification(const SlotFit& fit, const SlotsFile& file, const std::vector<Assumption>& assumed) {
  io::Json json;
  const bool identified = fit.status == SlotFit::Status::identified;
  json["status"] = identified ? "identified" : "edge unknown";
  json["rows"] = file.slots.size();
  json["std"] = deviations_of(fit);
  json["r_squared"] = of_each(fit, &CoefficientPair::r_squared);
  json["noise_n"] = of_each(fit, &CoefficientPair::noise_n);
  json["correlation"] = of_each(fit, &CoefficientPair::correlation);
  json["depends_on_speed"] = fit.depends_on_speed;
  json["speed_probability"] = io::number(fit.speed_probability);
  json["notes"] = fit.notes;
  json["assumed"] = io::assumed_json(assumed);
  io::Json residuals = io::Json::array();
  for (std::size_t i = 0; i < file.lines.size(); ++i) {
    residuals.push_back(residual_json(file.slots[i], file.lines[i], fit.residual_n.col(static_cast<Eigen::Index>(i))));
  }
  json["residuals"] = residuals;
  io::Json speeds = io::Json::array();
  for (const SpeedGroup& group : fit.by_speed) {
    speeds.push_back({{"spindle_speed_rpm", io::number(group.spindle_speed_rad_per_s / units::rpm)},
                      {"rows", group.rows},
                      {"coefficients", coefficients_of(group)},
                      {"std", deviations_of(group)}});
  }
  json["by_speed"] = speeds;
  return json;
}

/// JSON values as TOML has them too: inline tables in place of objects; what is null is left out.
std::string inline_toml(const io::Json& json) {
  if (!json.is_structured()) return json.dump();
  std::string text;
  for (const auto& [key, value] : json.items()) {
    if (value.is_null()) continue;
    if (!text.empty()) text += ", ";
    if (json.is_object()) text += key + " = ";
    text += inline_toml(value);
  }
  return json.is_array() ? "[" + text + "]" : "{ " + text + " }";
}

}  // namespace

SlotsFile read_slots(const std::filesystem::path& path) {
  SlotsFile out;
  const io::TextTable table = io::parse_text_table(io::read_file(path), path.string(), out.notes);
  check_columns(table);
  out.slots.reserve(table.rows.size());
  out.lines.reserve(table.rows.size());
  for (const io::TextTable::Row& row : table.rows) {
    out.slots.push_back(read_row(table, row));
    out.lines.push_back(row.line);
  }
  return out;
}

std::string slot_fit_toml(const SlotFit& fit, const SlotsFile& file, const std::vector<Assumption>& assumed) {
  std::string text = coefficients_toml(fit.coefficients()) + "\n[identification]\n";
  const io::Json reported = identification(fit, file, assumed);
  for (const auto& [key, value] : reported.items()) {
    if (!value.is_null()) text += fmt::format("{} = {}\n", key, inline_toml(value));
  }
  return text;
}

std::string slot_fit_json(const SlotFit& fit, const SlotsFile& file, const std::vector<Assumption>& assumed) {
  io::Json json;
  json["coefficients"] = coefficients_of(fit);
  json["identification"] = identification(fit, file, assumed);
  return io::dump(json);
}

std::string slot_fit_csv(const SlotFit& fit) {
  std::string out = "spindle_speed_rpm,coefficient,value,std,r_squared,noise_n\n";
  const auto add = [&out](const std::string& speed, const auto& of) {
    for (const auto& [name, pair] : pairs_of(of)) {
      const std::string quality = io::csv_number(pair->r_squared) + "," + io::csv_number(pair->noise_n);
      io::add_csv_row(
          out, {speed, fmt::format("{}_n_per_mm2", name), io::csv_number(pair->cutting_n_per_m2, units::n_per_mm2),
                io::csv_number(pair->cutting_deviation_n_per_m2, units::n_per_mm2), quality});
      io::add_csv_row(
          out, {speed, fmt::format("{}_edge_n_per_mm", name), io::csv_number(pair->edge_n_per_m, units::n_per_mm),
                io::csv_number(pair->edge_deviation_n_per_m, units::n_per_mm), quality});
    }
  };
  add("", fit);
  for (const SpeedGroup& group : fit.by_speed) add(io::csv_number(group.spindle_speed_rad_per_s, units::rpm), group);
  return out;
}

}  // namespace robomill::cutting
