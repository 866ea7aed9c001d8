#include "report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/text.hpp"

namespace robomill::app {
namespace {

using monitor::MonitorEvent;

double known(double value) {
  return value > 0.0 ? value : report::missing;
}

std::string note_of(const MonitorEvent& event) {
  switch (event.kind) {
    case MonitorEvent::Kind::fault: {
      std::string names;
      for (const std::string& name : monitor::fault_names(event.decision.faults)) {
        names += (names.empty() ? "" : ", ") + name;
      }
      return names.empty() ? "the input is well again" : "the input: " + names;
    }
    case MonitorEvent::Kind::stream:
      return event.message.empty() ? event.what : event.message;
    case MonitorEvent::Kind::recording:
      return "recorded " + event.file;
    default:
      break;
  }
  return event.decision.hidden == monitor::Hidden::none ? "" : std::string(monitor::to_string(event.decision.hidden));
}

std::string speed_fact(const monitor::MonitorOptions& options) {
  std::string out = options.spindle_speed_rad_per_s > 0.0
                        ? fmt::format("{:.0f} rpm as given", options.spindle_speed_rad_per_s / units::rpm)
                        : "from the signal";
  if (options.teeth > 0) out += fmt::format(", {} teeth", options.teeth);
  return out;
}

std::string detector_fact(const monitor::MonitorOptions& options) {
  std::string out = fmt::format("{}, {:.4g} ms each {:.4g} ms", monitor::to_string(options.kind),
                                options.window_s / units::ms, options.hop_s / units::ms);
  if (options.kind == monitor::Kind::comb_cusum) {
    return out + fmt::format(", {:.3g} false alarms an hour allowed", options.false_alarms_per_hour);
  }
  return out + fmt::format(", {} entropy {} {:.6g}", monitor::to_string(options.entropy),
                           options.alarm_below ? "below" : "above", options.threshold);
}

report::RocCurve curve_of(const char* label, const std::vector<monitor::RocPoint>& roc) {
  const auto n = static_cast<Eigen::Index>(roc.size());
  report::RocCurve out{.label = label,
                       .false_alarm_rate = Eigen::VectorXd(n),
                       .detection_rate = Eigen::VectorXd(n),
                       .threshold = Eigen::VectorXd(n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const monitor::RocPoint& point = roc[static_cast<std::size_t>(i)];
    out.false_alarm_rate[i] = point.false_alarm_rate;
    out.detection_rate[i] = point.detection_rate;
    out.threshold[i] = point.threshold;
  }
  return out;
}

std::string half_fact(const monitor::CalibratedHalf& half) {
  std::string out = fmt::format("{} stable, {} with chatter: {:.1f} % false, {:.1f} % found", half.stable, half.chatter,
                                100.0 * half.chosen.false_alarm_rate, 100.0 * half.chosen.detection_rate);
  if (std::isfinite(half.chosen.median_delay_s)) {
    out += fmt::format(", {:.0f} ms after onset", half.chosen.median_delay_s / units::ms);
  }
  return out;
}

}  // namespace

report::MonitorEvent report_event(const MonitorEvent& event) {
  const monitor::Decision& decision = event.decision;
  report::MonitorEvent out;
  out.time_s = event.time_s;
  out.state = decision.state;
  out.note = note_of(event);
  if (event.kind != MonitorEvent::Kind::state) return out;
  out.score = decision.score;
  out.threshold = decision.threshold;
  out.chatter_frequency_hz = known(decision.chatter_frequency_hz);
  out.chatter_frequency_std_hz = known(decision.chatter_frequency_std_hz);
  out.mode = event.mode;
  out.suggested_spindle_speed_rad_per_s = known(event.suggested_spindle_speed_rad_per_s);
  return out;
}

report::Report monitor_page(report::MonitorRun run, const monitor::MonitorFile& file, const std::string& source) {
  const monitor::MonitorOptions& options = file.options;
  run.facts = {{"Recording", fmt::format("{}, {:.6g} Hz", source, options.sample_rate_hz)},
               {"Detector", detector_fact(options)},
               {"Spindle speed", speed_fact(options)}};
  report::Report page;
  page.title = "Chatter monitor";
  page.monitor = std::move(run);
  return page;
}

report::Report calibration_page(const monitor::Calibration& calibration) {
  report::CalibrationRun run;
  run.facts = {
      {"Chatter is", fmt::format("{} entropy {} {:.6g}", monitor::to_string(calibration.options.entropy),
                                 calibration.options.alarm_below ? "below" : "above", calibration.options.threshold)},
      {"The half that set it", half_fact(calibration.setting)},
      {"The half that verifies it", half_fact(calibration.verifying)}};
  if (std::isfinite(calibration.median_lead_s)) {
    run.facts.push_back(
        {"Lead over the spectrogram", fmt::format("{:.0f} ms (median)", calibration.median_lead_s / units::ms)});
  }
  run.false_alarm_rate = calibration.verifying.chosen.false_alarm_rate;
  run.detection_rate = calibration.verifying.chosen.detection_rate;
  run.curves = {curve_of("set", calibration.setting.roc), curve_of("verified", calibration.verifying.roc)};
  for (const monitor::Alarm& alarm : calibration.alarms) {
    run.rows.push_back({.name = alarm.name,
                        .chatter = alarm.chatter,
                        .verifies = alarm.verifying,
                        .alarmed = std::isfinite(alarm.alarm_s) && !alarm.early,
                        .delay_s = alarm.alarm_s - alarm.onset_s,
                        .lead_s = alarm.lead_s});
  }
  report::Report page;
  page.title = "Calibration of the chatter monitor";
  page.calibration = std::move(run);
  return page;
}

void check_report_place(const std::filesystem::path& path) {
  const std::string ending = io::lowered(path.extension().string());
  if (path.empty() || ending == ".json" || ending == ".html") return;
  throw InvalidInput(path.string(), "a report is written as .json or .html");
}

void write_report(const std::filesystem::path& path, const report::Report& page) {
  const bool html = io::lowered(path.extension().string()) == ".html";
  io::write_file(path, html ? report::report_html(page) : report::report_json(page));
}

}  // namespace robomill::app
