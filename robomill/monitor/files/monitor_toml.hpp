#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/sample_source.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/monitor/monitor.hpp"

// Method: robomill/monitor/README.md, "Files"

namespace robomill::monitor {

/// [mqtt]: where samples come from and events go to.
struct MqttSettings {
  std::string host = "127.0.0.1";
  int port = 0;                     ///< 0: 1883, with TLS 8883
  std::string topic = {};           ///< of the samples; empty: none
  std::string events_topic = {};    ///< of the events; empty: they are not published
  std::string commands_topic = {};  ///< of what a rule of [act] commands; empty: the events alone say it
  std::string client_id = {};       ///< empty: one of its own
  std::string user = {};
  std::filesystem::path password_file = {};  ///< its first line
  bool tls = false;
  std::filesystem::path ca_file = {};  ///< who signed the broker's certificate; empty: the system's list
  std::filesystem::path certificate_file = {}, key_file = {};  ///< the monitor's own, where the broker asks for one
  int qos = 1;                                                 ///< 0, 1 or 2
  /// Of the broker that samples come from: without a first connection for so long the monitor ends; 0: it waits for
  /// ever.
  double connect_timeout_s = 10.0;

  [[nodiscard]] int port_or_default() const { return port != 0 ? port : (tls ? 8883 : 1883); }
};

/// [act]: what to do about chatter. Rules act on the robot through live/.
enum class ActRule {
  none,    ///< without that table
  reduce,  ///< the feed, to reduce_to: it bounds the damage and does not end regenerative chatter
  hold,    ///< the motion, with a retract: a tool that stands still in the cut rubs
  speed    ///< the spindle, to the suggested speed; the feed follows, so that feed per tooth stays
};
inline constexpr Name<ActRule> act_rule_names[] = {
    {"none", ActRule::none}, {"reduce", ActRule::reduce}, {"hold", ActRule::hold}, {"speed", ActRule::speed}};
struct ActSettings {
  ActRule rule = ActRule::speed;
  double reduce_to = 0.5;  ///< of the programmed feed, in (0, 1)
  double retract_m = 0.0;  ///< out of the cut, along the tool's axis; hold: > 0, required
  /// Of the spindle: speeds that tool and machine allow, lowest < highest. 0: from half the speed at which chatter was
  /// first detected up to that speed.
  double lowest_rad_per_s = 0.0, highest_rad_per_s = 0.0;
  double settle_s = 2.0;  ///< > 0; after a change of speed, before chatter that is still there counts against it
  double calm_s = 1.0;    ///< > 0; stable for so long, an alarm is over and a reduced feed is restored
};

/// monitor.toml.
struct MonitorFile {
  std::filesystem::path path = {};
  /// [signal], without the rate; the tachometer is the last channel. The spindle speed is followed.
  io::SampleColumns columns = {.channels = {}, .followed = "spindle_speed_rpm", .followed_factor = units::rpm};
  /// signal.sensors: of each channel but the tachometer the name of its sensor; empty: those of unlike units are judged
  /// apart. MonitorOptions::sensors numbers them as they come.
  std::vector<std::string> sensors = {};
  MonitorOptions options = {};  ///< sample_rate_hz is 0 where the file leaves it to the recording
  /// Whether nothing above half the sample rate was sampled; false: not stated, and lines may be folded.
  bool anti_alias_filter = false;
  std::filesystem::path modes = {};    ///< process.modes; empty: none
  std::filesystem::path machine = {};  ///< process.machine, machine.json; load_machine reads it; empty: none
  std::filesystem::path lobes = {};    ///< process.lobes, or the document itself where it holds the cut; empty: none
  double timeout_s = 1.0;              ///< without samples for so long, the state is blind; > 0
  ActSettings act = {.rule = ActRule::none};
  MqttSettings mqtt = {};
  int metrics_port = -1;  ///< -1: none; 0: any that is free
  std::string metrics_host = "127.0.0.1";
  std::filesystem::path recording_folder = {};  ///< empty: alarms are not recorded
  double recording_s = 60.0;                    ///< before each alarm
  std::vector<std::string> notes = {};          ///< sentences for the user
  std::vector<Assumption> assumed = {};         ///< sample values
};

/// Everything but the sample rate, where it is missing, is checked.
/// @throws InvalidInput with file, line, key and value
[[nodiscard]] ROBOMILL_API MonitorFile read_monitor(const io::TomlSource& source);

/// Checks the options once the sample rate is known. @throws InvalidInput in the words of the file
ROBOMILL_API void validate(const MonitorFile& file);

/// monitor.toml as text, with the tables [signal], [process] and [detector]; `remarks` stand above as comments. Paths
/// are written as they are.
[[nodiscard]] ROBOMILL_API std::string monitor_toml(const MonitorFile& file, const std::string& remarks = {});

/// "mqtt://HOST[:PORT]/TOPIC", or mqtts:// for TLS, put into settings. False where the text is no such address.
/// @throws InvalidInput if it is one without a host or topic, or its port is none
ROBOMILL_API bool parse_mqtt_address(const std::string& text, MqttSettings& settings);

}  // namespace robomill::monitor
