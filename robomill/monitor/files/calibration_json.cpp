#include "robomill/monitor/files/calibration_json.hpp"

namespace robomill::monitor {
namespace {

using io::key;
using io::Schema;
using io::Use;

const Schema<RocPoint>& point_table() {
  static const Schema<RocPoint> table(
      "roc_point", "how a threshold does",
      {key("threshold", &RocPoint::threshold, "of the entropy").nullable(),
       key("false_alarm_rate", &RocPoint::false_alarm_rate, "share of the stable recordings").nullable(),
       key("detection_rate", &RocPoint::detection_rate, "share of those with chatter").nullable(),
       key("median_delay_s", &RocPoint::median_delay_s, "alarm less onset; none: no onset is known").nullable()},
      Use::written);
  return table;
}

const Schema<CalibratedHalf>& half_table() {
  static const Schema<CalibratedHalf> table(
      "calibrated_half", "half of the recordings",
      {key("stable", &CalibratedHalf::stable, "recordings"), key("chatter", &CalibratedHalf::chatter, "recordings"),
       key("chosen", &CalibratedHalf::chosen, point_table(), "at the calibrated threshold"),
       key("roc", &CalibratedHalf::roc, point_table(), "the ROC curve")},
      Use::written);
  return table;
}

const Schema<Alarm>& judged_recording_table() {
  static const Schema<Alarm> table(
      "calibrated_recording", "a recording at the calibrated threshold",
      {key("name", &Alarm::name, "of the recording"),
       key(
           "label", [](const Alarm& alarm) { return alarm.chatter ? "chatter" : "stable"; }, "as given")
           .words({"stable", "chatter"}),
       key(
           "half", [](const Alarm& alarm) { return alarm.verifying ? "verifying" : "setting"; }, "that it belongs to")
           .words({"setting", "verifying"}),
       key("early", &Alarm::early, "raised before the onset: no detection"),
       key("alarm_s", &Alarm::alarm_s, "when the alarm was raised").nullable(),
       key("onset_s", &Alarm::onset_s, "as given").nullable(),
       key("line_hz", &Alarm::line_hz, "chatter's line in the spectrogram").nullable(),
       key("visible_s", &Alarm::visible_s, "when it became visible").nullable(),
       key("lead_s", &Alarm::lead_s, "alarm before that").nullable()},
      Use::written);
  return table;
}

}  // namespace

const Schema<Calibration>& calibration_table() {
  static const Schema<Calibration> table(
      "calibration", "the published detector's threshold, from labelled recordings",
      {key("status", &Calibration::status, calibration_status_names, "found, or why not"),
       key(
           "reason", [](const Calibration& c) { return reason(c); }, "in words; empty: found"),
       key(
           "kind", [](const Calibration& c) { return to_string(c.options.kind); }, "of the detector"),
       key(
           "entropy", [](const Calibration& c) { return to_string(c.options.entropy); }, "of the detector"),
       key(
           "threshold", [](const Calibration& c) { return c.options.threshold; }, "of the entropy")
           .nullable(),
       key(
           "alarm", [](const Calibration& c) { return c.options.alarm_below ? "below" : "above"; }, "of the threshold")
           .words({"below", "above"}),
       key("setting", &Calibration::setting, half_table(), "that the threshold was set with"),
       key("verifying", &Calibration::verifying, half_table(), "that it was not set with"),
       key("median_lead_s", &Calibration::median_lead_s, "over the verifying half").nullable(),
       key("recordings", &Calibration::alarms, judged_recording_table(), "in the order given")},
      Use::written, 1);
  return table;
}

std::string calibration_json(const Calibration& calibration) {
  return io::dump(calibration_table().write(calibration));
}

}  // namespace robomill::monitor
