#include "robomill/process/files/forces_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/units.hpp"
#include "robomill/io/append.hpp"
#include "robomill/io/json.hpp"
#include "robomill/process/forces.hpp"

namespace robomill::process {
namespace {

using io::Json;
using io::number;

Json vector(const Eigen::Vector3d& v, double unit = 1.0) {
  return Json::array({number(v.x() / unit), number(v.y() / unit), number(v.z() / unit)});
}

double sign_of(const ForcesResult& result) {
  return result.cut.on_workpiece ? -1.0 : 1.0;
}

std::string revolution_csv(const RevolutionForces& revolution, double sign) {
  const cutting::CuttingForce& force = revolution.deflected.force;
  const bool vibrating = revolution.vibrating_force_n.cols() > 0;
  std::string text = "rotation_deg,fx_n,fy_n,fz_n,torque_n_m";
  text += vibrating ? ",vibrating_fx_n,vibrating_fy_n,vibrating_fz_n\n" : "\n";
  for (Eigen::Index i = 0; i < force.rotation_rad.size(); ++i) {
    const Eigen::Vector3d f = sign * force.force_n.col(i);
    io::append(text, "{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}", force.rotation_rad(i) / units::deg, f.x(), f.y(), f.z(),
               force.torque_n_m(i));
    if (vibrating) {
      const Eigen::Vector3d v = sign * revolution.vibrating_force_n.col(i);
      io::append(text, ",{:.9g},{:.9g},{:.9g}", v.x(), v.y(), v.z());
    }
    text += '\n';
  }
  return text;
}

/// A program's columns: what a row of the table and of the JSON hold alike.
struct Column {
  const char* name;
  double (*value)(const ProgramForces& program, const BlockResult& row);
};

const program::Block& block_of(const ProgramForces& program, const BlockResult& row) {
  return program.program.blocks[row.force.block];
}

constexpr Column columns[] = {
    {"block", [](const ProgramForces&, const BlockResult& r) { return static_cast<double>(r.force.block + 1); }},
    {"line", [](const ProgramForces& p, const BlockResult& r) { return static_cast<double>(block_of(p, r).line); }},
    {"x_mm", [](const ProgramForces& p, const BlockResult& r) { return block_of(p, r).end.tip_m.x() / units::mm; }},
    {"y_mm", [](const ProgramForces& p, const BlockResult& r) { return block_of(p, r).end.tip_m.y() / units::mm; }},
    {"z_mm", [](const ProgramForces& p, const BlockResult& r) { return block_of(p, r).end.tip_m.z() / units::mm; }},
    {"axial_depth_mm", [](const ProgramForces&, const BlockResult& r) { return r.force.axial_depth_m / units::mm; }},
    {"radial_depth_mm", [](const ProgramForces&, const BlockResult& r) { return r.force.radial_depth_m / units::mm; }},
    {"mean_fx_n", [](const ProgramForces&, const BlockResult& r) { return r.force.mean_force_n.x(); }},
    {"mean_fy_n", [](const ProgramForces&, const BlockResult& r) { return r.force.mean_force_n.y(); }},
    {"mean_fz_n", [](const ProgramForces&, const BlockResult& r) { return r.force.mean_force_n.z(); }},
    {"peak_f_n", [](const ProgramForces&, const BlockResult& r) { return r.force.peak_force_n; }},
    {"torque_n_m", [](const ProgramForces&, const BlockResult& r) { return r.force.mean_torque_n_m; }},
    {"revolution_torque_n_m", [](const ProgramForces&, const BlockResult& r) { return r.force.revolution_torque_n_m; }},
    {"peak_torque_n_m", [](const ProgramForces&, const BlockResult& r) { return r.force.peak_torque_n_m; }},
    {"power_w", [](const ProgramForces&, const BlockResult& r) { return r.force.power_w; }},
    {"peak_power_w", [](const ProgramForces&, const BlockResult& r) { return r.force.peak_power_w; }},
    {"sustained_power_w", [](const ProgramForces&, const BlockResult& r) { return r.force.sustained_power_w; }},
    {"deflection_um", [](const ProgramForces&, const BlockResult& r) { return r.deflection_m.norm() / units::um; }},
    {"deflection_x_um", [](const ProgramForces&, const BlockResult& r) { return r.deflection_m.x() / units::um; }},
    {"deflection_y_um", [](const ProgramForces&, const BlockResult& r) { return r.deflection_m.y() / units::um; }},
    {"deflection_z_um", [](const ProgramForces&, const BlockResult& r) { return r.deflection_m.z() / units::um; }},
    {"peak_deflection_um",
     [](const ProgramForces&, const BlockResult& r) { return r.peak_deflection_m.norm() / units::um; }},
    {"cutting_time_s", [](const ProgramForces&, const BlockResult& r) { return r.force.cutting_time_s; }},
    {"feed_per_tooth_mm",
     [](const ProgramForces&, const BlockResult& r) { return r.force.feed_per_tooth_m / units::mm; }},
    {"removed_mm3", [](const ProgramForces&, const BlockResult& r) { return r.force.removed_volume_m3 / units::mm3; }},
    {"condition_number", [](const ProgramForces&, const BlockResult& r) { return r.condition_number; }},
};

/// A column of a program whose sign depends on whether forces are those on the tool or on the workpiece.
bool turns(std::string_view name) {
  return name.starts_with("mean_f");
}

/// Columns of the robot, empty where there is none.
bool of_robot(std::string_view name) {
  return name.find("deflection") != std::string_view::npos || name == "condition_number";
}

std::string program_csv(const ForcesResult& result) {
  const ProgramForces& program = *result.program;
  const double sign = sign_of(result);
  std::string text;
  for (const Column& column : columns) text += std::string(text.empty() ? "" : ",") + column.name;
  text += '\n';
  for (const BlockResult& row : program.blocks) {
    bool first = true;
    for (const Column& column : columns) {
      if (!first) text += ',';
      first = false;
      if (of_robot(column.name) && row.joints.size() == 0) continue;
      const double value = column.value(program, row) * (turns(column.name) ? sign : 1.0);
      io::append(text, "{:.9g}", value);
    }
    text += '\n';
  }
  return text;
}

Json arcs_json(const cutting::Engagement& engagement) {
  Json rings = Json::array();
  for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
    const cutting::EdgeSlice& slice = engagement.slices[i];
    Json arcs = Json::array();
    for (const cutting::Arc& arc : engagement.of(i)) {
      arcs.push_back({number(arc.entry_rad / units::deg), number(arc.exit_rad / units::deg)});
    }
    rings.push_back({{"height_mm", number(slice.height_m / units::mm)},
                     {"radius_mm", number(slice.radius_m / units::mm)},
                     {"position_deg", number(slice.position_rad / units::deg)},
                     {"arcs_deg", std::move(arcs)}});
  }
  return rings;
}

const char* name_of(cutting::StaticDeflection::Status status) {
  switch (status) {
    case cutting::StaticDeflection::Status::diverged:
      return "digs in";
    case cutting::StaticDeflection::Status::lifts_off:
      return "lifts off";
    case cutting::StaticDeflection::Status::found:
      break;
  }
  return "found";
}

Json sweep_json(const robot::Redundancy& sweep, double used_rad) {
  Json gamma = Json::array();
  Json deflection = Json::array();
  Json along = Json::array();
  Json condition = Json::array();
  Json limit = Json::array();
  for (const robot::RedundancySample& sample : sweep.samples) {
    const bool stands = sample.status == robot::Reach::Status::found && !sample.buckled;
    const auto known = [&](double value) { return stands ? number(value) : Json(); };
    gamma.push_back(number(sample.gamma_rad / units::deg));
    deflection.push_back(known(sample.error_m.norm() / units::um));
    along.push_back(known(sample.error_along_normal_m / units::um));
    condition.push_back(known(sample.condition_number));
    limit.push_back(known(sample.limit_distance_rad / units::deg));
  }
  const bool found = sweep.status == robot::Redundancy::Status::found;
  return {{"rotation_deg", std::move(gamma)},
          {"deflection_um", std::move(deflection)},
          {"along_normal_um", std::move(along)},
          {"condition_number", std::move(condition)},
          {"limit_distance_deg", std::move(limit)},
          {"best_deg", found ? number(sweep.best.gamma_rad / units::deg) : Json()},
          {"best_deflection_um", found ? number(sweep.best.error_m.norm() / units::um) : Json()},
          {"used_deg", number(used_rad / units::deg)}};
}

Json vibration_json(const simulation::Simulation& s) {
  const bool found = s.small.status == simulation::SmallVibration::Status::found;
  return {{"verdict", to_string(s.verdict)},
          {"chatter_frequency_hz", s.chatter_frequency_hz > 0.0 ? number(s.chatter_frequency_hz) : Json()},
          {"chatter_amplitude_um", number(s.chatter_amplitude_m / units::um)},
          {"spectral_radius", found ? number(s.small.spectral_radius) : Json()},
          {"missed_share", number(s.missed_share)},
          {"error_estimate", number(s.error_estimate)}};
}

Json revolution_json(const RevolutionForces& revolution, double sign) {
  const cutting::StaticDeflection& deflected = revolution.deflected;
  const cutting::CuttingForce& force = deflected.force;
  const bool robot = revolution.posture.has_value();
  Json out = {{"mean_n", vector(sign * force.mean_n)},
              {"peak_n", vector(sign * force.peak_n)},
              {"rms_n", vector(force.rms_n)},
              {"peak_force_n", number(force.peak_force_n)},
              {"torque_n_m", number(force.mean_torque_n_m)},
              {"peak_torque_n_m", number(force.peak_torque_n_m)},
              {"power_w", number(force.power_w)},
              {"chip_area_mm2", number(force.chip_area_m2 / (units::mm * units::mm))},
              {"patch_area_mm2", number(cutting::patch_area_m2(deflected.engagement) / (units::mm * units::mm))},
              {"removal_rate_mm3_per_s", number(force.removal_rate_m3_per_s / units::mm3)},
              {"missed_share", number(force.missed_share)},
              {"deflection_um", robot ? vector(deflected.deflection_m, units::um) : Json()},
              {"peak_deflection_um", robot ? number(deflected.peak_deflection_m / units::um) : Json()},
              {"axial_depth_left_mm", number(deflected.cut.axial_depth_m / units::mm)},
              {"settled", name_of(deflected.status)},
              {"condition_number", robot ? number(revolution.posture->condition_number) : Json()}};
  out["spindle_rotation"] = revolution.spindle_rotation
                                ? sweep_json(*revolution.spindle_rotation, revolution.posture->pose.gamma_rad)
                                : Json();
  out["vibration"] = revolution.vibration ? vibration_json(*revolution.vibration) : Json();
  out["engagement"] = arcs_json(deflected.engagement);
  out["rotation_deg"] = io::numbers(force.rotation_rad / units::deg);
  const std::string names[] = {"fx_n", "fy_n", "fz_n"};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    out[names[axis]] = io::numbers(sign * force.force_n.row(axis).transpose());
  }
  out["torque_by_rotation_n_m"] = io::numbers(force.torque_n_m);
  if (revolution.vibrating_force_n.cols() == 0) return out;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    out["vibrating_" + names[axis]] = io::numbers(sign * revolution.vibrating_force_n.row(axis).transpose());
  }
  return out;
}

