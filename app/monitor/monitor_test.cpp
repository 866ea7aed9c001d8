// robomill monitor as a user runs it: recordings, pipes, a broker.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "monitor/http_get.hpp"
#include "monitor/mqtt.hpp"
#include "monitor/test_processes.hpp"
#include "robomill/base/random.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/sample_source.hpp"
#include "robomill/monitor/files/stream_block.hpp"
#include "test_program.hpp"

namespace robomill::app {
namespace monitor_test {

using nlohmann::json;
using test::wait_for;

constexpr double rate_hz = 10240.0;
constexpr std::size_t block_frames = 512;
constexpr double chatter_hz = 683.0, onset_s = 4.0;

/// A cut at 3000 rpm with two teeth and noise; from onset_s on chatter grows, until it stands.
std::vector<float> cut(double seconds, bool chatters) {
  Random random(42);
  std::vector<float> samples;
  const auto count = static_cast<std::size_t>(seconds * rate_hz);
  for (std::size_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / rate_hz;
    double x = 0.3 * random.normal();
    for (int k = 1; k <= 6; ++k) x += 4.0 / k * std::sin(2.0 * std::numbers::pi * 50.0 * k * t + k);
    if (chatters && t > onset_s) {
      x += std::min(20.0, 0.02 * std::exp((t - onset_s) / 0.05)) * std::sin(2.0 * std::numbers::pi * chatter_hz * t);
    }
    samples.push_back(static_cast<float>(x));
  }
  return samples;
}

class MonitorVerb : public ProgramTest {
 protected:
  void SetUp() override { folder_.file("monitor.toml", config_); }
  void wav(const std::string& name, const std::vector<float>& samples) {
    io::write_wav(folder_.at(name), samples, 1, rate_hz);
  }
  [[nodiscard]] std::vector<json> events(const std::string& name = "events.jsonl") const {
    std::vector<json> out;
    std::istringstream lines(slurp(folder_.at(name)));
    for (std::string line; std::getline(lines, line);) {
      out.push_back(json::parse(line, nullptr, false));
      EXPECT_FALSE(out.back().is_discarded()) << line;
    }
    return out;
  }
  /// Of one kind: "state", or what befell a stream.
  [[nodiscard]] std::vector<json> events_of(const std::string& what) const {
    std::vector<json> out;
    for (const json& event : events()) {
      if (event["event"] == what || (event.contains("what") && event["what"] == what)) out.push_back(event);
    }
    return out;
  }
  [[nodiscard]] bool has_event(const std::string& what) const {
    return slurp(folder_.at("events.jsonl")).find("\"" + what + "\"") != std::string::npos;
  }

  /// The configuration with another timeout.
  [[nodiscard]] std::string timed(const std::string& timeout_s) const {
    return "[signal]\ntimeout_s = " + timeout_s + "\n" + config_.substr(config_.find('\n') + 1);
  }

