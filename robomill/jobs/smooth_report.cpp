#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/jobs/smooth.hpp"

namespace robomill::jobs {
namespace {

using report::LimitUse;

void add_use(std::vector<LimitUse>& uses, std::string what, LimitUse::Quantity quantity, int order,
             const path::Usage& usage) {
  uses.push_back({.what = std::move(what),
                  .quantity = quantity,
                  .order = order,
                  .max = usage.max,
                  .limit = usage.limit > 0.0 ? usage.limit : report::missing,
                  .violations = usage.violations,
                  .at_s = usage.at_s,
                  .block = usage.block + 1});
}

std::vector<LimitUse> uses_of(const path::CheckResult& check, const std::array<bool, 6>& prismatic) {
  using enum LimitUse::Quantity;
  std::vector<LimitUse> uses;
  add_use(uses, "tip, distance to the program", length, 0, check.tip_error_m);
  add_use(uses, "axis, angle to the program", angle, 0, check.axis_error_rad);
  add_use(uses, "tip, speed over the programmed", share, 0, check.feed);
  add_use(uses, "tip, speed", length, 1, check.tip_velocity);
  add_use(uses, "tip, acceleration", length, 2, check.tip_acceleration);
  add_use(uses, "tip, jerk", length, 3, check.tip_jerk);
  add_use(uses, "axis, speed", angle, 1, check.axis_velocity);
  add_use(uses, "axis, acceleration", angle, 2, check.axis_acceleration);
  add_use(uses, "axis, jerk", angle, 3, check.axis_jerk);
  for (std::size_t i = 0; i < check.joints.size(); ++i) {
    const path::CheckResult::Joint& joint = check.joints[i];
    const LimitUse::Quantity quantity = prismatic.at(i) ? length : angle;
    if (joint.position.violations > 0) {
      add_use(uses, fmt::format("joint {}, beyond its range", i + 1), quantity, 0, joint.position);
    }
    add_use(uses, fmt::format("joint {}, velocity", i + 1), quantity, 1, joint.velocity);
    add_use(uses, fmt::format("joint {}, acceleration", i + 1), quantity, 2, joint.acceleration);
    add_use(uses, fmt::format("joint {}, jerk", i + 1), quantity, 3, joint.jerk);
  }
  return uses;
}

double known(double value) {
  return value > 0.0 ? value : report::missing;
}

report::SmoothMethod method_report(const path::SmoothedBy& by, const std::array<bool, 6>& prismatic) {
  const path::Summary& summary = by.summary;
  report::SmoothMethod out;
  out.name = path::name_of(by.method);
  out.duration_s = summary.duration_s;
  out.lower_bound_s = known(summary.lower_bound_s);
  out.sum_t2_s = known(summary.sum_t2_s);
  out.plan_s = known(summary.plan_s);
  out.sample_s = summary.samples > 0 ? known(summary.emit_s / static_cast<double>(summary.samples)) : report::missing;
  out.samples = summary.samples;
  out.rounds = summary.rounds;
  out.tip_error_m = summary.check.tip_error_m.max;
  out.axis_error_rad = summary.check.axis_error_rad.max;
  out.joint_share = joint_share(summary.check);
  for (std::size_t i = 0; i < by.tracking_error.size(); ++i) {
    double& worst = prismatic.at(i) ? out.tracking_error_m : out.tracking_error_rad;
    worst = std::fmax(worst, by.tracking_error[i]);
  }
  out.uses = uses_of(summary.check, prismatic);
  return out;
}

std::vector<report::Fact> facts_of(const SmoothResult& result) {
  const path::SmoothingOptions& options = result.options;
  std::vector<report::Fact> facts = {
      {"Program", fmt::format("{}, {} blocks", result.smoothed.program, result.first().summary.blocks)},
      {"Machine", fmt::format("{}, {} joints", result.smoothed.cell, result.first().summary.check.joints.size())},
      {"Tolerance", fmt::format("tip {:.4g} mm, axis {:.4g}°", options.tip_tolerance_m / units::mm,
                                options.axis_tolerance_rad / units::deg)}};
  const std::vector<double>& gamma = result.posture.posture.gamma_rad;
  if (result.turns_about_axis && !gamma.empty()) {
    facts.push_back({"Turn about the tool", gamma.size() > 1 ? std::string("along the way")
                                                             : fmt::format("{:.4g}°", gamma.front() / units::deg)});
  }
  return facts;
}

}  // namespace

report::Smooth smooth_report(const SmoothResult& result) {
  report::Smooth out;
  out.facts = facts_of(result);
  if (result.trajectory_holds() && !result.holds()) {
    out.warnings.push_back(
        fmt::format("The robot program does not hold, see the notes{}",
                    result.smoothed.written ? "; it was written all the same." : "; it was not written."));
  }
  if (!result.trajectory_holds()) {
    out.warnings.push_back(fmt::format(
        "{} violations of limits{}.", result.first().summary.check.violations(),
        result.smoothed.written ? "; the trajectory was written all the same" : ": there is no trajectory"));
  }
  out.notes = result.smoothed.notes;
  for (const program::Skipped& item : result.smoothed.skipped) {
    out.skipped.push_back(fmt::format("line {}: {}", item.line, item.what));
  }
  out.tip_tolerance_m = result.options.tip_tolerance_m;
  out.max_tip_speed_m_per_s = result.options.max_velocity_m_per_s;
  out.max_axis_speed_rad_per_s = result.options.max_angular_velocity_rad_per_s;
  out.blocks = result.first().summary.blocks;
  out.program_m = result.outline.path_m;
  for (std::size_t i = 0; i < result.smoothed.methods.size(); ++i) {
    out.methods.push_back(method_report(result.smoothed.methods[i], result.smoothed.prismatic));
    if (i < result.motions.size()) out.methods.back().motion = result.motions[i];
  }
  for (std::size_t k = 0; k < result.outline.corners.size(); ++k) {
    const report::ProgramCorner& corner = result.outline.corners[k];
    report::CornerView view = {.block = corner.block + 1,
                               .line = corner.line,
                               .turn_rad = corner.turn_rad,
                               .radius_m = corner.radius_m,
                               .program_m = corner.vertices_m};
    for (const std::vector<Eigen::Matrix2Xd>& paths : result.corner_paths) view.tip_m.push_back(paths[k]);
    out.corners.push_back(std::move(view));
  }
  return out;
}

}  // namespace robomill::jobs
