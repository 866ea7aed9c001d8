#include "robomill/jobs/files/lobes_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/files/coefficients_toml.hpp"
#include "robomill/cutting/files/cutter_schema.hpp"
#include "robomill/cutting/polynomial.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/process/files/cut_fields.hpp"
#include "robomill/process/files/structure_schema.hpp"
#include "robomill/stability/files/chart_schema.hpp"

namespace robomill::jobs {
namespace {

/// @throws InvalidInput at the first of the keys that is given
void reject_any(const io::TomlFile& file, std::initializer_list<std::string> keys, const char* rule) {
  for (const std::string& key : keys) {
    if (file.has(key)) throw file.reject(key, rule);
  }
}

/// What a drill needs; its lips are the tool's teeth, and in the cut all round.
void take_drilling(io::TomlFile& file, const cutting::CutTable& cut, LobesFile& out) {
  reject_any(file,
             {"tool.kind", "tool.corner_radius_mm", "tool.cutting_height_mm", "tool.pitch_deg", "tool.runout_um",
              "process_damping", "speed_variation", "lobes.sweep", "surface_error", "dynamics.equal_directions",
              "dynamics.rigid_directions"},
             "is no part of drilling");
  file.number("tool.point_angle_deg", "point_angle_rad", units::deg, out.point_angle_rad);
  file.require("cut.feed_per_revolution_mm", "A drill feeds along its axis");
  out.feed_per_revolution_m = *cut.feed_per_revolution_m;
  out.radial_depth_m = out.problem.milling.tool.diameter_m;
  out.problem.milling.immersion = {.entry_rad = 0.0, .exit_rad = std::numbers::pi};
}

/// The same for its lobes, once its coefficients are known.
cutting::Drill drill_of(io::TomlFile& file, const LobesFile& out) {
  cutting::Drill drill;
  drill.lips = out.problem.milling.tool.teeth;
  drill.diameter_m = out.problem.milling.tool.diameter_m;
  if (out.point_angle_rad != 0.0) drill.point_angle_rad = out.point_angle_rad;
  drill.coefficients = out.problem.milling.coefficients;
  file.locate([&] { drill.validate(); });
  return drill;
}

/// Whether the file asks for what the plane does not know: another cutter, a posture, forces along the axis.
bool is_spatial(const io::TomlFile& file, const cutting::Cutter& cutter, const cutting::CutTable& cut,
                stability::SweptParameter sweep) {
  return cutter.kind != cutting::CutterKind::flat_end || cut.lead_rad != 0.0 || cut.tilt_rad != 0.0 ||
         sweep != stability::SweptParameter::axial_depth || file.has("coefficients.axial_n_per_mm2");
}

/// The same cut, as far as a material's coefficients ask for it.
cutting::CutAtHand cut_at_hand(const LobesFile& cut, cutting::CutterKind kind) {
  const cutting::Milling& milling = cut.problem.milling;
  cutting::CutAtHand out;
  out.kind = kind;
  if (cut.drilling) return out;
  out.feed_per_tooth_m = milling.feed_per_tooth_m;
  if (kind == cutting::CutterKind::flat_end && milling.immersion.exit_rad > milling.immersion.entry_rad) {
    out.mean_chip_thickness_m = cutting::mean_chip_thickness_m(milling.immersion, milling.feed_per_tooth_m);
  }
  return out;
}

/// The cut of a cutter in three directions.
void take_spatial(io::TomlFile& file, const cutting::Cutter& cutter, const cutting::CutTable& cut, LobesFile& out) {
  using stability::SweptParameter;
  reject_any(file, {"cut.entry_deg", "cut.exit_deg", "process_damping", "speed_variation"},
             "is for an upright flat end in x and y");
  if (file.has("surface_error") && out.sweep != SweptParameter::axial_depth) {
    throw file.reject("surface_error", "goes with a chart over the axial depth");
  }
  process::require_engagement(file, cut, cutter.mill, cutter.kind, "\"up\", \"down\" or \"slot\"");
  const bool slot = cut.direction == cutting::MillingDirection::slot;
  if (slot && out.sweep == SweptParameter::radial_depth) {
    throw file.reject("lobes.sweep", "must not be the step-over of a slot, which has no neighbour");
  }
  if (!cut.axial_depth_m && out.sweep != SweptParameter::axial_depth) {
    file.require("cut.axial_depth_mm", "The chart varies something else");
  }
  stability::SpatialMilling milling;
  milling.cutter = cutter;
  milling.feed_per_tooth_m = cut.feed_per_tooth_m;
  milling.cut = cut.milled();
  milling.cut.curvature_along_feed_per_m = milling.cut.curvature_across_feed_per_m = 0.0;  // a chart's surface is plane
  out.direction = cut.direction;
  out.radial_depth_m = slot ? cutter.mill.diameter_m : milling.cut.radial_depth_m;
  out.problem.spatial = milling;
}

/// The engagement over the chart shows what only the cut itself can: a shank in it, coefficients below 0.
void check_spatial(io::TomlFile& file, LobesFile& out) {
  using stability::SweptParameter;
  stability::SpatialMilling& milling = *out.problem.spatial;
  if (out.sweep == SweptParameter::axial_depth) milling.cut.axial_depth_m = out.options.axial_depth_m[1];
  constexpr double tip_rad = 5.0 * units::deg;
  bool tip_cuts = false;
  const auto look = [&](const cutting::Cut& cut) {
    const cutting::Engagement engagement = cutting::engage(milling.cutter, cut);
    if (engagement.slices.empty()) return;
    const auto [low, high] = std::ranges::minmax_element(engagement.slices, {}, &cutting::EdgeSlice::position_rad);
    milling.coefficients.validate(low->position_rad, high->position_rad);
    tip_cuts = tip_cuts || low->position_rad < tip_rad;
  };
  file.locate([&] {
    milling.validate();
    constexpr int looks = 8;
    for (int i = 0; i <= looks; ++i) {
      const double value = out.sweep_range[0] + (out.sweep_range[1] - out.sweep_range[0]) * i / looks;
      cutting::Cut cut = milling.cut;
      if (out.sweep == SweptParameter::radial_depth) cut.radial_depth_m = out.sweep_range[1];
      if (out.sweep == SweptParameter::lead) cut.lead_rad = value;
      if (out.sweep == SweptParameter::tilt) cut.tilt_rad = value;
      look(cut);
      if (out.sweep != SweptParameter::lead && out.sweep != SweptParameter::tilt) break;  // all are alike
    }
  });
  if (tip_cuts && milling.cutter.kind == cutting::CutterKind::ball_end) {
    out.notes.push_back(
        "the ball's tip is in the cut: there the cutting speed goes to 0 and material is ploughed, not cut; the "
        "coefficients are taken to hold there too");
  }
}

/// The cut of an upright flat end, whose angles the file gives, or direction and radial depth.
void take_plane(const io::TomlFile& file, const cutting::CutTable& cut, LobesFile& out) {
  cutting::Milling& milling = out.problem.milling;
  const double diameter_m = milling.tool.diameter_m;
  const bool entry = cut.entry_rad.has_value(), exit = cut.exit_rad.has_value();
  if (cut.direction && (entry || exit)) {
    throw file.reject("cut.direction", "must not stand beside entry_deg and exit_deg");
  }
  if (entry != exit) file.require(entry ? "cut.exit_deg" : "cut.entry_deg", "Both angles are needed");
  if (entry) {
    milling.immersion = {.entry_rad = *cut.entry_rad, .exit_rad = *cut.exit_rad};
    file.locate([&] { milling.immersion.validate(); });
    out.radial_depth_m = cutting::radial_depth(milling.immersion, diameter_m);
    if (cut.radial_depth_m && std::abs(*cut.radial_depth_m - out.radial_depth_m) > 0.01 * diameter_m) {
      throw file.reject("cut.entry_deg",
                        fmt::format("contradicts the radial depth: to cut from entry to exit angle is {:.4g} mm deep",
                                    out.radial_depth_m / units::mm),
                        "Leave one of the two out");
    }
    return;
  }
  process::require_engagement(file, cut, milling.tool, cutting::CutterKind::flat_end,
                              "\"up\", \"down\" or \"slot\"; or give entry_deg and exit_deg");
  out.direction = cut.direction;
  out.radial_depth_m = cut.radial_depth_m.value_or(diameter_m);
  file.locate([&] { milling.immersion = cutting::immersion(*cut.direction, out.radial_depth_m, diameter_m); });
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

void read_coefficients_of(io::TomlFile& file, LobesFile& out, cutting::CoefficientTable& table) {
  cutting::ForceCoefficients& k = out.problem.milling.coefficients;
  table = cutting::read_coefficient_table(file, cut_at_hand(out, cutting::CutterKind::flat_end));
  k = of_the_side(table.coefficients, out.problem.milling.tool.helix_rad);
  const char* const named = cutting::names_a_material(file)     ? "coefficients"
                            : file.has("coefficients.file")     ? "coefficients.file"
                            : file.has("coefficients.material") ? "coefficients.material"
                                                                : nullptr;
  if (named == nullptr) return file.locate([&] { k.validate(); });
  try {
    k.validate();
  } catch (const InvalidInput& error) {
    throw file.reject(named, "gives a coefficient that cannot be used: " + std::string(error.what()));
  }
}

/// What pushes on the teeth: coefficients, process damping; and how the spindle turns.
void read_forces(io::TomlFile& file, LobesFile& out, cutting::CoefficientTable& table) {
  read_coefficients_of(file, out, table);
  cutting::Milling& milling = out.problem.milling;
  cutting::process_damping_table().read(file, "process_damping", milling.process_damping);
  cutting::speed_variation_table().read(file, "speed_variation", milling.speed_variation);
  file.locate([&] { milling.validate(); });
}

/// The chart's range and grid, beside a cut that is known.
void check_chart(const io::TomlFile& file, const stability::ChartTable& chart, LobesFile& out) {
  using stability::SweptParameter;
  stability::LobesOptions& options = out.options;
  file.require("lobes.spindle_speed_rpm", "[from, to]");
  const std::string swept = "lobes." + stability::swept_key(chart.sweep);
  for (const auto& [name, parameter] : stability::swept_names) {
    const std::string key = "lobes." + stability::swept_key(parameter);
    if (parameter == chart.sweep || parameter == SweptParameter::axial_depth || !file.has(key)) continue;
    throw file.reject(key, fmt::format("goes with sweep = \"{}\"", name), "What the cut has stands in [cut]");
  }
  if (chart.sweep == SweptParameter::axial_depth) {
    file.require(swept, "[from, to]");
    return file.locate([&] { options.validate(); });
  }
  file.require(swept, "[from, to], what the chart varies");
  reject_any(file, {"lobes.method", "lobes.intervals", "lobes.output", "uncertainty", "lobes.axial_depth_mm"},
             "does not go with a sweep of another parameter than the axial depth");
  out.sweep_range = *chart.range_of(chart.sweep);
  if (!file.has("lobes.grid")) options.grid = {60, 40};
  options.axial_depth_m = {0.0, std::max(out.problem.spatial->cut.axial_depth_m, 1e-6)};  // does not count
  file.locate([&] {
    options.validate();
    sweep_options(out).validate();
  });
}

void read_uncertainty(io::TomlFile& file, stability::Uncertainty& u) {
  if (!file.has("uncertainty")) return;
  u.samples = 200;
  stability::uncertainty_options_table().read(file, "uncertainty", u);
  file.locate([&] { u.validate(); });
}

/// What a material brings along: its spread where [uncertainty] gives none, and what to know of its source.
void take_material(const io::TomlFile& file, const cutting::CoefficientTable& table, cutting::CutterKind kind,
                   LobesFile& out) {
  out.notes.insert(out.notes.end(), table.notes.begin(), table.notes.end());
  cutting::CutAtHand cut = cut_at_hand(out, kind);
  const double radius_m = 0.5 * out.problem.milling.tool.diameter_m;
  for (std::size_t i = 0; i < 2; ++i) cut.cutting_speed_m_per_s[i] = radius_m * out.options.spindle_speed_rad_per_s[i];
  cut.diameter_m = 2.0 * radius_m;
  std::ranges::move(table.outside(cut), std::back_inserter(out.notes));
  if (!out.drilling) std::ranges::move(table.unlike_recommended(cut), std::back_inserter(out.notes));
  process::add_unusual(cut, out.notes);
  if (table.std_ratio == 0.0) return;
  for (const char* key : {"tangential_std_n_per_mm2", "radial_std_n_per_mm2", "coefficient_std_ratio"}) {
    if (file.has(std::string("uncertainty.") + key)) return;
  }
  out.uncertainty.coefficient_std_ratio = table.std_ratio;
  out.band_note = fmt::format(
      "In the limits' uncertainty the coefficients count with one factor, whose standard deviation is that of {}, "
      "{:.3g} %, unless [uncertainty] says another.",
      table.std_of, 100.0 * table.std_ratio);
}

/// What vibrates.
void read_structures(io::TomlFile& file, LobesFile& out) {
  process::DynamicsTable tool = process::read_dynamics(file);
  if (!out.drilling && !tool.structure.own.modes.empty()) process::keep_named_directions(file, tool.structure.own);
  out.modes = std::move(tool.structure.modes);
  out.frf = std::move(tool.structure.frf);
  out.problem.dynamics = std::move(tool.structure.own);
  out.cell = std::move(tool.cell);
  out.joints = std::move(tool.joints);
  if (tool.axes == process::StructureAxes::flange) out.posture_axes = cell::PostureAxes::flange;
  out.directions = std::move(tool.directions);
  out.problem.keep_modes = std::move(tool.keep_modes);
  process::StructureTable part = process::read_workpiece_dynamics(file);
  const bool vibrates = !part.modes.empty() || !part.own.modes.empty();
  if (out.problem.spatial) {
    out.problem.spatial->modes_turn_with_tool = tool.axes == process::StructureAxes::tool;
    if (vibrates && out.problem.spatial->modes_turn_with_tool) {
      throw file.reject("dynamics.axes",
                        "must be \"feed\" beside workpiece_dynamics: a part does not lean with the tool");
    }
  }
  out.workpiece_modes = std::move(part.modes);
  out.workpiece_frf = std::move(part.frf);
  out.problem.workpiece_dynamics = std::move(part.own);
}

/// The chart's depths, beside edges and drill.
void check_depth(const io::TomlFile& file, const cutting::Cutter& cutter, const LobesFile& out) {
  const double edges_m = cutter.cutting_height_m;
  if (!out.problem.spatial && file.has("tool.cutting_height_mm") &&
      out.options.axial_depth_m[1] > edges_m * (1.0 + 1e-9)) {
    throw file.reject("lobes.axial_depth_mm",
                      fmt::format("goes deeper than the edges reach, {:.6g} mm", edges_m / units::mm),
                      "tool.cutting_height_mm says how far up they reach");
  }
  if (out.drilling && out.options.axial_depth_m[1] > 0.5 * cutter.mill.diameter_m * (1.0 + 1e-12)) {
    throw file.reject("lobes.axial_depth_mm", "must end at the drill's radius at most",
                      "Of drilling it is the lips' radial width, from the pilot hole to the rim");
  }
}

void read_surface_error(io::TomlFile& file, LobesFile& out) {
  if (!file.has("surface_error")) return;
  stability::SurfaceErrorTable surface;
  stability::surface_error_table().read(file, "surface_error", surface);
  if (!(out.problem.milling.feed_per_tooth_m > 0.0)) file.require("cut.feed_per_tooth_mm", "surface_error needs it");
  out.surface_grid = surface.grid;
}

/// What a job measures, predicts or takes the structure from.
constexpr const char* structure_keys[] = {"job.hits",     "job.frf",    "job.modes",  "job.assembly", "dynamics.modes",
                                          "dynamics.frf", "dynamics.x", "dynamics.y", "dynamics.z"};

LobesFile read(io::TomlFile& file, const std::filesystem::path& path) {
  LobesFile out;
  out.path = file.file_of_part("job.lobes", "lobes");
  const bool gives_structure = std::ranges::any_of(structure_keys, [&](const char* key) { return file.has(key); });
  if (gives_structure && file.has("job")) out.job = path;
  if (!file.has("job") && (file.has("spindle.max_speed_rpm") || file.has("spindle.min_speed_rpm"))) {
    out.notes.emplace_back("[spindle] takes no part in a chart without [job]: lobes.spindle_speed_rpm is its range.");
  }
  // First: an error about a speed or a depth that [cut] has too is then the chart's.
  stability::ChartTable chart;
  stability::chart_options_table().read(file, "lobes", chart);
  out.options = chart.options;
  out.sweep = chart.sweep;
  cutting::Cutter cutter;
  process::read_cutter(file, cutter);
  out.problem.milling.tool = cutter.mill;
  cutting::CutTable cut;
  cutting::cut_table().read(file, "cut", cut);
  out.drilling = cut.drilling;
  out.problem.feed_direction_rad = cut.feed_direction_rad;
  if (!out.drilling) out.problem.milling.feed_per_tooth_m = cut.feed_per_tooth_m;
  const bool spatial = !out.drilling && is_spatial(file, cutter, cut, out.sweep);
  cutting::CoefficientTable table;
  if (spatial) {
    take_spatial(file, cutter, cut, out);
    table = cutting::read_coefficient_table(file, cut_at_hand(out, cutter.kind));
    out.problem.spatial->coefficients = table.coefficients;
  } else {
    out.drilling ? take_drilling(file, cut, out) : take_plane(file, cut, out);
    read_forces(file, out, table);
  }
  if (out.drilling) out.problem.drilling = drill_of(file, out);
  read_structures(file, out);
  check_chart(file, chart, out);
  if (spatial) check_spatial(file, out);
  check_depth(file, cutter, out);
  read_uncertainty(file, out.uncertainty);
  take_material(file, table, cutter.kind, out);
  read_surface_error(file, out);
  std::ranges::move(file.done(), std::back_inserter(out.notes));
  return out;
}

}  // namespace

stability::SweepOptions sweep_options(const LobesFile& file) {
  stability::SweepOptions sweep;
  sweep.parameter = file.sweep;
  sweep.range = file.sweep_range;
  sweep.spindle_speed_rad_per_s = file.options.spindle_speed_rad_per_s;
  sweep.grid = file.options.grid;
  sweep.tolerance = file.options.tolerance;
  sweep.points = file.options.points;
  for (stability::OperatingPoint& point : sweep.points) {
    if (stability::is_angle(file.sweep)) point.axial_depth_m *= units::deg / units::mm;
  }
  return sweep;
}

void LobesFile::drop_dynamics() {
  dropped_dynamics = true;
  modes.clear();
  frf.clear();
  cell.clear();
  posture.reset();
  directions = {};
  problem.dynamics = {};
  problem.measured = {};
  std::erase_if(assumed, [](const Assumption& one) { return one.key.starts_with("dynamics."); });
}

void LobesFile::validate() const {
  const bool nothing = problem.dynamics.modes.empty() && problem.measured.frfs.empty();
  const char* const rule = "must name the structure: modes, frf, x and y, or cell and joints_deg";
  const char* const hint = "Measure it (robomill frf, then robomill modes); a plan leaves modes.json of its job";
  if (!document) {
    if (nothing) throw InvalidInput("dynamics", rule);
    return problem.validate();
  }
  if (nothing) throw document->reject("dynamics", rule, hint);
  document->locate([&] { problem.validate(); });
}

LobesFile read_lobes(const io::TomlSource& source) {
  const auto document = std::make_shared<io::TomlFile>(source);
  LobesFile out = read(*document, source.path);
  out.document = document;
  add_assumed(out.assumed, io::sample_values(*document));
  return out;
}

void require_plane(const LobesFile& file, const std::string& hint) {
  if (!file.problem.in_three_directions()) return;
  throw InvalidInput(file.path.string(), "must be a milling cut of an upright flat end in x and y here", hint);
}

void require_modes_in_three_directions(const LobesFile& file) {
  if (!file.problem.in_three_directions() || (file.frf.empty() && file.workpiece_frf.empty())) return;
  throw InvalidInput(file.path.string(), "a cut in three directions needs modes, not FRFs", "Fit them: robomill modes");
}

LobesFile read_milling(const std::filesystem::path& path, const std::string& hint) {
  LobesFile file = read_lobes(path);
  load_dynamics(file);
  require_plane(file, hint);
  file.validate();
  return file;
}

}  // namespace robomill::jobs
