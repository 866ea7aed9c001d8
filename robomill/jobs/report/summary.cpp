#include "robomill/jobs/outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/note_lines.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/process/forces.hpp"

namespace robomill::jobs {
namespace {

using io::append;

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

}  // namespace robomill::jobs