Json stock_json(const ProgramForces& program) {
  if (!program.stock) return {};
  const ProgramStock& stock = *program.stock;
  Json top;
  if (stock.assumed) {
    top = stock.assumed->top == cutting::DefaultStock::Top::program_zero ? "program zero" : "axial depth";
  }
  return {{"assumed", stock.assumed.has_value()},
          {"top_from", std::move(top)},
          {"min_mm", vector(stock.stock.lowest_m(), units::mm)},
          {"max_mm", vector(stock.stock.highest_m(), units::mm)}};
}

Json block_json(const ProgramForces& program, const BlockResult& row, double sign) {
  Json out = Json::object();
  for (const Column& column : columns) {
    const bool known = !of_robot(column.name) || row.joints.size() > 0;
    const double value = column.value(program, row) * (turns(column.name) ? sign : 1.0);
    const bool whole = std::string_view(column.name) == "block" || std::string_view(column.name) == "line";
    out[column.name] = !known ? Json() : whole ? Json(static_cast<std::size_t>(value)) : number(value);
  }
  return out;
}

/// A row a block, with how far and how long the program has run at its end.
Json blocks_json(const ProgramForces& program, double sign) {
  Json blocks = Json::array();
  double path_m = 0.0;
  double time_s = 0.0;
  for (const BlockResult& row : program.blocks) {
    const program::Block& block = block_of(program, row);
    path_m += (block.end.tip_m - program.program.begin_of(row.force.block).tip_m).norm();
    time_s += block.duration_s;
    Json entry = block_json(program, row, sign);
    entry["cuts"] = row.force.cuts();
    entry["path_mm"] = number(path_m / units::mm);
    entry["time_s"] = number(time_s);
    blocks.push_back(std::move(entry));
  }
  return blocks;
}

