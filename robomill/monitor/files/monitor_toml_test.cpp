#include "robomill/monitor/files/monitor_toml.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "robomill/base/units.hpp"
#include "robomill/monitor/files/recordings_toml.hpp"
#include "testing/support.hpp"

namespace robomill::monitor {
namespace monitor_toml_test {

constexpr const char* least = "[signal]\nsample_rate_hz = 10240\nchannels = [\"ax_m_per_s2\"]\n";

TEST(MonitorToml, NumbersSensorsAsTheyCome) {
  const test::Folder folder;
  const auto read = [&](const std::string& signal) {
    return read_monitor(folder.file("m.toml", "[signal]\nsample_rate_hz = 1000\n" + signal));
  };
  const MonitorFile named = read(
      "channels = [\"i1_a\", \"ax\", \"i2_a\"]\nsensors = [\"drives\", \"spindle\", \"drives\"]\n"
      "tachometer = \"pulse\"\n[detector]\nagreeing_sensors = 2\n");
  EXPECT_EQ(named.options.sensors, (std::vector<int>{0, 1, 0, 0}));
  EXPECT_EQ(named.options.agreeing_sensors, 2);
  EXPECT_TRUE(named.notes.empty());
  EXPECT_EQ(read_monitor(folder.file("again.toml", monitor_toml(named))).options.sensors, named.options.sensors);
  const MonitorFile units = read("channels = [\"ax_m_per_s2\", \"ay_m_per_s2\", \"i1 [A]\"]\n");
  EXPECT_EQ(units.options.sensors, (std::vector<int>{0, 0, 1}));
  ASSERT_EQ(units.notes.size(), 1U);
  EXPECT_NE(units.notes.front().find("i1 [A] (sensor 2)"), std::string::npos) << units.notes.front();
  EXPECT_TRUE(read("channels = [\"ax_m_per_s2\", \"ay_m_per_s2\"]\n").options.sensors.empty());
  EXPECT_TRUE(read("channels = [\"ax_m_per_s2\", \"ay\", \"az [g]\"]\n").options.sensors.empty());
  EXPECT_TRUE(read("channels = [1, 2]\nsensors = [\"a\", \"a\"]\n").options.sensors.empty());
  const std::string error = test::rejection([&] { (void)read("channels = [1, 2]\nsensors = [\"a\"]\n"); });
  EXPECT_NE(error.find("m.toml:4: signal.sensors"), std::string::npos) << error;
}

TEST(MonitorToml, ReadsEveryKey) {
  const test::Folder folder;
  const MonitorFile file = read_monitor(folder.file(
      "monitor.toml",
      "[signal]\nsample_rate_hz = 10240\nanti_alias_filter = true\nchannels = [\"ax\", \"ay\"]\n"
      "tachometer = \"pulse\"\ncolumns = 5\nscale = 50\nfull_scale = 49.9\n"
      "[process]\nspindle_speed_rpm = 3000\nmin_speed_rpm = 60\nteeth = 2\n"
      "modes = \"modes.json\"\nlobes = \"lobes.toml\"\n"
      "[detector]\nkind = \"energy-entropy\"\nwindow_ms = 50\nhop_ms = 25\n"
      "bands = 8\nentropy = \"normalised\"\nthreshold = 1.5\n"
      "alarm = \"below\"\nfalse_alarms_per_hour = 0.5\n"
      "[mqtt]\nhost = \"broker\"\nport = 8884\ntopic = \"cell/ax\"\n"
      "events_topic = \"cell/events\"\ncommands_topic = \"cell/commands\"\nclient_id = \"me\"\nuser = \"u\"\n"
      "password_file = \"secret\"\ntls = true\nca_file = \"ca.pem\"\n"
      "certificate_file = \"c.pem\"\nkey_file = \"k.pem\"\nqos = 0\nconnect_timeout_s = 2.5\n"
      "[metrics]\nport = 9110\nhost = \"0.0.0.0\"\n"
      "[act]\nrule = \"hold\"\nreduce_to = 0.4\nretract_mm = 3\n"
      "spindle_speed_rpm = [3000, 9000]\nsettle_s = 1.5\ncalm_s = 4\n"
      "[recording]\nfolder = \"alarms\"\nseconds = 30\n"));
  EXPECT_EQ(file.options.sample_rate_hz, 10240.0);
  EXPECT_TRUE(file.anti_alias_filter);
  EXPECT_EQ(file.columns.channels, (std::vector<std::string>{"ax", "ay", "pulse"}));
  EXPECT_EQ(file.columns.raw_columns, 5);
  EXPECT_EQ(file.columns.scale, 50.0);
  EXPECT_EQ(file.options.channels, 3);
  EXPECT_EQ(file.options.tachometer_channel, 2);
  EXPECT_EQ(file.options.full_scale, 49.9);
  EXPECT_NEAR(file.options.spindle_speed_rad_per_s, 100.0 * std::numbers::pi, 1e-9);
  EXPECT_NEAR(file.options.min_speed_rad_per_s, 2.0 * std::numbers::pi, 1e-12);
  EXPECT_EQ(file.options.teeth, 2);
  EXPECT_EQ(file.modes, folder.at("modes.json"));
  EXPECT_EQ(file.lobes, folder.at("lobes.toml"));
  EXPECT_EQ(file.options.kind, Kind::energy_entropy);
  EXPECT_DOUBLE_EQ(file.options.window_s, 0.05);
  EXPECT_DOUBLE_EQ(file.options.hop_s, 0.025);
  EXPECT_EQ(file.options.bands, 8);
  EXPECT_EQ(file.options.entropy, Entropy::normalised);
  EXPECT_EQ(file.options.threshold, 1.5);
  EXPECT_TRUE(file.options.alarm_below);
  EXPECT_EQ(file.options.false_alarms_per_hour, 0.5);
  EXPECT_EQ(file.mqtt.host, "broker");
  EXPECT_EQ(file.mqtt.port_or_default(), 8884);
  EXPECT_EQ(file.mqtt.topic, "cell/ax");
  EXPECT_EQ(file.mqtt.events_topic, "cell/events");
  EXPECT_EQ(file.mqtt.commands_topic, "cell/commands");
  EXPECT_EQ(file.act.rule, ActRule::hold);
  EXPECT_EQ(file.act.reduce_to, 0.4);
  EXPECT_DOUBLE_EQ(file.act.retract_m, 3e-3);
  EXPECT_NEAR(file.act.lowest_rad_per_s, 100.0 * std::numbers::pi, 1e-9);
  EXPECT_NEAR(file.act.highest_rad_per_s, 300.0 * std::numbers::pi, 1e-9);
  EXPECT_EQ(file.act.settle_s, 1.5);
  EXPECT_EQ(file.act.calm_s, 4.0);
  EXPECT_EQ(file.mqtt.password_file, folder.at("secret"));
  EXPECT_TRUE(file.mqtt.tls);
  EXPECT_EQ(file.mqtt.key_file, folder.at("k.pem"));
  EXPECT_EQ(file.mqtt.qos, 0);
  EXPECT_EQ(file.mqtt.connect_timeout_s, 2.5);
  EXPECT_EQ(file.metrics_port, 9110);
  EXPECT_EQ(file.metrics_host, "0.0.0.0");
  EXPECT_EQ(file.recording_folder, folder.at("alarms"));
  EXPECT_EQ(file.recording_s, 30.0);
}

TEST(MonitorToml, HasDefaults) {
  const test::Folder folder;
  const MonitorFile file = read_monitor(folder.file("monitor.toml", least));
  EXPECT_EQ(file.options.kind, Kind::comb_cusum);
  EXPECT_FALSE(file.anti_alias_filter);
  EXPECT_NEAR(file.options.min_speed_rad_per_s, std::numbers::pi, 1e-12);
  EXPECT_EQ(file.options.tachometer_channel, -1);
  EXPECT_EQ(file.metrics_port, -1);
  EXPECT_EQ(file.recording_s, 60.0);
  EXPECT_EQ(file.mqtt.port_or_default(), 1883);
  EXPECT_NO_THROW(validate(file));
  const MonitorFile numbered = read_monitor(folder.file("n.toml", "[signal]\nchannels = [2, 1]\ntachometer = 3\n"));
  EXPECT_EQ(numbered.columns.channels, (std::vector<std::string>{"2", "1", "3"}));
  EXPECT_EQ(read_monitor(folder.file("o.toml", "[signal]\nchannels = 1\n")).columns.channels.front(), "1");
  // Its rate comes from the recording; where that gives none either, the error names the key.
  EXPECT_NE(test::rejection([&] { validate(numbered); }).find("signal.sample_rate_hz"), std::string::npos);
}

// Nothing acts unless asked to; who asks for no rule in particular gets the one that can end chatter.
TEST(MonitorToml, ActsOnlyWhereATableSaysSo) {
  const test::Folder folder;
  const auto rule = [&](const std::string& more) { return read_monitor(folder.file("m.toml", least + more)).act.rule; };
  EXPECT_EQ(rule(""), ActRule::none);
  EXPECT_EQ(rule("[act]\n"), ActRule::speed);
  EXPECT_EQ(rule("[act]\nreduce_to = 0.3\n"), ActRule::speed);
  EXPECT_EQ(rule("[act]\nrule = \"none\"\n"), ActRule::none);
  EXPECT_EQ(rule("[act]\nrule = \"reduce\"\n"), ActRule::reduce);
  EXPECT_EQ(rule("[act]\nrule = \"speed\"\n"), ActRule::speed);
  EXPECT_EQ(rule("[act]\nrule = \"hold\"\nretract_mm = 1\n"), ActRule::hold);
}

TEST(MonitorToml, ReportsWhatIsWrongWithLineAndKey) {
  const test::Folder folder;
  const auto rejection = [&](const std::string& more) {
    return test::rejection([&] { (void)read_monitor(folder.file("m.toml", least + more)); });
  };
  const auto expect = [&](const std::string& more, const char* part) {
    EXPECT_NE(rejection(more).find(part), std::string::npos) << rejection(more);
  };
  expect("[detector]\nhop_ms = 0\n", "m.toml:5: detector.hop_ms = 0");
  expect("[detector]\nhop_ms = 0.2\n", "m.toml:5: detector.hop_ms = 0.2 ms; must be at least 4 samples long");
  expect("[detector]\nhop_ms = 60\n", "detector.window_ms");
  expect("[detector]\nwindow_ms = 1e6\n",
         "m.toml:5: detector.window_ms = 1e+06 ms; must be at most 1000000 samples long. Is it in us? 50 ms is usual");
  expect("[detector]\nhop_ms = 2.5e5\nwindow_ms = 50\n",
         "m.toml:5: detector.hop_ms = 250000 ms; must be at most 1000000 samples long. Is it in us? 25 ms is usual");
  expect("[detector]\nwindow_ms = 0.05\nhop_ms = 25\n",
         "m.toml:5: detector.window_ms = 0.05 ms; must be at least 8 samples long. Is it in s? 50 ms is usual");
  expect("[detector]\nbands = 1\n", "m.toml:5: detector.bands = 1; must be >= 2 and <= 64");
  expect("[detector]\nkind = \"energy-entropy\"\n", "detector.threshold: is missing; must be finite");
  expect("[detector]\nkind = \"magic\"\n", "must be one of \"comb-cusum\", \"energy-entropy\"");
  expect("[detector]\nfalse_alarms_per_hour = 0\n", "m.toml:5: detector.false_alarms_per_hour = 0");
  expect("[detector]\ntreshold = 5\n", "threshold");
  expect("[process]\nteeth = -1\n", "m.toml:5: process.teeth = -1");
  expect("[process]\nspindle_speed_rpm = -100\n", "m.toml:5: process.spindle_speed_rpm = -100 rpm");
  expect(
      "[process]\nspindle_speed_rpm = 20\n",
      "m.toml:5: process.spindle_speed_rpm = 20 rpm; must be at least the speed below which the spindle stands still "
      "and nothing is judged. Is it in 1/s?");
  expect("[process]\nmin_speed_rpm = 0\n", "m.toml:5: process.min_speed_rpm = 0 rpm; must be >= 1 and <= 100000");
  expect("[mqtt]\nport = 70000\n", "m.toml:5: mqtt.port = 70000");
  expect("[mqtt]\nca_file = \"ca.pem\"\n", "needs mqtt.tls = true");
  expect("[mqtt]\ntls = true\nkey_file = \"k\"\n", "go together");
  expect("[mqtt]\npassword_file = \"k\"\n", "needs mqtt.user");
  expect("[mqtt]\nqos = 3\n", "m.toml:5: mqtt.qos = 3; must be >= 0 and <= 2");
  expect("[mqtt]\nconnect_timeout_s = -1\n", "m.toml:5: mqtt.connect_timeout_s = -1 s; must be >= 0 and <= 86400");
  expect("[mqtt]\nevents_topic = \"a/#\"\n", "without + and #");
  expect("[mqtt]\ncommands_topic = \"a/+\"\n", "m.toml:5: mqtt.commands_topic = \"a/+\"; must be one topic");
  expect("[mqtt]\ntopic = \"a\"\ncommands_topic = \"a\"\n", "must differ from mqtt.topic");
  expect("[mqtt]\nevents_topic = \"a\"\ncommands_topic = \"a\"\n", "must differ from mqtt.events_topic");
  expect("[act]\nrule = \"stop\"\n", "must be one of \"none\", \"reduce\", \"hold\", \"speed\"");
  expect("[act]\nreduce_to = 1\n", "m.toml:5: act.reduce_to = 1; must lie between 0 and 1");
  expect("[act]\nrule = \"hold\"\n", "m.toml:4: act.retract_mm: is missing. A tool that stands still in the cut rubs");
  expect("[act]\nrule = \"hold\"\nretract_mm = 0\n", "m.toml:6: act.retract_mm = 0 mm; must be > 0");
  expect("[act]\nspindle_speed_rpm = 9000\n", "must be [lowest, highest]");
  expect("[act]\nspindle_speed_rpm = [9000, 3000]\n", "must be [lowest, highest]");
  expect("[act]\nsettle_s = 0\n", "m.toml:5: act.settle_s = 0");
  expect("[act]\nwait_s = 1\n", "act.wait_s");
  expect("[metrics]\nport = -2\n", "metrics.port = -2");
  expect("[recording]\nseconds = 0\n", "recording.seconds = 0");
  const auto signal = [&](const char* text) {
    return test::rejection([&] { (void)read_monitor(folder.file("s.toml", std::string("[signal]\n") + text)); });
  };
  EXPECT_NE(signal("sample_rate_hz = 10240\n").find("signal.channels: is missing"), std::string::npos)
      << signal("sample_rate_hz = 10240\n");
  EXPECT_NE(signal("channels = []\n").find("must name one column"), std::string::npos) << signal("channels = []\n");
  EXPECT_NE(signal("channels = [0]\n").find("numbers from 1"), std::string::npos);
  EXPECT_NE(signal("channels = [1, 1]\n").find("twice"), std::string::npos);
  EXPECT_NE(signal("sample_rate_hz = 10\nchannels = [1]\n").find("s.toml:2: signal.sample_rate_hz = 10 Hz"),
            std::string::npos);
  EXPECT_NE(signal("channels = [1]\ntachometer = 1\n").find("another column"), std::string::npos);
  EXPECT_NE(signal("channels = [1]\nscale = 0\n").find("signal.scale = 0"), std::string::npos);
  // A corner frequency, a text or a number states nothing: whether the filter is there is asked.
  for (const char* wrong : {"4000", "\"yes\"", "1", "nan", "[true]", "{ corner_hz = 800 }"}) {
    const std::string said = signal(("channels = [1]\nanti_alias_filter = " + std::string(wrong) + "\n").c_str());
    EXPECT_NE(said.find("s.toml:3: signal.anti_alias_filter"), std::string::npos) << said;
    EXPECT_NE(said.find("must be true or false"), std::string::npos) << said;
  }
  EXPECT_NE(signal("channels = [1]\nantialias_filter = true\n").find("signal.anti_alias_filter"), std::string::npos);
}

TEST(MonitorToml, FollowsTheSpindleSpeedOfARecording) {
  const test::Folder folder;
  const MonitorFile file = read_monitor(folder.file("m.toml", "[signal]\nchannels = \"ax\"\n"));
  const auto source = io::open_samples(folder.file("r.csv", "ax,spindle_speed_rpm\n1,3000\n2,\n"), file.columns);
  io::SampleBlock block;
  ASSERT_TRUE(source->next(2, block));
  EXPECT_NEAR(block.followed, 3000.0 * units::rpm, 1e-9);
}

TEST(MonitorToml, IsReadAsItWasWritten) {
  const test::Folder folder;
  MonitorFile file;
  file.columns.channels = {"a \"quoted\" \\ name", "2", "pulse"};
  file.options.sample_rate_hz = 5000.0;
  file.options.channels = 3;
  file.options.tachometer_channel = 2;
  file.options.kind = Kind::energy_entropy;
  file.options.threshold = 0.1234567890123;
  file.options.alarm_below = true;
  file.options.spindle_speed_rad_per_s = 4000.0 * units::rpm;
  file.options.min_speed_rad_per_s = 100.0 * units::rpm;
  file.options.speed_std_ratio = 0.05;
  const std::string text = monitor_toml(file, "calibrated on\ntwo lines");
  EXPECT_EQ(text.rfind("# calibrated on\n# two lines\n[signal]\n", 0), 0U);
  EXPECT_NE(text.find("spindle_speed_rpm = 4000\n"), std::string::npos);
  const MonitorFile back = read_monitor(folder.file("m.toml", text));
  EXPECT_EQ(back.columns.channels, file.columns.channels);
  EXPECT_EQ(back.options.kind, file.options.kind);
  EXPECT_EQ(back.options.threshold, file.options.threshold);
  EXPECT_EQ(back.options.alarm_below, true);
  EXPECT_EQ(back.options.speed_std_ratio, 0.05);
  EXPECT_NEAR(back.options.min_speed_rad_per_s, file.options.min_speed_rad_per_s, 1e-12);
  EXPECT_EQ(back.options.tachometer_channel, 2);
  EXPECT_EQ(monitor_toml(back), monitor_toml(file));
  EXPECT_EQ(text.find("anti_alias_filter"), std::string::npos);
  file.anti_alias_filter = true;
  EXPECT_TRUE(read_monitor(folder.file("m.toml", monitor_toml(file))).anti_alias_filter);
}

TEST(MqttAddress, IsHostPortAndTopic) {
  MqttSettings settings;
  EXPECT_FALSE(parse_mqtt_address("recording.wav", settings));
  ASSERT_TRUE(parse_mqtt_address("mqtt://broker/cell/1/ax", settings));
  EXPECT_EQ(settings.host, "broker");
  EXPECT_EQ(settings.topic, "cell/1/ax");
  EXPECT_EQ(settings.port_or_default(), 1883);
  ASSERT_TRUE(parse_mqtt_address("mqtts://[::1]:2000/t", settings));
  EXPECT_EQ(settings.host, "[::1]");
  EXPECT_EQ(settings.port_or_default(), 2000);
  EXPECT_TRUE(settings.tls);
  for (const char* wrong : {"mqtt://broker", "mqtt://broker/", "mqtt:///t", "mqtt://broker:0/t", "mqtt://broker:x/t",
                            "mqtt://broker:70000/t"}) {
    EXPECT_THROW(parse_mqtt_address(wrong, settings), InvalidInput) << wrong;
  }
}

constexpr const char* four =
    "[[recordings]]\nfile = \"a.wav\"\nlabel = \"stable\"\n[[recordings]]\nfile = \"b.wav\"\nlabel = \"stable\"\n"
    "[[recordings]]\nfile = \"c.wav\"\nlabel = \"chatter\"\nonset_s = 1.5\nspindle_speed_rpm = 4500\n"
    "[[recordings]]\nfile = \"d.wav\"\nlabel = \"chatter\"\n";

TEST(RecordingsToml, ReadsLabelsAndOnsets) {
  const test::Folder folder;
  const RecordingsFile file = read_recordings(folder.file(
      "r.toml",
      std::string(least) + "[process]\nspindle_speed_rpm = 3000\n[calibration]\nfalse_alarm_rate = 0.1\n" + four));
  ASSERT_EQ(file.recordings.size(), 4U);
  EXPECT_EQ(file.monitor.options.kind, Kind::energy_entropy);
  EXPECT_EQ(file.false_alarm_rate, 0.1);
  EXPECT_FALSE(file.recordings[0].chatter);
  EXPECT_TRUE(std::isnan(file.recordings[0].onset_s));
  EXPECT_EQ(file.recordings[2].onset_s, 1.5);
  EXPECT_TRUE(file.recordings[2].chatter);
  EXPECT_NEAR(file.recordings[2].spindle_speed_rad_per_s, 4500.0 * units::rpm, 1e-9);
  EXPECT_NEAR(file.recordings[3].spindle_speed_rad_per_s, 3000.0 * units::rpm, 1e-9);
  EXPECT_EQ(file.recordings[3].files, std::vector<std::filesystem::path>{folder.at("d.wav")});
}

TEST(RecordingsToml, TakesSeveralFilesOfARecording) {
  const test::Folder folder;
  const RecordingsFile file = read_recordings(folder.file(
      "r.toml", std::string(least) + four + "[[recordings]]\nfile = [\"x.wav\", \"y.wav\"]\nlabel = \"stable\"\n"));
  EXPECT_EQ(file.recordings[4].files, (std::vector<std::filesystem::path>{folder.at("x.wav"), folder.at("y.wav")}));
}

TEST(RecordingsToml, RejectsWhatCannotCalibrate) {
  const test::Folder folder;
  const auto expect = [&](const std::string& text, const char* part) {
    const std::string said = test::rejection([&] { (void)read_recordings(folder.file("r.toml", least + text)); });
    EXPECT_NE(said.find(part), std::string::npos) << said;
  };
  const std::string stable = "[[recordings]]\nfile = \"a.wav\"\nlabel = \"stable\"\n";
  expect("", "recordings: is missing");
  expect(stable + stable, "label = \"chatter\"");
  const std::string chatter = "[[recordings]]\nfile = \"c.wav\"\nlabel = \"chatter\"\n";
  expect(chatter + chatter, "label = \"stable\"");
  expect("[[recordings]]\nfile = \"c.wav\"\nlabel = \"loud\"\n", "r.toml:6: recordings[1].label = \"loud\"");
  expect(stable + "onset_s = 1\n", "is of chatter");
  expect(std::string(four) + "spindle_speed_rpm = 0\n", "must be > 0");
  expect("[[recordings]]\nfile = [\"c.wav\", \"c.wav\"]\nlabel = \"stable\"\n", "r.toml:5: recordings[1].file");
  expect("[[recordings]]\nfile = [\"c.wav\", \"c.wav\"]\nlabel = \"stable\"\n", "names a file twice");
  expect("[[recordings]]\nlabel = \"stable\"\n", "recordings[1].file: is missing");
  expect(std::string("[calibration]\nfalse_alarm_rate = 1\n") + four, "must be >= 0 and < 1");
}

}  // namespace monitor_toml_test
}  // namespace robomill::monitor
