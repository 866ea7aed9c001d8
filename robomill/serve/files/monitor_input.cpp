#include "robomill/serve/files/monitor_input.hpp"

#include <fmt/format.h>

#include "robomill/base/error.hpp"
#include "robomill/monitor/files/machine_json.hpp"

namespace robomill::serve {

monitor::MqttSettings read_broker_settings(const Folder& folder, const std::string& config) {
  monitor::MqttSettings out = monitor::read_monitor(folder.resolve(config)).mqtt;
  out.client_id.clear();  // a monitor may run with it
  return out;
}

MonitorInput open_monitor_input(const Folder& folder, const std::string& config, const std::string& input) {
  MonitorInput out = {.file = monitor::read_monitor(folder.resolve(config))};
  monitor::MonitorFile& file = out.file;
  // The page looks on.
  file.mqtt.events_topic.clear();
  file.mqtt.commands_topic.clear();
  file.recording_folder.clear();
  // A broker ends the older of two connections with one name.
  file.mqtt.client_id.clear();
  const bool is_stream = input.empty() ? !file.mqtt.topic.empty() : monitor::parse_mqtt_address(input, file.mqtt);
  if (is_stream) {
    if (file.options.sample_rate_hz <= 0.0) {
      throw InvalidInput(InvalidInput::Parts{
          .where = file.path.string(), .field = "signal.sample_rate_hz", .rule = "must be given for a stream"});
    }
    out.name = fmt::format("mqtt://{}:{}/{}", file.mqtt.host, file.mqtt.port_or_default(), file.mqtt.topic);
  } else {
    if (input.empty()) {
      throw InvalidInput("input", "is missing, and monitor.toml names no mqtt.topic",
                         "Give a recording of the folder, or mqtt://HOST/TOPIC");
    }
    out.name = input;
    out.recording = io::open_samples(folder.resolve(input), file.columns);
    if (file.options.sample_rate_hz <= 0.0) file.options.sample_rate_hz = out.recording->sample_rate_hz();
    if (file.options.full_scale <= 0.0) file.options.full_scale = out.recording->full_scale();
  }
  monitor::load_machine(file);
  monitor::validate(file);
  return out;
}

}  // namespace robomill::serve