using Ranked = std::pair<double, const Json*>;

/// The blocks that cut and their values in a column; those of which it is not known are left out.
std::vector<Ranked> cutting_blocks(const Json& blocks, const char* column) {
  std::vector<Ranked> out;
  for (const Json& block : blocks) {
    const Json& value = block.at(column);
    if (value.is_number() && block.at("cuts").get<bool>()) out.emplace_back(value.get<double>(), &block);
  }
  return out;
}

/// The highest value of the columns that a program is judged by, and where; null where none is known.
Json highest_json(const Json& blocks) {
  Json out = Json::object();
  for (const char* column :
       {"peak_f_n", "revolution_torque_n_m", "peak_torque_n_m", "sustained_power_w", "peak_deflection_um"}) {
    const std::vector<Ranked> values = cutting_blocks(blocks, column);
    out[column] = nullptr;
    if (values.empty()) continue;
    const auto& [value, block] = *std::ranges::max_element(values, {}, &Ranked::first);
    out[column] = {{"value", value}, {"block", block->at("block")}, {"line", block->at("line")}};
  }
  return out;
}

constexpr std::size_t worst_blocks = 10;

/// The blocks with the highest peak force, the worst first.
Json worst_json(const Json& blocks) {
  std::vector<Ranked> order = cutting_blocks(blocks, "peak_f_n");
  std::ranges::stable_sort(order, std::ranges::greater(), &Ranked::first);
  order.resize(std::min(order.size(), worst_blocks));
  Json worst = Json::array();
  for (const auto& [force, block] : order) worst.push_back(*block);
  return worst;
}

