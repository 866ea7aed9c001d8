#include "robomill/process/files/forces_toml.hpp"

#include <algorithm>
#include <iterator>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/files/coefficients_toml.hpp"
#include "robomill/io/toml/file.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/process/files/cut_fields.hpp"
#include "robomill/process/files/forces_schema.hpp"
#include "robomill/process/files/structure_schema.hpp"

namespace robomill::process {
namespace {

using io::key;

constexpr Name<robot::Inertia> inertia_names[] = {{"full", robot::Inertia::full},
                                                  {"diagonal", robot::Inertia::diagonal}};

io::Row<Cut> feed_direction_row() {
  io::Row<Cut> row = key("feed_direction", &Cut::feed_direction, "[x, y, z] of the feed in the work frame");
  row.key.rule.entries = 3;
  row.read = [](io::TomlFile& file, const std::string& path, const io::Row<Cut>& self, Cut& out) {
    std::vector<double> direction;
    if (!file.numbers(path, self.member, 1.0, direction)) return;
    if (direction.size() != 3) throw file.reject(path, "must be [x, y, z] in the work frame");
    out.feed_direction = {direction[0], direction[1], direction[2]};
    if (!(out.feed_direction.norm() > 0.0)) throw file.reject(path, "must not be zero");
    out.feed_direction.normalize();
  };
  return row;
}

/// What the file says of a single cut, checked.
void check_cut(const io::TomlFile& file, const cutting::CutTable& cut, const ForcesFile& out) {
  file.require("cut.axial_depth_mm");
  file.require("cut.feed_per_tooth_mm");
  file.require("cut.spindle_speed_rpm");
  require_engagement(file, cut, out.cutter.mill, out.cutter.kind, "\"up\", \"down\" or \"slot\"");
  try {
    file.locate([&] {
      out.cut.validate(out.cutter);
      out.motion.validate();
    });
  } catch (const InvalidInput& error) {
    // The file gives radii, whose inverse no factor converts.
    for (const char* which : {"along", "across"}) {
      if (error.parts().field.find(std::string("curvature_") + which) == std::string::npos) continue;
      throw file.reject(std::string("cut.surface_radius_") + which + "_feed_mm", error.parts().rule,
                        error.parts().hint);
    }
    throw;
  }
}

void read_cut(io::TomlFile& file, ForcesJob job, ForcesFile& out) {
  cutting::CutTable cut;
  file.choice("force_on", cutting::force_on_names, cut.force_on_workpiece);
  cutting::cut_table().read(file, "cut", cut);
  out.cut = cut.milled();
  out.motion = {.feed_per_tooth_m = cut.feed_per_tooth_m,
                .spindle_speed_rad_per_s = cut.spindle_speed_rad_per_s.value_or(0.0)};
  out.feed_direction_rad = cut.feed_direction_rad;
  out.on_workpiece = cut.force_on_workpiece;
  if (job != ForcesJob::program) check_cut(file, cut, out);
}

/// @param document  whose [robot] may be the arm itself
void read_robot(io::TomlFile& file, const std::filesystem::path& document, ForcesJob job, ForcesFile& out) {
  const bool alone = job != ForcesJob::program;
  const bool holds_arm = std::ranges::any_of(cell::arm_keys, [&](const char* key) { return file.has(key); });
  const bool has_cell = holds_arm || file.has("job.cell");
  if (!file.has("robot") && !has_cell) return;
  if (alone && has_cell && !file.has("robot.joints_deg")) return;  // no posture to cut in
  if (!file.path("robot.cell", out.cell) && has_cell) {
    out.cell = file.has("job.cell") ? file.file_of_part("job.cell", "robot") : document;
  }
  robot_of_cut_table().read(file, "robot", out);
  if (!alone) return;
  if (!has_cell) file.require("robot.cell", "The file that describes the robot");
  file.require("robot.joints_deg", "The posture in which it cuts");
}

void read_stock(io::TomlFile& file, ForcesFile& out) {
  cutting::StockTable stock;
  cutting::stock_table().read(file, "stock", stock);
  out.dexel_m = stock.dexel_m;
  out.neighbours = stock.kind == cutting::StockKind::neighbours;
  if (out.neighbours) {
    file.require("cut.axial_depth_mm", "How deep every block cuts beside its neighbour");
    if (out.cutter.kind != cutting::CutterKind::ball_end) {
      throw file.reject("tool.kind", "must be \"ball-end\" where there is no stock");
    }
  }
  out.stock = cutting::stock_of(file, stock);
}

/// A material's are those at the cut's mean chip, which depth and direction tell of an upright flat end alone.
void read_coefficients(io::TomlFile& file, ForcesJob job, ForcesFile& out) {
  cutting::CutAtHand cut;
  cut.kind = out.cutter.kind;
  if (job != ForcesJob::program) {
    const double speed_m_per_s = 0.5 * out.cutter.mill.diameter_m * out.motion.spindle_speed_rad_per_s;
    cut.cutting_speed_m_per_s = {speed_m_per_s, speed_m_per_s};
    cut.feed_per_tooth_m = out.motion.feed_per_tooth_m;
    cut.diameter_m = out.cutter.mill.diameter_m;
    if (cut.kind == cutting::CutterKind::flat_end && out.cut.lead_rad == 0.0 && out.cut.tilt_rad == 0.0) {
      cut.mean_chip_thickness_m = cutting::mean_chip_thickness_m(
          cutting::immersion(out.cut.direction, out.cut.radial_depth_m, out.cutter.mill.diameter_m),
          cut.feed_per_tooth_m);
    }
  }
  const cutting::CoefficientTable table = cutting::read_coefficient_table(file, cut);
  out.coefficients = table.coefficients;
  out.notes = table.notes;
  std::ranges::move(table.outside(cut), std::back_inserter(out.notes));
  std::ranges::move(table.unlike_recommended(cut), std::back_inserter(out.notes));
  add_unusual(cut, out.notes);
}

/// Of a structure that must be given by modes.
modal::ModalModel modes_of(const io::TomlFile& file, const std::string& table, const StructureTable& structure,
                           std::vector<std::string>& notes) {
  if (!structure.frf.empty()) throw file.reject(table + ".frf", "must be modes here", "Fit them: robomill modes");
  return structure.modes.empty() ? structure.own : modal::read_modes(structure.modes, notes);
}

ForcesFile read(io::TomlFile& file, const std::filesystem::path& path, ForcesJob job) {
  ForcesFile out;
  out.path = file.file_of_part("job.forces", "cut");
  out.job = job;
  file.require("tool.kind", "\"flat-end\", \"ball-end\", \"bull-nose\" or \"general\"");
  read_cutter(file, out.cutter);
  read_cut(file, job, out);
  const bool has_coefficients = job != ForcesJob::identification || file.has("coefficients");
  if (has_coefficients) read_coefficients(file, job, out);
  read_stock(file, out);
  forces_options_table().read(file, "forces", out);
  file.locate([&] {
    out.force.validate();
    if (job == ForcesJob::program) {
      // Which rings will cut is not known yet; the side of the cutter stands for the units.
      const double side = cutting::Profile(out.cutter).pieces().back().last.position_rad;
      out.coefficients.validate(side, side);
      if (out.dexel_m > 0.5 * out.cutter.mill.diameter_m) {
        throw InvalidInput("dexel_m", out.dexel_m, "m", "must be at most the cutter's radius",
                           "A tenth of it resolves depths");
      }
    }
  });
  if (job != ForcesJob::program) {
    // What only the cut itself shows, a shank in it or a coefficient below 0, is reported in the file's words.
    file.locate([&] {
      const cutting::Engagement engagement = cutting::engage(out.cutter, out.cut, {.slices = out.slices});
      if (!has_coefficients) return;
      static_cast<void>(cutting::cutting_force(out.cutter, engagement, out.coefficients, out.motion, out.force));
    });
  }
  read_robot(file, path, job, out);
  DynamicsTable dynamics = read_dynamics(file);
  if (!dynamics.structure.own.modes.empty()) keep_named_directions(file, dynamics.structure.own);
  out.dynamics = modes_of(file, "dynamics", dynamics.structure, out.notes);
  modal::FrfSet none;
  if (const auto assumed = complete_directions(out.dynamics, none, dynamics.directions, path, "dynamics")) {
    out.assumed.push_back(*assumed);
  }
  out.workpiece_dynamics = modes_of(file, "workpiece_dynamics", read_workpiece_dynamics(file), out.notes);
  std::ranges::move(file.done(), std::back_inserter(out.notes));
  return out;
}

}  // namespace

const io::Schema<Cut>& forces_options_table() {
  using cutting::ForceOptions;
  static const io::Schema<Cut> table(
      "forces", "how forces are computed",
      {io::of(&Cut::force, key("steps", &ForceOptions::steps, "of a revolution").at_least(8.0).at_most(1e5)),
       key("slices", &Cut::slices, "rings of the cutter; 0: as many as it takes").at_least(0.0).at_most(1e4),
       key("power_time_s", &Cut::power_time_s,
           "along a program: the power is averaged over this time before it is compared with the spindle")
           .above(0.0)});
  return table;
}

const io::Schema<Cut>& robot_of_cut_table() {
  static const io::Schema<Cut> table(
      "robot_of_cut", "the robot that a single cut deflects",
      {io::declared<Cut>("cell", io::Holds::path, "the file that describes it"),
       key("joints_deg", &Cut::joints_rad, "its posture"), feed_direction_row(),
       key("vibration", &Cut::robot_vibrates,
           "the arm's own modes take part in the vibration (needs links and damping in the cell)"),
       key("inertia", &Cut::robot_inertia, inertia_names,
           "of the arm's modes: of all links, or the joints' own without what couples them")});
  return table;
}

InvalidInput ForcesFile::in_its_words(const InvalidInput& error) const {
  if (!error.parts().where.empty()) return error;
  InvalidInput reported = document ? document->located(error) : error;
  if (!reported.parts().where.empty()) return reported;
  InvalidInput::Parts parts = error.parts();
  parts.where = path.string();
  return InvalidInput(std::move(parts));
}

std::filesystem::path program_of_job(const io::TomlSource& source) {
  io::TomlFile file(source);
  std::filesystem::path program;
  file.path("job.program", program);
  return program;
}

ForcesFile read_forces(const io::TomlSource& source, ForcesJob job) {
  const auto document = std::make_shared<io::TomlFile>(source);
  ForcesFile out = read(*document, source.path, job);
  out.document = document;
  add_assumed(out.assumed, io::sample_values(*document));
  return out;
}

}  // namespace robomill::process
