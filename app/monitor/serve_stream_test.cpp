// robomill serve as a user runs it on spindles whose samples come from a broker.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "monitor/mqtt.hpp"
#include "monitor/test_monitor.hpp"
#include "robomill/base/units.hpp"
#include "robomill/monitor/files/stream_block.hpp"
#include "testing/processes.hpp"
#include "testing/serve/hammer.hpp"
#include "testing/serve/http_client.hpp"

namespace robomill::app {
namespace serve_stream_test {

using test::wait_for;

/// A server of a folder with a monitor.toml, and a client that sends to a broker.
class ServeStream : public MonitorVerb {
 protected:
  void SetUp() override {
    folder_.file("monitor.toml", timed("3600") + "[mqtt]\nport = " + std::to_string(broker_.port()) +
                                     "\ntopic = \"cell/ax\"\nconnect_timeout_s = 60\n");
    server_ = std::make_unique<test::Process>(
        std::vector<std::string>{ROBOMILL_PROGRAM, "serve", folder_.path(), "--port", "0"}, folder_.at("out.txt"),
        folder_.at("err.txt"));
    ASSERT_TRUE(wait_for([this] { return port() > 0; })) << slurp(folder_.at("err.txt"));
    const std::string page = test::http_ask(port(), "GET", "/").body;
    const std::size_t token = page.find("\"token\":\"") + 9;
    token_ = page.substr(token, page.find('"', token) - token);
    monitor::MqttSettings settings;
    settings.port = broker_.port();
    client_ = std::make_unique<MqttClient>(settings, "", MqttClient::Calls{});
    client_->start();
    ASSERT_TRUE(client_->wait_until_connected(std::chrono::seconds(60)));
  }
  void TearDown() override { client_.reset(); }
  [[nodiscard]] int port() const {
    const std::string said = slurp(folder_.at("out.txt"));
    const std::size_t at = said.find("http://127.0.0.1:");
    return at == std::string::npos || said.find("/\n", at) == std::string::npos ? 0 : std::stoi(said.substr(at + 17));
  }
  json ask(const char* method, const std::string& path, const std::string& body = {}) const {
    const test::HttpAnswer answer = test::http_ask(port(), method, path, {{"X-Robomill-Token", token_}}, body);
    EXPECT_EQ(answer.status, 200) << answer.body;
    return json::parse(answer.body, nullptr, false);
  }
  void send(const std::string& topic, std::uint64_t number) {
    monitor::StreamBlock block;
    block.sequence = number;
    block.sample_rate_hz = rate_hz;
    block.spindle_speed_rad_per_s = 3000.0 * units::rpm;
    block.channels = 1;
    const auto first = samples_.begin() + static_cast<std::ptrdiff_t>(512 * number);
    block.samples.assign(first, first + 512);
    ASSERT_TRUE(wait_for([&] { return client_->publish(topic, monitor::encode_stream_block(block)); }));
  }
  [[nodiscard]] double decisions(int id) const {
    return ask("GET", "/api/monitors/" + std::to_string(id))["decision_count"];
  }

