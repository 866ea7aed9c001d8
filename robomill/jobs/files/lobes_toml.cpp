#include "robomill/jobs/files/lobes_toml.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/files/coefficients_toml.hpp"
#include "robomill/cutting/polynomial.hpp"
#include "robomill/io/toml_file.hpp"
#include "robomill/jobs/files/cut_fields.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/modes_files.hpp"

namespace robomill::jobs {
namespace {

/// What a drill needs; its lips are the tool's teeth, and in the cut all round.
void read_drilling(io::TomlFile& file, LobesFile& out) {
  for (const char* key : {"tool.pitch_deg", "tool.runout_um", "process_damping", "speed_variation"}) {
    if (file.has(key)) throw file.reject(key, "is no part of drilling");
  }
  file.number("tool.point_angle_deg", "point_angle_rad", units::deg, out.point_angle_rad);
  file.require("cut.feed_per_revolution_mm", "A drill feeds along its axis");
  file.number("cut.feed_per_revolution_mm", "feed_per_revolution_m", units::mm, out.feed_per_revolution_m);
  file.number("cut.feed_direction_deg", "feed_direction_rad", units::deg, out.problem.feed_direction_rad);
  if (!(out.feed_per_revolution_m > 0.0)) throw file.reject("cut.feed_per_revolution_mm", "must be > 0");
  out.radial_depth_m = out.problem.milling.tool.diameter_m;
  out.problem.milling.immersion = {.entry_rad = 0.0, .exit_rad = std::numbers::pi};
}

void read_cut(io::TomlFile& file, LobesFile& out) {
  cutting::Milling& milling = out.problem.milling;
  file.choice<bool>("cut.kind", {{"milling", false}, {"drilling", true}}, out.drilling);
  if (out.drilling) {
    read_drilling(file, out);
    return;
  }
  file.number("cut.feed_per_tooth_mm", "feed_per_tooth_m", units::mm, milling.feed_per_tooth_m);
  file.number("cut.feed_direction_deg", "feed_direction_rad", units::deg, out.problem.feed_direction_rad);
  const bool radial = read_radial_depth(file, out.radial_depth_m);
  const bool entry = file.number("cut.entry_deg", "entry_rad", units::deg, milling.immersion.entry_rad);
  const bool exit = file.number("cut.exit_deg", "exit_rad", units::deg, milling.immersion.exit_rad);
  cutting::MillingDirection direction = cutting::MillingDirection::up;
  const bool named = read_direction(file, direction);
  if (milling.feed_per_tooth_m < 0.0) throw file.reject("cut.feed_per_tooth_mm", "must be >= 0");
  if (named && (entry || exit)) throw file.reject("cut.direction", "must not stand beside entry_deg and exit_deg");
  if (entry != exit) file.require(entry ? "cut.exit_deg" : "cut.entry_deg", "Both angles are needed");
  const double diameter_m = milling.tool.diameter_m;
  if (entry) {
    file.locate([&] { milling.immersion.validate(); });
    out.radial_depth_m = cutting::radial_depth(milling.immersion, diameter_m);
    return;
  }
  if (!named) file.require("cut.direction", "\"up\", \"down\" or \"slot\"; or give entry_deg and exit_deg");
  out.direction = direction;
  if (direction == cutting::MillingDirection::slot) {
    if (!radial) out.radial_depth_m = diameter_m;
  } else if (!radial) {
    file.require("cut.radial_depth_mm");
  }
  file.locate([&] { milling.immersion = cutting::immersion(direction, out.radial_depth_m, diameter_m); });
}

/// What a file or a material says of the side of a cutter, κ = 90°, each per width.
cutting::ForceCoefficients of_the_side(const cutting::MillingCoefficients& k, double helix_rad) {
  const bool per_length = cutting::counts_edge_length(k.edge_measure, cutting::CutterKind::flat_end);
  const double stretch = per_length ? 1.0 / std::cos(helix_rad) : 1.0;
  const auto value = [](const std::vector<double>& entries) {
    return cutting::detail::polynomial(entries, 0.5 * std::numbers::pi);
  };
  return {.tangential_n_per_m2 = value(k.tangential_n_per_m2),
          .radial_n_per_m2 = value(k.radial_n_per_m2),
          .tangential_edge_n_per_m = stretch * value(k.tangential_edge_n_per_m),
          .radial_edge_n_per_m = stretch * value(k.radial_edge_n_per_m)};
}

void read_coefficients_of(io::TomlFile& file, const cutting::FlatEndMill& tool, cutting::ForceCoefficients& k) {
  const char* const named = file.has("coefficients.file") ? "coefficients.file" : "coefficients.material";
  if (file.has(named)) {
    k = of_the_side(cutting::read_coefficient_table(file), tool.helix_rad);
    try {
      k.validate();
    } catch (const InvalidInput& error) {
      throw file.reject(named, "gives a coefficient that cannot be used: " + std::string(error.what()));
    }
    return;
  }
  file.number("coefficients.tangential_n_per_mm2", "tangential_n_per_m2", units::n_per_mm2, k.tangential_n_per_m2);
  file.number("coefficients.radial_n_per_mm2", "radial_n_per_m2", units::n_per_mm2, k.radial_n_per_m2);
  file.number("coefficients.tangential_edge_n_per_mm", "tangential_edge_n_per_m", units::n_per_mm,
              k.tangential_edge_n_per_m);
  file.number("coefficients.radial_edge_n_per_mm", "radial_edge_n_per_m", units::n_per_mm, k.radial_edge_n_per_m);
  file.locate([&] { k.validate(); });
}

/// What pushes on the teeth: coefficients, process damping; and how the spindle turns.
void read_forces(io::TomlFile& file, cutting::Milling& milling) {
  read_coefficients_of(file, milling.tool, milling.coefficients);
  cutting::ProcessDamping& damping = milling.process_damping;
  file.number("process_damping.indentation_n_per_mm3", "indentation_n_per_m3", units::n_per_mm3,
              damping.indentation_n_per_m3);
  file.number("process_damping.wear_land_mm", "wear_land_m", units::mm, damping.wear_land_m);
  file.number("process_damping.friction", "friction", 1.0, damping.friction);
  file.number("speed_variation.amplitude_ratio", "amplitude_ratio", 1.0, milling.speed_variation.amplitude_ratio);
  file.number("speed_variation.frequency_ratio", "frequency_ratio", 1.0, milling.speed_variation.frequency_ratio);
  file.locate([&] { milling.validate(); });
}

void read_pair(io::TomlFile& file, const char* key, const char* member, double factor, std::array<double, 2>& out) {
  std::vector<double> values;
  if (!file.numbers(key, member, factor, values)) return;
  if (values.size() != 2) throw file.reject(key, "must be [from, to]");
  out = {values[0], values[1]};
}

void read_chart(io::TomlFile& file, stability::LobesOptions& options) {
  file.require("lobes.spindle_speed_rpm", "[from, to]");
  file.require("lobes.axial_depth_mm", "[from, to]");
  read_pair(file, "lobes.spindle_speed_rpm", "spindle_speed_rad_per_s", units::rpm, options.spindle_speed_rad_per_s);
  read_pair(file, "lobes.axial_depth_mm", "axial_depth_m", units::mm, options.axial_depth_m);
  std::vector<int> grid;
  if (file.integers("lobes.grid", "grid", grid)) {
    if (grid.size() != 2) throw file.reject("lobes.grid", "must be [speeds, depths]");
    options.grid = {grid[0], grid[1]};
  }
  file.choice("lobes.method", stability::method_names, options.method);
  file.choice<stability::Output>(
      "lobes.output", {{"boundary", stability::Output::boundary}, {"map", stability::Output::map}}, options.output);
  file.integer("lobes.intervals", "intervals", options.intervals);
  file.number("lobes.tolerance", "tolerance", 1.0, options.tolerance);
  file.locate([&] { options.validate(); });
}

void read_uncertainty(io::TomlFile& file, stability::Uncertainty& u) {
  if (!file.has("uncertainty")) return;
  u.samples = 200;
  file.integer("uncertainty.samples", "samples", u.samples);
  file.number("uncertainty.tangential_std_n_per_mm2", "tangential_std_n_per_m2", units::n_per_mm2,
              u.tangential_std_n_per_m2);
  file.number("uncertainty.radial_std_n_per_mm2", "radial_std_n_per_m2", units::n_per_mm2, u.radial_std_n_per_m2);
  file.number("uncertainty.frequency_std_ratio", "frequency_std_ratio", 1.0, u.frequency_std_ratio);
  file.number("uncertainty.damping_std_ratio", "damping_std_ratio", 1.0, u.damping_std_ratio);
  file.number("uncertainty.residue_std_ratio", "residue_std_ratio", 1.0, u.residue_std_ratio);
  std::vector<int> grid;
  if (file.integers("uncertainty.grid", "grid", grid)) {
    if (grid.size() != 2) throw file.reject("uncertainty.grid", "must be [speeds, depths]");
    u.grid = {grid[0], grid[1]};
  }
  file.locate([&] { u.validate(); });
}

LobesFile read(io::TomlFile& file, const std::filesystem::path& path) {
  LobesFile out;
  out.path = path;
  read_mill(file, out.problem.milling.tool);
  read_cut(file, out);
  read_forces(file, out.problem.milling);
  read_structure(file, "dynamics", out.modes, out.frf, out.problem.dynamics);
  if (!out.drilling) out.directions = read_missing_directions(file, "dynamics", out.problem.dynamics);
  file.integers("dynamics.keep_modes", "keep_modes", out.problem.keep_modes);
  read_structure(file, "workpiece_dynamics", out.workpiece_modes, out.workpiece_frf, out.problem.workpiece_dynamics);
  read_chart(file, out.options);
  read_uncertainty(file, out.uncertainty);
  if (file.has("surface_error")) {
    std::vector<int> grid = {60, 60};
    file.integers("surface_error.grid", "grid", grid);
    if (grid.size() != 2) throw file.reject("surface_error.grid", "must be [speeds, depths]");
    if (grid[0] < 2 || grid[1] < 2)
      throw file.reject("surface_error.grid", "must have at least 2 points in each direction");
    if (!(out.problem.milling.feed_per_tooth_m > 0.0)) file.require("cut.feed_per_tooth_mm", "surface_error needs it");
    out.surface_grid = {grid[0], grid[1]};
  }
  file.done();
  return out;
}

}  // namespace

void LobesFile::drop_dynamics() {
  modes.clear();
  frf.clear();
  directions = {};
  problem.dynamics = {};
  problem.measured = {};
}

void LobesFile::validate() const {
  const bool nothing = problem.dynamics.modes.empty() && problem.measured.frfs.empty();
  const char* const rule = "must name the structure: modes, frf, or x and y";
  if (!document) {
    if (nothing) throw InvalidInput("dynamics", rule);
    return problem.validate();
  }
  if (nothing) throw document->reject("dynamics", rule);
  document->locate([&] { problem.validate(); });
}

LobesFile read_lobes(const std::filesystem::path& path) {
  const auto document = std::make_shared<io::TomlFile>(path);
  LobesFile out = read(*document, path);
  out.document = document;
  return out;
}

void load_dynamics(LobesFile& file) {
  if (!file.modes.empty()) file.problem.dynamics = modal::read_modes(file.modes);
  if (!file.workpiece_modes.empty()) file.problem.workpiece_dynamics = modal::read_modes(file.workpiece_modes);
  const auto measured = [&file](const std::filesystem::path& path) {
    modal::FrfFile frfs = modal::read_frfs({path});
    file.notes.insert(file.notes.end(), frfs.notes.begin(), frfs.notes.end());
    if (frfs.added_decay_per_s > 0.0) {
      throw InvalidInput(path.string(), "still holds the damping of an exponential window",
                         "Fit modes, which can do without it, or estimate the FRFs with remove_added_damping");
    }
    return std::move(frfs.set);
  };
  if (!file.frf.empty()) file.problem.measured = measured(file.frf);
  if (!file.workpiece_frf.empty()) file.problem.workpiece_measured = measured(file.workpiece_frf);
  if (file.drilling) return;
  const auto words = complete_directions(file.problem.dynamics, file.problem.measured, file.directions,
                                         file.path.string(), "dynamics");
  if (words) file.notes.push_back(*words);
}

LobesFile read_milling(const std::filesystem::path& path, const std::string& hint) {
  LobesFile file = read_lobes(path);
  load_dynamics(file);
  if (file.drilling) throw InvalidInput(path.string(), "lobes are those of milling", hint);
  file.validate();
  return file;
}

}  // namespace robomill::jobs
