#include "robomill/monitor/files/monitor_toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/si.hpp"
#include "robomill/io/system/append.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/io/toml/samples.hpp"
#include "robomill/monitor/files/monitor_tables.hpp"

namespace robomill::monitor {
namespace {

/// Stands in for a rate that only the recording knows, so that all else can be checked.
constexpr double some_rate_hz = 10'240.0;

/// Rules over several keys.
void check_mqtt(const io::TomlFile& file, const MqttSettings& mqtt) {
  if (!mqtt.password_file.empty() && mqtt.user.empty()) throw file.reject("mqtt.password_file", "needs mqtt.user");
  for (const char* key : {"mqtt.ca_file", "mqtt.certificate_file", "mqtt.key_file"}) {
    if (file.has(key) && !mqtt.tls) throw file.reject(key, "needs mqtt.tls = true");
  }
  if (mqtt.certificate_file.empty() != mqtt.key_file.empty()) {
    throw file.reject(mqtt.key_file.empty() ? "mqtt.certificate_file" : "mqtt.key_file",
                      "certificate_file and key_file go together");
  }
}

void read_act(io::TomlFile& file, ActSettings& act) {
  if (!file.has("act")) return;
  act = {};
  act_table().read(file, "act", act);
  if (act.rule == ActRule::hold && act.retract_m == 0.0) {
    file.require("act.retract_mm", "A tool that stands still in the cut rubs and marks the part: hold needs a retract");
  }
}

/// By the unit that a channel's name states: "m/s²" and "g" are one. Empty: none.
std::string quantity_of(const std::string& channel) {
  const std::string unit = io::unit_of_column(channel);
  if (unit.empty()) return {};
  const io::Quantity quantity = io::parse_unit(unit).quantity;
  return quantity == io::Quantity::unknown ? unit : fmt::format("{}", static_cast<int>(quantity));
}

/// By the names given, else by the quantities that the channels' names state.
void number_sensors(const io::TomlFile& file, MonitorFile& out) {
  const std::vector<std::string>& channels = out.columns.channels;
  std::vector<std::string> names = out.sensors;
  const auto tachometer = static_cast<std::size_t>(out.options.tachometer_channel);
  const std::size_t vibration = channels.size() - (tachometer < channels.size() ? 1 : 0);
  if (file.has("signal.sensors") && names.size() != vibration) {
    throw file.reject("signal.sensors", fmt::format("must name one sensor a channel: {}", vibration));
  }
  if (names.empty()) {
    if (out.options.kind != Kind::comb_cusum) return;
    for (std::size_t c = 0; c < vibration; ++c) names.push_back(quantity_of(channels[c]));
    // One that says nothing is of the first that does.
    const auto first = std::ranges::find_if(names, [](const std::string& name) { return !name.empty(); });
    if (first == names.end()) return;
    const std::string said = *first;
    std::ranges::replace(names, std::string(), said);
  }
  std::vector<std::string> unlike;
  out.options.sensors.clear();
  for (const std::string& name : names) {
    const auto at = std::ranges::find(unlike, name) - unlike.begin();
    if (at == std::ssize(unlike)) unlike.push_back(name);
    out.options.sensors.push_back(static_cast<int>(at));
  }
  if (unlike.size() < 2) {
    out.options.sensors.clear();
    return;
  }
  out.options.sensors.resize(channels.size());  // the tachometer is the last one
}

/// Of sensors that nobody named.
std::vector<std::string> notes_on_sensors(const MonitorFile& file) {
  if (!file.sensors.empty() || file.options.sensors.empty()) return {};
  std::string list;
  for (std::size_t c = 0; c < file.columns.channels.size(); ++c) {
    if (static_cast<int>(c) == file.options.tachometer_channel) continue;
    io::append(list, "{}{} (sensor {})", list.empty() ? "" : ", ", file.columns.channels[c],
               file.options.sensors[c] + 1);
  }
  return {"channels of unlike units are judged as sensors apart, and an alarm takes their agreement: " + list +
          ". signal.sensors says otherwise"};
}

std::string toml_value(const io::Json& value) {
  if (value.is_string()) return io::toml_quoted(value.get_ref<const std::string&>());
  if (!value.is_array())
    return value.is_number_float() ? fmt::format("{:.15g}", value.get<double>()) : io::plain_text(value);
  std::string list;
  for (const io::Json& one : value) list += (list.empty() ? "" : ", ") + toml_value(one);
  return "[" + list + "]";
}

/// @param written  (const std::string& key, bool changed) -> whether the key is; changed: it is not the default
template <class T, class Written>
void append_table(std::string& out, const io::Schema<T>& table, const T& object, Written written) {
  const T fresh{};
  for (const io::Row<T>& row : table.rows()) {
    const io::Json value = table.value(row, object);
    if (value.is_discarded() || value.is_null()) continue;
    if (!written(row.key.name, value != table.value(row, fresh))) continue;
    io::append(out, "{} = {}\n", row.key.name, toml_value(value));
  }
}

}  // namespace

void read_detection(io::TomlFile& file, MonitorFile& out) {
  signal_table().read(file, "signal", out);
  out.columns.sample_rate_hz = out.options.sample_rate_hz;
  file.locate([&] { out.columns.validate(); });
  process_table().read(file, "process", out);
  detector_table().read(file, "detector", out.options);
  number_sensors(file, out);
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
  read_detection(file, out);
  if (out.lobes.empty() && file.has("lobes")) out.lobes = source.path;
  read_act(file, out.act);
  mqtt_table().read(file, "mqtt", out.mqtt);
  check_mqtt(file, out.mqtt);
  metrics_table().read(file, "metrics", out);
  recording_table().read(file, "recording", out);
  out.notes = file.done();
  std::ranges::copy(notes_on_sensors(out), std::back_inserter(out.notes));
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
    if (parts.field == "machine") parts.field = "process.machine";
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
  std::string_view rest = remarks;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    io::append(out, "# {}\n", rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  const auto changed = [](const std::string& /*key*/, bool differs) { return differs; };
  out += "[signal]\n";
  append_table(out, signal_table(), file, changed);
  out += "\n[process]\n";
  append_table(out, process_table(), file, changed);
  out += "\n[detector]\n";
  append_table(out, detector_table(), o, [&](const std::string& key, bool /*differs*/) {
    const bool published = key == "entropy" || key == "threshold" || key == "alarm";
    if (key == "agreeing_sensors") return o.agreeing_sensors > 0;
    return o.kind == Kind::energy_entropy ? key != "false_alarms_per_hour" : !published;
  });
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
