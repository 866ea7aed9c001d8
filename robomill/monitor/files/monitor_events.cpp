#include "robomill/monitor/files/monitor_events.hpp"

#include <fmt/format.h>

#include <array>
#include <cstddef>

#include "robomill/base/units.hpp"
#include "robomill/modal/files/mode_json.hpp"

namespace robomill::monitor {
namespace {

constexpr std::array<Fault, 6> all_faults = {not_finite,        stuck,        clipped, dead_channel,
                                             wrong_sample_rate, speed_unknown};

io::Json text_or_null(const std::string& text) {
  return text.empty() ? io::Json(nullptr) : io::Json(text);
}

/// Of names of files whatever their bytes.
std::string line_of(const io::Json& json) {
  return json.dump(-1, ' ', false, io::Json::error_handler_t::replace) + '\n';
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
  for (const Fault fault : all_faults) {
    if ((faults & fault) != 0) names.emplace_back(to_string(fault));
  }
  return names;
}

std::string line_text(const std::vector<double>& line_hz) {
  if (line_hz.empty()) return {};
  std::string out = fmt::format("{:.1f}", line_hz.front());
  for (std::size_t i = 1; i < line_hz.size(); ++i) {
    out += fmt::format("{}{:.1f}", i + 1 < line_hz.size() ? ", " : " or ", line_hz[i]);
  }
  return out + (line_hz.size() == 1 ? " Hz folded" : " Hz");
}

std::string event_line(const MonitorEvent& event) {
  const Decision& d = event.decision;
  const bool chatters = d.chatter_frequency_hz > 0.0;
  io::Json json;
  json["time_s"] = io::number(event.time_s);
  json["event"] = to_string(event.kind);
  json["state"] = to_string(d.state);
  json["reason"] = d.state == State::blind ? io::Json(to_string(d.reason)) : io::Json(nullptr);
  json["score"] = io::number(d.score);
  json["threshold"] = io::number(d.threshold);
  json["energy_entropy"] = io::number(d.energy_entropy);
  json["level"] = io::number(d.level);
  json["chatter_frequency_hz"] = io::positive(d.chatter_frequency_hz);
  json["chatter_frequency_std_hz"] = chatters ? io::number(d.chatter_frequency_std_hz) : io::Json(nullptr);
  json["channel"] = chatters ? io::Json(d.channel + 1) : io::Json(nullptr);
  json["hidden"] = d.synchronous == SynchronousChatter::none ? io::Json(nullptr) : io::Json(to_string(d.synchronous));
  modal::set_mode(json, event.mode);
  json["line_frequencies_hz"] = io::Json::array();
  for (const double line_hz : event.line_hz) json["line_frequencies_hz"].push_back(io::number(line_hz));
  json["spindle_speed_rpm"] = io::positive(d.spindle_speed_rad_per_s, units::rpm);
  json["spindle_speed_std_rpm"] = io::positive(d.spindle_speed_std_rad_per_s, units::rpm);
  json["suggested_spindle_speed_rpm"] = io::positive(event.suggested_spindle_speed_rad_per_s, units::rpm);
  json["suggested_axial_depth_mm"] = io::positive(event.suggested_axial_depth_m, units::mm);
  json["depth_limited_by"] = text_or_null(std::string(name_in(depth_limited_by_names, event.depth_limited_by)));
  json["stable_spindle_speeds_rpm"] = io::Json::array();
  for (const double speed : event.stable_speeds_rad_per_s) {
    json["stable_spindle_speeds_rpm"].push_back(io::number(speed / units::rpm));
  }
  json["no_speed"] = text_or_null(std::string(name_in(no_speed_names, event.no_speed)));
  json["command"] = text_or_null(event.command);
  json["faults"] = fault_names(d.faults);
  json["suggested_sample_rate_hz"] =
      (d.faults & wrong_sample_rate) != 0 ? io::positive(d.suggested_sample_rate_hz) : io::Json(nullptr);
  json["compute_us"] = io::number(event.compute_s / units::us);
  if (event.kind == MonitorEvent::Kind::stream) {
    json["what"] = text_or_null(event.what);
    json["count"] = event.count;
  }
  if (event.kind == MonitorEvent::Kind::recording) json["file"] = text_or_null(event.file);
  if (!event.message.empty()) json["message"] = event.message;
  return line_of(json);
}

std::string started_line(const SessionStart& start) {
  io::Json json = {{"time_s", 0.0},        {"event", "started"},     {"started", start.started},
                   {"input", start.input}, {"config", start.config}, {"version", start.version}};
  if (!start.message.empty()) json["message"] = start.message;
  return line_of(json);
}

std::string lost_events_line(std::uint64_t count) {
  return line_of({{"time_s", nullptr},
                  {"event", "stream"},
                  {"what", "events-lost"},
                  {"count", count},
                  {"message", "events that could not be written here were too many to keep"}});
}

}  // namespace robomill::monitor
