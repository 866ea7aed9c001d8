// A decision becomes a command and reaches whoever listens, through a real broker on loopback.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "broker.hpp"
#include "mqtt.hpp"
#include "robomill/live/advisor.hpp"
#include "robomill/live/session.hpp"
#include "testing/monitor/signal.hpp"
#include "testing/processes.hpp"
#include "testing/support.hpp"

namespace robomill::app {
namespace commands_test {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

/// What came on a topic, and when.
class Listener {
 public:
  Listener(const monitor::MqttSettings& settings, const std::string& topic)
      : client_(settings, topic, {.message = [this](std::span<const std::byte> payload) {
                  const Clock::time_point now = Clock::now();
                  const std::scoped_lock lock(mutex_);
                  messages_.emplace_back(std::string(reinterpret_cast<const char*>(payload.data()), payload.size()),
                                         now);
                }}) {
    client_.start();
    // A subscription counts some time after the connection.
    EXPECT_TRUE(test::wait_for([&] {
      client_.publish(topic, "{\"command\":\"probe\"}");
      return !messages().empty();
    }));
  }
  /// The first of this command.
  [[nodiscard]] std::optional<std::pair<json, Clock::time_point>> first(const std::string& command) const {
    for (const auto& [text, time] : messages()) {
      json message = json::parse(text);
      if (message["command"] == command) return std::pair(std::move(message), time);
    }
    return std::nullopt;
  }

 private:
  using Message = std::pair<std::string, Clock::time_point>;
  [[nodiscard]] std::vector<Message> messages() const {
    const std::scoped_lock lock(mutex_);
    return messages_;
  }
  mutable std::mutex mutex_;
  std::vector<Message> messages_;
  MqttClient client_;
};

/// 80 turns a second, three teeth; from 2 s on chatter at 683 Hz.
monitor::MonitorFile file_for(const test::Mosquitto& broker, monitor::ActRule rule) {
  monitor::MonitorFile file;
  file.columns.channels = {"ax"};
  file.options.sample_rate_hz = 10'240.0;
  file.options.spindle_speed_rad_per_s = 2.0 * std::numbers::pi * 80.0;
  file.options.teeth = 3;
  file.act.rule = rule;
  file.mqtt.port = broker.port();
  file.mqtt.commands_topic = "cell/commands";
  return file;
}

TEST(Commands, ReachWhoeverListensThroughABroker) {
  const test::Folder folder;
  // Nagle: otherwise the broker keeps a message up to 40 ms, until the one before it was acknowledged.
  const test::Mosquitto mosquitto(folder.path(), "allow_anonymous true\nset_tcp_nodelay true\n");
  const monitor::MonitorFile file = file_for(mosquitto, monitor::ActRule::speed);
  const Listener listener(file.mqtt, file.mqtt.commands_topic);
  const live::Advisor advisor({.teeth = 3});
  Broker* broker = nullptr;
  Clock::time_point decided, command_decided;
  std::vector<std::string> commands;
  live::SessionOutputs outputs;
  outputs.decision = [&](const monitor::Decision&, double, double) { decided = Clock::now(); };
  outputs.advise = [&](monitor::MonitorEvent& event) { advisor.advise(event); };
  outputs.command = [&](const live::Command& command) {
    command_decided = decided;
    broker->publish(command);
  };
  outputs.event = [&](const monitor::MonitorEvent& event, const std::string&) {
    if (!event.command.empty()) commands.push_back(event.command);
    return true;
  };
  live::Session session(file, {}, std::move(outputs));
  Broker connection(file, false, session.queue(), session.notices(), session.metrics());
  broker = &connection;
  ASSERT_TRUE(test::wait_for([&] { return session.metrics().connected.load(); }));
  const std::vector<float> samples = monitor::testing::vibration({.chatter_hz = 683.0, .seconds = 3.0});
  for (std::size_t at = 0; at + 256 <= samples.size() && commands.empty(); at += 256) {
    live::Hop hop;
    hop.samples.assign(samples.begin() + static_cast<std::ptrdiff_t>(at),
                       samples.begin() + static_cast<std::ptrdiff_t>(at + 256));
    session.process(std::move(hop));
  }
  ASSERT_EQ(commands, std::vector<std::string>{"spindle-speed"});
  ASSERT_TRUE(test::wait_for([&] { return listener.first("spindle-speed").has_value(); }));
  const auto [message, received] = *listener.first("spindle-speed");
  // 683 Hz over three teeth, and the next speed below 4,800 rpm: k = 3.
  EXPECT_NEAR(message["spindle_speed_rpm"].get<double>(), 60.0 * 683.0 / 9.0, 30.0);
  EXPECT_NEAR(message["feed_override"].get<double>(), message["spindle_speed_rpm"].get<double>() / 4800.0, 1e-3);
  EXPECT_EQ(message["first"], "feed");
  EXPECT_GT(message["time_s"].get<double>(), 2.0);
  EXPECT_NE(message["reason"].get<std::string>().find("chatter at 68"), std::string::npos) << message;
  const double took_s = std::chrono::duration<double>(received - command_decided).count();
  std::printf("decision to command received: %.3f ms\n", 1e3 * took_s);
  EXPECT_LT(took_s, 1.0);  // bench/act_latency has what it takes
}

// A command that finds no connection is dropped and reported, not sent when the connection is back.
TEST(Commands, AreReportedWhereTheyCannotBeSent) {
  const test::Folder folder;
  test::Mosquitto mosquitto(folder.path());
  const monitor::MonitorFile file = file_for(mosquitto, monitor::ActRule::reduce);
  mosquitto.stop();
  std::vector<std::string> reported;
  live::SessionOutputs outputs;
  outputs.event = [&](const monitor::MonitorEvent& event, const std::string&) {
    reported.push_back(event.what);
    return true;
  };
  live::Session session(file, {}, std::move(outputs));
  Broker broker(file, false, session.queue(), session.notices(), session.metrics());
  broker.publish(live::Command{.kind = live::Command::Kind::feed, .feed_override = 0.5});
  session.emit_notices(true);
  EXPECT_NE(std::find(reported.begin(), reported.end(), "commands-not-published"), reported.end());
}

}  // namespace commands_test
}  // namespace robomill::app
