#include "robomill/jobs/calibrate.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "robomill/base/printable.hpp"
#include "robomill/jobs/verbs/records.hpp"
#include "robomill/monitor/files/calibration_json.hpp"

namespace robomill::jobs {
namespace {

using monitor::Calibration;

std::string half_text(const char* name, const monitor::CalibratedHalf& half) {
  const monitor::RocPoint& p = half.chosen;
  std::string out = fmt::format("{:<10}{:>4} stable, {:.1f} % raise a false alarm; {:>4} with chatter, {:.1f} % found",
                                name, half.stable, 100.0 * p.false_alarm_rate, half.chatter, 100.0 * p.detection_rate);
  if (std::isfinite(p.median_delay_s)) {
    out += fmt::format(", {:.0f} ms after their onset (median)", 1e3 * p.median_delay_s);
  }
  return out + "\n";
}

std::string direction(const Calibration& calibration) {
  return fmt::format("{} entropy {} {:.6g}", monitor::to_string(calibration.options.entropy),
                     calibration.options.alarm_below ? "below" : "above", calibration.options.threshold);
}

std::string summary_of(const Calibration& calibration) {
  std::string out = calibration.status == Calibration::Status::found
                        ? fmt::format("Chatter is {}.\n", direction(calibration))
                        : fmt::format("Not calibrated: {}. Of what was tried, {} did best.\n",
                                      monitor::reason(calibration), direction(calibration));
  out += half_text("setting", calibration.setting) + half_text("verifying", calibration.verifying);
  if (std::isfinite(calibration.median_lead_s)) {
    out += fmt::format(
        "The alarm comes {:.0f} ms before the line is seen in the spectrogram (median of the verifying half).\n",
        1e3 * calibration.median_lead_s);
  }
  return out;
}

Outcome run_calibrate_verb(const VerbJob& job, Progress& progress) {
  const CalibrateResult result = run_calibrate(job.input(), job.seed(), progress);
  const Calibration& calibration = result.calibration;
  Outcome outcome = {.summary = summary_of(calibration), .json = monitor::calibration_json(calibration)};
  outcome.page = [notes = result.monitor.notes, summary = outcome.summary, json = outcome.json] {
    page::Report page;
    page.title = "Calibration of the chatter monitor";
    page.notes = notes;
    page.summary = summary;
    page.calibration = json;
    return page;
  };
  for (const std::string& note : result.monitor.notes) outcome.summary += printable(note) + "\n";
  if (!job.output.empty()) write_document(job.output, result);
  if (!result.found()) {
    const bool detector = io::format_of(job.output) == io::Format::toml;
    outcome.shortfall = "not calibrated: " + monitor::reason(calibration) +
                        (detector ? "; " + job.output.string() + " is not written" : "");
  }
  return outcome;
}

}  // namespace

Verb calibrate_verb() {
  return {.name = "calibrate",
          .purpose = "labelled recordings to the published detector's threshold",
          .more = "With its ROC curve, half of the recordings to verify.",
          .example = "calibrate recordings.toml -o monitor.toml",
          .readme = "robomill/monitor/README.md",
          .input = file_option("recordings", "recordings.toml: files with labels", {"recordings"}, true),
          .document = Document::calibration,
          .report = &page::Report::calibration,
          .options = {seed_option()},
          .run = &run_calibrate_verb};
}

}  // namespace robomill::jobs
