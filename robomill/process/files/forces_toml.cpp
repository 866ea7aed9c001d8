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

namespace robomill::process {
namespace {

/// The radius of a curved surface, > 0 where it is convex, to its curvature.
void read_radius(io::TomlFile& file, const char* key, double& curvature_per_m) {
  double radius_m = 0.0;
  if (!file.number(key, "surface_radius_m", units::mm, radius_m)) return;
  if (radius_m == 0.0) throw file.reject(key, "must not be 0", "> 0 is convex, < 0 concave; a plane has none");
  curvature_per_m = 1.0 / radius_m;
}

void read_cut(io::TomlFile& file, ForcesJob job, ForcesFile& out) {
  const bool alone = job == ForcesJob::revolution;
  file.number("cut.axial_depth_mm", "axial_depth_m", units::mm, out.cut.axial_depth_m);
  const bool radial = read_radial_depth(file, out.cut.radial_depth_m);
  file.number("cut.feed_per_tooth_mm", "feed_per_tooth_m", units::mm, out.motion.feed_per_tooth_m);
  const bool turning =
      file.number("cut.spindle_speed_rpm", "spindle_speed_rad_per_s", units::rpm, out.motion.spindle_speed_rad_per_s);
  const bool named = read_direction(file, out.cut.direction);
  file.number("cut.lead_deg", "lead_rad", units::deg, out.cut.lead_rad);
  file.number("cut.tilt_deg", "tilt_rad", units::deg, out.cut.tilt_rad);
  file.number("cut.feed_direction_deg", "feed_direction_rad", units::deg, out.feed_direction_rad);
  read_radius(file, "cut.surface_radius_along_feed_mm", out.cut.curvature_along_feed_per_m);
  read_radius(file, "cut.surface_radius_across_feed_mm", out.cut.curvature_across_feed_per_m);
  std::string on = "tool";
  file.text("force_on", on);
  file.text("cut.force_on", on);
  if (on != "tool" && on != "workpiece") throw file.reject("force_on", "must be \"tool\" or \"workpiece\"");
  out.on_workpiece = on == "workpiece";
  if (turning && !(out.motion.spindle_speed_rad_per_s > 0.0)) throw file.reject("cut.spindle_speed_rpm", "must be > 0");
  if (!alone) return;
  file.require("cut.axial_depth_mm");
  file.require("cut.feed_per_tooth_mm");
  file.require("cut.spindle_speed_rpm");
  if (!named) file.require("cut.direction", "\"up\", \"down\" or \"slot\"");
  if (!radial && out.cut.direction != cutting::MillingDirection::slot) file.require("cut.radial_depth_mm");
  require_full_width(file, out.cut.direction, out.cut.radial_depth_m, out.cutter.mill, out.cutter.kind);
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

/// @param document  whose [robot] may be the arm itself
void read_robot(io::TomlFile& file, const std::filesystem::path& document, ForcesJob job, ForcesFile& out) {
  const bool alone = job == ForcesJob::revolution;
  const bool holds_arm = std::ranges::any_of(cell::arm_keys, [&](const char* key) { return file.has(key); });
  const bool has_cell = holds_arm || file.has("job.cell");
  if (!file.has("robot") && !has_cell) return;
  if (alone && has_cell && !file.has("robot.joints_deg")) return;  // no posture to cut in
  if (!file.path("robot.cell", out.cell) && has_cell) {
    out.cell = file.has("job.cell") ? file.file_of_part("job.cell", "robot") : document;
  }
  file.numbers("robot.joints_deg", "joints_rad", units::deg, out.joints_rad);
  std::vector<double> direction;
  if (file.numbers("robot.feed_direction", "feed_direction", 1.0, direction)) {
    if (direction.size() != 3) throw file.reject("robot.feed_direction", "must be [x, y, z] in the work frame");
    out.feed_direction = {direction[0], direction[1], direction[2]};
    if (!(out.feed_direction.norm() > 0.0)) throw file.reject("robot.feed_direction", "must not be zero");
    out.feed_direction.normalize();
  }
  file.boolean("robot.vibration", out.robot_vibrates);
  if (!alone) return;
  if (!has_cell) file.require("robot.cell", "The file that describes the robot");
  file.require("robot.joints_deg", "The posture in which it cuts");
}

template <class Vector>
void read_point(io::TomlFile& file, const std::string& key, const std::string& member, Vector& out) {
  std::vector<double> values;
  file.require(key);
  file.numbers(key, member, units::mm, values);
  if (values.size() != static_cast<std::size_t>(out.size())) {
    throw file.reject(key, out.size() == 3 ? "must be [x, y, z]" : "must be [x, y]");
  }
  out = Eigen::Map<const Vector>(values.data());
}

/// The axis of a round stock, x and y; 0, 0 where it is absent.
void read_round(io::TomlFile& file, cutting::Stock& stock) {
  if (file.has("stock.center_mm")) read_point(file, "stock.center_mm", "center_m", stock.center_m);
  if (stock.shape == cutting::Stock::Shape::cylinder) {
    for (const char* key : {"stock.radius_mm", "stock.bottom_mm", "stock.top_mm"}) file.require(key);
    file.number("stock.radius_mm", "radius_m", units::mm, stock.radius_m);
    file.number("stock.bottom_mm", "bottom_m", units::mm, stock.bottom_m);
    file.number("stock.top_mm", "top_m", units::mm, stock.top_m);
    return;
  }
  std::vector<double> radius, height;
  file.require("stock.outline_radius_mm", "Radii of the outline, from below to above");
  file.require("stock.outline_z_mm", "Their heights");
  file.numbers("stock.outline_radius_mm", "outline_m", units::mm, radius);
  file.numbers("stock.outline_z_mm", "outline_m", units::mm, height);
  if (radius.size() != height.size()) throw file.reject("stock.outline_z_mm", "must have a height for each radius");
  stock.outline_m.reserve(radius.size());
  for (std::size_t i = 0; i < radius.size(); ++i) stock.outline_m.emplace_back(radius[i], height[i]);
}

void read_stock(io::TomlFile& file, ForcesFile& out) {
  using Shape = cutting::Stock::Shape;
  file.number("stock.dexel_mm", "dexel_m", units::mm, out.dexel_m);
  if (!(out.dexel_m > 0.0)) throw file.reject("stock.dexel_mm", "must be > 0");
  std::string kind;
  if (file.text("stock.kind", kind) && kind == "neighbours") {
    out.neighbours = true;
    file.require("cut.axial_depth_mm", "How deep every block cuts beside its neighbour");
    if (!(out.cut.axial_depth_m > 0.0)) throw file.reject("cut.axial_depth_mm", "must be > 0");
    if (out.cutter.kind != cutting::CutterKind::ball_end) {
      throw file.reject("tool.kind", "must be \"ball-end\" where there is no stock");
    }
    return;
  }
  cutting::Stock stock;
  if (!file.choice<Shape>("stock.kind", {{"box", Shape::box}, {"cylinder", Shape::cylinder}, {"turned", Shape::turned}},
                          stock.shape)) {
    return;
  }
  if (stock.shape == Shape::box) {
    read_point(file, "stock.min_mm", "min_m", stock.min_m);
    read_point(file, "stock.max_mm", "max_m", stock.max_m);
  } else {
    read_round(file, stock);
  }
  file.locate([&] { stock.validate(); });
  out.stock = stock;
}

/// A material's are those at the cut's mean chip, which depth and direction tell of an upright flat end alone.
void read_coefficients(io::TomlFile& file, ForcesJob job, ForcesFile& out) {
  cutting::CutAtHand cut;
  cut.kind = out.cutter.kind;
  if (job == ForcesJob::revolution) {
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

ForcesFile read(io::TomlFile& file, const std::filesystem::path& path, ForcesJob job) {
  ForcesFile out;
  out.path = file.file_of_part("job.forces", "cut");
  out.job = job;
  file.require("tool.kind", "\"flat-end\", \"ball-end\", \"bull-nose\" or \"general\"");
  read_cutter(file, out.cutter);
  read_cut(file, job, out);
  read_coefficients(file, job, out);
  read_stock(file, out);
  file.integer("forces.steps", "steps", out.force.steps);
  file.integer("forces.slices", "slices", out.slices);
  file.number("forces.power_time_s", "power_time_s", 1.0, out.power_time_s);
  if (!(out.power_time_s > 0.0)) throw file.reject("forces.power_time_s", "must be > 0");
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
  if (job == ForcesJob::revolution) {
    // What only the cut itself shows, a shank in it or a coefficient below 0, is reported in the file's words.
    file.locate([&] {
      const cutting::Engagement engagement = cutting::engage(out.cutter, out.cut, {.slices = out.slices});
      static_cast<void>(cutting::cutting_force(out.cutter, engagement, out.coefficients, out.motion, out.force));
    });
  }
  read_robot(file, path, job, out);
  modal::MissingDirections said;
  const auto structure = [&](const std::string& table, modal::ModalModel& model) {
    std::filesystem::path modes, frf;
    read_structure(file, table, modes, frf, model);
    if (table == "dynamics") said = read_missing_directions(file, table, model);
    if (!frf.empty()) throw file.reject(table + ".frf", "must be modes here", "Fit them: robomill modes");
    if (!modes.empty()) model = modal::read_modes(modes, out.notes);
  };
  structure("dynamics", out.dynamics);
  modal::FrfSet none;
  if (const auto assumed = complete_directions(out.dynamics, none, said, path, "dynamics")) {
    out.assumed.push_back(*assumed);
  }
  structure("workpiece_dynamics", out.workpiece_dynamics);
  std::ranges::move(file.done(), std::back_inserter(out.notes));
  return out;
}

}  // namespace

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
