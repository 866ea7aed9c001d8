#include <array>
#include <cmath>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/report/json.hpp"

namespace robomill::report {
namespace {

using Json = nlohmann::ordered_json;

struct Unit {
  const char* text;
  double si;
};

Unit unit_of(LimitUse::Quantity quantity, int order) {
  static constexpr std::array<const char*, 4> lengths = {"mm", "mm/s", "mm/s²", "mm/s³"};
  static constexpr std::array<const char*, 4> angles = {"°", "°/s", "°/s²", "°/s³"};
  const auto at = static_cast<std::size_t>(order);
  switch (quantity) {
    case LimitUse::Quantity::length:
      return {lengths.at(at), units::mm};
    case LimitUse::Quantity::angle:
      return {angles.at(at), units::deg};
    case LimitUse::Quantity::share:
      break;
  }
  return {"", 1.0};
}

Json uses_json(const SmoothMethod& method) {
  Json rows = Json::array();
  for (const LimitUse& use : method.uses) {
    const Unit unit = unit_of(use.quantity, use.order);
    rows.push_back({{"what", text(use.what)},
                    {"unit", unit.text},
                    {"max", number(use.max, unit.si)},
                    {"limit", number(use.limit, unit.si)},
                    {"share", number(use.max / use.limit)},
                    {"violations", use.violations},
                    {"at_s", number(use.at_s)},
                    {"block", use.block > 0 ? Json(use.block) : Json(nullptr)}});
  }
  return rows;
}

Json joint_json(const JointMotion& joint, bool points) {
  const double unit = joint.prismatic ? units::mm : units::deg;
  const bool tracked = joint.tracking_error.low.size() > 0;
  return {{"unit", joint.prismatic ? "mm" : "°"},
          {"velocity", band_json(joint.velocity, points, unit)},
          {"acceleration", band_json(joint.acceleration, points, unit)},
          {"jerk", band_json(joint.jerk, points, unit)},
          {"tracking_error", tracked ? band_json(joint.tracking_error, points, unit) : Json(nullptr)},
          {"max_velocity", number(joint.max_velocity, unit)},
          {"max_acceleration", number(joint.max_acceleration, unit)},
          {"max_jerk", number(joint.max_jerk, unit)}};
}

Json way_json(const Eigen::Matrix3Xd& way) {
  return {{"x_mm", numbers(way.row(0).transpose(), units::mm)},
          {"y_mm", numbers(way.row(1).transpose(), units::mm)},
          {"z_mm", numbers(way.row(2).transpose(), units::mm)}};
}

Json flat_json(const Eigen::Matrix2Xd& way) {
  return {{"x_mm", numbers(way.row(0).transpose(), units::mm)}, {"y_mm", numbers(way.row(1).transpose(), units::mm)}};
}

Json motion_json(const Motion& motion) {
  const bool points = is_single(motion.tip_speed_m_per_s);
  Json joints = Json::array();
  for (const JointMotion& joint : motion.joints) joints.push_back(joint_json(joint, points));
  Json track = way_json(motion.tip_m);
  track["speed_mm_per_s"] = numbers(motion.tip_speed_at_m_per_s, units::mm);
  return {{"time_s", run_times_json(motion.tip_speed_m_per_s.low.size(), points, motion.run_s)},
          {"tip_speed_mm_per_s", band_json(motion.tip_speed_m_per_s, points, units::mm)},
          {"axis_speed_deg_per_s", band_json(motion.axis_speed_rad_per_s, points, units::deg)},
          {"joints", std::move(joints)},
          {"track", std::move(track)}};
}

Json method_json(const SmoothMethod& method) {
  std::size_t violations = 0;
  for (const LimitUse& use : method.uses) violations += use.violations;
  return {{"name", text(method.name)},
          {"duration_s", number(method.duration_s)},
          {"lower_bound_s", number(method.lower_bound_s)},
          {"violations", violations},
          {"tip_error_um", number(method.tip_error_m, units::um)},
          {"axis_error_deg", number(method.axis_error_rad, units::deg)},
          {"joint_share", number(method.joint_share)},
          {"tracking_error_deg", number(method.tracking_error_rad, units::deg)},
          {"tracking_error_um", number(method.tracking_error_m, units::um)},
          {"sum_t2_s", number(method.sum_t2_s)},
          {"rounds", method.rounds},
          {"plan_s", number(method.plan_s)},
          {"sample_us", number(method.sample_s, units::us)},
          {"samples", method.samples},
          {"uses", uses_json(method)},
          {"motion", motion_json(method.motion)}};
}

Json corners_json(const std::vector<CornerView>& corners) {
  Json list = Json::array();
  for (const CornerView& corner : corners) {
    Json ways = Json::array();
    for (const Eigen::Matrix2Xd& way : corner.tip_m) ways.push_back(flat_json(way));
    list.push_back({{"block", corner.block},
                    {"line", corner.line},
                    {"turn_deg", number(corner.turn_rad, units::deg)},
                    {"radius_mm", number(corner.radius_m, units::mm)},
                    {"program", flat_json(corner.program_m)},
                    {"corner_paths", std::move(ways)}});
  }
  return list;
}

}  // namespace

Json smooth_json(const Smooth& smooth) {
  Json methods = Json::array();
  for (const SmoothMethod& method : smooth.methods) methods.push_back(method_json(method));
  return {{"facts", facts_json(smooth.facts)},
          {"warnings", texts(smooth.warnings)},
          {"notes", texts(smooth.notes)},
          {"skipped", texts(smooth.skipped)},
          {"blocks", smooth.blocks},
          {"tip_tolerance_mm", number(smooth.tip_tolerance_m, units::mm)},
          {"max_tip_speed_mm_per_s", number(smooth.max_tip_speed_m_per_s, units::mm)},
          {"max_axis_speed_deg_per_s", number(smooth.max_axis_speed_rad_per_s, units::deg)},
          {"program", way_json(smooth.program_m)},
          {"methods", std::move(methods)},
          {"corners", corners_json(smooth.corners)}};
}

}  // namespace robomill::report
