#include "robomill/io/toml/tables.hpp"

#include <algorithm>

namespace robomill::io {
namespace {

constexpr std::string_view tables[] = {
    // hits and their records
    "acquisition", "hits",
    // the cut
    "tool", "cut", "coefficients", "process_damping", "speed_variation", "dynamics", "workpiece_dynamics",
    // its chart, its forces
    "lobes", "uncertainty", "surface_error", "stock", "forces", "force_on",
    // the robot's cell
    "robot", "workpiece", "geometry", "smoothing", "program", "postures",
    // the job
    "job", "spindle", "safety", "finishing", "decide", "cuts",
    // the monitor
    "signal", "process", "detector", "act", "mqtt", "metrics", "recording"};

/// Of tables that several readers know a part of. A * ends the beginning of keys that one reader knows.
constexpr std::string_view shared_keys[] = {
    // the cutter, its edges' length, and what it is to the robot
    "tool.kind", "tool.teeth", "tool.diameter_mm", "tool.helix_*", "tool.pitch_deg", "tool.runout_*",
    "tool.cutting_height_mm", "tool.corner_*", "tool.bottom_angle_deg", "tool.side_angle_deg", "tool.point_angle_deg",
    "tool.max_axial_depth_mm", "tool.length_mm", "tool.mass_kg", "tool.center_mm", "tool.number", "tool.load_number",
    "tool.name", "tool.mount_*",
    // an arm, and how a cut of one revolution stands on it
    "robot.kind", "robot.model", "robot.urdf*", "robot.dh*", "robot.links*", "robot.joint_*", "robot.base_*",
    "robot.platform_*", "robot.start_joints_deg", "robot.gamma_deg", "robot.description", "robot.source", "robot.notes",
    "robot.assumed*", "robot.cell", "robot.joints_deg", "robot.feed_direction", "robot.vibration",
    // what the spindle can do, and how a controller switches it
    "spindle.min_speed_rpm", "spindle.max_speed_rpm", "spindle.curve*", "spindle.output", "spindle.coolant_output",
    "spindle.spin_up_s"};

}  // namespace

bool is_known_table(std::string_view name) {
  return std::ranges::find(tables, name) != std::end(tables);
}

std::optional<SharedKey> shared_key(std::string_view key) {
  for (const std::string_view entry : shared_keys) {
    const bool begins = entry.ends_with('*');
    const std::string_view name = entry.substr(0, entry.size() - (begins ? 1 : 0));
    if (begins ? key.starts_with(name) : key == name) return SharedKey{.name = name, .begins = begins};
  }
  return std::nullopt;
}

bool AskedKeys::has_below(std::string_view key, std::string_view joint) const {
  const std::string begin = std::string(key) + std::string(joint);
  const auto first = keys_.lower_bound(begin);
  return first != keys_.end() && first->starts_with(begin);
}

bool AskedKeys::covers(std::string_view key) const {
  const auto below = [this](std::string_view part) { return has_below(part, ".") || has_below(part, "["); };
  if (contains(key) || below(key)) return true;
  for (std::size_t end = key.find_last_of(".["); end != std::string_view::npos; end = key.find_last_of(".[")) {
    key = key.substr(0, end);
    if (contains(key) && !below(key)) return true;
  }
  return false;
}

bool AskedKeys::leaves_table(std::string_view table) const {
  return is_known_table(table) && !contains(table) && !has_below(table, ".") && !has_below(table, "[");
}

bool AskedKeys::leaves_key(std::string_view key) const {
  const std::optional<SharedKey> shared = shared_key(key);
  return shared && !(shared->begins && has_below(shared->name, ""));
}

}  // namespace robomill::io
