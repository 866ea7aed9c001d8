#include "robomill/process/in_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/posture_choice.hpp"
#include "robomill/io/note_lines.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/process/smooth.hpp"

namespace robomill::process {
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

void add_revolution(std::string& out, const RevolutionForces& revolution, bool on_workpiece) {
  const double sign = on_workpiece ? -1.0 : 1.0;
  const cutting::CuttingForce& force = revolution.deflected.force;
  append(out, "{:<12} {:>10} {:>10} {:>10}   on the {}, feed frame\n", "", "x", "y", "z",
         on_workpiece ? "workpiece" : "tool");
  add_vector(out, "mean", sign * force.mean_n);
  if (revolution.rigid) add_vector(out, "mean, rigid", sign * revolution.rigid->mean_n);
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

/// "12.3": a dash for what was not measured.
std::string or_dash(double value) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value) : "–";
}

void add_measured(std::string& out, const MeasuredRevolution& measured) {
  const cutting::MeasuredForce& m = measured.force;
  append(out, "measured     {}: {} revolutions from {:.4g} to {:.4g} s; {:.2f} ± {:.2g} rpm\n",
         printable(measured.path.filename().string()), m.revolutions, m.from_s, m.to_s,
         m.spindle_speed_rad_per_s / units::rpm, m.spindle_speed_deviation_rad_per_s / units::rpm);
  const auto row = [&out](const char* label, const Eigen::Vector3d& v, const char* unit, double factor = 1.0) {
    append(out, "  {:<18} {:>10} {:>10} {:>10} {}\n", label, or_dash(factor * v.x()), or_dash(factor * v.y()),
           or_dash(factor * v.z()), unit);
  };
  row("mean, measured", m.mean_n, "N");
  row("mean, predicted", m.predicted_mean_n, "N");
  row("peak, measured", m.peak_n, "N");
  row("peak, predicted", m.predicted_peak_n, "N");
  row("rms, measured", m.rms_n, "N");
  row("error, rms", m.error_n, "N");
  row("… of measured rms", m.error_ratio, "%", 100.0);
  row("… without means", m.shape_error_ratio, "%", 100.0);
  row("record's scatter", m.scatter_n, "N, of single revolutions about their mean");
  row("tooth to tooth", m.between_teeth_n, "N, rms of what differs between teeth");
  row("drift", m.drift_n, "N over the stretch, taken out about its middle");
}

/// One block with its largest values.
void add_block(std::string& out, const ProgramForces& program, const char* label, const BlockResult& row) {
  const bool bends = row.joints.size() > 0;
  append(out, "{:<12} {:>6} {:>10.4g} {:>10.3g} {:>10.4g} {:>10.4g} {:>10} {:>10.3g}\n", label,
         program.program.blocks[row.force.block].line, row.force.peak_force_n, row.force.revolution_torque_n_m,
         row.force.peak_power_w, row.force.sustained_power_w,
         bends ? fmt::format("{:.4g}", row.peak_deflection_m.norm() / units::um) : "–",
         row.force.axial_depth_m / units::mm);
}

void add_program(std::string& out, const ProgramForces& program, double power_time_s) {
  const auto highest = [&](auto value) -> const BlockResult& {
    return *std::ranges::max_element(program.blocks, {}, [&](const BlockResult& row) { return value(row); });
  };
  append(out, "{} blocks, {} of them cut; {:.4g} mm³ removed; {:.2f} s\n", program.blocks.size(),
         program.cutting_blocks(), program.removed_volume_m3 / units::mm3, program.seconds);
  if (program.stock && !program.stock->assumed) append(out, "stock        {}\n", stock_text(program));
  append(out, "{:<12} {:>6} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "the block of", "line", "force N",
         "torque Nm", "power W", "power W", "bends µm", "depth mm");
  append(out, "{:<12} {:>6} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "", "", "peak", "1 turn", "1 turn",
         fmt::format("{:.4g} s", power_time_s), "1 turn", "");
  add_block(out, program, "most force", highest([](const BlockResult& r) { return r.force.peak_force_n; }));
  add_block(out, program, "most torque", highest([](const BlockResult& r) { return r.force.revolution_torque_n_m; }));
  add_block(out, program, "most power", highest([](const BlockResult& r) { return r.force.sustained_power_w; }));
  if (program.blocks.front().joints.size() == 0) return;
  add_block(out, program, "most bend", highest([](const BlockResult& r) { return r.peak_deflection_m.norm(); }));
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
           by.summary.duration_s, by.summary.check.violations(), 100.0 * joint_share(by.summary.check),
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

}  // namespace

std::string summary(const ForcesResult& result) {
  std::string out;
  if (result.revolution) add_revolution(out, *result.revolution, result.cut.on_workpiece);
  if (result.measured) add_measured(out, *result.measured);
  if (result.program) add_program(out, *result.program, result.cut.power_time_s);
  io::add_notes(out, result.warnings, "warning      ");
  io::add_notes(out, result.notes, "note         ");
  return out + assumed_text(result.assumed);
}

std::string summary(const SmoothResult& result) {
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

std::string shortfall(const ForcesResult& result) {
  if (!result.revolution) return {};
  const RevolutionForces& revolution = *result.revolution;
  if (revolution.deflected.status != cutting::StaticDeflection::Status::found) {
    return "there is no static deflection of the robot";
  }
  const bool undecided = revolution.vibration && revolution.vibration->verdict == simulation::Verdict::undecided;
  return undecided ? "the vibration is neither stable nor chatter as far as it was simulated" : "";
}

std::string shortfall(const SmoothResult& result) {
  if (result.holds()) return {};
  std::string what = "the trajectory breaks limits";
  if (!result.clear()) {
    what = path::clearance_text(*result.smoothed.clearance);
  } else if (result.trajectory_holds() && !result.smoothed.robot_program->one_speed()) {
    what = "the robot program carries out one spindle speed of several, see the notes";
  } else if (result.trajectory_holds()) {
    what = result.smoothed.robot_program->too_long() ? "the robot program is too long for its controller, see the notes"
                                                     : "the robot program leaves its tolerances, see the notes";
  }
  if (!result.output.empty() && !result.smoothed.written) {
    what += "; it was not written";
    if (result.stale) what += fmt::format(", and the {} of an earlier run was removed", result.output.string());
  }
  return what;
}

}  // namespace robomill::process
