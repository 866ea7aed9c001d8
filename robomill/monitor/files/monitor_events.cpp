#include "robomill/monitor/files/monitor_events.hpp"

#include <array>

#include "robomill/base/units.hpp"
#include "robomill/modal/files/mode_json.hpp"

namespace robomill::formats {
namespace {

constexpr std::array<monitor::Fault, 6> all_faults = {monitor::not_finite,        monitor::stuck,
                                                      monitor::clipped,           monitor::dead_channel,
                                                      monitor::wrong_sample_rate, monitor::speed_unknown};

Json positive(double value, double unit = 1.0) {
  return value > 0.0 ? number(value / unit) : Json(nullptr);
}

Json text_or_null(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

}  // namespace

const char* to_string(MonitorEvent::Kind kind) {
  switch (kind) {
    case MonitorEvent::Kind::state:
      return "state";
    case MonitorEvent::Kind::window:
      return "window";
    case MonitorEvent::Kind::fault:
      return "fault";
    case MonitorEvent::Kind::stream:
      return "stream";
    default:
      return "recording";
  }
}

std::vector<std::string> fault_names(std::uint32_t faults) {
  std::vector<std::string> names;
  for (const monitor::Fault fault : all_faults) {
    if ((faults & fault) != 0) names.emplace_back(monitor::to_string(fault));
  }
  return names;
}

std::string event_line(const MonitorEvent& event) {
  const monitor::Decision& d = event.decision;
  const bool chatters = d.chatter_frequency_hz > 0.0;
  Json json;
  json["time_s"] = number(event.time_s);
  json["event"] = to_string(event.kind);
  json["state"] = monitor::to_string(d.state);
  json["score"] = number(d.score);
  json["threshold"] = number(d.threshold);
  json["energy_entropy"] = number(d.energy_entropy);
  json["level"] = number(d.level);
  json["chatter_frequency_hz"] = positive(d.chatter_frequency_hz);
  json["chatter_frequency_std_hz"] = chatters ? number(d.chatter_frequency_std_hz) : Json(nullptr);
  json["channel"] = chatters ? Json(d.channel + 1) : Json(nullptr);
  json["hidden"] = d.hidden == monitor::Hidden::none ? Json(nullptr) : Json(monitor::to_string(d.hidden));
  set_mode(json, event.mode);
  json["spindle_speed_rpm"] = positive(d.spindle_speed_rad_per_s, units::rpm);
  json["suggested_spindle_speed_rpm"] = positive(event.suggested_spindle_speed_rad_per_s, units::rpm);
  json["suggested_axial_depth_mm"] = positive(event.suggested_axial_depth_m, units::mm);
  json["stable_spindle_speeds_rpm"] = Json::array();
  for (const double speed : event.stable_speeds_rad_per_s) {
    json["stable_spindle_speeds_rpm"].push_back(number(speed / units::rpm));
  }
  json["faults"] = fault_names(d.faults);
  json["suggested_sample_rate_hz"] =
      (d.faults & monitor::wrong_sample_rate) != 0 ? positive(d.suggested_sample_rate_hz) : Json(nullptr);
  json["compute_us"] = number(event.compute_s / units::us);
  if (event.kind == MonitorEvent::Kind::stream) {
    json["what"] = text_or_null(event.what);
    json["count"] = event.count;
  }
  if (event.kind == MonitorEvent::Kind::recording) json["file"] = text_or_null(event.file);
  if (!event.message.empty()) json["message"] = event.message;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace robomill::formats
