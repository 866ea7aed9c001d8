#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "robomill/base/units.hpp"
#include "robomill/jobs/forces.hpp"

namespace robomill::jobs {
namespace {

std::string cutter_text(const cutting::Cutter& cutter) {
  const char* kind = "general cutter";
  switch (cutter.kind) {
    case cutting::CutterKind::flat_end:
      kind = "flat end";
      break;
    case cutting::CutterKind::ball_end:
      kind = "ball end";
      break;
    case cutting::CutterKind::bull_nose:
      kind = "bull nose";
      break;
    case cutting::CutterKind::general:
      break;
  }
  return fmt::format("{}, {:.4g} mm, {} teeth, helix {:.3g}°", kind, cutter.mill.diameter_m / units::mm,
                     cutter.mill.teeth, cutter.mill.helix_rad / units::deg);
}

std::string verdict_text(const simulation::Simulation& s) {
  switch (s.verdict) {
    case simulation::Verdict::stable:
      return "stable";
    case simulation::Verdict::chatter:
      return "chatter";
    case simulation::Verdict::undecided:
      break;
  }
  return "undecided: the simulation was too short";
}

std::vector<report::EngagementRing> rings(const cutting::Engagement& engagement) {
  std::vector<report::EngagementRing> out;
  out.reserve(engagement.slices.size());
  for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
    report::EngagementRing ring = {.height_m = engagement.slices[i].height_m,
                                   .position_rad = engagement.slices[i].position_rad};
    for (const cutting::Arc& arc : engagement.of(i)) {
      ring.arcs.push_back({.entry_rad = arc.entry_rad, .exit_rad = arc.exit_rad});
    }
    out.push_back(std::move(ring));
  }
  return out;
}

report::ForceRevolution revolution_report(const RevolutionForces& revolution, bool on_workpiece) {
  const cutting::CuttingForce& force = revolution.deflected.force;
  const double sign = on_workpiece ? -1.0 : 1.0;
  report::ForceRevolution out;
  out.rotation_rad = force.rotation_rad;
  out.vibrating = revolution.vibrating_force_n.cols() > 0;
  out.force_n = sign * (out.vibrating ? revolution.vibrating_force_n : force.force_n);
  out.on_workpiece = on_workpiece;
  out.torque_n_m = force.torque_n_m;
  out.mean_n = sign * force.mean_n;
  out.peak_n = sign * force.peak_n;
  out.rms_n = force.rms_n;
  out.mean_torque_n_m = force.mean_torque_n_m;
  out.peak_torque_n_m = force.peak_torque_n_m;
  out.power_w = force.power_w;
  out.chip_area_m2 = force.chip_area_m2;
  out.removal_rate_m3_per_s = force.removal_rate_m3_per_s;
  out.engagement = rings(revolution.deflected.engagement);
  if (revolution.posture) {
    out.deflection_m = revolution.deflected.deflection_m;
    out.peak_deflection_m = revolution.deflected.peak_deflection_m;
  }
  if (revolution.vibration) {
    out.verdict = verdict_text(*revolution.vibration);
    if (revolution.vibration->chatter_frequency_hz > 0.0) {
      out.chatter_frequency_hz = revolution.vibration->chatter_frequency_hz;
    }
  }
  return out;
}

report::ForcePath path_report(const ProgramForces& program) {
  const auto n = static_cast<Eigen::Index>(program.blocks.size());
  report::ForcePath out;
  for (Eigen::VectorXd* column :
       {&out.block, &out.line, &out.path_m, &out.time_s, &out.axial_depth_m, &out.radial_depth_m, &out.peak_force_n,
        &out.torque_n_m, &out.peak_torque_n_m, &out.power_w}) {
    column->resize(n);
  }
  out.tip_m.resize(3, n);
  out.mean_force_n.resize(3, n);
  const bool bends = n > 0 && program.blocks.front().joints.size() > 0;
  if (bends) out.deflection_m.resize(n);
  double run = 0.0;
  double time = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const BlockResult& row = program.blocks[static_cast<std::size_t>(i)];
    const program::Block& block = program.program.blocks[row.force.block];
    run += (block.end.tip_m - program.program.begin_of(row.force.block).tip_m).norm();
    time += block.duration_s;
    out.block(i) = static_cast<double>(row.force.block + 1);
    out.line(i) = static_cast<double>(block.line);
    out.tip_m.col(i) = block.end.tip_m;
    out.path_m(i) = run;
    out.time_s(i) = time;
    out.axial_depth_m(i) = row.force.axial_depth_m;
    out.radial_depth_m(i) = row.force.radial_depth_m;
    out.peak_force_n(i) = row.force.peak_force_n;
    out.mean_force_n.col(i) = row.force.mean_force_n;
    out.torque_n_m(i) = row.force.revolution_torque_n_m;
    out.peak_torque_n_m(i) = row.force.peak_torque_n_m;
    out.power_w(i) = row.force.sustained_power_w;
    if (bends) out.deflection_m(i) = row.peak_deflection_m.norm();
    out.cuts.push_back(row.force.cuts());
  }
  return out;
}

report::RedundancySweep sweep_report(const robot::Redundancy& sweep, double used_rad) {
  const auto n = static_cast<Eigen::Index>(sweep.samples.size());
  report::RedundancySweep out;
  out.rotation_rad.resize(n);
  out.deflection_m.setConstant(n, report::missing);
  out.condition_number.setConstant(n, report::missing);
  for (Eigen::Index i = 0; i < n; ++i) {
    const robot::RedundancySample& sample = sweep.samples[static_cast<std::size_t>(i)];
    out.rotation_rad(i) = sample.gamma_rad;
    if (sample.status != robot::Choice::Status::found || sample.buckled) continue;
    out.deflection_m(i) = sample.error_m.norm();
    out.condition_number(i) = sample.condition_number;
  }
  if (sweep.status == robot::Redundancy::Status::found) out.best_rad = sweep.best.gamma_rad;
  out.used_rad = used_rad;
  return out;
}

}  // namespace

report::Forces forces_report(const ForcesResult& result) {
  report::Forces out;
  out.facts.push_back({"Cutter", cutter_text(result.file.cutter)});
  out.warnings = result.warnings;
  out.notes = result.notes;
  if (result.revolution) {
    const cutting::Cut& cut = result.file.cut;
    out.facts.push_back(
        {"Cut", fmt::format("{:.4g} mm deep, {:.4g} mm step-over, {:.4g} mm a tooth, lead {:.3g}°, tilt {:.3g}°",
                            cut.axial_depth_m / units::mm, cut.radial_depth_m / units::mm,
                            result.file.motion.feed_per_tooth_m / units::mm, cut.lead_rad / units::deg,
                            cut.tilt_rad / units::deg)});
    out.facts.push_back({"Speed", fmt::format("{:.0f} rpm", result.file.motion.spindle_speed_rad_per_s / units::rpm)});
    out.revolution = revolution_report(*result.revolution, result.file.on_workpiece);
    if (result.revolution->spindle_rotation) {
      out.spindle_rotation =
          sweep_report(*result.revolution->spindle_rotation, result.revolution->posture->pose.gamma_rad);
    }
  }
  if (result.program) {
    out.facts.push_back({"Program", fmt::format("{} blocks", result.program->blocks.size())});
    if (result.program->stock) {
      out.facts.push_back({"Stock", stock_text(*result.program)});
    }
    out.path = path_report(*result.program);
    out.path->power_time_s = result.file.power_time_s;
  }
  return out;
}

}  // namespace robomill::jobs
