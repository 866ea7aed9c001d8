#include "robomill/process/files/structure_schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"

namespace robomill::process {
namespace {

using io::Json;
using io::key;
using io::of;
using io::Row;
using io::Schema;
using io::TomlFile;

/// A mode of one direction, by its mass or its stiffness k = m ω².
struct OwnMode {
  modal::MassMode mode = {};
  std::optional<double> modal_mass_kg = {}, modal_stiffness_n_per_m = {};
};

const Schema<OwnMode>& own_mode_table() {
  static const Schema<OwnMode> table(
      "own_mode", "a mode of one direction",
      {of(&OwnMode::mode,
          key("frequency_hz", &modal::MassMode::frequency_hz, "natural frequency").above(0.0).required()),
       of(&OwnMode::mode, key("damping_ratio", &modal::MassMode::damping_ratio, "share of the critical damping")
                              .above(0.0)
                              .below(1.0, "It is a ratio, not a percentage")
                              .required()),
       key("modal_mass_kg", &OwnMode::modal_mass_kg, "or modal_stiffness_n_per_um: one of them").above(0.0),
       key("modal_stiffness_n_per_um", &OwnMode::modal_stiffness_n_per_m, "in place of modal_mass_kg").above(0.0)});
  return table;
}

/// @param path  of the mode's table
modal::MassMode mass_mode(const TomlFile& file, const std::string& path, const OwnMode& own) {
  modal::MassMode out = own.mode;
  if (own.modal_mass_kg && own.modal_stiffness_n_per_m) {
    throw file.reject(path + ".modal_stiffness_n_per_um", "must not stand beside modal_mass_kg",
                      "One follows from the other and frequency_hz");
  }
  if (own.modal_stiffness_n_per_m) {
    const double omega = units::revolution * out.frequency_hz;
    out.modal_mass_kg = *own.modal_stiffness_n_per_m / (omega * omega);
  } else {
    file.require(path + ".modal_mass_kg", "Or give modal_stiffness_n_per_um in its place");
    out.modal_mass_kg = *own.modal_mass_kg;
  }
  return out;
}

/// Modes of one direction, numbered after those of the directions before it.
Row<StructureTable> own_modes_row(const char* name, Eigen::Index axis) {
  constexpr Eigen::Index axes = 3;
  Row<StructureTable> row{.key = {.name = name,
                                  .holds = io::Holds::table,
                                  .lists = 1,
                                  .table = &own_mode_table().info(),
                                  .meaning = "modes along it in place of a file; [] of one that is rigid"}};
  row.read = [axis](TomlFile& file, const std::string& path, const Row<StructureTable>& self, StructureTable& out) {
    for (std::size_t i = 0; i < file.tables(path); ++i) {
      const std::string table = fmt::format("{}[{}]", path, i);
      OwnMode mode;
      own_mode_table().read(file, table, mode, fmt::format("{}modes[{}].", self.member, out.own.modes.size() + 1));
      out.own.modes.push_back(modal::mode_from_mass(mass_mode(file, table, mode), axis, axes));
    }
  };
  row.write = [](const StructureTable&, const Row<StructureTable>&) { return Json(); };
  return row;
}

std::vector<Row<StructureTable>> structure_rows() {
  return {key("modes", &StructureTable::modes, "a file of modes; or x, y and z"),
          key("frf", &StructureTable::frf,
              "measured FRFs in place of modes: lobes by multi-frequency and zeroth-order without a fit; simulate fits "
              "modes"),
          own_modes_row("x", 0), own_modes_row("y", 1), own_modes_row("z", 2)};
}

constexpr Name<StructureAxes> axes_names[] = {{"feed", StructureAxes::feed},
                                              {"tool", StructureAxes::tool},
                                              {"base", StructureAxes::base},
                                              {"flange", StructureAxes::flange}};

Row<modal::MissingDirections> rigid_row() {
  Row<modal::MissingDirections> row{
      .key = {.name = "rigid_directions",
              .holds = io::Holds::word,
              .lists = 1,
              .words = {"x", "y"},
              .meaning = "the same: they do not move; of modes in the file [] means rigid too"}};
  row.read = [](TomlFile& file, const std::string& path, const Row<modal::MissingDirections>&,
                modal::MissingDirections& out) {
    std::vector<std::string> names;
    file.texts(path, names);
    for (const std::string& name : names) {
      if (name != "x" && name != "y") throw file.reject(path, "must be a list of \"x\" and \"y\"");
      out.rigid.push_back(name == "x" ? modal::Axis::x : modal::Axis::y);
    }
  };
  row.write = [](const modal::MissingDirections&, const Row<modal::MissingDirections>&) { return Json::array(); };
  return row;
}

/// @throws InvalidInput where more than one of a table's sources is given
void finish(const TomlFile& file, const std::string& table, StructureTable& out) {
  const int sources = (out.modes.empty() ? 0 : 1) + (out.frf.empty() ? 0 : 1) + (out.own.modes.empty() ? 0 : 1);
  if (sources > 1) throw file.reject(table, "must give only one of modes, frf, and x, y and z");
  if (out.own.modes.empty()) return;
  out.own.excitations =
      out.own.responses = {{.axis = modal::Axis::x}, {.axis = modal::Axis::y}, {.axis = modal::Axis::z}};
}

}  // namespace

const Schema<StructureTable>& workpiece_dynamics_table() {
  static const Schema<StructureTable> table("workpiece_dynamics", "the part and its fixture, in the axes of the tool's",
                                            structure_rows());
  return table;
}

const Schema<modal::MissingDirections>& missing_directions_table() {
  static const Schema<modal::MissingDirections> table(
      "missing_directions", "what a direction is taken for that nobody measured",
      {key("equal_directions", &modal::MissingDirections::equal,
           "where modes or FRFs have one direction only: the other is equal. Milling needs this or rigid_directions"),
       rigid_row()});
  return table;
}

const Schema<DynamicsTable>& dynamics_table() {
  static const Schema<DynamicsTable> table = [] {
    std::vector<Row<DynamicsTable>> rows;
    for (const Row<StructureTable>& row : structure_rows()) rows.push_back(of(&DynamicsTable::structure, row));
    io::add_rows(
        rows, {key("axes", &DynamicsTable::axes, axes_names,
                   "of a cut in three directions: x, y, z are fixed to the feed (default), or incline with the tool; "
                   "beside a cell the axes of the cut's x, y, z: base (default) or flange"),
               key("cell", &DynamicsTable::cell,
                   "in place of modes: those of a posture, from the cell's [[postures]] or its own numbers, with "
                   "their uncertainty"),
               key("joints_deg", &DynamicsTable::joints, "that posture: one value a joint").as("joints")});
    for (const Row<modal::MissingDirections>& row : missing_directions_table().rows()) {
      rows.push_back(of(&DynamicsTable::directions, row));
    }
    rows.push_back(key("keep_modes", &DynamicsTable::keep_modes, "from 1; the others are left out"));
    return Schema<DynamicsTable>("dynamics", "what vibrates with the tool", std::move(rows));
  }();
  return table;
}

StructureTable read_workpiece_dynamics(TomlFile& file) {
  StructureTable out;
  workpiece_dynamics_table().read(file, "workpiece_dynamics", out);
  finish(file, "workpiece_dynamics", out);
  return out;
}

DynamicsTable read_dynamics(TomlFile& file) {
  DynamicsTable out;
  dynamics_table().read(file, "dynamics", out);
  finish(file, "dynamics", out.structure);
  const bool cell = !out.cell.empty();
  if (cell && out.joints.empty()) file.require("dynamics.joints_deg", "The posture: one value a joint");
  if (!cell && !out.joints.empty()) file.require("dynamics.cell", "Whose joints?");
  if (cell && (!out.structure.modes.empty() || !out.structure.frf.empty() || !out.structure.own.modes.empty())) {
    throw file.reject("dynamics.cell", "must not stand beside modes, frf, x, y or z");
  }
  if (out.axes && cell != (*out.axes == StructureAxes::base || *out.axes == StructureAxes::flange)) {
    throw file.reject("dynamics.axes", cell ? "must be \"base\" or \"flange\" beside a cell"
                                            : "must be \"feed\" or \"tool\": no cell is given");
  }
  return out;
}

void keep_named_directions(const TomlFile& file, modal::ModalModel& own) {
  std::vector<Eigen::Index> named;
  std::vector<modal::Dof> dofs;
  for (std::size_t i = 0; i < own.responses.size(); ++i) {
    if (!file.has("dynamics." + modal::to_string(own.responses[i]))) continue;
    named.push_back(static_cast<Eigen::Index>(i));
    dofs.push_back(own.responses[i]);
  }
  own.excitations = own.responses = dofs;
  for (modal::Mode& mode : own.modes) {
    mode.left = mode.left(named).eval();
    mode.right = mode.right(named).eval();
  }
}

std::optional<Assumption> complete_directions(modal::ModalModel& modes, modal::FrfSet& measured,
                                              const modal::MissingDirections& said, const std::filesystem::path& where,
                                              const std::string& table) {
  if (modes.modes.empty() && measured.frfs.empty()) return std::nullopt;
  const bool fitted = !modes.modes.empty();
  try {
    require_said(fitted ? unknown_directions(modes) : unknown_directions(measured), said);
    if (said.equal && fitted) modes = with_equal_directions(modes);
    if (said.equal && !fitted) measured = with_equal_directions(measured);
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    parts.where = where.string();
    parts.field = parts.field.empty() ? table : table + "." + parts.field;
    throw InvalidInput(std::move(parts));
  }
  std::optional<Assumption> assumed = modal::assumed_of(said);
  if (assumed) {
    assumed->key = table + "." + assumed->key;
    assumed->file = where.filename().string();
  }
  return assumed;
}

}  // namespace robomill::process
