#include "robomill/monitor/files/calibration_json.hpp"

#include "robomill/io/json.hpp"

namespace robomill::monitor {
namespace {

io::Json point_json(const RocPoint& point) {
  return {{"threshold", io::number(point.threshold)},
          {"false_alarm_rate", io::number(point.false_alarm_rate)},
          {"detection_rate", io::number(point.detection_rate)},
          {"median_delay_s", io::number(point.median_delay_s)}};
}

io::Json half_json(const CalibratedHalf& half) {
  io::Json json = {{"stable", half.stable}, {"chatter", half.chatter}, {"chosen", point_json(half.chosen)}};
  json["roc"] = io::Json::array();
  for (const RocPoint& point : half.roc) json["roc"].push_back(point_json(point));
  return json;
}

}  // namespace

std::string calibration_json(const Calibration& calibration) {
  io::Json json;
  json["status"] = name_in(calibration_status_names, calibration.status);
  json["reason"] = reason(calibration);
  json["kind"] = to_string(calibration.options.kind);
  json["entropy"] = to_string(calibration.options.entropy);
  json["threshold"] = io::number(calibration.options.threshold);
  json["alarm"] = calibration.options.alarm_below ? "below" : "above";
  json["setting"] = half_json(calibration.setting);
  json["verifying"] = half_json(calibration.verifying);
  json["median_lead_s"] = io::number(calibration.median_lead_s);
  json["recordings"] = io::Json::array();
  for (const Alarm& alarm : calibration.alarms) {
    json["recordings"].push_back({{"name", alarm.name},
                                  {"label", alarm.chatter ? "chatter" : "stable"},
                                  {"half", alarm.verifying ? "verifying" : "setting"},
                                  {"early", alarm.early},
                                  {"alarm_s", io::number(alarm.alarm_s)},
                                  {"onset_s", io::number(alarm.onset_s)},
                                  {"line_hz", io::number(alarm.line_hz)},
                                  {"visible_s", io::number(alarm.visible_s)},
                                  {"lead_s", io::number(alarm.lead_s)}});
  }
  return io::dump(json);
}

}  // namespace robomill::monitor