  const std::string config_ =
      "[signal]\nsample_rate_hz = 10240\nchannels = [\"ax_m_per_s2\"]\n[process]\nspindle_speed_rpm = 3000\nteeth = "
      "2\n";
};

TEST_F(MonitorVerb, DetectsChatterInARecording) {
  wav("rec.wav", cut(8.0, true));
  const Ended run =
      robomill("monitor monitor.toml --input rec.wav -o events.jsonl --record alarms --report report.json");
  ASSERT_EQ(run.exit, 0) << run.err;
  const std::vector<json> states = events_of("state");
  const auto alarm =
      std::find_if(states.begin(), states.end(), [](const json& event) { return event["state"] == "chatter"; });
  ASSERT_NE(alarm, states.end()) << run.out;
  EXPECT_GT((*alarm)["time_s"].get<double>(), onset_s);
  EXPECT_LT((*alarm)["time_s"].get<double>(), onset_s + 0.5);
  EXPECT_NEAR((*alarm)["chatter_frequency_hz"].get<double>(), chatter_hz, 2.0);
  EXPECT_NE(run.out.find("chatter at 68"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("320 decisions, 1 alarm."), std::string::npos) << run.out;
  // The seconds before the alarm, as they were.
  ASSERT_EQ(events_of("recording").size(), 1U);
  const auto recorded =
      io::open_samples(folder_.path() / events_of("recording")[0]["file"].get<std::string>(), {.channels = {"1"}});
  io::SampleBlock block;
  ASSERT_TRUE(recorded->next(100'000, block));
  EXPECT_NEAR(static_cast<double>(block.samples.size()) / rate_hz, (*alarm)["time_s"].get<double>(), 0.026);
  EXPECT_EQ(block.samples[1000], cut(1.0, false)[1000]);
  const json report = json::parse(slurp(folder_.at("report.json")));
  EXPECT_EQ(report["monitor"]["decision_count"], 320);
  EXPECT_EQ(report["monitor"]["events"].size(), events().size());
  EXPECT_FALSE(report["monitor"]["spectrogram"].is_null());
}

// 683 Hz at 3000 rpm with two teeth: tooth passing 100 Hz, so k = 7 gives 60 * 683 / (2 * 7) rpm; mode 2 stands there.
TEST_F(MonitorVerb, NamesTheModeAndABetterSpeed) {
  wav("rec.wav", cut(6.0, true));
  folder_.file("modes.toml",
               "[[modes]]\nfrequency_hz = 300\ndamping_ratio = 0.02\nleft = { x = [1, 0] }\nright = { x = [1, 0] }\n"
               "[[modes]]\nfrequency_hz = 682\ndamping_ratio = 0.01\nleft = { x = [1, 0] }\nright = { x = [1, 0] }\n");
  folder_.file("moded.toml", config_ + "modes = \"modes.toml\"\n");
  ASSERT_EQ(robomill("monitor moded.toml --input rec.wav -o events.jsonl").exit, 0);
  const std::vector<json> states = events_of("state");
  const auto alarm =
      std::find_if(states.begin(), states.end(), [](const json& event) { return event["state"] == "chatter"; });
  ASSERT_NE(alarm, states.end());
  EXPECT_EQ((*alarm)["mode"], 2);
  EXPECT_NEAR((*alarm)["suggested_spindle_speed_rpm"].get<double>(), 60.0 * chatter_hz / 14.0, 15.0);
  EXPECT_GE((*alarm)["stable_spindle_speeds_rpm"].size(), 2U);
  folder_.file("toothless.toml", "[signal]\nchannels = [1]\n[process]\nmodes = \"modes.toml\"\n");
  EXPECT_NE(robomill("monitor toothless.toml --input rec.wav").err.find("process.teeth"), std::string::npos);
}

// The chart that robomill lobes writes of the same file: its deepest limit, of which a fifth is kept as a margin.
TEST_F(MonitorVerb, AdvisesTheBestSpeedAndDepthOfTheLobes) {
  wav("rec.wav", cut(6.0, true));
  folder_.file("lobes.toml",
               "[tool]\nteeth = 3\ndiameter_mm = 12\n[cut]\ndirection = \"up\"\nradial_depth_mm = 1.8\n"
               "feed_per_tooth_mm = 0.01\n[coefficients]\ntangential_n_per_mm2 = 712\nradial_n_per_mm2 = 287\n"
               "[dynamics]\nx = [{ frequency_hz = 682, damping_ratio = 0.02, modal_mass_kg = 0.02 }]\n"
               "y = [{ frequency_hz = 682, damping_ratio = 0.02, modal_mass_kg = 0.02 }]\n"
               "[lobes]\nspindle_speed_rpm = [6600, 7500]\naxial_depth_mm = [0, 3]\n"
               "grid = [20, 10]\n");
  const Ended chart = robomill("lobes lobes.toml -o -");
  ASSERT_EQ(chart.exit, 0) << chart.err;
  const json lobes = json::parse(chart.out);
  double best_rpm = 0.0, best_mm = 0.0, least_mm = 1e9;
  for (const json& limit : lobes["limit"]) {
    ASSERT_FALSE(limit["axial_depth_mm"].is_null());
    const auto depth_mm = limit["axial_depth_mm"].get<double>();
    least_mm = std::min(least_mm, depth_mm);
    if (depth_mm <= best_mm) continue;
    best_mm = depth_mm;
    best_rpm = limit["spindle_speed_rpm"].get<double>();
  }
  ASSERT_GT(best_mm, 1.2 * least_mm);  // otherwise any speed would do, or else the first or the last
  ASSERT_NE(best_rpm, lobes["limit"].front()["spindle_speed_rpm"].get<double>());
  ASSERT_NE(best_rpm, lobes["limit"].back()["spindle_speed_rpm"].get<double>());
  folder_.file("lobed.toml", config_ + "lobes = \"lobes.toml\"\n");
  const Ended run = robomill("monitor lobed.toml --input rec.wav -o events.jsonl");
  ASSERT_EQ(run.exit, 0) << run.err;
  const std::vector<json> states = events_of("state");
  const auto alarm =
      std::find_if(states.begin(), states.end(), [](const json& event) { return event["state"] == "chatter"; });
  ASSERT_NE(alarm, states.end());
  EXPECT_NEAR((*alarm)["suggested_spindle_speed_rpm"].get<double>(), best_rpm, 1e-6 * best_rpm);
  EXPECT_NEAR((*alarm)["suggested_axial_depth_mm"].get<double>(), 0.8 * best_mm, 1e-6 * best_mm);
  // Of the milling robot's modes it is one of the arm that shows up there, 7 tooth passings less 17.4 Hz: for it there
  // is no better speed.
  folder_.file("armed.toml", config_ + "modes = \"" ROBOMILL_SOURCE_DIR "/data/robot-modes.toml\"\n");
  ASSERT_EQ(robomill("monitor armed.toml --input rec.wav -o events.jsonl").exit, 0);
  for (const json& event : events_of("state")) {
    EXPECT_TRUE(event["suggested_spindle_speed_rpm"].is_null());
    if (event["state"] != "chatter") continue;
    EXPECT_TRUE(event["no_speed"] == "arm" || event["no_speed"] == "unclear") << event;
  }
  folder_.file("unlobed.toml", config_ + "lobes = \"none.toml\"\n");
  const Ended rejected = robomill("monitor unlobed.toml --input rec.wav -o unlobed.jsonl");
  EXPECT_EQ(rejected.exit, 1);
  EXPECT_NE(rejected.err.find("none.toml"), std::string::npos) << rejected.err;
  EXPECT_FALSE(std::filesystem::exists(folder_.at("unlobed.jsonl")));
}

TEST_F(MonitorVerb, LeavesAnEmptyFileWhereNothingHappens) {
  wav("rec.wav", cut(5.0, false));
  const Ended run = robomill("monitor monitor.toml --input rec.wav -o events.jsonl");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_EQ(slurp(folder_.at("events.jsonl")), "");
  EXPECT_TRUE(std::filesystem::exists(folder_.at("events.jsonl")));
  EXPECT_NE(run.out.find("0 alarms"), std::string::npos) << run.out;
  EXPECT_EQ(robomill("monitor monitor.toml --input rec.wav --quiet").out, "");
}

TEST_F(MonitorVerb, ReportsEveryWindow) {
  wav("rec.wav", cut(2.0, false));
  const Ended run = robomill("monitor monitor.toml --input rec.wav --every-window -o -");
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_EQ(std::count(run.out.begin(), run.out.end(), '\n'), 80);
  std::istringstream lines(run.out);
  double before_s = 0.0;
  for (std::string line; std::getline(lines, line);) {
    const json event = json::parse(line);
    for (const char* key : {"time_s", "state", "score", "threshold", "energy_entropy", "chatter_frequency_hz", "mode",
                            "suggested_spindle_speed_rpm", "compute_us"}) {
      EXPECT_TRUE(event.contains(key)) << key;
    }
    EXPECT_NEAR(event["time_s"].get<double>() - before_s, 0.025, 1.5e-4);
    before_s = event["time_s"].get<double>();
  }
}

// The same samples by each way in: the same events but for the time that they took.
TEST_F(MonitorVerb, GivesTheSameEventsForEveryInput) {
  const std::vector<float> samples = cut(6.0, true);
  wav("rec.wav", samples);
  folder_.file("rec.raw", {reinterpret_cast<const char*>(samples.data()), 4 * samples.size()});
  std::string csv = "time_s,ax_m_per_s2\n", bare;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::array<char, 64> text = {};
    std::snprintf(text.data(), text.size(), "%.9g", static_cast<double>(samples[i]));
    csv += std::to_string(static_cast<double>(i) / rate_hz) + "," + text.data() + "\n";
    bare += std::string(text.data()) + "\n";
  }
  folder_.file("rec.csv", csv);
  folder_.file("bare.csv", bare);
  const auto events_from = [&](const std::string& input) {
    const Ended run = robomill("monitor monitor.toml --every-window -o - " + input);
    EXPECT_EQ(run.exit, 0) << run.err;
    std::string out;
    std::istringstream lines(run.out);
    for (std::string line; std::getline(lines, line);) {
      json event = json::parse(line);
      event.erase("compute_us");
      out += event.dump() + "\n";
    }
    return out;
  };
  const std::string wanted = events_from("--input rec.wav");
  EXPECT_EQ(std::count(wanted.begin(), wanted.end(), '\n'), 240);
  EXPECT_EQ(events_from("--input rec.csv"), wanted);
  EXPECT_EQ(events_from("--input bare.csv"), wanted);
  EXPECT_EQ(events_from("--input - <rec.raw"), wanted);
  EXPECT_EQ(events_from("--input - --format f32 <rec.raw"), wanted);
  EXPECT_EQ(events_from("--input rec.raw --format f32"), wanted);
  const Ended piped = shell("cat rec.csv | '" ROBOMILL_PROGRAM "' monitor monitor.toml --input - -o events.jsonl");
  EXPECT_EQ(piped.exit, 0) << piped.err;
  EXPECT_FALSE(events_of("state").empty());
}

TEST_F(MonitorVerb, LivesThroughBadSamples) {
  std::vector<float> samples = cut(4.0, false);
  for (std::size_t i = 20'000; i < 21'000; ++i) samples[i] = std::numeric_limits<float>::quiet_NaN();
  wav("rec.wav", samples);
  const Ended run = robomill("monitor monitor.toml --input rec.wav -o events.jsonl --report report.html");
  ASSERT_EQ(run.exit, 0);
  // 1,000 samples are three hops that are mostly lost, and four more are left out.
  EXPECT_NE(run.out.find("cannot tell: gap, for 0.2 s\n"), std::string::npos) << run.out;
  const std::string page = slurp(folder_.at("report.html"));
  EXPECT_NE(page.find("Cannot tell: gap, for 0."), std::string::npos);
  EXPECT_EQ(page.find("cannot tell: gap"), std::string::npos);  // once is enough
  const std::vector<json> faults = events_of("fault");
  ASSERT_FALSE(faults.empty());
  EXPECT_EQ(faults.front()["faults"][0], "not-finite");
  const std::vector<json> states = events_of("state");
  ASSERT_GE(states.size(), 2U);
  EXPECT_EQ(states[0]["reason"], "gap");
  EXPECT_NE(states[1]["state"], "blind");
  EXPECT_NEAR(faults.front()["time_s"].get<double>(), 20'000 / rate_hz, 0.03);
  folder_.file(
      "rec.csv", "ax_m_per_s2\n" + [] {
        std::string rows;
        for (int i = 0; i < 3000; ++i) rows += i % 100 == 50 ? "what\n" : std::to_string(i % 7) + "\n";
        return rows;
      }());
  ASSERT_EQ(robomill("monitor monitor.toml --input rec.csv -o events.jsonl").exit, 0);
  std::uint64_t rows = 0;
  for (const json& event : events_of("unreadable-rows")) rows += event["count"].get<std::uint64_t>();
  EXPECT_EQ(rows, 30U);
}

// A pipe whose writer waits until it is missed, and then goes on.
TEST_F(MonitorVerb, MissesSamplesOfAPipe) {
  const std::vector<float> samples = cut(1.0, false);
  folder_.file("rec.raw", {reinterpret_cast<const char*>(samples.data()), 4 * samples.size()});
  folder_.file("monitor.toml", timed("0.2"));
  const Ended run = shell(
      "(cat rec.raw; i=0; until grep -q no-signal events.jsonl || [ $i -gt 600 ]; do i=$((i+1)); sleep 0.1; done; "
      "cat rec.raw) | '" ROBOMILL_PROGRAM
      "' monitor monitor.toml --input - --format f32 -o events.jsonl --report "
      "report.json");
  ASSERT_EQ(run.exit, 0) << run.err;
  const std::vector<json> states = events_of("state");
  ASSERT_GE(states.size(), 2U);
  EXPECT_EQ(states[0]["state"], "blind");
  EXPECT_EQ(states[0]["reason"], "no-signal");
  EXPECT_NE(states[1]["state"], "blind");
  EXPECT_TRUE(states[1]["reason"].is_null());
  EXPECT_NE(run.out.find("blind (no-signal)\n"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("0 alarms.\ncannot tell: no-signal, for 0."), std::string::npos) << run.out;
  EXPECT_EQ(run.out.find("gap"), std::string::npos) << run.out;
  const json times = json::parse(slurp(folder_.at("report.json")))["monitor"]["state_times"];
  const auto blind =
      std::find_if(times.begin(), times.end(), [](const json& time) { return time["state"] == "blind"; });
  ASSERT_NE(blind, times.end()) << times;
  EXPECT_EQ((*blind)["reason"], "no-signal");
  EXPECT_GE((*blind)["duration_s"].get<double>(), 0.2);
}

TEST_F(MonitorVerb, RejectsBadInputWithOneMessage) {
  wav("rec.wav", cut(0.5, false));
  const auto rejected = [&](const std::string& arguments, const char* part) {
    const Ended run = robomill("monitor " + arguments);
    EXPECT_EQ(run.exit, 1) << arguments;
    EXPECT_NE(run.err.find(part), std::string::npos) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  };
  EXPECT_EQ(robomill("monitor").exit, 2);
  EXPECT_EQ(robomill("monitor monitor.toml --input rec.wav --format magic").exit, 2);
  rejected("monitor.toml", "--input");
  rejected("none.toml --input rec.wav", "none.toml");
  rejected("monitor.toml --input none.wav", "none.wav");
  rejected("monitor.toml --input rec.wav -o no/such/folder.jsonl", "cannot be written");
  rejected("monitor.toml --input rec.wav --every-window -o - >/dev/full", "could not be written");
  rejected("monitor.toml --input rec.wav --report r.pdf", "r.pdf");
  rejected("monitor.toml --input mqtt://127.0.0.1", "names no topic");
  folder_.file("five.toml", "[signal]\nsample_rate_hz = 5000\nchannels = [1]\n");
  rejected("five.toml --input rec.wav -o five.jsonl", "was sampled at 10240 Hz");
  EXPECT_FALSE(std::filesystem::exists(folder_.at("five.jsonl")));
  folder_.file("two.toml", "[signal]\nchannels = [1, 2]\n");
  rejected("two.toml --input rec.wav", "has no column 2");
  rejected("two.toml --input mqtt://127.0.0.1/t", "must be given for a stream");
  folder_.file("x.csv", "ay\n1\n");
  rejected("monitor.toml --input x.csv", "has no column ax_m_per_s2. It has 1 column: ay");
}

TEST_F(MonitorVerb, ShowsALine) {
  wav("rec.wav", cut(3.0, false));
  const Ended run = robomill("monitor monitor.toml --input rec.wav --watch");
  ASSERT_EQ(run.exit, 0);
  EXPECT_GE(std::count(run.err.begin(), run.err.end(), '\n'), 3);
  EXPECT_NE(run.err.find("stable"), std::string::npos);
}

/// With a broker, a monitor that listens to it and a client that sends.
class MonitorStream : public MonitorVerb {
 protected:
  void SetUp() override {
    MonitorVerb::SetUp();
    configure("3600");  // a test may take its time between two blocks
    monitor::MqttSettings settings;
    settings.port = broker_.port();
    client_ = std::make_unique<MqttClient>(
        settings, "cell/events", MqttClient::Calls{.message = [this](std::span<const std::byte> payload) {
          const std::scoped_lock lock(mutex_);
          published_.append(reinterpret_cast<const char*>(payload.data()), payload.size());
          published_ += '\n';
        }});
    client_->start();
    ASSERT_TRUE(client_->wait_until_connected(std::chrono::seconds(60)));
  }
  void TearDown() override { client_.reset(); }
  void configure(const std::string& timeout_s) {
    folder_.file("monitor.toml", timed(timeout_s) + "[mqtt]\nport = " + std::to_string(broker_.port()) +
                                     "\ntopic = \"cell/ax\"\nevents_topic = \"cell/events\"\n");
  }
  void listen(const std::string& input = {}) {
    std::vector<std::string> words = {
        ROBOMILL_PROGRAM, "monitor", folder_.at("monitor.toml"), "-o", folder_.at("events.jsonl"),
        "--metrics-port", "0"};
    if (!input.empty()) words.insert(words.end(), {"--input", input});
    monitor_ = std::make_unique<test::Process>(words, folder_.at("out.txt"), folder_.at("err.txt"));
    ASSERT_TRUE(wait_for([this] { return metrics_port() > 0; })) << slurp(folder_.at("err.txt"));
  }
  void send(const std::string& payload) {
    ASSERT_TRUE(wait_for([&] { return client_->publish("cell/ax", payload); }));
  }
  [[nodiscard]] std::string message(std::uint64_t number, double seconds_from = 0.0) const {
    monitor::StreamBlock block;
    block.sequence = number;
    block.sample_rate_hz = rate_hz;
    block.spindle_speed_rad_per_s = 3000.0 * units::rpm;
    block.channels = 1;
    const std::size_t first = static_cast<std::size_t>(seconds_from * rate_hz) + number * block_frames;
    block.samples.assign(samples_.begin() + static_cast<std::ptrdiff_t>(first),
                         samples_.begin() + static_cast<std::ptrdiff_t>(first + block_frames));
    return monitor::encode_stream_block(block);
  }
  /// Nothing that was sent before the subscription stood comes: sends the first block until a decision was made.
  void begin() {
    ASSERT_TRUE(wait_for([&] {
      send(message(0));
      return metric("decisions_total") >= 1.0;
    }));
  }
  [[nodiscard]] int metrics_port() const {
    const std::string said = slurp(folder_.at("err.txt"));
    const std::string before = "metrics at http://127.0.0.1:";
    const std::size_t at = said.find(before);
    if (at == std::string::npos || said.find("/metrics\n", at) == std::string::npos) return 0;
    return std::stoi(said.substr(at + before.size()));
  }
  [[nodiscard]] double metric(const std::string& name) const {
    const std::string answer = test::http_get(metrics_port(), "/metrics");
    const std::size_t at = answer.find("\nrobomill_" + name + " ");
    return at == std::string::npos ? NAN : std::stod(answer.substr(at + name.size() + 11));
  }
  /// Ctrl-C: 130, and every line is whole.
  void interrupt() {
    monitor_->signal(SIGINT);
    EXPECT_EQ(monitor_->wait(), 130) << slurp(folder_.at("err.txt"));
    (void)events();
  }
  [[nodiscard]] bool published(const std::string& text) {
    const std::scoped_lock lock(mutex_);
    return published_.find(text) != std::string::npos;
  }

  test::Mosquitto broker_{folder_.path()};
  std::vector<float> samples_ = cut(8.0, true);
  std::mutex mutex_;
  std::string published_;
  std::unique_ptr<MqttClient> client_;
  std::unique_ptr<test::Process> monitor_;
};

TEST_F(MonitorStream, DetectsChatterThroughABroker) {
  listen();
  begin();
  for (std::uint64_t i = 1; i < 150; ++i) {
    send(message(i));
    // No faster than the monitor processes them: no hop may be left out here.
    ASSERT_TRUE(wait_for([&] { return i % 20 != 0 || metric("decisions_total") >= 2.0 * static_cast<double>(i); }));
  }
  ASSERT_TRUE(wait_for([&] { return metric("decisions_total") >= 300.0; }));
  EXPECT_EQ(metric("alarms_total"), 1.0);
  EXPECT_EQ(metric("state"), 2.0);
  EXPECT_EQ(metric("dropped_hops_total"), 0.0);
  EXPECT_TRUE(wait_for([&] { return published("\"state\":\"chatter\""); }));
  interrupt();
  const std::vector<json> states = events_of("state");
  const auto alarm =
      std::find_if(states.begin(), states.end(), [](const json& event) { return event["state"] == "chatter"; });
  ASSERT_NE(alarm, states.end());
  EXPECT_NEAR((*alarm)["chatter_frequency_hz"].get<double>(), chatter_hz, 2.0);
  EXPECT_GT((*alarm)["time_s"].get<double>(), onset_s);
  EXPECT_NE(slurp(folder_.at("out.txt")).find("1 alarm"), std::string::npos);
}

TEST_F(MonitorStream, ReportsEveryFaultOfTheStream) {
  listen("mqtt://127.0.0.1:" + std::to_string(broker_.port()) + "/cell/ax");
  begin();
  send("garbage");
  send(std::string(2'000'000, 'R'));
  send(message(1).substr(0, 100));
  ASSERT_TRUE(wait_for([&] { return metric("refused_messages_total") >= 3.0; }));
  for (const std::uint64_t i : std::vector<std::uint64_t>{1, 2, 2, 4, 3, 5, 8, 9, 10, 11, 12, 13, 6, 14})
    send(message(i));
  ASSERT_TRUE(wait_for([&] { return has_event("late-blocks"); }));
  EXPECT_EQ(metric("lost_blocks_total"), 2.0);
  ASSERT_TRUE(wait_for([&] { return metric("decisions_total") >= 2.0 * 15.0; }));  // the lost ones as NaN
  interrupt();
  for (const char* what : {"refused-messages", "lost-blocks", "doubled-blocks", "reordered-blocks", "late-blocks"}) {
    EXPECT_FALSE(events_of(what).empty()) << what;
  }
  EXPECT_EQ(events_of("lost-blocks")[0]["count"], 2);
  ASSERT_FALSE(events_of("fault").empty());
  EXPECT_EQ(events_of("fault")[0]["faults"][0], "not-finite");
}

TEST_F(MonitorStream, LivesThroughABrokerThatGoesAndComes) {
  listen();
  begin();
  broker_.stop();
  ASSERT_TRUE(wait_for([&] { return has_event("broker-lost"); }));
  EXPECT_EQ(metric("connected"), 0.0);
  broker_.start();
  ASSERT_TRUE(wait_for([&] { return metric("connected") == 1.0; }));
  const double before = metric("decisions_total");
  std::uint64_t number = 30;
  ASSERT_TRUE(wait_for([&] {
    send(message(number++ % 100));
    return metric("decisions_total") > before;
  }));
  interrupt();
  EXPECT_FALSE(events_of("broker-connected").empty());
}

TEST_F(MonitorStream, SaysThatThereIsNoBrokerAndEndsByCtrlC) {
  broker_.stop();
  listen();
  ASSERT_TRUE(wait_for([&] { return has_event("broker-unreachable"); }));
  EXPECT_NE(slurp(folder_.at("out.txt")).find("trying again"), std::string::npos);
  interrupt();
}

// Blocks stop coming, whether or not the connection stands.
TEST_F(MonitorStream, MissesTheBlocksOfABroker) {
  configure("0.2");
  listen();
  ASSERT_TRUE(wait_for([&] { return has_event("no-signal"); }));
  EXPECT_EQ(metric("state"), 3.0);
  EXPECT_EQ(metric("decisions_total"), 0.0);
  begin();
  ASSERT_TRUE(wait_for([&] { return metric("blind_seconds_total{reason=\"no-signal\"}") > 0.3; }));
  interrupt();
  const std::vector<json> states = events_of("state");
  ASSERT_GE(states.size(), 2U);
  EXPECT_EQ(states[0]["state"], "blind");
  EXPECT_NE(states[1]["state"], "blind");
  EXPECT_NE(slurp(folder_.at("out.txt")).find("cannot tell: no-signal"), std::string::npos);
}

TEST_F(MonitorStream, PublishesEventsOfARecording) {
  wav("rec.wav", samples_);
  const Ended run = robomill("monitor monitor.toml --input rec.wav -o events.jsonl --seconds 7");
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_NE(run.out.find("280 decisions"), std::string::npos) << run.out;
  EXPECT_TRUE(wait_for([&] { return published("\"state\":\"chatter\""); }));
}

// What a rule commands goes to its topic, and the event says that it did.
TEST_F(MonitorStream, PublishesCommands) {
  folder_.file("acting.toml", config_ + "[act]\nrule = \"reduce\"\n[mqtt]\nport = " + std::to_string(broker_.port()) +
                                  "\ncommands_topic = \"cell/events\"\n");
  wav("rec.wav", samples_);
  const Ended run = robomill("monitor acting.toml --input rec.wav -o events.jsonl");
  EXPECT_EQ(run.exit, 0) << run.err;
  EXPECT_NE(run.out.find("; chatter: feed to 50 %"), std::string::npos) << run.out;
  EXPECT_TRUE(wait_for([&] { return published("\"command\":\"feed\""); }));
  EXPECT_TRUE(published("\"feed_override\":0.5"));
  std::size_t followed = 0;
  for (const json& event : events()) followed += event["command"] == "feed" ? 1U : 0U;
  EXPECT_EQ(followed, 1U);
  // Without a topic the events alone say what would have been commanded.
  folder_.file("dry.toml", config_ + "[act]\nrule = \"reduce\"\n");
  ASSERT_EQ(robomill("monitor dry.toml --input rec.wav -o events.jsonl").exit, 0);
  EXPECT_TRUE(has_event("feed"));
  EXPECT_EQ(slurp(folder_.at("events.jsonl")).find("broker"), std::string::npos);
}

}  // namespace monitor_test
}  // namespace robomill::app
