// robomill serve as a user runs it on spindles whose samples come from a broker.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "monitor/mqtt.hpp"
#include "monitor/test_monitor.hpp"
#include "monitor/test_processes.hpp"
#include "robomill/base/units.hpp"
#include "robomill/monitor/files/stream_block.hpp"
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

TEST_F(ServeStream, MonitorsTwoSpindles) {
  const int first = ask("POST", "/api/monitors", R"({"config":"monitor.toml"})")["id"];
  const std::string other = "mqtt://127.0.0.1:" + std::to_string(broker_.port()) + "/cell/bx";
  const int second = ask("POST", "/api/monitors", json{{"config", "monitor.toml"}, {"input", other}}.dump())["id"];
  // What is sent before a subscription stands does not come: the first block again, until it does.
  for (const auto& [topic, id] : {std::pair("cell/ax", first), std::pair("cell/bx", second)}) {
    ASSERT_TRUE(wait_for([&] {
      send(topic, 0);
      return decisions(id) >= 1.0;
    }));
  }
  for (std::uint64_t i = 1; i < 150; ++i) {
    send("cell/ax", i);
    if (i < 60) send("cell/bx", i);
    ASSERT_TRUE(wait_for([&] { return i % 20 != 0 || decisions(first) >= 2.0 * static_cast<double>(i); }));
  }
  ASSERT_TRUE(wait_for([&] { return decisions(first) >= 300.0 && decisions(second) >= 120.0; }));
  json all = ask("GET", "/api/monitors/" + std::to_string(first));
  EXPECT_EQ(all["alarm_count"], 1);
  for (const json& row : all["alarms"]) {  // beside what befell the stream
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
