#include "robomill/jobs/calibrate.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "robomill/monitor/files/calibration_json.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
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

}  // namespace

Exit run(const CalibrateCommand& command, const Common& common, Progress& progress) {
  require_output(common, {io::Format::toml}, "a calibrated detector is written as .toml");
  const jobs::CalibrateResult result = jobs::run_calibrate(command.recordings, common.seed, progress);
  const std::string json = monitor::calibration_json(result.calibration);
  const bool found = result.calibration.status == Calibration::Status::found;
  if (found || common.output == "-") {
    write_output(common, [&](io::Format format) {
      return format == io::Format::toml ? jobs::calibrated_toml(result, common.output) : json;
    });
  }
  if (!common.report.empty()) {
    page::Report page;
    page.title = "Calibration of the chatter monitor";
    page.notes = result.monitor.notes;
    page.summary = summary_of(result.calibration);
    page.calibration = json;
    write_report(common.report, page, json);
  }
  if (common.wants_summary()) {
    fmt::print("{}", summary_of(result.calibration));
    print_notes(result.monitor.notes, "");
  }
  if (found) return done;
  fmt::print(stderr, "robomill: not calibrated: {}{}\n", monitor::reason(result.calibration),
             common.output.empty() || common.output == "-" ? "" : "; " + common.output + " is not written");
  return not_reached;
}

}  // namespace robomill::app
