#include "robomill/process/files/cut_fields.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/files/cutter_schema.hpp"
#include "robomill/cutting/unusual_cut.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/usual_ranges.hpp"

namespace robomill::process {
namespace {

modal::Mode read_inline_mode(io::TomlFile& file, const std::string& row, const std::string& member, Eigen::Index axis) {
  modal::MassMode mode;
  const std::string mass = row + "modal_mass_kg", stiffness = row + "modal_stiffness_n_per_um";
  for (const char* key : {"frequency_hz", "damping_ratio"}) file.require(row + key);
  file.number(row + "frequency_hz", member + "frequency_hz", 1.0, mode.frequency_hz);
  file.number(row + "damping_ratio", member + "damping_ratio", 1.0, mode.damping_ratio);
  if (!(mode.frequency_hz > 0.0)) throw file.reject(row + "frequency_hz", "must be > 0");
  if (file.has(stiffness)) {
    if (file.has(mass)) {
      throw file.reject(stiffness, "must not stand beside modal_mass_kg",
                        "One follows from the other and frequency_hz");
    }
    double stiffness_n_per_m = 0.0;
    file.number(stiffness, member + "modal_stiffness_n_per_m", 1.0 / units::um, stiffness_n_per_m);
    if (!(stiffness_n_per_m > 0.0)) throw file.reject(stiffness, "must be > 0");
    const double omega = units::revolution * mode.frequency_hz;
    mode.modal_mass_kg = stiffness_n_per_m / (omega * omega);
  } else {
    file.require(mass, "Or give modal_stiffness_n_per_um in its place");
    file.number(mass, member + "modal_mass_kg", 1.0, mode.modal_mass_kg);
    if (!(mode.modal_mass_kg > 0.0)) throw file.reject(mass, "must be > 0");
  }
  if (!(mode.damping_ratio > 0.0 && mode.damping_ratio < 1.0)) {
    throw file.reject(row + "damping_ratio", "must lie between 0 and 1", "It is a ratio, not a percentage");
  }
  return modal::mode_from_mass(mode, axis, 3);
}

/// Of its own modes a table gives x, y and z; those of which it says nothing, not even [], are none of the structure's.
void keep_named_directions(const io::TomlFile& file, const std::string& table, modal::ModalModel& model) {
  std::vector<Eigen::Index> named;
  std::vector<modal::Dof> dofs;
  for (std::size_t i = 0; i < model.responses.size(); ++i) {
    if (!file.has(table + "." + modal::to_string(model.responses[i]))) continue;
    named.push_back(static_cast<Eigen::Index>(i));
    dofs.push_back(model.responses[i]);
  }
  model.excitations = model.responses = dofs;
  for (modal::Mode& mode : model.modes) {
    mode.left = mode.left(named).eval();
    mode.right = mode.right(named).eval();
  }
}

}  // namespace

void read_cutter(io::TomlFile& file, cutting::Cutter& cutter) {
  cutting::cutter_table().read(file, "tool", cutter);
  if (cutter.kind == cutting::CutterKind::flat_end || cutter.kind == cutting::CutterKind::ball_end) {
    for (const char* key : {"tool.corner_radius_mm", "tool.corner_center_radius_mm", "tool.corner_center_height_mm",
                            "tool.bottom_angle_deg", "tool.side_angle_deg"}) {
      if (file.has(key)) throw file.reject(key, "is no part of this kind of cutter", "tool.kind says which it is");
    }
  }
  file.locate([&] { cutter.validate(); });
}

bool read_direction(io::TomlFile& file, cutting::MillingDirection& direction) {
  constexpr Name<cutting::MillingDirection> names[] = {{"up", cutting::MillingDirection::up},
                                                       {"down", cutting::MillingDirection::down},
                                                       {"slot", cutting::MillingDirection::slot}};
  constexpr const char* key = "cut.direction";
  std::string word;
  if (file.text(key, word) && !value_in(names, word)) {
    word = io::lowered(word);
    const char* const hint = word.starts_with("climb")          ? "Climb milling is \"down\" here"
                             : word.starts_with("conventional") ? "Conventional milling is \"up\" here"
                                                                : "";
    throw file.reject(key, one_of(names), hint);
  }
  return file.choice(key, names, direction);
}

bool read_radial_depth(io::TomlFile& file, double& radial_depth_m) {
  if (file.has("cut.radial_depth_mm") && file.has("cut.stepover_mm")) {
    throw file.reject("cut.stepover_mm", "must not stand beside radial_depth_mm", "They are two names of one thing");
  }
  return file.number("cut.radial_depth_mm", "radial_depth_m", units::mm, radial_depth_m) ||
         file.number("cut.stepover_mm", "radial_depth_m", units::mm, radial_depth_m);
}

void require_full_width(const io::TomlFile& file, cutting::MillingDirection direction, double radial_depth_m,
                        const cutting::FlatEndMill& tool, cutting::CutterKind kind) {
  if (direction != cutting::MillingDirection::slot || kind == cutting::CutterKind::ball_end) return;
  for (const char* key : {"cut.radial_depth_mm", "cut.stepover_mm"}) {
    if (!file.has(key) || std::abs(radial_depth_m / tool.diameter_m - 1.0) < 1e-6) continue;
    throw file.reject(key,
                      fmt::format("contradicts cut.direction = \"slot\", whose width is the diameter, {:.6g} mm",
                                  tool.diameter_m / units::mm),
                      "A narrower cut is \"up\" or \"down\"; of a slot leave the radial depth out");
  }
}

void add_unusual(const cutting::CutAtHand& cut, std::vector<std::string>& notes) {
  for (const std::string& text :
       cutting::unusual_cut(cut.diameter_m, cut.feed_per_tooth_m, cut.cutting_speed_m_per_s)) {
    notes.push_back(std::string(io::warning_label) + text);
  }
}

modal::MissingDirections read_missing_directions(io::TomlFile& file, const std::string& table, modal::ModalModel& own) {
  modal::MissingDirections out;
  file.boolean(table + ".equal_directions", out.equal);
  std::vector<std::string> names;
  file.texts(table + ".rigid_directions", names);
  for (const std::string& name : names) {
    if (name != "x" && name != "y") throw file.reject(table + ".rigid_directions", "must be a list of \"x\" and \"y\"");
    out.rigid.push_back(name == "x" ? modal::Axis::x : modal::Axis::y);
  }
  if (!own.modes.empty()) keep_named_directions(file, table, own);
  return out;
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

void read_structure(io::TomlFile& file, const std::string& table, std::filesystem::path& modes,
                    std::filesystem::path& frf, modal::ModalModel& out) {
  file.path(table + ".modes", modes);
  file.path(table + ".frf", frf);
  modal::ModalModel own;
  own.excitations = own.responses = {{.axis = modal::Axis::x}, {.axis = modal::Axis::y}, {.axis = modal::Axis::z}};
  const std::array<const char*, 3> axes = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    const std::string key = fmt::format("{}.{}", table, axes[axis]);
    for (std::size_t i = 0; i < file.tables(key); ++i) {
      const std::string member = fmt::format("modes[{}].", own.modes.size() + 1);
      own.modes.push_back(
          read_inline_mode(file, fmt::format("{}[{}].", key, i), member, static_cast<Eigen::Index>(axis)));
    }
  }
  const int sources = (modes.empty() ? 0 : 1) + (frf.empty() ? 0 : 1) + (own.modes.empty() ? 0 : 1);
  if (sources > 1) throw file.reject(table, "must give only one of modes, frf, and x, y and z");
  if (!own.modes.empty()) out = own;
}

}  // namespace robomill::process
