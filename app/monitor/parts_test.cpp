// Metrics over HTTP, and the line of --watch.
#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <string>
#include <vector>

#include "http_get.hpp"
#include "metrics_server.hpp"
#include "robomill/base/error.hpp"
#include "testing/processes.hpp"
#include "testing/support.hpp"
#include "watch.hpp"

namespace robomill::app {
namespace parts_test {

TEST(Metrics, AnswerInTheTextFormat) {
  live::MetricValues values;
  monitor::Decision decision;
  decision.state = monitor::State::chatter;
  decision.score = 12.5;
  decision.chatter_frequency_hz = 683.5;
  values.set(decision);
  values.level = std::numeric_limits<double>::quiet_NaN();
  values.dropped_hops = 3;
  const MetricsServer server(values, "127.0.0.1", 0);
  const std::string answer = test::http_get(server.port(), "/metrics");
  EXPECT_EQ(answer.rfind("HTTP/1.1 200 OK", 0), 0U) << answer;
  for (const char* line : {"\nrobomill_state 2\n", "\nrobomill_score 12.5\n", "\nrobomill_chatter_frequency_hz 683.5\n",
                           "\nrobomill_decisions_total 1\n", "\nrobomill_dropped_hops_total 3\n",
                           "# TYPE robomill_score gauge\n", "# TYPE robomill_alarms_total counter\n"}) {
    EXPECT_NE(answer.find(line), std::string::npos) << line;
  }
  EXPECT_EQ(answer.find("nan"), std::string::npos);
  EXPECT_EQ(test::http_get(server.port(), "/other").rfind("HTTP/1.1 404", 0), 0U);
  EXPECT_EQ(test::http_get(server.port(), "/" + std::string(20'000, 'x')).rfind("HTTP/1.1 414", 0), 0U);
  EXPECT_NE(
      test::rejection([&] { const MetricsServer second(values, "127.0.0.1", server.port()); }).find("cannot listen"),
      std::string::npos);
}

// A page whose name was made to point at this machine has its own name in its requests.
TEST(Metrics, AreNotForOtherHosts) {
  const live::MetricValues values;
  const MetricsServer server(values, "localhost", 0);
  const std::string port = ":" + std::to_string(server.port());
  for (const char* host : {"localhost", "127.0.0.1", "[::1]"}) {
    EXPECT_EQ(test::http_get(server.port(), "/metrics", host + port).rfind("HTTP/1.1 200 OK", 0), 0U) << host;
  }
  for (const std::string& host : {"evil.example" + port, std::string("localhost"), std::string("localhost:1")}) {
    const std::string answer = test::http_get(server.port(), "/metrics", host);
    EXPECT_EQ(answer.rfind("HTTP/1.1 403", 0), 0U) << answer;
    EXPECT_EQ(answer.find("robomill_state"), std::string::npos) << host;
  }
}

// Ten that connect and say nothing must not keep an eleventh waiting: the server holds each for a while.
TEST(Metrics, AnswerBesideIdleConnections) {
  const live::MetricValues values;
  const MetricsServer server(values, "127.0.0.1", 0);
  std::vector<int> idle;
  for (int i = 0; i < 10; ++i) {
    idle.push_back(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    const sockaddr_in address = test::loopback(server.port());
    ASSERT_EQ(::connect(idle.back(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  }
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(test::http_get(server.port(), "/metrics").rfind("HTTP/1.1 200 OK", 0), 0U);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  for (const int descriptor : idle) ::close(descriptor);
}

TEST(Watch, ShowsTheSpectrumAsABar) {
  monitor::Decision decision;
  decision.state = monitor::State::transition;
  decision.bands = 4;
  decision.band_level = {0.0F, 1.0F, 0.063F, 0.001F};  // none, 0, -24 and -60 dB
  decision.level = 1.25;
  decision.score = 3.0;
  decision.threshold = 9.0;
  decision.chatter_frequency_hz = 683.6;
  const std::string line = watch_line(decision, 12.3456);
  EXPECT_NE(line.find("[ █▄ ]"), std::string::npos) << line;
  EXPECT_NE(line.find("12.346 s  transition"), std::string::npos) << line;
  EXPECT_NE(line.find("683.6 Hz"), std::string::npos) << line;
  EXPECT_EQ(line.find("rpm"), std::string::npos) << line;
  EXPECT_NE(watch_line({}, 0.0).find("[]"), std::string::npos);
  decision.state = monitor::State::blind;
  decision.reason = monitor::BlindReason::no_signal;
  EXPECT_NE(watch_line(decision, 0.0).find("blind (no-signal)"), std::string::npos);
}

}  // namespace parts_test
}  // namespace robomill::app
