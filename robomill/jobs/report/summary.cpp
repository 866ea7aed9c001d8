#include "robomill/jobs/report/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/posture_choice.hpp"
#include "robomill/io/note_lines.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/jobs/smooth.hpp"
#include "robomill/process/forces.hpp"

namespace robomill::jobs {
namespace {

using io::append;

void add_vector(std::string& out, const char* label, const Eigen::Vector3d& v) {
  append(out, "{:<12} {:>10.4g} {:>10.4g} {:>10.4g} N\n", label, v.x(), v.y(), v.z());
}

void add_vibration(std::string& out, const simulation::Simulation& vibration) {
  append(out, "vibration    {}", to_string(vibration.verdict));
  if (vibration.chatter_frequency_hz > 0.0) {
    append(out, " at {:.1f} Hz, {:.3g} µm", vibration.chatter_frequency_hz, vibration.chatter_amplitude_m / units::um);
  }
  if (vibration.small.status == simulation::SmallVibration::Status::found) {
    append(out, ", |μ| = {:.4f}", vibration.small.spectral_radius);
  }
  append(out, "\n");
}

void add_revolution(std::string& out, const process::RevolutionForces& revolution, bool on_workpiece) {
  const double sign = on_workpiece ? -1.0 : 1.0;
  const cutting::CuttingForce& force = revolution.deflected.force;
  append(out, "{:<12} {:>10} {:>10} {:>10}   on the {}, feed frame\n", "", "x", "y", "z",
         on_workpiece ? "workpiece" : "tool");
  add_vector(out, "mean", sign * force.mean_n);
  add_vector(out, "peak", sign * force.peak_n);
  add_vector(out, "rms", force.rms_n);
  append(out, "torque       mean {:.4g}, peak {:.4g} N·m\n", force.mean_torque_n_m, force.peak_torque_n_m);
  append(out, "power        mean {:.4g} W; removal {:.4g} mm³/s\n", force.power_w,
         force.removal_rate_m3_per_s / units::mm3);
  if (revolution.posture) {
    const Eigen::Vector3d q = revolution.deflected.deflection_m / units::um;
    append(out, "deflection   {:.4g}, {:.4g}, {:.4g} µm under the mean force; depth left {:.6g} mm\n", q.x(), q.y(),
           q.z(), revolution.deflected.cut.axial_depth_m / units::mm);
  }
  if (revolution.spindle_rotation && revolution.spindle_rotation->status == robot::Redundancy::Status::found) {
    append(out, "best γ       {:.1f}°: {:.4g} µm\n", revolution.spindle_rotation->best.gamma_rad / units::deg,
           revolution.spindle_rotation->best.error_m.norm() / units::um);
  }
  if (revolution.vibration) add_vibration(out, *revolution.vibration);
}

/// One block with its largest values.
void add_block(std::string& out, const process::ProgramForces& program, const char* label,
               const process::BlockResult& row) {
  const bool bends = row.joints.size() > 0;
  append(out, "{:<12} {:>6} {:>10.4g} {:>10.3g} {:>10.4g} {:>10.4g} {:>10} {:>10.3g}\n", label,
         program.program.blocks[row.force.block].line, row.force.peak_force_n, row.force.revolution_torque_n_m,
         row.force.peak_power_w, row.force.sustained_power_w,
         bends ? fmt::format("{:.4g}", row.peak_deflection_m.norm() / units::um) : "–",
         row.force.axial_depth_m / units::mm);
}

void add_program(std::string& out, const process::ProgramForces& program, double power_time_s) {
  const auto highest = [&](auto value) {
    return *std::ranges::max_element(program.blocks, {}, [&](const process::BlockResult& row) { return value(row); });
  };
  append(out, "{} blocks, {} of them cut; {:.4g} mm³ removed; {:.2f} s\n", program.blocks.size(),
         program.cutting_blocks(), program.removed_volume_m3 / units::mm3, program.seconds);
  if (program.stock && !program.stock->assumed) append(out, "stock        {}\n", process::stock_text(program));
  append(out, "{:<12} {:>6} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "the block of", "line", "force N",
         "torque Nm", "power W", "power W", "bends µm", "depth mm");
  append(out, "{:<12} {:>6} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "", "", "peak", "1 turn", "1 turn",
         fmt::format("{:.4g} s", power_time_s), "1 turn", "");
  add_block(out, program, "most force", highest([](const process::BlockResult& r) { return r.force.peak_force_n; }));
  add_block(out, program, "most torque",
            highest([](const process::BlockResult& r) { return r.force.revolution_torque_n_m; }));
  add_block(out, program, "most power",
            highest([](const process::BlockResult& r) { return r.force.sustained_power_w; }));
  if (program.blocks.front().joints.size() == 0) return;
  add_block(out, program, "most bend",
            highest([](const process::BlockResult& r) { return r.peak_deflection_m.norm(); }));
}

/// "43 %", or "–" without a limit; "!" behind what breaks it.
std::string share(const path::Usage& usage) {
  if (!(usage.limit > 0.0)) return "–";
  return fmt::format("{:.1f} %{}", 100.0 * usage.max / usage.limit, usage.violations > 0 ? " !" : "");
}

void add_row(std::string& out, const char* name, const std::array<std::string, 4>& cells,
             const std::string& more = {}) {
  append(out, "{:<10}{:>12}{:>14}{:>12}{:>12}  {}\n", name, cells[0], cells[1], cells[2], cells[3], more);
}

void add_check(std::string& out, const path::SmoothedBy& by) {
  const path::CheckResult& check = by.summary.check;
  add_row(out, "", {"velocity", "acceleration", "jerk", "tolerance"}, "of the limits");
  add_row(out, "tip",
          {share(check.tip_velocity), share(check.tip_acceleration), share(check.tip_jerk), share(check.tip_error_m)},
          fmt::format("{:.4g} mm from the program; {:.1f} % of the feed", check.tip_error_m.max / units::mm,
                      100.0 * check.feed.max));
  add_row(
      out, "axis",
      {share(check.axis_velocity), share(check.axis_acceleration), share(check.axis_jerk), share(check.axis_error_rad)},
      fmt::format("{:.4g}° from the program", check.axis_error_rad.max / units::deg));
  for (std::size_t i = 0; i < check.joints.size(); ++i) {
    const path::CheckResult::Joint& joint = check.joints[i];
    std::string more;
    if (joint.position.violations > 0) more = "beyond its range";
    add_row(out, fmt::format("joint {}", i + 1).c_str(),
            {share(joint.velocity), share(joint.acceleration), share(joint.jerk), ""}, more);
  }
}

void add_methods(std::string& out, const path::SmoothedProgram& smoothed) {
  append(out, "\n{:<18}{:>12}{:>12}{:>14}{:>14}{:>12}\n", "", "duration", "violations", "joint limits", "tip error",
         "planned in");
  for (const path::SmoothedBy& by : smoothed.methods) {
    append(out, "{:<18}{:>10.3f} s{:>12}{:>12.1f} %{:>11.4g} mm{:>10.3f} s\n", name_in(path::method_names, by.method),
           by.summary.duration_s, by.summary.check.violations(), 100.0 * process::joint_share(by.summary.check),
           by.summary.check.tip_error_m.max / units::mm, by.summary.plan_s);
  }
}

/// What a controller makes of the points of a joint program.
void add_run(std::string& out, const path::ProgramRun& run) {
  const double shortest = run.shortest_step_s / units::ms, longest = run.longest_step_s / units::ms;
  append(out, "\nrobot program  {} points, ", run.points);
  if (shortest == longest) {
    append(out, "one every {:.4g} ms", longest);
  } else {
    append(out, "{:.4g} to {:.4g} ms apart", shortest, longest);
  }
  append(out,
         "; joints interpolated between them: {:.4g} mm and {:.4g}° from the program, {:.4g} mm and {:.4g}° from the "
         "trajectory\n",
         run.distances.tip_error_m / units::mm, run.distances.axis_error_rad / units::deg,
         run.distances.tip_deviation_m / units::mm, run.distances.axis_deviation_rad / units::deg);
}

void add_operation(std::string& out, const char* label, const decision::Operation& op) {
  append(out, "{:<12} {:>7.0f} rpm  {:.3f} mm  {:.3g} mm/tooth  {:.4g} mm³/s  limited by {}\n", label,
         op.spindle_speed_rad_per_s / units::rpm, op.axial_depth_m / units::mm, op.feed_per_tooth_m / units::mm,
         op.removal_rate_m3_per_s / units::mm3, decision::limited_by_text(op));
}

/// What else to know of the recommended one.
void add_details(std::string& out, const decision::Operation& op) {
  append(
      out, "             cutting speed {:.4g} m/min, feed {:.4g} mm/min, mean torque {:.3g} N·m, mean power {:.3g} W\n",
      op.cutting_speed_m_per_s * units::minute, op.feed_m_per_s / units::mm * units::minute, op.torque_n_m, op.power_w);
  if (std::isfinite(op.vibration.amplitude_m)) {
    append(out, "             forced vibration {:.3g} µm about the mean, most of it at {:.1f} Hz\n",
           op.vibration.amplitude_m / units::um, op.vibration.frequency_hz);
  }
  if (!std::isfinite(op.peak_deflection_m)) return;
  const std::string error = std::isfinite(op.surface_error_m)
                                ? fmt::format("surface error {:+.3g} µm, ", op.surface_error_m / units::um)
                                : std::string();
  append(out, "             {}peak deflection {:.3g} µm, the mean one included\n", error,
         op.peak_deflection_m / units::um);
}

/// On top: nothing that follows is worth more than the model.
void add_disagreement(std::string& out, const decision::Agreement& count) {
  if (count.disagree == 0) return;
  append(out, "test cuts    {} of {} disagree with the prediction: find out why before you use these numbers\n",
         count.disagree, count.agree + count.disagree);
}

/// Blocks that are stable by the mean prediction and not by its 5 % quantile.
std::string uncertain_text(std::size_t blocks) {
  return blocks > 0 ? fmt::format(" by the mean prediction, {} more may, within its uncertainty", blocks)
                    : std::string();
}

/// How many blocks chatter, first of all.
void add_blocks(std::string& out, const process::ForcesResult& forces, const process::ProgramBlocks& blocks) {
  const auto within = [](const process::BlockRow& row) {
    return row.cuts && !row.unstable() && row.stability_margin < 0.0;
  };
  append(out, "blocks       {} of {} that cut are unstable{}", blocks.unstable, blocks.cutting,
         uncertain_text(static_cast<std::size_t>(std::ranges::count_if(blocks.rows, within))));
  if (blocks.cutting == 0) {
    append(out, "\n");
    return;
  }
  const process::BlockRow& worst = blocks.rows[blocks.worst];
  append(out, "; the worst, gain margin {}, is in line {} (block {}): {:.4g} mm deep, ",
         std::isfinite(worst.stability.at.gain_margin) ? fmt::format("{:.3g}", worst.stability.at.gain_margin)
                                                       : "without end",
         forces.program->program.blocks[blocks.worst].line, blocks.worst + 1, worst.axial_depth_m / units::mm);
  if (worst.stability.limited()) {
    append(out, "limit {:.4g} mm, {} at {:.4g} Hz", worst.stability.at.limit_depth_m / units::mm,
           to_string(worst.stability.regime), worst.stability.chatter_frequency_hz());
  } else {
    append(out, "no limit up to {:.4g} mm", worst.stability.searched_depth_m[1] / units::mm);
  }
  append(out, "\n             {} evaluations in {:.2f} s\n", blocks.evaluations, blocks.seconds);
}

/// Rejected speeds beyond these are counted.
constexpr std::size_t most_rejected = 6;

void add_decision(std::string& out, const PlanResult& result) {
  const process::Decision& decision = *result.decision;
  const process::Outcome& before = decision.as_programmed;
  const auto rpm = [](const process::Outcome& o) {
    const double low = o.lowest_spindle_speed_rad_per_s / units::rpm;
    const double high = o.highest_spindle_speed_rad_per_s / units::rpm;
    return low == high ? fmt::format("{:.0f} rpm", low) : fmt::format("{:.0f} to {:.0f} rpm", low, high);
  };
  const auto add = [&](const char* word, const process::Outcome& o) {
    append(out, "{} {}, {:.4g} s of cutting at the feeds{}\n", word, rpm(o), o.cutting_time_s,
           std::isfinite(o.robot_time_s) ? fmt::format(", {:.4g} s the robot's time for the program", o.robot_time_s)
                                         : "");
    append(out, "             least stability margin {:.2f} of the limits' 5 % quantile; {} blocks chatter{}\n",
           o.least_stability_margin, o.unstable_blocks, uncertain_text(o.uncertain_blocks));
    for (const process::Violation& v : o.violations) {
      append(out, "               {} in block {}\n", process::limit_text(v), v.block + 1);
    }
  };
  add("as programmed", before);
  if (decision.decided) {
    add("as decided   ", *decision.decided);
    const bool robot = std::isfinite(before.robot_time_s) && before.robot_time_s > 0.0;
    const double share = (robot ? decision.decided->robot_time_s / before.robot_time_s
                                : decision.decided->cutting_time_s / before.cutting_time_s) -
                         1.0;
    append(out, "             {:.0f} % {} of {}\n", 100.0 * std::abs(share), share <= 0.0 ? "less" : "more",
           robot ? "the robot's time for the program"
                 : "the cutting time at the feeds; what the robot takes is not known without [smoothing] in the cell");
    append(out, "             collisions {}\n", collisions_checked(result) ? "checked" : "not checked");
    append(out, "             {} changes of S, {} of F, {} lines of {} changed; {} cuts looked at, {} runs, {:.3g} s\n",
           decision.speeds_changed, decision.feeds_changed,
           result.decided->text ? result.decided->text->changed_lines : 0, result.decided->name, decision.evaluations,
           decision.exact_runs, decision.seconds);
  } else {
    append(out, "no conditions: {}\n", decision.reason);
  }
  for (std::size_t i = 0; i < std::min(most_rejected, decision.alternatives.size()); ++i) {
    const process::RejectedAlternative& one = decision.alternatives[i];
    append(out, "rejected      {:.0f} rpm: {}, block {}\n", one.speed.spindle_speed_rad_per_s / units::rpm,
           process::limit_text(one.speed.stopped_by), one.block + 1);
  }
  if (decision.alternatives.size() > most_rejected) {
    append(out, "              {} more in plan.json\n", decision.alternatives.size() - most_rejected);
  }
}

}  // namespace

std::string summary(const PlanResult& result) {
  std::string out;
  if (result.decision) add_decision(out, result);
  const PlannedProgram& shown = result.shown();
  if (shown.blocks) add_blocks(out, *shown.forces, *shown.blocks);
  const decision::Agreement count = decision::agreement(result.cuts);
  add_disagreement(out, count);
  if (result.hits) {
    for (const modal::HitVerdict& hit : result.hits->hits) {
      if (hit.accepted) continue;
      append(out, "rejected     {}: {}\n", printable(hit.file), hit.reasons.empty() ? "" : hit.reasons.front());
    }
  }
  if (result.prediction && !result.prediction->peaks.empty()) {
    const coupling::TipPeak& first = result.prediction->peaks.front();
    append(out, "predicted    first peak of {} at {:.1f} Hz, {:.3g} µm/N\n", modal::to_string(first.name),
           first.frequency_hz, first.receptance_m_per_n / units::um);
  }
  if (result.recommendation.recommended) {
    add_operation(out, "recommended", *result.recommendation.recommended);
    add_details(out, *result.recommendation.recommended);
    for (const decision::Operation& op : result.recommendation.alternatives) add_operation(out, "alternative", op);
  } else if (result.recommends() || !result.recommendation.reason.empty()) {
    append(out, "{}: {}\n", result.has_lobes() ? "no safe depth" : "no answer", result.recommendation.reason);
  }
  if (shown.path) {
    const path::Summary& smoothed = shown.path->first().summary;
    append(out, "program      {:.3f} s for {} blocks; {} violations of limits\n", smoothed.duration_s, smoothed.blocks,
           smoothed.check.violations());
  }
  if (!result.cuts.empty()) {
    append(out, "test cuts    {} agree, {} disagree, {} without a result\n", count.agree, count.disagree,
           count.not_compared);
  }
  if (shown.blocks) io::add_notes(out, process::block_warnings(*shown.forces, *shown.blocks), "warning      ");
  if (shown.forces) io::add_notes(out, shown.forces->warnings, "warning      ");
  io::add_notes(out, result.warnings, "warning      ");
  io::add_notes(out, result.notes, "note         ");
  if (shown.blocks) io::add_notes(out, process::block_notes(*shown.blocks), "note         ");
  if (result.decision) io::add_notes(out, result.decision->notes, "note         ");
  return out + assumed_text(result.assumed);
}

std::string summary(const process::ForcesResult& result) {
  std::string out;
  if (result.revolution) add_revolution(out, *result.revolution, result.cut.on_workpiece);
  if (result.program) add_program(out, *result.program, result.cut.power_time_s);
  io::add_notes(out, result.warnings, "warning      ");
  io::add_notes(out, result.notes, "note         ");
  return out + assumed_text(result.assumed);
}

std::string summary(const process::SmoothResult& result) {
  std::string out;
  const path::SmoothedBy& by = result.first();
  const path::Summary& run = by.summary;
  append(out, "{}  {:.3f} s", name_in(path::method_names, by.method), run.duration_s);
  if (run.lower_bound_s > 0.0) append(out, " (bound {:.3f} s)", run.lower_bound_s);
  append(out, " for {} blocks; {} samples; planned in {:.3g} s", run.blocks, run.samples, run.plan_s);
  if (run.rounds > 1) append(out, ", {} rounds", run.rounds);
  append(out, "\n");
  if (result.smoothed.posture) {
    append(out, "starts at {}\n",
           cell::posture_text(*result.smoothed.posture, static_cast<int>(run.check.joints.size()),
                              result.smoothed.prismatic));
  }
  append(out, "\n");
  add_check(out, by);
  if (result.smoothed.methods.size() > 1) add_methods(out, result.smoothed);
  if (result.smoothed.robot_program) add_run(out, *result.smoothed.robot_program);
  append(out, "\n{} violations of limits\n", run.check.violations());
  append(out, "collisions {}\n",
         result.smoothed.clearance ? printable(path::clearance_text(*result.smoothed.clearance)) : "not checked");
  for (const program::Skipped& item : result.smoothed.skipped)
    append(out, "skipped    line {}: {}\n", item.line, printable(item.what));
  io::add_notes(out, result.smoothed.notes, "note       ");
  return out + assumed_text(result.smoothed.assumed);
}

}  // namespace robomill::jobs