Json program_json(const ForcesResult& result) {
  const ProgramForces& program = *result.program;
  Json blocks = blocks_json(program, sign_of(result));
  Json highest = highest_json(blocks);
  Json worst = worst_json(blocks);
  Json skipped = Json::array();
  for (const program::Skipped& item : program.program.skipped) {
    skipped.push_back({{"line", item.line}, {"what", item.what}});
  }
  const auto limit = [&](double decision::SpindleCapacity::*of) {
    return result.spindle && (*result.spindle).*of > 0.0 ? number((*result.spindle).*of) : Json();
  };
  return {{"removed_mm3", number(program.removed_volume_m3 / units::mm3)},
          {"seconds", number(program.seconds)},
          {"cutting_blocks", program.cutting_blocks()},
          {"power_time_s", number(result.cut.power_time_s)},
          {"torque_limit_n_m", limit(&decision::SpindleCapacity::torque_n_m)},
          {"power_limit_w", limit(&decision::SpindleCapacity::power_w)},
          {"stock", stock_json(program)},
          {"highest", std::move(highest)},
          {"worst", std::move(worst)},
          {"blocks", std::move(blocks)},
          {"skipped", std::move(skipped)}};
}

const char* name_of(cutting::CutterKind kind) {
  switch (kind) {
    case cutting::CutterKind::flat_end:
      return "flat end";
    case cutting::CutterKind::ball_end:
      return "ball end";
    case cutting::CutterKind::bull_nose:
      return "bull nose";
    case cutting::CutterKind::general:
      break;
  }
  return "general cutter";
}

/// What was cut with what, in words.
Json facts_json(const ForcesResult& result) {
  Json facts = Json::array();
  const auto add = [&](const char* label, std::string value) {
    facts.push_back({{"label", label}, {"value", std::move(value)}});
  };
  const cutting::Cutter& cutter = result.cut.cutter;
  add("Cutter", fmt::format("{}, {:.4g} mm, {} teeth, helix {:.3g}°", name_of(cutter.kind),
                            cutter.mill.diameter_m / units::mm, cutter.mill.teeth, cutter.mill.helix_rad / units::deg));
  if (result.revolution) {
    const cutting::Cut& cut = result.cut.cut;
    add("Cut", fmt::format("{:.4g} mm deep, {:.4g} mm step-over, {:.4g} mm a tooth, lead {:.3g}°, tilt {:.3g}°",
                           cut.axial_depth_m / units::mm, cut.radial_depth_m / units::mm,
                           result.cut.motion.feed_per_tooth_m / units::mm, cut.lead_rad / units::deg,
                           cut.tilt_rad / units::deg));
    add("Speed", fmt::format("{:.0f} rpm", result.cut.motion.spindle_speed_rad_per_s / units::rpm));
  }
  if (result.program) {
    add("Program", fmt::format("{} blocks", result.program->blocks.size()));
    const std::optional<ProgramStock>& stock = result.program->stock;
    if (stock && !stock->assumed) add("Stock", stock_text(*result.program));
  }
  return facts;
}

}  // namespace

std::string forces_csv(const ForcesResult& result) {
  return result.program ? program_csv(result) : revolution_csv(*result.revolution, sign_of(result));
}

Json forces_object(const ForcesResult& result) {
  Json out = {{"force_on", result.cut.on_workpiece ? "workpiece" : "tool"}};
  if (result.revolution) out.update(revolution_json(*result.revolution, sign_of(result)));
  if (result.program) out.update(program_json(result));
  out["facts"] = facts_json(result);
  out["warnings"] = result.warnings;
  out["notes"] = result.notes;
  out["assumed"] = io::assumed_json(result.assumed);
  return out;
}

std::string forces_json(const ForcesResult& result) {
  return io::dump(forces_object(result));
}

}  // namespace robomill::process
