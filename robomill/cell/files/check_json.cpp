#include "robomill/cell/files/check_json.hpp"

#include <algorithm>
#include <string_view>

#include "robomill/base/units.hpp"
#include "robomill/cell/check/shown.hpp"
#include "robomill/io/json.hpp"
#include "robomill/path/files/smooth_object.hpp"
#include "robomill/robot/euler.hpp"

namespace robomill::cell {
namespace {

using io::Json;

Json lengths(const Eigen::Ref<const Eigen::VectorXd>& length_m) {
  return io::numbers_in(units::mm, length_m);
}

Json direction(const Eigen::Vector3d& axis) {
  return {io::number(axis.x()), io::number(axis.y()), io::number(axis.z())};
}

Json degrees(double a_rad, double b_rad, double c_rad) {
  return {io::number(a_rad / units::deg), io::number(b_rad / units::deg), io::number(c_rad / units::deg)};
}

Json limit(double value, double unit) {
  return is_limit(value) ? io::number(value / unit) : Json();
}

bool is_assumed(const Cell& cell, std::string_view key) {
  return std::ranges::any_of(cell.assumed, [key](const Assumption& one) { return one.key == key; });
}

Json joint_limits_json(const CellCheck& check, int joint) {
  const double unit = joint_unit(check.prismatic, joint).size;
  const robot::JointLimits& limits = check.limits;
  Json out = {{"joint", joint + 1}, {"unit", unit == units::deg ? "deg" : "mm"}};
  out["min_position"] = limit(limits.min_position(joint), unit);
  out["max_position"] = limit(limits.max_position(joint), unit);
  out["max_velocity_per_s"] = io::positive(limits.max_velocity(joint), unit);
  out["max_acceleration_per_s2"] = io::positive(limits.max_acceleration(joint), unit);
  out["max_jerk_per_s3"] = io::positive(limits.max_jerk(joint), unit);
  out["assumed"] = Json::array();
  for (const auto& [key, name] : {std::pair{"robot.joint_min_position", "min_position"},
                                  {"robot.joint_max_position", "max_position"},
                                  {"robot.joint_max_velocity", "max_velocity_per_s"},
                                  {"robot.joint_max_acceleration", "max_acceleration_per_s2"},
                                  {"robot.joint_max_jerk", "max_jerk_per_s3"}}) {
    if (is_assumed(check.cell, key)) out["assumed"].push_back(name);
  }
  return out;
}

Json by_joint(const CellCheck& check, const robot::Position6& values) {
  Json out = Json::array();
  for (int i = 0; i < check.joints; ++i) out.push_back(limit(values(i), joint_unit(check.prismatic, i).size));
  return out;
}

Json pose_json(const Eigen::Isometry3d& pose) {
  const robot::Euler turn = robot::euler_of(pose.linear());
  const Eigen::Quaterniond quaternion(pose.linear());
  const Eigen::AngleAxisd about(pose.linear());
  const double sign = quaternion.w() < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d vector = about.angle() * about.axis();
  Json out = {{"origin_mm", lengths(pose.translation())}};
  out["abc_deg"] = degrees(turn.a_rad, turn.b_rad, turn.c_rad);
  out["quaternion"] = {io::number(sign * quaternion.w()), io::number(sign * quaternion.x()),
                       io::number(sign * quaternion.y()), io::number(sign * quaternion.z())};
  out["rotation_vector_rad"] = {io::number(vector.x()), io::number(vector.y()), io::number(vector.z())};
  return out;
}

Json stand_json(const CellCheck& check, const CellStand& stand) {
  Json out = {{"name", stand.name}, {"joints", by_joint(check, stand.position)}};
  out["tip_mm"] = lengths(stand.tip_m);
  out["axis"] = direction(stand.axis);
  out["program_tip_mm"] = lengths(stand.tool.tip_m);
  out["program_axis"] = direction(stand.tool.axis);
  out["gamma_deg"] = io::number(stand.tool.gamma_rad / units::deg);
  out["flange"] = pose_json(stand.flange);
  out["to_limit"] = by_joint(check, stand.to_limit);
  out["nearest_joint"] = stand.nearest_joint < 0 ? Json() : Json(stand.nearest_joint + 1);
  out["condition_number"] = io::number(stand.condition_number);
  return out;
}

constexpr Name<robot::Reach::Status> states[] = {{"out of reach", robot::Reach::Status::out_of_reach},
                                                 {"outside limits", robot::Reach::Status::outside_limits},
                                                 {"singular", robot::Reach::Status::singular}};

Json miss_json(const CellCheck& check, const Miss& miss) {
  Json out = {{"block", miss.block}, {"line", miss.line > 0 ? Json(miss.line) : Json()}};
  out["tip_mm"] = lengths(miss.pose.tip_m);
  out["axis"] = direction(miss.pose.axis);
  out["base_tip_mm"] = lengths(Eigen::Vector3d(check.placement.workpiece * miss.pose.tip_m));
  out["state"] = name_in(states, miss.status);
  out["joints"] = Json::array();
  for (const BeyondLimit& beyond : miss.beyond) {
    const double unit = joint_unit(check.prismatic, beyond.joint).size;
    out["joints"].push_back({{"joint", beyond.joint + 1},
                             {"position", io::number(beyond.position / unit)},
                             {"limit", io::number(beyond.limit / unit)},
                             {"beyond", io::number((beyond.position - beyond.limit) / unit)}});
  }
  out["out_of_reach_mm"] = io::positive(miss.out_of_reach_m, units::mm);
  out["out_of_reach_deg"] = io::positive(miss.out_of_reach_rad, units::deg);
  out["condition_number"] = io::positive(miss.condition_number);
  out["text"] = what_misses(miss, check.prismatic);
  return out;
}

/// origin_mm and rotation_deg as a cell has them.
Json workpiece_json(const Eigen::Isometry3d& workpiece) {
  const robot::Euler turn = robot::euler_of(workpiece.linear());
  return {{"origin_mm", lengths(workpiece.translation())},
          {"rotation_deg", degrees(turn.c_rad, turn.b_rad, turn.a_rad)}};
}

/// How a program, or the origin, is reached.
void add_choice(const CellCheck& check, const path::PostureChoice& choice, Json& out) {
  const std::vector<double>& gamma_rad = choice.posture.gamma_rad;
  out["margin"] = io::number(choice.margin.least);
  out["posture"] = path::posture_table().write({&choice, check.joints, &check.prismatic});
  out["margin_joint"] = choice.margin.joint < 0 ? io::Json() : io::Json(choice.margin.joint + 1);
  if (check.cell.hybrid || gamma_rad.empty()) {
    out["gamma_deg"] = nullptr;
    return;
  }
  const auto [low, high] = std::ranges::minmax(gamma_rad);
  out["gamma_deg"] = {io::number(low / units::deg), io::number(high / units::deg)};
}

Json placement_json(const CellCheck& check) {
  const Placement& placement = check.placement;
  Json out = workpiece_json(placement.workpiece);
  out["works"] = placement.works();
  out["program"] = check.program.empty() ? Json() : Json(check.program);
  out["whole"] = check.whole;
  out["poses"] = placement.poses;
  out["complete"] = placement.complete;
  out["missed"] = placement.misses.size();
  out["misses"] = Json::array();
  for (const Miss& miss : placement.misses) out["misses"].push_back(miss_json(check, miss));
  out["no_way"] = placement.no_way.empty() ? Json() : Json(placement.no_way);
  if (placement.works()) add_choice(check, placement.choice, out);
  return out;
}

Json proposal_json(const CellCheck& check, const Proposal& proposal) {
  Json out = workpiece_json(proposal.placement.workpiece);
  out["shift_mm"] = lengths(proposal.shift_m);
  out["turn_deg"] = io::number(proposal.turn_rad / units::deg);
  add_choice(check, proposal.placement.choice, out);
  return out;
}

template <class Point>
Json points(const std::vector<Point>& line) {
  Json out = Json::array();
  for (const Point& point : line) out.push_back(lengths(point));
  return out;
}

template <class Point>
Json lines(const std::vector<std::vector<Point>>& all) {
  Json out = Json::array();
  for (const std::vector<Point>& line : all) out.push_back(points(line));
  return out;
}

Json drawing_json(const CellDrawing& drawing) {
  Json figures = Json::array();
  for (const CellFigure& figure : drawing.figures) {
    figures.push_back({{"name", figure.name},
                       {"links_mm", lines(figure.links_m)},
                       {"joints_mm", points(figure.joints_m)},
                       {"flange_mm", lengths(figure.flange_m)},
                       {"tip_mm", lengths(figure.tip_m)}});
  }
  return {{"figures", std::move(figures)},
          {"reach_side_mm", lines(drawing.reach_side_m)},
          {"reach_top_mm", lines(drawing.reach_top_m)},
          {"program_mm", points(drawing.program_m)}};
}

}  // namespace

std::string cell_check_json(const CellCheck& check) {
  const Cell& cell = check.cell;
  const auto text = [](const std::string& said) { return said.empty() ? Json() : Json(said); };
  Json out = {{"cell", cell.path.filename().string()}};
  out["robot"] = {{"kind", cell.hybrid ? "hybrid-2upr-rpu" : "serial"},
                  {"model", text(cell.model)},
                  {"description", text(cell.description)},
                  {"source", text(cell.source)}};
  out["joints"] = Json::array();
  for (int i = 0; i < check.joints; ++i) out["joints"].push_back(joint_limits_json(check, i));
  out["postures"] = Json::array();
  for (const CellStand& stand : check.stands) out["postures"].push_back(stand_json(check, stand));
  out["at_limits"] = Json::array();
  for (const CellStand& stand : check.at_limits) out["at_limits"].push_back(stand_json(check, stand));
  out["placement"] = placement_json(check);
  out["proposals"] = Json::array();
  for (const Proposal& proposal : check.proposals) out["proposals"].push_back(proposal_json(check, proposal));
  out["drawing"] = drawing_json(check.drawing);
  out["assumed"] = io::assumed_json(cell.assumed);
  out["notes"] = check.notes;
  return io::dump(out);
}

}  // namespace robomill::cell
