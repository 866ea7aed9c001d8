#include "robomill/path/files/smooth_json.hpp"

#include <algorithm>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/json.hpp"
#include "robomill/path/files/smooth_object.hpp"

namespace robomill::path {
namespace {

io::Json place_json(const Usage& usage) {
  return {{"violations", usage.violations}, {"at_s", io::number(usage.at_s)}, {"block", usage.block + 1}};
}

/// Under "max_velocity_mm_per_s", "limit_velocity_mm_per_s" and "velocity".
/// @param suffix  of the unit
void add_usage(io::Json& json, const std::string& name, const char* suffix, const Usage& usage, double unit = 1.0) {
  json["max_" + name + suffix] = io::number(usage.max / unit);
  json["limit_" + name + suffix] = usage.limit > 0.0 ? io::number(usage.limit / unit) : io::Json();
  json[name] = place_json(usage);
}

io::Json joint_json(const CheckResult::Joint& joint, bool prismatic, const double* tracking_error) {
  io::Json json = {{"unit", prismatic ? "m" : "rad"}};
  add_usage(json, "velocity", "", joint.velocity);
  add_usage(json, "acceleration", "", joint.acceleration);
  add_usage(json, "jerk", "", joint.jerk);
  json["beyond_position"] = io::number(std::max(0.0, joint.position.max));
  json["position"] = place_json(joint.position);
  json["violations"] =
      joint.position.violations + joint.velocity.violations + joint.acceleration.violations + joint.jerk.violations;
  if (tracking_error != nullptr) json["max_tracking_error"] = io::number(*tracking_error);
  return json;
}

io::Json tip_json(const CheckResult& check) {
  io::Json json = io::Json::object();
  add_usage(json, "velocity", "_mm_per_s", check.tip_velocity, units::mm);
  add_usage(json, "acceleration", "_mm_per_s2", check.tip_acceleration, units::mm);
  add_usage(json, "jerk", "_mm_per_s3", check.tip_jerk, units::mm);
  add_usage(json, "error", "_mm", check.tip_error_m, units::mm);
  add_usage(json, "share_of_feed", "", check.feed);
  json["violations"] = check.tip_velocity.violations + check.tip_acceleration.violations + check.tip_jerk.violations +
                       check.tip_error_m.violations + check.feed.violations;
  return json;
}

io::Json axis_json(const CheckResult& check) {
  io::Json json = io::Json::object();
  add_usage(json, "velocity", "_deg_per_s", check.axis_velocity, units::deg);
  add_usage(json, "acceleration", "_deg_per_s2", check.axis_acceleration, units::deg);
  add_usage(json, "jerk", "_deg_per_s3", check.axis_jerk, units::deg);
  add_usage(json, "error", "_deg", check.axis_error_rad, units::deg);
  json["violations"] = check.axis_velocity.violations + check.axis_acceleration.violations +
                       check.axis_jerk.violations + check.axis_error_rad.violations;
  return json;
}

io::Json method_json(const SmoothedBy& smoothed, const std::array<bool, 6>& prismatic) {
  const Summary& summary = smoothed.summary;
  const CheckResult& check = summary.check;
  const double samples = static_cast<double>(std::max<std::size_t>(summary.samples, 1));
  io::Json json = {{"method", name_in(method_names, smoothed.method)}, {"duration_s", io::number(summary.duration_s)}};
  json["lower_bound_s"] = summary.lower_bound_s > 0.0 ? io::number(summary.lower_bound_s) : io::Json();
  json["max_tip_error_mm"] = io::number(check.tip_error_m.max / units::mm);
  json["max_axis_error_deg"] = io::number(check.axis_error_rad.max / units::deg);
  json["violations"] = check.violations();
  json["tip"] = tip_json(check);
  json["axis"] = axis_json(check);
  json["joints"] = io::Json::array();
  for (std::size_t i = 0; i < check.joints.size(); ++i) {
    const bool tracked = i < smoothed.tracking_error.size();
    json["joints"].push_back(
        joint_json(check.joints[i], prismatic.at(i), tracked ? &smoothed.tracking_error[i] : nullptr));
  }
  add_usage(json, "pose_error", "_mm", check.pose_error, units::mm);
  add_usage(json, "dwell_error", "_s", check.dwell_s);
  json["faulty_samples"] = check.faulty;
  json["blocks"] = summary.blocks;
  json["samples"] = summary.samples;
  json["rounds"] = summary.rounds;
  json["plan_seconds"] = io::number(summary.plan_s);
  json["microseconds_per_sample"] = io::number(summary.emit_s / samples / units::us);
  json["sum_t2_s"] = summary.sum_t2_s > 0.0 ? io::number(summary.sum_t2_s) : io::Json();
  json["largest_overlap_s"] = summary.largest_overlap_s > 0.0 ? io::number(summary.largest_overlap_s) : io::Json();
  return json;
}

io::Json speeds_json(const ProgramRun& run) {
  io::Json out = io::Json::array();
  for (const double speed : run.spindle_speeds_rad_per_s) out.push_back(io::number(speed / units::rpm));
  return out;
}

const char* status_text(robot::Clearance::Status status) {
  using Status = robot::Clearance::Status;
  switch (status) {
    case Status::too_near:
      return "too_near";
    case Status::gouge:
      return "gouge";
    case Status::collision:
      return "collision";
    case Status::clear:
      break;
  }
  return "clear";
}

io::Json clearance_json(const PathClearance& path) {
  const robot::Clearance& at = path.clearance;
  io::Json bodies = io::Json::array();
  if (!at.first.empty()) bodies = {at.first, at.second};
  return {{"status", status_text(at.status)},
          {"bodies", std::move(bodies)},
          {"least_distance_mm", at.first.empty() ? io::Json() : io::number(at.distance_m / units::mm)},
          {"depth_mm", io::number(at.depth_m / units::mm)},
          {"clearance_mm", io::number(path.required_m / units::mm)},
          {"looked_within_mm", io::number(path.reach_m / units::mm)},
          {"block", path.block + 1},
          {"line", path.line > 0 ? io::Json(path.line) : io::Json()},
          {"at_s", io::number(path.time_s)},
          {"positions", path.looks},
          {"most_between_mm", io::number(path.between_m / units::mm)},
          {"text", clearance_text(path)}};
}

io::Json run_json(const ProgramRun& run) {
  return {{"points", run.points},
          {"shortest_step_ms", io::number(run.shortest_step_s / units::ms)},
          {"longest_step_ms", io::number(run.longest_step_s / units::ms)},
          {"max_joint_deviation_deg", io::number(run.distances.joint_deviation_rad / units::deg)},
          {"max_tip_deviation_mm", io::number(run.distances.tip_deviation_m / units::mm)},
          {"max_axis_deviation_deg", io::number(run.distances.axis_deviation_rad / units::deg)},
          {"max_tip_error_mm", io::number(run.distances.tip_error_m / units::mm)},
          {"max_axis_error_deg", io::number(run.distances.axis_error_rad / units::deg)},
          {"limit_error_mm", io::number(run.tip_tolerance_m / units::mm)},
          {"limit_error_deg", io::number(run.axis_tolerance_rad / units::deg)},
          {"spindle_speeds_rpm", speeds_json(run)},
          {"most_points", run.most_points > 0 ? io::Json(run.most_points) : io::Json()},
          {"holds", run.holds()}};
}

}  // namespace

io::Json posture_object(const PostureChoice& choice, int joints, const std::array<bool, 6>& prismatic) {
  io::Json out = {{"joints", io::Json::array()}};
  for (int i = 0; i < joints; ++i) {
    const bool slides = prismatic.at(static_cast<std::size_t>(i));
    out["joints"].push_back({{"unit", slides ? "mm" : "deg"},
                             {"position", io::number(choice.posture.start(i) / (slides ? units::mm : units::deg))}});
  }
  const bool known = choice.resemblance && choice.resemblance->known;
  const auto as_at_home = [&](bool Resemblance::*part) {
    return known ? io::Json((*choice.resemblance).*part) : io::Json();
  };
  out["shoulder_as_at_home"] = as_at_home(&Resemblance::shoulder);
  out["elbow_as_at_home"] = as_at_home(&Resemblance::elbow);
  out["wrist_as_at_home"] = as_at_home(&Resemblance::wrist);
  out["whole_turns_from_home"] = choice.resemblance ? io::Json(choice.resemblance->turns) : io::Json();
  out["margin"] = io::number(choice.margin.least);
  out["margin_block"] = choice.margin.block + 1;
  out["margin_joint"] = choice.margin.joint < 0 ? io::Json() : io::Json(choice.margin.joint + 1);
  const std::string near = singularity_text(choice.at_margin);
  out["near_singularity"] = near.empty() ? io::Json() : io::Json(near);
  return out;
}

io::Json smooth_object(const SmoothedProgram& smoothed) {
  if (smoothed.methods.empty()) throw InvalidInput("methods", "must hold at least one");
  io::Json json = method_json(smoothed.methods.front(), smoothed.prismatic);
  json["written"] = smoothed.written;
  json["program"] = smoothed.program;
  json["cell"] = smoothed.cell;
  json["gamma_deg"] = io::Json();
  if (smoothed.gamma_rad) {
    const auto& [lowest, highest] = *smoothed.gamma_rad;
    json["gamma_deg"] = {io::number(lowest / units::deg), io::number(highest / units::deg)};
  }
  json["posture"] = io::Json();
  if (smoothed.posture) {
    const int joints = static_cast<int>(smoothed.methods.front().summary.check.joints.size());
    json["posture"] = posture_object(*smoothed.posture, joints, smoothed.prismatic);
  }
  json["skipped"] = io::Json::array();
  for (const program::Skipped& item : smoothed.skipped) {
    json["skipped"].push_back({{"line", item.line}, {"what", item.what}});
  }
  json["notes"] = smoothed.notes;
  json["assumed"] = io::assumed_json(smoothed.assumed);
  json["collisions"] = smoothed.clearance ? clearance_json(*smoothed.clearance) : io::Json();
  json["robot_program"] = smoothed.robot_program ? run_json(*smoothed.robot_program) : io::Json();
  if (smoothed.methods.size() > 1) {
    json["methods"] = io::Json::array();
    for (const SmoothedBy& method : smoothed.methods)
      json["methods"].push_back(method_json(method, smoothed.prismatic));
  }
  return json;
}

std::string smooth_json(const SmoothedProgram& smoothed) {
  return io::dump(smooth_object(smoothed));
}

}  // namespace robomill::path
