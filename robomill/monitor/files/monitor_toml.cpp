#include "robomill/monitor/files/monitor_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/monitor/files/monitor_tables.hpp"

namespace robomill::monitor {
namespace {

/// Stands in for a rate that only the recording knows, so that all else can be checked.
constexpr double some_rate_hz = 10'240.0;

void read_mqtt(io::TomlFile& file, MqttSettings& mqtt) {
  file.text("mqtt.host", mqtt.host);
  if (file.integer("mqtt.port", "port", mqtt.port) && (mqtt.port < 1 || mqtt.port > 65'535)) {
    throw file.reject("mqtt.port", "must lie between 1 and 65535");
  }
  file.text("mqtt.topic", mqtt.topic);
  file.text("mqtt.events_topic", mqtt.events_topic);
  file.text("mqtt.commands_topic", mqtt.commands_topic);
  for (const auto& [key, topic] :
       {std::pair{"mqtt.events_topic", &mqtt.events_topic}, {"mqtt.commands_topic", &mqtt.commands_topic}}) {
    if (topic->empty()) continue;
    if (topic->find_first_of("+#") != std::string::npos) throw file.reject(key, "must be one topic, without + and #");
    if (*topic == mqtt.topic) throw file.reject(key, "must differ from mqtt.topic");
  }
  if (!mqtt.commands_topic.empty() && mqtt.commands_topic == mqtt.events_topic) {
    throw file.reject("mqtt.commands_topic", "must differ from mqtt.events_topic");
  }
  file.text("mqtt.client_id", mqtt.client_id);
  file.text("mqtt.user", mqtt.user);
  if (file.path("mqtt.password_file", mqtt.password_file) && mqtt.user.empty()) {
    throw file.reject("mqtt.password_file", "needs mqtt.user");
  }
  file.boolean("mqtt.tls", mqtt.tls);
  file.path("mqtt.ca_file", mqtt.ca_file);
  file.path("mqtt.certificate_file", mqtt.certificate_file);
  file.path("mqtt.key_file", mqtt.key_file);
  for (const char* key : {"mqtt.ca_file", "mqtt.certificate_file", "mqtt.key_file"}) {
    if (file.has(key) && !mqtt.tls) throw file.reject(key, "needs mqtt.tls = true");
  }
  if (mqtt.certificate_file.empty() != mqtt.key_file.empty()) {
    throw file.reject(mqtt.key_file.empty() ? "mqtt.certificate_file" : "mqtt.key_file",
                      "certificate_file and key_file go together");
  }
  if (file.integer("mqtt.qos", "qos", mqtt.qos) && (mqtt.qos < 0 || mqtt.qos > 2)) {
    throw file.reject("mqtt.qos", "must be 0, 1 or 2");
  }
  if (file.number("mqtt.connect_timeout_s", "connect_timeout_s", 1.0, mqtt.connect_timeout_s) &&
      !(mqtt.connect_timeout_s >= 0.0 && mqtt.connect_timeout_s <= 86'400.0)) {
    throw file.reject("mqtt.connect_timeout_s", "must lie between 0 and 86400", "0 waits for ever");
  }
}

void read_act(io::TomlFile& file, ActSettings& act) {
  if (!file.has("act")) return;
  act.rule = ActRule::speed;
  file.choice("act.rule", act_rule_names, act.rule);
  if (file.number("act.reduce_to", "reduce_to", 1.0, act.reduce_to) && !(act.reduce_to > 0.0 && act.reduce_to < 1.0)) {
    throw file.reject("act.reduce_to", "must lie between 0 and 1", "It is a share of the programmed feed");
  }
  if (file.number("act.retract_mm", "retract_m", units::mm, act.retract_m) && !(act.retract_m > 0.0)) {
    throw file.reject("act.retract_mm", "must be > 0");
  }
  if (act.rule == ActRule::hold && act.retract_m == 0.0) {
    file.require("act.retract_mm", "A tool that stands still in the cut rubs and marks the part: hold needs a retract");
  }
  std::vector<double> range;
  if (file.numbers("act.spindle_speed_rpm", "lowest_rad_per_s", units::rpm, range)) {
    if (range.size() != 2 || !(range[0] > 0.0 && range[1] > range[0])) {
      throw file.reject("act.spindle_speed_rpm", "must be [lowest, highest], both > 0",
                        "The range that tool and spindle allow");
    }
    act.lowest_rad_per_s = range[0];
    act.highest_rad_per_s = range[1];
  }
  for (const auto& [key, member, value] :
       {std::tuple{"act.settle_s", "settle_s", &act.settle_s}, std::tuple{"act.calm_s", "calm_s", &act.calm_s}}) {
    if (file.number(key, member, 1.0, *value) && !(*value > 0.0 && *value <= 3600.0)) {
      throw file.reject(key, "must lie between 0 and 3600");
    }
  }
}

void read_outputs(io::TomlFile& file, MonitorFile& out) {
  if (file.integer("metrics.port", "metrics_port", out.metrics_port) &&
      (out.metrics_port < 0 || out.metrics_port > 65'535)) {
    throw file.reject("metrics.port", "must lie between 0 and 65535", "0 takes any port that is free");
  }
  file.text("metrics.host", out.metrics_host);
  file.path("recording.folder", out.recording_folder);
  if (file.number("recording.seconds", "recording_s", 1.0, out.recording_s) &&
      !(out.recording_s > 0.0 && out.recording_s <= 3600.0)) {
    throw file.reject("recording.seconds", "must lie between 0 and 3600");
  }
}

std::string number_text(double value) {
  return fmt::format("{:.15g}", value);
}

}  // namespace

bool read_column(io::TomlFile& file, const std::string& key, std::string& out) {
  if (!file.is_number(key)) return file.text(key, out);
  int number = 0;
  file.integer(key, key, number);
  if (number < 1) throw file.reject(key, "must be a column's name or its number from 1");
  out = std::to_string(number);
  return true;
}

void read_signal(io::TomlFile& file, MonitorFile& out) {
  file.number("signal.sample_rate_hz", "sample_rate_hz", 1.0, out.options.sample_rate_hz);
  out.columns.sample_rate_hz = out.options.sample_rate_hz;
  file.boolean("signal.anti_alias_filter", out.anti_alias_filter);
  file.require("signal.channels", "Write channels = [\"ax_m_per_s2\"]: names of columns, or numbers from 1");
  if (file.is_number("signal.channels")) {
    out.columns.channels.resize(1);
    (void)read_column(file, "signal.channels", out.columns.channels.front());
  } else if (file.is_number("signal.channels[0]")) {
    std::vector<int> numbers;
    file.integers("signal.channels", "columns", numbers);
    for (const int number : numbers) {
      if (number < 1) throw file.reject("signal.channels", "must hold names of columns or numbers from 1");
      out.columns.channels.push_back(std::to_string(number));
    }
  } else {
    file.texts("signal.channels", out.columns.channels);
  }
  std::string tachometer;
  (void)read_column(file, "signal.tachometer", tachometer);
  file.integer("signal.columns", "columns", out.columns.raw_columns);
  file.number("signal.scale", "scale", 1.0, out.columns.scale);
  file.number("signal.full_scale", "full_scale", 1.0, out.options.full_scale);
  file.integer("signal.pulses_per_revolution", "pulses_per_revolution", out.options.pulses_per_revolution);
  std::vector<std::string>& channels = out.columns.channels;
  file.locate([&] {
    out.columns.validate();
    if (std::ranges::find(channels, tachometer) == channels.end()) return;
    throw InvalidInput("tachometer", "must be another column than the channels");
  });
  if (!tachometer.empty()) {
    out.options.tachometer_channel = static_cast<int>(channels.size());
    channels.push_back(tachometer);
  }
  out.options.channels = static_cast<int>(channels.size());
}

void read_process(io::TomlFile& file, MonitorFile& out) {
  file.number("process.spindle_speed_rpm", "spindle_speed_rad_per_s", units::rpm, out.options.spindle_speed_rad_per_s);
  file.number("process.spindle_speed_std_ratio", "speed_std_ratio", 1.0, out.options.speed_std_ratio);
  file.number("process.min_speed_rpm", "min_speed_rad_per_s", units::rpm, out.options.min_speed_rad_per_s);
  file.integer("process.teeth", "teeth", out.options.teeth);
}

void read_detector(io::TomlFile& file, MonitorFile& out) {
  MonitorOptions& options = out.options;
  file.choice("detector.kind", kind_names, options.kind);
  file.number("detector.window_ms", "window_s", units::ms, options.window_s);
  file.number("detector.hop_ms", "hop_s", units::ms, options.hop_s);
  file.integer("detector.bands", "bands", options.bands);
  file.choice("detector.entropy", entropy_names, options.entropy);
  file.number("detector.threshold", "threshold", 1.0, options.threshold);
  bool below = options.alarm_below;
  file.choice<bool>("detector.alarm", {{"above", false}, {"below", true}}, below);
  options.alarm_below = below;
  file.number("detector.false_alarms_per_hour", "false_alarms_per_hour", 1.0, options.false_alarms_per_hour);
}

void check_options(const io::TomlFile& file, const MonitorFile& monitor) {
  file.locate([&] {
    MonitorOptions options = monitor.options;
    if (!file.has("signal.sample_rate_hz")) options.sample_rate_hz = some_rate_hz;
    try {
      options.validate();
    } catch (const InvalidInput& error) {
      // A number of samples, where the file has a time.
      if (error.parts().unit != "samples") throw;
      throw file.reject(error.parts().field == "hop_s" ? "detector.hop_ms" : "detector.window_ms", error.parts().rule,
                        error.parts().hint);
    }
  });
}

MonitorFile read_monitor(const io::TomlSource& source) {
  io::TomlFile file(source);
  MonitorFile out;
  out.path = source.path;
  read_signal(file, out);
  read_process(file, out);
  file.path("process.modes", out.modes);
  if (!file.path("process.lobes", out.lobes) && file.has("lobes")) out.lobes = source.path;
  read_detector(file, out);
  if (file.number("signal.timeout_s", "timeout_s", 1.0, out.timeout_s) &&
      !(out.timeout_s > 0.0 && out.timeout_s <= 3600.0)) {
    throw file.reject("signal.timeout_s", "must lie between 0 and 3600");
  }
  read_act(file, out.act);
  read_mqtt(file, out.mqtt);
  read_outputs(file, out);
  out.notes = file.done();
  out.assumed = io::sample_values(file);
  check_options(file, out);
  return out;
}

void validate(const MonitorFile& file) {
  try {
    file.options.validate();
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    parts.where = file.path.string();
    if (parts.field == "sample_rate_hz") {
      parts.field = "signal.sample_rate_hz";
      if (file.options.sample_rate_hz == 0.0) parts.hint = "The recording does not say what it was sampled at";
    }
    throw InvalidInput(std::move(parts));
  }
}

std::string monitor_toml(const MonitorFile& file, const std::string& remarks) {
  const MonitorOptions& o = file.options;
  std::string out;
  const auto line = [&out](std::string_view key, const std::string& value) {
    io::append(out, "{} = {}\n", key, value);
  };
  std::string_view rest = remarks;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    io::append(out, "# {}\n", rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  out += "[signal]\n";
  if (o.sample_rate_hz > 0.0) line("sample_rate_hz", number_text(o.sample_rate_hz));
  if (file.anti_alias_filter) line("anti_alias_filter", "true");
  std::string names, tachometer;
  for (int channel = 0; const std::string& name : file.columns.channels) {
    std::string& list = channel++ == o.tachometer_channel ? tachometer : names;
    list += (list.empty() ? "" : ", ") + io::toml_quoted(name);
  }
  line("channels", "[" + names + "]");
  if (!tachometer.empty()) line("tachometer", tachometer);
  if (o.pulses_per_revolution != 1) line("pulses_per_revolution", std::to_string(o.pulses_per_revolution));
  if (file.columns.raw_columns > 0) line("columns", std::to_string(file.columns.raw_columns));
  if (file.columns.scale != 1.0) line("scale", number_text(file.columns.scale));
  if (o.full_scale > 0.0) line("full_scale", number_text(o.full_scale));
  out += "\n[process]\n";
  if (o.spindle_speed_rad_per_s > 0.0) line("spindle_speed_rpm", number_text(o.spindle_speed_rad_per_s / units::rpm));
  if (o.min_speed_rad_per_s != MonitorOptions().min_speed_rad_per_s) {
    line("min_speed_rpm", number_text(o.min_speed_rad_per_s / units::rpm));
  }
  if (o.teeth > 0) line("teeth", std::to_string(o.teeth));
  if (!file.modes.empty()) line("modes", io::toml_quoted(file.modes.string()));
  if (!file.lobes.empty()) line("lobes", io::toml_quoted(file.lobes.string()));
  out += "\n[detector]\n";
  line("kind", io::toml_quoted(to_string(o.kind)));
  line("window_ms", number_text(o.window_s / units::ms));
  line("hop_ms", number_text(o.hop_s / units::ms));
  line("bands", std::to_string(o.bands));
  if (o.kind == Kind::energy_entropy) {
    line("entropy", io::toml_quoted(to_string(o.entropy)));
    line("threshold", number_text(o.threshold));
    line("alarm", io::toml_quoted(o.alarm_below ? "below" : "above"));
  } else {
    line("false_alarms_per_hour", number_text(o.false_alarms_per_hour));
  }
  return out;
}

bool parse_mqtt_address(const std::string& text, MqttSettings& settings) {
  std::string_view rest = text;
  if (rest.starts_with("mqtts://")) {
    settings.tls = true;
    rest.remove_prefix(8);
  } else if (rest.starts_with("mqtt://")) {
    rest.remove_prefix(7);
  } else {
    return false;
  }
  const auto reject = [&text](const char* rule) { return InvalidInput(text, rule, "Write mqtt://HOST:PORT/TOPIC"); };
  const std::size_t slash = rest.find('/');
  if (slash == std::string_view::npos || slash + 1 == rest.size()) throw reject("names no topic");
  std::string_view host = rest.substr(0, slash);
  settings.topic = rest.substr(slash + 1);
  const std::size_t colon = host.rfind(':');
  if (colon != std::string_view::npos && host.find(']', colon) == std::string_view::npos) {
    const std::string_view digits = host.substr(colon + 1);
    const char* const end = digits.data() + digits.size();
    const std::from_chars_result read = std::from_chars(digits.data(), end, settings.port);
    if (read.ec != std::errc() || read.ptr != end || settings.port < 1 || settings.port > 65'535) {
      throw reject("has no port between 1 and 65535");
    }
    host = host.substr(0, colon);
  } else {
    settings.port = 0;
  }
  if (host.empty()) throw reject("names no host");
  settings.host = host;
  return true;
}

}  // namespace robomill::monitor
