#pragma once
#include <memory>
#include <string>

#include "robomill/io/sample_source.hpp"
#include "robomill/monitor/files/monitor_toml.hpp"
#include "robomill/serve/files/folder.hpp"

// Method: robomill/serve/README.md, "Monitor"

namespace robomill::serve {

/// What a session of the monitor takes: its settings, and its samples.
struct MonitorInput {
  monitor::MonitorFile file = {};                    ///< writes, publishes and commands nothing
  std::string name = {};                             ///< of the input, for the client
  std::unique_ptr<io::SampleSource> recording = {};  ///< none: file.mqtt.topic of a broker
};

/// @param config  a monitor.toml of the folder
/// @param input   a recording of the folder, "mqtt://HOST[:PORT]/TOPIC", or empty: mqtt.topic of monitor.toml
/// @throws InvalidInput if a file is missing or wrong, leads out of the folder, or they do not fit each other
[[nodiscard]] MonitorInput open_monitor_input(const Folder& folder, const std::string& config,
                                              const std::string& input);

/// [mqtt] of a monitor.toml of the folder: the broker's user, password, TLS and time-out, for another stream.
/// @throws InvalidInput if the file is missing or wrong, or leads out of the folder
[[nodiscard]] monitor::MqttSettings read_broker_settings(const Folder& folder, const std::string& config);

}  // namespace robomill::serve
