#include "robomill/jobs/plan.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

void print_operation(const char* label, const decision::Operation& op) {
  fmt::print("{:<12} {:>7.0f} rpm  {:.3f} mm  {:.3g} mm/tooth  {:.4g} mm³/s  limited by {}\n", label,
             op.spindle_speed_rad_per_s / units::rpm, op.axial_depth_m / units::mm, op.feed_per_tooth_m / units::mm,
             op.removal_rate_m3_per_s / units::mm3, jobs::limited_by_text(op));
}

/// What else to know of the recommended one.
void print_details(const decision::Operation& op) {
  fmt::print(
      "             cutting speed {:.4g} m/min, feed {:.4g} mm/min, mean torque {:.3g} N·m, mean power {:.3g} W\n",
      op.cutting_speed_m_per_s * units::minute, op.feed_m_per_s / units::mm * units::minute, op.torque_n_m, op.power_w);
  if (!std::isfinite(op.peak_deflection_m)) return;
  const std::string error = std::isfinite(op.surface_error_m)
                                ? fmt::format("surface error {:+.3g} µm, ", op.surface_error_m / units::um)
                                : std::string();
  fmt::print("             {}peak deflection {:.3g} µm, from forced vibration\n", error,
             op.peak_deflection_m / units::um);
}

/// On top: nothing that follows is worth more than the model.
void print_disagreement(const report::Agreement& count) {
  if (count.disagree == 0) return;
  fmt::print("test cuts    {} of {} disagree with the prediction: find out why before you use these numbers\n",
             count.disagree, count.agree + count.disagree);
}

void print_summary(const jobs::PlanResult& result) {
  const report::Agreement count = report::agreement(result.cuts);
  print_disagreement(count);
  if (result.hits) {
    for (const modal::HitVerdict& hit : result.hits->hits) {
      if (hit.accepted) continue;
      fmt::print("rejected     {}: {}\n", printable(hit.file), hit.reasons.empty() ? "" : hit.reasons.front());
    }
  }
  if (result.prediction && !result.prediction->peaks.empty()) {
    const report::TipPeak& first = result.prediction->peaks.front();
    fmt::print("predicted    first peak of {} at {:.1f} Hz, {:.3g} µm/N\n", modal::to_string(first.name),
               first.frequency_hz, first.receptance_m_per_n / units::um);
  }
  if (result.recommendation.recommended) {
    print_operation("recommended", *result.recommendation.recommended);
    print_details(*result.recommendation.recommended);
    for (const decision::Operation& op : result.recommendation.alternatives) print_operation("alternative", op);
  } else {
    fmt::print("{}: {}\n", result.has_lobes() ? "no safe depth" : "no answer", result.recommendation.reason);
  }
  if (result.path) {
    const path::Summary& smoothed = result.path->first().summary;
    fmt::print("program      {:.3f} s for {} blocks; {} violations of limits\n", smoothed.duration_s, smoothed.blocks,
               smoothed.check.violations());
  }
  if (!result.cuts.empty()) {
    fmt::print("test cuts    {} agree, {} disagree, {} without a result\n", count.agree, count.disagree,
               count.not_compared);
  }
  print_notes(result.warnings, "warning      ");
  print_notes(result.notes, "note         ");
}

}  // namespace

Exit run(const PlanCommand& command, const Common& common, Progress& progress) {
  const std::filesystem::path folder = common.to_stdout() ? std::string() : common.output;
  const jobs::PlanResult result = jobs::run_job(command.job, common.seed, progress, folder, command.accept_fit);
  if (common.to_stdout()) {
    fmt::print("{}", jobs::plan_json(result));
  } else if (!common.output.empty()) {
    jobs::write_plan(common.output, result);
  }
  if (common.wants_summary()) print_summary(result);
  if (result.path && !result.path->holds()) return not_reached;
  return result.recommendation.status == decision::Recommendation::Status::found ? done : not_reached;
}

}  // namespace robomill::app
