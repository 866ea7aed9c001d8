#include "robomill/robot/files/loads_csv.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/table.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::robot {
namespace {

/// A column that is not a joint's.
struct Column {
  const char* key;
  double factor;
  double& (*value)(Load& load);
  bool needed;
};
constexpr std::array<Column, 10> columns = {{
    {"fx_n", 1.0, [](Load& load) -> double& { return load.wrench.force_n.x(); }, true},
    {"fy_n", 1.0, [](Load& load) -> double& { return load.wrench.force_n.y(); }, true},
    {"fz_n", 1.0, [](Load& load) -> double& { return load.wrench.force_n.z(); }, true},
    {"dx_mm", units::mm, [](Load& load) -> double& { return load.displacement_m.x(); }, true},
    {"dy_mm", units::mm, [](Load& load) -> double& { return load.displacement_m.y(); }, true},
    {"dz_mm", units::mm, [](Load& load) -> double& { return load.displacement_m.z(); }, true},
    {"mx_n_m", 1.0, [](Load& load) -> double& { return load.wrench.moment_n_m.x(); }, false},
    {"my_n_m", 1.0, [](Load& load) -> double& { return load.wrench.moment_n_m.y(); }, false},
    {"mz_n_m", 1.0, [](Load& load) -> double& { return load.wrench.moment_n_m.z(); }, false},
    {"deviation_mm", units::mm, [](Load& load) -> double& { return load.deviation_m; }, false},
}};

std::string joint_column(const Arm& arm, std::size_t joint) {
  return fmt::format("q{}_{}", joint + 1, arm.joints[joint].prismatic ? "mm" : "deg");
}

/// Where each column stands; nothing where an optional one is missing.
struct Places {
  std::vector<std::size_t> joints = {};
  std::array<std::optional<std::size_t>, columns.size()> others = {};
};

Places find_columns(const io::TextTable& table, const Arm& arm) {
  std::vector<std::string> known;
  known.reserve(arm.joints.size() + columns.size());
  for (std::size_t i = 0; i < arm.joints.size(); ++i) known.push_back(joint_column(arm, i));
  for (const Column& column : columns) known.emplace_back(column.key);
  table.require_known(known);
  const auto needed = [&](const std::string& name) {
    const std::optional<std::size_t> found = table.column(name);
    if (!found) {
      throw InvalidInput(table.where, fmt::format("has no column {}", name),
                         fmt::format("The arm has {} joints: {} to {}, fx_n, fy_n, fz_n, dx_mm, dy_mm, dz_mm",
                                     arm.joints.size(), known.front(), known[arm.joints.size() - 1]));
    }
    return *found;
  };
  Places out;
  out.joints.reserve(arm.joints.size());
  for (std::size_t i = 0; i < arm.joints.size(); ++i) out.joints.push_back(needed(known[i]));
  for (std::size_t i = 0; i < columns.size(); ++i) {
    out.others[i] = columns[i].needed ? needed(columns[i].key) : table.column(columns[i].key);
  }
  return out;
}

double read_field(const io::TextTable& table, const io::TextTable::Row& row, std::size_t place, double factor) {
  const std::string& field = row.fields[place];
  const std::optional<double> number = io::parse_cell(field);
  if (number && std::isfinite(*number)) return *number * factor;
  InvalidInput::Parts parts{.where = fmt::format("{}:{}", table.where, row.line), .field = table.names[place]};
  parts.rule = field.empty() ? "is missing" : "must be a finite number";
  if (!field.empty()) parts.value = fmt::format("\"{}\"", field);
  throw InvalidInput(std::move(parts));
}

}  // namespace

LoadsFile read_loads(const std::filesystem::path& path, const Arm& arm) {
  LoadsFile out{.path = path};
  const io::TextTable table = io::parse_text_table(io::read_file(path), path.string(), out.notes);
  const Places places = find_columns(table, arm);
  std::vector<double> joints_deg;  // of all rows, to see whether they are in radians
  out.loads.reserve(table.rows.size());
  out.line.reserve(table.rows.size());
  for (const io::TextTable::Row& row : table.rows) {
    Load load{.position = Eigen::VectorXd(arm.size())};
    for (std::size_t i = 0; i < arm.joints.size(); ++i) {
      const double factor = arm.joints[i].prismatic ? units::mm : units::deg;
      load.position(static_cast<Eigen::Index>(i)) = read_field(table, row, places.joints[i], factor);
    }
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (!places.others[i]) continue;
      columns[i].value(load) = read_field(table, row, *places.others[i], columns[i].factor);
    }
    for (std::size_t i = 0; i < arm.joints.size(); ++i) {
      if (!arm.joints[i].prismatic) joints_deg.push_back(load.position(static_cast<Eigen::Index>(i)) / units::deg);
    }
    out.loads.push_back(std::move(load));
    out.line.push_back(row.line);
  }
  if (auto warning = io::unusual_warning(path.string(), "joints_deg", joints_deg))
    out.notes.push_back(std::move(*warning));
  return out;
}

IdentifiedStiffness identify_joint_stiffness(const Arm& arm, const Eigen::Vector3d& point_m, const LoadsFile& file,
                                             const IdentifyOptions& options) {
  try {
    return identify_joint_stiffness(arm, point_m, file.loads, options);
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    constexpr std::string_view prefix = "loads[";
    std::size_t load = 0;
    if (parts.field.starts_with(prefix)) {
      std::from_chars(parts.field.data() + prefix.size(), parts.field.data() + parts.field.size(), load);
    }
    if (load == 0 || load > file.line.size()) {
      if (parts.field == "loads") parts.where = file.path.string();
      throw InvalidInput(std::move(parts));
    }
    parts.where = fmt::format("{}:{}", file.path.string(), file.line[load - 1]);
    parts.field = parts.field.substr(parts.field.find("].") + 2);
    if (parts.field == "deviation_m" && parts.number) {
      parts.field = "deviation_mm";
      parts.number = io::round_15(*parts.number / units::mm);
      parts.unit = "mm";
    }
    throw InvalidInput(std::move(parts));
  }
}

}  // namespace robomill::robot
