// robomill monitor as a user runs it on samples that come while they are taken: a pipe, a broker.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <sstream>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "monitor/http_get.hpp"
#include "monitor/mqtt.hpp"
#include "monitor/test_monitor.hpp"
#include "robomill/base/units.hpp"
#include "robomill/monitor/files/stream_block.hpp"
#include "testing/processes.hpp"

namespace robomill::app {
namespace monitor_stream_test {

using test::wait_for;

constexpr std::size_t block_frames = 512;

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
  const auto silent = std::ranges::find_if(states, [](const json& event) { return event["reason"] == "no-signal"; });
  ASSERT_LT(silent + 1, states.end());  // the next decision ends it, in learning or not
  EXPECT_EQ((*silent)["state"], "blind");
  EXPECT_NE(silent[1]["reason"], "no-signal");
  EXPECT_NE(states.back()["state"], "blind");
  EXPECT_TRUE(states.back()["reason"].is_null());
  EXPECT_NE(run.out.find("blind (no-signal)\n"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("0 alarms.\ncannot tell: no-signal, for 0."), std::string::npos) << run.out;
  EXPECT_EQ(run.out.find("gap"), std::string::npos) << run.out;
  const json times = json::parse(slurp(folder_.at("report.json")))["monitor"]["state_times"];
  const auto blind =
      std::find_if(times.begin(), times.end(), [](const json& time) { return time["reason"] == "no-signal"; });
  ASSERT_NE(blind, times.end()) << times;
  EXPECT_EQ((*blind)["state"], "blind");
  EXPECT_GE((*blind)["duration_s"].get<double>(), 0.2);
}

// A night's events are there after the next start, each session behind its "started".
TEST_F(MonitorVerb, AppendsToTheEventsOfEarlierSessions) {
  const std::vector<float> samples = cut(5.0, true);
  folder_.file("rec.raw", {reinterpret_cast<const char*>(samples.data()), 4 * samples.size()});
  folder_.file("events.jsonl", "{\"event\":\"old\"}\n{\"event\":\"cut o");
  for (int session = 1; session <= 2; ++session) {
    const Ended run =
        shell("cat rec.raw | '" ROBOMILL_PROGRAM "' monitor monitor.toml --input - --format f32 -o events.jsonl");
    ASSERT_EQ(run.exit, 0) << run.err;
    EXPECT_EQ(run.err.find("its last line was not finished") == std::string::npos, session == 2) << run.err;
  }
  std::vector<std::string> kinds;
  std::istringstream lines(slurp(folder_.at("events.jsonl")));
  for (std::string line; std::getline(lines, line);) {
    const json event = json::parse(line, nullptr, false);
    const std::string kind = event.is_discarded() ? "cut" : event.at("event").get<std::string>();
    if (kind == "old" || kind == "cut" || kind == "started" || event.value("state", "") == "chatter") {
      kinds.push_back(kind);
    }
    if (kind == "started") {
      EXPECT_EQ(event.at("input"), "standard input");
      EXPECT_EQ(event.at("config"), "monitor.toml");
    }
  }
  ASSERT_GE(kinds.size(), 6U);
  EXPECT_EQ(std::count(kinds.begin(), kinds.end(), "started"), 2);
  EXPECT_EQ(kinds[0], "old");
  EXPECT_EQ(kinds[1], "cut");
  EXPECT_EQ(kinds[2], "started");
  EXPECT_EQ(kinds[3], "state");
  EXPECT_EQ(kinds.back(), "state");
}

// A full disk ends no watch: what is found is shown, and in the end it is said that nothing was saved.
TEST_F(MonitorVerb, GoesOnWhereEventsCannotBeSaved) {
  const std::vector<float> samples = cut(6.0, true);
  folder_.file("rec.raw", {reinterpret_cast<const char*>(samples.data()), 4 * samples.size()});
  const Ended run =
      shell("cat rec.raw | '" ROBOMILL_PROGRAM "' monitor monitor.toml --input - --format f32 -o /dev/full");
  EXPECT_EQ(run.exit, 1);
  EXPECT_NE(run.out.find("chatter at 68"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("decisions, 1 alarm"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("events-not-saved"), std::string::npos) << run.out;
  const std::size_t said = run.err.find("robomill: /dev/full: events cannot be saved: No space left on device");
  EXPECT_NE(said, std::string::npos) << run.err;
  EXPECT_EQ(run.err.find("events cannot be saved", said + 30), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("events could not be saved"), std::string::npos) << run.err;
}

// The speed column says for half a second that the spindle hardly turns.
TEST_F(MonitorVerb, AlarmsAfterAStandstill) {
  const std::vector<float> samples = cut(8.0, true);
  std::string csv = "ax_m_per_s2,spindle_speed_rpm\n";
  for (std::size_t i = 0; i < samples.size(); ++i) {
    csv += std::to_string(samples[i]) + (static_cast<double>(i) < 0.5 * rate_hz ? ",0.05\n" : ",3000\n");
  }
  folder_.file("rec.csv", csv);
  const Ended run = shell("timeout 120 '" ROBOMILL_PROGRAM "' monitor monitor.toml --input rec.csv -o events.jsonl");
  ASSERT_EQ(run.exit, 0) << run.err;
  const json alarm = first_alarm();
  ASSERT_FALSE(alarm.is_null()) << run.out;
  EXPECT_GT(alarm["time_s"].get<double>(), onset_s);
  EXPECT_LT(alarm["time_s"].get<double>(), onset_s + 0.5);
  const std::vector<json> states = events_of("state");
  EXPECT_EQ(states[0]["state"], "blind");
  EXPECT_EQ(states[0]["reason"], "standstill");
  EXPECT_NE(run.out.find("cannot tell: standstill, for 0.475 s"), std::string::npos) << run.out;
}

/// A port at which connections are taken and nothing is ever said.
class SilentPort {
 public:
  SilentPort() : port_(test::free_port()), descriptor_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const sockaddr_in address = test::loopback(port_);
    EXPECT_EQ(::bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    EXPECT_EQ(::listen(descriptor_, 8), 0);
  }
  ~SilentPort() { ::close(descriptor_); }
  SilentPort(const SilentPort&) = delete;
  SilentPort& operator=(const SilentPort&) = delete;
  [[nodiscard]] int port() const { return port_; }

 private:
  int port_, descriptor_;
};

// Nobody listens at the one port, and what listens at the other is no broker.
TEST_F(MonitorVerb, EndsWhereNoBrokerAnswers) {
  folder_.file("monitor.toml", config_ + "[mqtt]\nconnect_timeout_s = 0.3\n");
  const SilentPort silent;
  for (const int port : {test::free_port(), silent.port()}) {
    const std::string address = "mqtt://127.0.0.1:" + std::to_string(port);
    const Ended run = shell("timeout 60 '" ROBOMILL_PROGRAM "' monitor monitor.toml --input " + address + "/cell/ax");
    EXPECT_EQ(run.exit, 1) << run.err;
    EXPECT_NE(run.err.find("robomill: " + address + ": no connection within 0.3 s: "), std::string::npos) << run.err;
    EXPECT_NE(run.err.find("mqtt.connect_timeout_s"), std::string::npos) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
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
  const json alarm = first_alarm();
  ASSERT_FALSE(alarm.is_null());
  EXPECT_NEAR(alarm["chatter_frequency_hz"].get<double>(), chatter_hz, 2.0);
  EXPECT_GT(alarm["time_s"].get<double>(), onset_s);
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
  EXPECT_EQ(states[0]["reason"], "no-signal");
  EXPECT_NE(states[1]["reason"], "no-signal");
  EXPECT_NE(slurp(folder_.at("out.txt")).find("cannot tell: no-signal"), std::string::npos);
}

TEST_F(MonitorStream, EventsOutliveAKill) {
  listen();
  begin();
  send("garbage");
  ASSERT_TRUE(wait_for([&] { return has_event("refused-messages"); }));
  monitor_->signal(SIGKILL);
  EXPECT_EQ(monitor_->wait(), 128 + SIGKILL);
  const std::size_t before = events().size();
  listen();
  begin();
  interrupt();
  EXPECT_GT(events().size(), before);
  ASSERT_EQ(events_of("started").size(), 2U);
  EXPECT_EQ(events().front()["event"], "started");
  EXPECT_EQ(events_of("refused-messages").size(), 1U);
}

/// A pipe in the place of standard output that is not read until asked to.
class UnreadPipe {
 public:
  explicit UnreadPipe(const std::filesystem::path& place) {
    EXPECT_EQ(::mkfifo(place.c_str(), 0600), 0);
    descriptor_ = ::open(place.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    EXPECT_GE(::fcntl(descriptor_, F_SETPIPE_SZ, 4096), 4096);
  }
  ~UnreadPipe() {
    thread_ = {};
    ::close(descriptor_);
  }
  UnreadPipe(const UnreadPipe&) = delete;
  UnreadPipe& operator=(const UnreadPipe&) = delete;
  void read() {
    thread_ = std::jthread([this](const std::stop_token& stop) {
      std::array<char, 4096> bytes = {};
      while (!stop.stop_requested()) {
        if (::read(descriptor_, bytes.data(), bytes.size()) <= 0) {
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
      }
    });
  }

 private:
  int descriptor_ = -1;
  std::jthread thread_;
};

// Nobody reads standard output, and the thread of the decisions hangs where it writes: all other ways say so.
TEST_F(MonitorStream, SaysThatItsDecisionsHang) {
  UnreadPipe out(folder_.at("out.fifo"));
  monitor_ =
      std::make_unique<test::Process>(std::vector<std::string>{ROBOMILL_PROGRAM, "monitor", folder_.at("monitor.toml"),
                                                               "-o", "-", "--every-window", "--metrics-port", "0"},
                                      folder_.at("out.fifo"), folder_.at("err.txt"));
  ASSERT_TRUE(wait_for([this] { return metrics_port() > 0; })) << slurp(folder_.at("err.txt"));
  begin();
  std::uint64_t number = 1;
  ASSERT_TRUE(wait_for([&] {
    if (number < 70) send(message(number++));
    return metric("blind_seconds_total{reason=\"overloaded\"}") > 0.9;
  }));
  EXPECT_EQ(metric("state"), 3.0);
  EXPECT_GE(metric("behind_seconds"), 1.0);
  EXPECT_TRUE(wait_for([&] { return published("\"reason\":\"overloaded\""); }));
  EXPECT_TRUE(wait_for([&] { return slurp(folder_.at("err.txt")).find("blind (overloaded)\n") != std::string::npos; }));
  out.read();
  ASSERT_TRUE(wait_for([&] {
    if (number < 150) send(message(number++));
    return metric("state") < 3.0;
  }));
  EXPECT_TRUE(wait_for([&] { return slurp(folder_.at("err.txt")).find("keep up") != std::string::npos; }));
  monitor_->signal(SIGINT);
  EXPECT_EQ(monitor_->wait(), 130) << slurp(folder_.at("err.txt"));
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

}  // namespace monitor_stream_test
}  // namespace robomill::app
