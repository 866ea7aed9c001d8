#include "robomill/monitor/files/calibration_json.hpp"

#include "robomill/io/json.hpp"

namespace robomill::formats {
namespace {

Json point_json(const monitor::RocPoint& point) {
  return {{"threshold", number(point.threshold)},
          {"false_alarm_rate", number(point.false_alarm_rate)},
          {"detection_rate", number(point.detection_rate)},
          {"median_delay_s", number(point.median_delay_s)}};
}

Json half_json(const monitor::CalibratedHalf& half) {
  Json json = {{"stable", half.stable}, {"chatter", half.chatter}, {"chosen", point_json(half.chosen)}};
  json["roc"] = Json::array();
  for (const monitor::RocPoint& point : half.roc) json["roc"].push_back(point_json(point));
  return json;
}

}  // namespace

std::string calibration_json(const monitor::Calibration& calibration) {
  Json json;
  json["kind"] = monitor::to_string(calibration.options.kind);
  json["entropy"] = monitor::to_string(calibration.options.entropy);
  json["threshold"] = number(calibration.options.threshold);
  json["alarm"] = calibration.options.alarm_below ? "below" : "above";
  json["setting"] = half_json(calibration.setting);
  json["verifying"] = half_json(calibration.verifying);
  json["median_lead_s"] = number(calibration.median_lead_s);
  json["recordings"] = Json::array();
  for (const monitor::Alarm& alarm : calibration.alarms) {
    json["recordings"].push_back({{"name", alarm.name},
                                  {"label", alarm.chatter ? "chatter" : "stable"},
                                  {"half", alarm.verifying ? "verifying" : "setting"},
                                  {"early", alarm.early},
                                  {"alarm_s", number(alarm.alarm_s)},
                                  {"onset_s", number(alarm.onset_s)},
                                  {"line_hz", number(alarm.line_hz)},
                                  {"visible_s", number(alarm.visible_s)},
                                  {"lead_s", number(alarm.lead_s)}});
  }
  return dump(json);
}

}  // namespace robomill::formats
