#include "robomill/monitor/files/monitor_tables.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"

namespace robomill::monitor {
namespace {

using io::declared;
using io::Holds;
using io::Json;
using io::key;
using io::of;
using io::Row;
using io::Schema;
using io::TomlFile;

constexpr double longest_s = 3600.0;
constexpr Name<bool> alarm_sides[] = {{"above", false}, {"below", true}};

/// A column's name, or its number from 1.
std::string read_column(TomlFile& file, const std::string& path) {
  std::string name;
  if (!file.is_number(path)) {
    file.text(path, name);
    return name;
  }
  int number = 0;
  file.integer(path, path, number);
  if (number < 1) throw file.reject(path, "must be a column's name or its number from 1");
  return std::to_string(number);
}

void read_channels(TomlFile& file, const std::string& path, MonitorFile& out) {
  std::vector<std::string>& channels = out.columns.channels;
  if (file.is_number(path)) {
    channels = {read_column(file, path)};
  } else if (file.is_number(path + "[0]")) {
    std::vector<int> numbers;
    file.integers(path, "columns", numbers);
    for (const int number : numbers) {
      if (number < 1) throw file.reject(path, "must hold names of columns or numbers from 1");
      channels.push_back(std::to_string(number));
    }
  } else {
    file.texts(path, channels);
  }
  if (channels.empty()) throw file.reject(path, "must name one column at least");
}

/// The last of the channels.
void read_tachometer(TomlFile& file, const std::string& path, MonitorFile& out) {
  std::vector<std::string>& channels = out.columns.channels;
  const std::string tachometer = read_column(file, path);
  if (!tachometer.empty()) {
    if (std::ranges::find(channels, tachometer) != channels.end()) {
      throw file.reject(path, "must be another column than the channels");
    }
    out.options.tachometer_channel = static_cast<int>(channels.size());
    channels.push_back(tachometer);
  }
  out.options.channels = static_cast<int>(channels.size());
}

Row<MonitorFile> channels_key() {
  Row<MonitorFile> row = declared<MonitorFile>(
      "channels", Holds::text,
      "columns by name, or by number from 1. WAV, raw samples and blocks of MQTT have no names: names are assigned to "
      "their columns in this order where there are as many",
      1);
  row.required("Write channels = [\"ax_m_per_s2\"]: names of columns, or numbers from 1");
  row.write = [](const MonitorFile& file, const Row<MonitorFile>&) {
    Json names = Json::array();
    for (int channel = 0; const std::string& name : file.columns.channels) {
      if (channel++ != file.options.tachometer_channel) names.push_back(name);
    }
    return names;
  };
  return row.or_one().or_also(Holds::integer).read_by(read_channels);
}

Row<MonitorFile> tachometer_key() {
  Row<MonitorFile> row =
      declared<MonitorFile>("tachometer", Holds::text,
                            "a column with the pulses of a tachometer or encoder, of either polarity; no vibration");
  row.write = [](const MonitorFile& file, const Row<MonitorFile>&) {
    const int channel = file.options.tachometer_channel;
    return channel < 0 ? Json() : Json(file.columns.channels[static_cast<std::size_t>(channel)]);
  };
  return row.or_also(Holds::integer).read_by(read_tachometer);
}

void read_topic(TomlFile& file, const std::string& path, const std::string& samples, std::string& out) {
  if (!file.text(path, out) || out.empty()) return;
  if (out.find_first_of("+#") != std::string::npos) throw file.reject(path, "must be one topic, without + and #");
  if (out == samples) throw file.reject(path, "must differ from mqtt.topic");
}

/// Topics of what is published.
std::vector<Row<MqttSettings>> published_keys() {
  return {key("events_topic", &MqttSettings::events_topic, "events are published here, one message each")
              .read_by([](TomlFile& file, const std::string& path, MqttSettings& out) {
                read_topic(file, path, out.topic, out.events_topic);
              }),
          key("commands_topic", &MqttSettings::commands_topic,
              "commands of [act] are published here, one message each; without it only the events state what would be "
              "commanded")
              .read_by([](TomlFile& file, const std::string& path, MqttSettings& out) {
                read_topic(file, path, out.topic, out.commands_topic);
                if (!out.commands_topic.empty() && out.commands_topic == out.events_topic) {
                  throw file.reject(path, "must differ from mqtt.events_topic");
                }
              })};
}

void read_speed_range(TomlFile& file, const std::string& path, ActSettings& act) {
  std::vector<double> range;
  if (!file.numbers(path, "lowest_rad_per_s", units::rpm, range)) return;
  if (range.size() != 2 || !(range[0] > 0.0 && range[1] > range[0])) {
    throw file.reject(path, "must be [lowest, highest], both > 0", "The range that tool and spindle allow");
  }
  act.lowest_rad_per_s = range[0];
  act.highest_rad_per_s = range[1];
}

}  // namespace

const Schema<MonitorFile>& signal_table() {
  static const Schema<MonitorFile> table(
      "signal", "the samples",
      {of(&MonitorFile::options,
          key("sample_rate_hz", &MonitorOptions::sample_rate_hz,
              "not needed where the recording states it (WAV, MAT, a column of time); a different one is rejected. "
              "Streams need it")
              .at_least(100.0)
              .at_most(1e6)),
       key("anti_alias_filter", &MonitorFile::anti_alias_filter,
           "whether a filter ahead of the converter removes frequencies above half the sample rate; false: not stated"),
       channels_key(), tachometer_key(),
       key("sensors", &MonitorFile::sensors,
           "the sensor of each channel, by name: powers of a sensor's channels are added, sensors are judged apart, "
           "and "
           "an alarm takes their agreement. Without it channels whose names state unlike units are unlike sensors"),
       of(&MonitorFile::options, key("pulses_per_revolution", &MonitorOptions::pulses_per_revolution,
                                     "of the tachometer. The pulse rate must be below half the sample rate")
                                     .at_least(1.0)
                                     .at_most(10'000.0)),
       of(&MonitorFile::columns, key("columns", &io::SampleColumns::raw_columns,
                                     "of raw samples, where not all of them are named; 0: they are")
                                     .at_least(0.0)
                                     .at_most(1024.0)),
       of(&MonitorFile::columns,
          key("scale", &io::SampleColumns::scale, "unit per full scale of WAV and int16; of float32 a factor. Not 0")),
       of(&MonitorFile::options,
          key("full_scale", &MonitorOptions::full_scale,
              "magnitude at which the converter clips, in the samples' unit; known of integer formats; 0: unknown")
              .at_least(0.0)),
       key("timeout_s", &MonitorFile::timeout_s, "of MQTT and pipes: without samples for this time the state is blind")
           .above(0.0)
           .at_most(longest_s)});
  return table;
}

const Schema<MonitorFile>& process_table() {
  static const Schema<MonitorFile> table(
      "process", "the cut",
      {of(&MonitorFile::options,
          key("spindle_speed_rpm", &MonitorOptions::spindle_speed_rad_per_s,
              "a hint, 0: none; a text column spindle_speed_rpm or the blocks of MQTT may carry it, where 0 is a "
              "standstill")
              .at_least(0.0)),
       of(&MonitorFile::options,
          key("spindle_speed_std_ratio", &MonitorOptions::speed_std_ratio,
              "of that hint. The hint is corrected where the signal shows another speed within 15 %")
              .as("speed_std_ratio")
              .at_least(1e-4)
              .at_most(0.2)),
       of(&MonitorFile::options,
          key("min_speed_rpm", &MonitorOptions::min_speed_rad_per_s,
              "below it, also at 0, the spindle counts as standing: the state is blind. spindle_speed_rpm must not be "
              "below it")
              .at_least(1.0)
              .at_most(1e5)),
       of(&MonitorFile::options,
          key("teeth", &MonitorOptions::teeth, "of the cutter; 0: unknown").at_least(0.0).at_most(64.0)),
       key("modes", &MonitorFile::modes, "modes.json: names the mode that chatters"),
       key("machine", &MonitorFile::machine,
           "machine.json: what the machine shows without chatter, of robomill monitor --learn"),
       key("lobes", &MonitorFile::lobes, "lobes.toml of the cut: the best speed and depth from its lobes")});
  return table;
}

const Schema<MonitorOptions>& detector_table() {
  static const Schema<MonitorOptions> table(
      "detector", "how chatter is detected",
      {key("kind", &MonitorOptions::kind, kind_names, "comb-cusum is robomill's own, the other the published one"),
       key("window_ms", &MonitorOptions::window_s, "energy-entropy's; twice it is the spectrogram's of the report")
           .above(0.0),
       key("hop_ms", &MonitorOptions::hop_s, "between decisions; at most the window").above(0.0),
       key("bands", &MonitorOptions::bands, "equal, up to half the sample rate").at_least(2.0).at_most(64.0),
       key("entropy", &MonitorOptions::entropy, entropy_names, "energy-entropy"),
       key("threshold", &MonitorOptions::threshold, "energy-entropy: required there, from robomill calibrate"),
       key("alarm", &MonitorOptions::alarm_below, alarm_sides,
           "energy-entropy: the side of the threshold that is chatter"),
       key("false_alarms_per_hour", &MonitorOptions::false_alarms_per_hour,
           "comb-cusum. It sets in how many of 8 hops a family must stand: 5 at 0.1, one more for every factor of 37 "
           "fewer, 3 to 8")
           .as("false_alarms_per_hour")
           .in_unit()
           .above(0.0),
       key("agreeing_sensors", &MonitorOptions::agreeing_sensors,
           "votes of several sensors at one line that an alarm takes, each up to 1; 0: (n + 1)/2 of n that see the cut")
           .at_least(0.0)});
  return table;
}

const Schema<MqttSettings>& mqtt_table() {
  static const Schema<MqttSettings> table("mqtt", "the broker that samples come from and events go to", [] {
    std::vector<Row<MqttSettings>> rows = {
        key("host", &MqttSettings::host, "of the broker; --input mqtt://HOST:PORT/TOPIC takes precedence"),
        key("port", &MqttSettings::port, "without it 1883, with TLS 8883").at_least(1.0).at_most(65'535.0),
        key("topic", &MqttSettings::topic, "of the samples")};
    io::add_rows(rows, published_keys());
    io::add_rows<MqttSettings>(
        rows,
        {key("client_id", &MqttSettings::client_id, "without it one of its own"),
         key("user", &MqttSettings::user, "name at the broker"),
         key("password_file", &MqttSettings::password_file, "its first line is the password"),
         key("tls", &MqttSettings::tls, "an encrypted connection"),
         key("ca_file", &MqttSettings::ca_file, "PEM; without it the system's list"),
         key("certificate_file", &MqttSettings::certificate_file,
             "PEM; the monitor's own, where the broker asks for one"),
         key("key_file", &MqttSettings::key_file, "PEM; of that certificate"),
         key("qos", &MqttSettings::qos, "quality of service").at_least(0.0).at_most(2.0),
         key("connect_timeout_s", &MqttSettings::connect_timeout_s,
             "longest wait for a broker's first connection, if samples come from it; then the monitor ends with an "
             "error (exit 1). 0: no limit. A connection lost later is always retried")
             .at_least(0.0)
             .at_most(86'400.0, "0 waits for ever")});
    return rows;
  }());
  return table;
}

const Schema<ActSettings>& act_table() {
  static const Schema<ActSettings> table(
      "act", "reaction to chatter",
      {key("rule", &ActSettings::rule, act_rule_names, "without [act] none. reduce and hold do not remove the cause"),
       key("reduce_to", &ActSettings::reduce_to, "reduce: share of the programmed feed")
           .above(0.0)
           .below(1.0, "It is a share of the programmed feed"),
       key("retract_mm", &ActSettings::retract_m,
           "hold: out of the cut along the tool's axis; required there, because a tool at rest rubs and marks the part")
           .above(0.0),
       declared<ActSettings>(
           "spindle_speed_rpm", Holds::number,
           "lowest and highest allowed by tool and spindle, for speed and for suggestions. Default of "
           "the rule: from half the speed at which chatter is first detected up to it",
           1)
           .entries(2)
           .above(0.0)
           .read_by(read_speed_range),
       key("settle_s", &ActSettings::settle_s,
           "speed: after a command, chatter is ignored for this time: longer than the spindle's change of speed")
           .above(0.0)
           .at_most(longest_s),
       key("calm_s", &ActSettings::calm_s,
           "after a stable state of this length an alarm is over and a reduced feed is restored")
           .above(0.0)
           .at_most(longest_s)});
  return table;
}

const Schema<MonitorFile>& metrics_table() {
  static const Schema<MonitorFile> table(
      "metrics", "GET /metrics in the text format of Prometheus",
      {key("port", &MonitorFile::metrics_port, "0: any free port; without it none")
           .as("metrics_port")
           .at_least(0.0)
           .at_most(65'535.0, "0 takes any port that is free"),
       key("host", &MonitorFile::metrics_host, "an address of this machine, or localhost")});
  return table;
}

const Schema<MonitorFile>& recording_table() {
  static const Schema<MonitorFile> table("recording", "the samples before each alarm, as float WAV",
                                         {key("folder", &MonitorFile::recording_folder, "without it none are kept"),
                                          key("seconds", &MonitorFile::recording_s, "length of each [s]")
                                              .as("recording_s")
                                              .above(0.0)
                                              .at_most(longest_s)});
  return table;
}

}  // namespace robomill::monitor