  test::Mosquitto broker_{folder_.path()};
  std::vector<float> samples_ = cut(8.0, true);
  std::string token_;
  std::unique_ptr<MqttClient> client_;
  std::unique_ptr<test::Process> server_;
};

/// A tap test whose hammer and accelerometers a gateway publishes: ay, force, ax.
class ServeTapStream : public ServeStream {
 protected:
  /// @param lost  the block of that place is left out
  void send(const test::HammerRecord& record, std::size_t lost = 1000) {
    constexpr std::size_t frames = 512;
    for (std::size_t at = 0; at < record.force_n.size(); at += frames) {
      monitor::StreamBlock block;
      block.sequence = next_++;
      block.sample_rate_hz = test::HammerRecord::rate_hz;
      block.channels = 3;
      for (std::size_t i = at; i < at + frames; ++i) {
        for (const auto* column : {&record.ay_m_per_s2, &record.force_n, &record.ax_m_per_s2}) {
          block.samples.push_back(static_cast<float>((*column)[i]));
        }
      }
      if (at / frames == lost) continue;
      ASSERT_TRUE(wait_for([&] { return client_->publish("cell/hammer", monitor::encode_stream_block(block)); }));
    }
  }
  static test::HammerRecord second(std::vector<test::Push> pushes, std::uint64_t seed) { return {8192, pushes, seed}; }
  /// Until all that was sent is processed: the queue has room for the second of a hit, and no more is dropped.
  void wait_for_silence() {
    ASSERT_TRUE(wait_for([&] { return ask("GET", "/api/tap")["stream"]["status"] == "silent"; }));
  }
  void hit(double peak_n, std::size_t taken) {
    send(second({{.at_s = 0.2, .peak_n = peak_n}}, ++seed_));
    ASSERT_TRUE(wait_for([&] { return ask("GET", "/api/tap")["taken"].size() == taken; }));
  }
  std::uint64_t next_ = 0, seed_ = 0;
};

TEST_F(ServeTapStream, TakesHitsAndSavesThem) {
  folder_.file("hits.toml",
               "[acquisition]\nsample_rate_hz = 8192\nmax_frequency_hz = 1000\nfrequency_resolution_hz = 2\n[[hits]]\n"
               "force = 2\nforce_direction = \"x\"\nresponses = { x = 3, y = 1 }\n");
  const std::string address = "mqtt://127.0.0.1:" + std::to_string(broker_.port()) + "/cell/hammer";
  ask("POST", "/api/tap", json{{"hits", "hits.toml"}, {"stream", address}}.dump());
  ASSERT_TRUE(wait_for([&] {
    send(test::HammerRecord(512, {}, ++seed_));
    return ask("GET", "/api/tap")["stream"]["status"] == "receiving";
  }));
  wait_for_silence();
  hit(100.0, 1);
  hit(80.0, 2);
  // A block that is lost takes its record with it.
  send(second({{.at_s = 0.2, .peak_n = 90.0}}, ++seed_), 6);
  ASSERT_TRUE(wait_for([&] { return ask("GET", "/api/tap")["stream"]["discarded"].size() == 1; }));
  wait_for_silence();
  ask("PUT", "/api/tap", R"({"force_direction":"y"})");
  hit(120.0, 3);
  const json state = ask("GET", "/api/tap");
  EXPECT_EQ(state["good"], 3) << state["taken"];
  EXPECT_EQ(state["taken"][2]["force_direction"], "y");
  ask("POST", "/api/tap/save", R"({"path":"tapped.toml"})");
  ask("POST", "/api/tap/save", R"({"path":"tip.json"})");
  const Ended frf = robomill("frf tapped.toml -o again.json");
  EXPECT_EQ(frf.exit, 0) << frf.err;
  const json tip = json::parse(slurp(folder_.at("tip.json"))), again = json::parse(slurp(folder_.at("again.json")));
  EXPECT_EQ(tip["frequency_hz"], again["frequency_hz"]);
  EXPECT_EQ(tip["receptance_m_per_n"], again["receptance_m_per_n"]);
  EXPECT_EQ(tip["coherence"], again["coherence"]);
}

// User, TLS and time-out are those of a monitor.toml that is named; without one none is spoken of.
TEST_F(ServeTapStream, TakesTheBrokersSettings) {
  folder_.file("hits.toml",
               "[acquisition]\nsample_rate_hz = 8192\n[[hits]]\nforce = 2\nforce_direction = \"x\"\n"
               "responses = { x = 3 }\n");
  folder_.file("other.toml", timed("1") + "[mqtt]\nconnect_timeout_s = 0.1\n");
  json request = {{"hits", "hits.toml"}, {"stream", "mqtt://127.0.0.1:" + std::to_string(test::free_port()) + "/a"}};
  const auto hint = [&] {
    ask("POST", "/api/tap", request.dump());
    json stream;
    EXPECT_TRUE(wait_for([&] {
      stream = ask("GET", "/api/tap")["stream"];
      return stream["status"] == "failed";
    }));
    return stream["error"]["hint"].get<std::string>();
  };
  EXPECT_EQ(hint(), "Does the broker run, and is its address right?");
  request["config"] = "other.toml";
  EXPECT_NE(hint().find("mqtt.connect_timeout_s of monitor.toml"), std::string::npos);
  EXPECT_NE(ask("GET", "/api/tap")["stream"]["error"]["text"].get<std::string>().find("within 0.1 s"),
            std::string::npos);
}

TEST_F(ServeStream, MonitorsTwoSpindles) {
  const int first = ask("POST", "/api/monitors", R"({"config":"monitor.toml"})")["id"];
  const std::string other = "mqtt://127.0.0.1:" + std::to_string(broker_.port()) + "/cell/bx";
  const int second = ask("POST", "/api/monitors", json{{"config", "monitor.toml"}, {"input", other}}.dump())["id"];
  // What is sent before a subscription stands does not come: the first block again, until it does.
  for (const auto& spindle : {std::pair("cell/ax", first), std::pair("cell/bx", second)}) {
    ASSERT_TRUE(wait_for([&] {
      send(spindle.first, 0);
      return decisions(spindle.second) >= 1.0;
    }));
  }
  for (std::uint64_t i = 1; i < 150; ++i) {
    send("cell/ax", i);
    if (i < 60) send("cell/bx", i);
    if (i % 20 != 0) continue;
    // Two hops a block: twenty blocks fit into the queue, whenever it is taken from.
    const double ax = 2.0 * static_cast<double>(i + 1),
                 bx = 2.0 * static_cast<double>(std::min<std::uint64_t>(i, 59) + 1);
    ASSERT_TRUE(wait_for([&] { return decisions(first) == ax && decisions(second) == bx; }))
        << i << ": " << ask("GET", "/api/monitors").dump().substr(0, 4000);
  }
  ASSERT_TRUE(wait_for([&] { return decisions(first) == 300.0 && decisions(second) == 120.0; }));
  json all = ask("GET", "/api/monitors/" + std::to_string(first));
  EXPECT_EQ(all["alarm_count"], 1);
  for (const json& row : all["alarms"]) {  // beside faults of the stream
    if (row["kind"] == "chatter") {
      EXPECT_NEAR(row["chatter_frequency_hz"].get<double>(), chatter_hz, 2.0);
    }
  }
  EXPECT_EQ(all["dropped_hops"], 0);
  all = ask("GET", "/api/monitors/" + std::to_string(second));
  EXPECT_EQ(all["alarm_count"], 0);
  EXPECT_EQ(all["input"], other);
  EXPECT_EQ(ask("DELETE", "/api/monitors/" + std::to_string(second)).size(), 1U);
  server_->signal(SIGINT);
  EXPECT_EQ(server_->wait(), 0) << slurp(folder_.at("err.txt"));
}

}  // namespace serve_stream_test
}  // namespace robomill::app
