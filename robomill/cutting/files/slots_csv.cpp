#include "robomill/cutting/files/slots_csv.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/files/coefficients_toml.hpp"
#include "robomill/cutting/files/slots_schema.hpp"
#include "robomill/io/csv.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/records/record_formats.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/schema.hpp"
#include "robomill/io/table.hpp"

namespace robomill::cutting {
namespace {

using io::key;
using io::of;
using io::Row;
using io::Schema;
using io::Use;

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

/// Rows of a file of named values (.mat, .npz, …), as those of a text: their numbers count from 1 as its lines do.
io::TextTable table_of(const io::Record& record, std::vector<std::string>& notes) {
  io::TextTable table{.where = record.file.string(), .names = record.names};
  const Eigen::Index rows = record.columns.front().size();
  for (const Eigen::VectorXd& column : record.columns) {
    if (column.size() != rows) throw InvalidInput(table.where, "has columns of several lengths");
  }
  for (Eigen::Index row = 0; row < rows; ++row) {
    io::TextTable::Row& to = table.rows.emplace_back();
    to.line = static_cast<std::size_t>(row) + 1;
    for (const Eigen::VectorXd& column : record.columns) to.fields.push_back(fmt::format("{}", column(row)));
  }
  std::ranges::copy(record.notes, std::back_inserter(notes));
  io::warn_of_unusual(table, notes);
  return table;
}

/// Text where the ending does not say that it is something else.
io::TextTable read_table(const std::filesystem::path& path, std::vector<std::string>& notes) {
  const bool is_text = io::record_format_of(path) == io::RecordFormat::text ||
                       (!io::is_read_as_record(path) && io::unread_record(path).what.empty());
  if (is_text) return io::parse_text_table(io::read_file(path), path.string(), notes);
  return table_of(io::read_record(path), notes);
}

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

constexpr std::array<const char*, 3> force_directions = {"tangential", "radial", "axial"};

template <class Fit>
std::array<const CoefficientPair*, 3> pairs_of(const Fit& fit) {
  return {&fit.tangential, &fit.radial, &fit.axial};
}

/// Of each direction.
using Each = std::array<double, 3>;
template <class Fit>
Each of_each(const Fit& fit, double CoefficientPair::*value) {
  Each out{};
  for (std::size_t i = 0; i < 3; ++i) out[i] = pairs_of(fit)[i]->*value;
  return out;
}

const Schema<Each>& each_table() {
  static const Schema<Each> table(
      "by_direction", "a number of each direction",
      [] {
        std::vector<Row<Each>> rows;
        for (std::size_t i = 0; i < 3; ++i) {
          const auto value = [i](const Each& each) { return each[i]; };
          rows.push_back(key(force_directions[i], value, "of the fit in this direction").nullable());
        }
        return rows;
      }(),
      Use::written);
  return table;
}

/// Each pair's numbers under the keys of coefficients.toml.
struct Values {
  Each cutting_n_per_m2 = {}, edge_n_per_m = {};
};

const Schema<Values>& values_table() {
  static const Schema<Values> table(
      "coefficient_values", "of cutting and of the edge",
      [] {
        std::vector<Row<Values>> rows;
        const auto add = [&rows](const char* ending, Each Values::*member, const char* meaning) {
          for (std::size_t i = 0; i < 3; ++i) {
            const auto value = [i, member](const Values& values) { return (values.*member)[i]; };
            rows.push_back(key(std::string(force_directions[i]) + ending, value, meaning).nullable());
          }
        };
        add("_n_per_mm2", &Values::cutting_n_per_m2, "of cutting");
        add("_edge_n_per_mm", &Values::edge_n_per_m, "of the edge");
        return rows;
      }(),
      Use::written);
  return table;
}

template <class Fit>
Values deviations_of(const Fit& fit) {
  return {of_each(fit, &CoefficientPair::cutting_deviation_n_per_m2),
          of_each(fit, &CoefficientPair::edge_deviation_n_per_m)};
}
template <class Fit>
Values coefficients_of(const Fit& fit) {
  return {of_each(fit, &CoefficientPair::cutting_n_per_m2), of_each(fit, &CoefficientPair::edge_n_per_m)};
}

const Schema<SpeedGroup>& group_table() {
  static const Schema<SpeedGroup> table(
      "speed_group", "the slots of one spindle speed",
      {key("spindle_speed_rpm", &SpeedGroup::spindle_speed_rad_per_s, "their mean").nullable(),
       key("rows", &SpeedGroup::rows, "how many"),
       key(
           "coefficients", [](const SpeedGroup& group) { return coefficients_of(group); }, values_table(),
           "fitted to them alone"),
       key(
           "std", [](const SpeedGroup& group) { return deviations_of(group); }, values_table(), "standard deviations")},
      Use::written);
  return table;
}

/// A slot, its line in the file and what the fit leaves of its force.
struct FittedSlot {
  SlotForce slot = {};
  std::size_t line = 0;
  Eigen::Vector3d residual_n = Eigen::Vector3d::Zero();
};

const Schema<FittedSlot>& slot_table() {
  using Slot = FittedSlot;
  static const Schema<Slot> table(
      "fitted_slot", "a slot as the file has it",
      {key("line", &Slot::line, "of the file"),
       of(&Slot::slot, key("feed_per_tooth_mm", &SlotForce::feed_per_tooth_m, "of the slot")),
       of(&Slot::slot, key("axial_depth_mm", &SlotForce::axial_depth_m, "of the slot")),
       key(
           "spindle_speed_rpm", [](const Slot& at) { return io::if_positive(at.slot.spindle_speed_rad_per_s); },
           "none: not given")
           .nullable(),
       of(&Slot::slot, key("force_n", &SlotForce::mean_force_n, "mean in x, y, z").entries(3)),
       key("residual_n", &Slot::residual_n, "the same less the fit's").entries(3)},
      Use::written);
  return table;
}

struct FitView {
  const SlotFit* fit = nullptr;
  const SlotsFile* file = nullptr;
  const std::vector<Assumption>* assumed = nullptr;
};

/// A number of each direction of the fit.
Row<FitView> each_key(const std::string& name, double CoefficientPair::*value, const std::string& meaning) {
  return key(
      name, [value](const FitView& view) { return of_each(*view.fit, value); }, each_table(), meaning);
}

std::vector<FittedSlot> slots_of(const FitView& view) {
  std::vector<FittedSlot> out;
  for (std::size_t i = 0; i < view.file->lines.size(); ++i)
    out.push_back({view.file->slots[i], view.file->lines[i], view.fit->residual_n.col(static_cast<Eigen::Index>(i))});
  return out;
}

const Schema<FitView>& identification_table() {
  using View = FitView;
  static const Schema<View> table(
      "identification", "how well the coefficients are known",
      {key(
           "status",
           [](const View& v) { return v.fit->status == SlotFit::Status::identified ? "identified" : "edge unknown"; },
           "what the slots determine")
           .words({"identified", "edge unknown"}),
       key(
           "rows", [](const View& v) { return v.file->slots.size(); }, "slots"),
       key(
           "std", [](const View& v) { return deviations_of(*v.fit); }, values_table(), "standard deviations"),
       each_key("r_squared", &CoefficientPair::r_squared, "share of the force that the fit explains"),
       each_key("noise_n", &CoefficientPair::noise_n, "scatter about the fit"),
       each_key("correlation", &CoefficientPair::correlation, "of the two coefficients"),
       key(
           "depends_on_speed", [](const View& v) { return v.fit->depends_on_speed; }, "beyond the scatter"),
       key(
           "speed_probability", [](const View& v) { return v.fit->speed_probability; },
           "of such a difference between speeds by chance")
           .nullable(),
       key(
           "notes", [](const View& v) { return v.fit->notes; }, "sentences for the user"),
       key(
           "assumed", [](const View& v) { return *v.assumed; }, io::assumption_table(), "what the input did not give"),
       key(
           "residuals", [](const View& v) { return slots_of(v); }, slot_table(), "of each slot"),
       key(
           "by_speed", [](const View& v) { return v.fit->by_speed; }, group_table(), "where there are several")},
      Use::written);
  return table;
}

const Schema<FitView>& fit_table() {
  static const Schema<FitView> table(
      "coefficients", "cutting force coefficients, from the mean forces of slots",
      {key(
           "coefficients", [](const FitView& v) { return coefficients_of(*v.fit); }, values_table(), "of all slots"),
       key(
           "identification", [](const FitView& v) { return v; }, identification_table(), "how well they are known")},
      Use::written, 1);
  return table;
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

const io::TableInfo& coefficients_document() {
  return fit_table().info();
}

SlotsFile read_slots(const std::filesystem::path& path) {
  SlotsFile out;
  const io::TextTable table = read_table(path, out.notes);
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
  const io::Json reported = identification_table().write({&fit, &file, &assumed});
  for (const auto& [key, value] : reported.items()) {
    if (!value.is_null()) text += fmt::format("{} = {}\n", key, inline_toml(value));
  }
  return text;
}

std::string slot_fit_json(const SlotFit& fit, const SlotsFile& file, const std::vector<Assumption>& assumed) {
  return io::dump(fit_table().write({&fit, &file, &assumed}));
}

std::string slot_fit_csv(const SlotFit& fit) {
  std::string out = "spindle_speed_rpm,coefficient,value,std,r_squared,noise_n\n";
  const auto add = [&out](const std::string& speed, const auto& of) {
    for (std::size_t i = 0; i < 3; ++i) {
      const char* const name = force_directions[i];
      const CoefficientPair* const pair = pairs_of(of)[i];
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
