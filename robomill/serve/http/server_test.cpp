#include "robomill/serve/http/server.hpp"

#include <gtest/gtest.h>
#include <sys/time.h>

#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "testing/serve/http_client.hpp"

namespace robomill::serve {
namespace http_server_test {

using test::HttpConnection;

constexpr std::size_t large = std::size_t{8} << 20;

std::unique_ptr<HttpServer> server(HttpServer::Options options = {}) {
  auto out = std::make_unique<HttpServer>(std::move(options));
  out->start({.admit = [](const HttpRequest& request) -> std::variant<std::uint64_t, HttpResponse> {
                if (request.path == "/throws") throw std::runtime_error("an error");
                if (request.path == "/too-much") throw std::bad_alloc();
                return std::uint64_t{100};
              },
              .handle =
                  [](const HttpRequest& request, const Reply& reply) {
                    if (request.path == "/events") return reply({.events = true});
                    if (request.path == "/large") return reply({.body = std::string(large, 'x')});
                    reply({.body = request.body.empty() ? "{}" : request.body});
                  },
              .knows = [](const HttpRequest& request) { return request.header("x-known") == "yes"; }});
  return out;
}

/// Until so many connections are open.
bool has_open(const HttpServer& http, std::size_t connections) {
  for (int tries = 0; tries < 6000; ++tries) {
    if (http.open_connections() == connections) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

TEST(HttpServer, GoesOnAfterAHandlerThatThrows) {
  const auto http = server();
  for (const char* path : {"/throws", "/too-much"}) {
    const test::HttpAnswer answer = test::http_ask(http->port(), "GET", path);
    EXPECT_EQ(answer.status, 500) << path;
    EXPECT_NE(answer.body.find("\"hint\":null"), std::string::npos) << answer.body;
  }
  EXPECT_EQ(test::http_ask(http->port(), "GET", "/").status, 200);
}

TEST(HttpServer, AnswersWhileSignalsInterruptCalls) {
  const auto http = server();
  struct sigaction nothing = {}, before = {};
  nothing.sa_handler = [](int) {};
  ASSERT_EQ(sigaction(SIGALRM, &nothing, &before), 0);
  const itimerval often = {.it_interval = {.tv_sec = 0, .tv_usec = 300}, .it_value = {.tv_sec = 0, .tv_usec = 300}};
  const itimerval never = {};
  setitimer(ITIMER_REAL, &often, nullptr);
  int answered = 0;
  for (int i = 0; i < 2000; ++i) answered += test::http_ask(http->port(), "GET", "/").status == 200 ? 1 : 0;
  setitimer(ITIMER_REAL, &never, nullptr);
  sigaction(SIGALRM, &before, nullptr);
  EXPECT_EQ(answered, 2000);
}

TEST(HttpServer, SendsEachHeaderOfAStreamOnce) {
  const auto http = server({.headers = {{"Cache-Control", "no-store"}}});
  HttpConnection events(http->port());
  events.send(test::http_text(http->port(), "GET", "/events"));
  ASSERT_TRUE(events.wait_for("retry: 1000"));
  const std::size_t first = events.got().find("Cache-Control");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(events.got().find("Cache-Control", first + 1), std::string::npos) << events.got();
}

// Closed with bytes that nobody read, the connection would be reset, and the answer perhaps lost.
TEST(HttpServer, ReadsOnWhereItRejectsAConnection) {
  const auto http = server({.connections = 1});
  const HttpConnection first(http->port());
  ASSERT_TRUE(has_open(*http, 1));
  HttpConnection rejected(http->port());
  const std::string part(1000, 'x');
  ASSERT_TRUE(rejected.send(part));
  ASSERT_TRUE(rejected.wait_for("try later"));
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(rejected.send(part)) << i;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(rejected.answer().status, 503);
  EXPECT_TRUE(rejected.ends(30.0));
}

// 14 usual places, 2 that are reserved; of one address 12, and 1.
TEST(HttpServer, SlowClientsLeavePlacesForOthers) {
  const auto http = server({.connections = 16, .header_s = 600.0});
  std::vector<HttpConnection> silent;
  for (int i = 0; i < 12; ++i) silent.emplace_back(http->port(), 2U);
  ASSERT_TRUE(has_open(*http, 12));
  {  // Behind a proxy they all have one address: who proves that he may ask has a place.
    HttpConnection one_more(http->port(), 2);
    ASSERT_TRUE(one_more.send(test::http_text(http->port(), "GET", "/", {{"X-Known", "yes"}})));
    EXPECT_EQ(one_more.answer().status, 200);
    HttpConnection too_many(http->port(), 2);
    EXPECT_EQ(too_many.answer().status, 503);
  }
  ASSERT_TRUE(has_open(*http, 12));
  {
    HttpConnection stranger(http->port(), 2);
    ASSERT_TRUE(stranger.send(test::http_text(http->port(), "GET", "/")));
    EXPECT_EQ(stranger.answer().status, 503);
  }
  ASSERT_TRUE(has_open(*http, 12));
  silent.emplace_back(http->port(), 3U);
  silent.emplace_back(http->port(), 3U);
  ASSERT_TRUE(has_open(*http, 14));
  // Now a client has to prove who it is, and soon.
  HttpConnection stranger(http->port(), 4);
  ASSERT_TRUE(stranger.send(test::http_text(http->port(), "GET", "/")));
  EXPECT_EQ(stranger.answer().status, 503);
  HttpConnection says_nothing(http->port(), 5);
  EXPECT_TRUE(says_nothing.ends(60.0));
  ASSERT_TRUE(has_open(*http, 14));
  HttpConnection known(http->port(), 6);
  ASSERT_TRUE(known.send(test::http_text(http->port(), "GET", "/", {{"X-Known", "yes"}})));
  EXPECT_EQ(known.answer().status, 200);
  silent.clear();
  ASSERT_TRUE(has_open(*http, 0));
  EXPECT_EQ(test::http_ask(http->port(), "GET", "/").status, 200);
}

TEST(HttpServer, ReadsRequestsInAnyPieces) {
  const auto http = server();
  // Two requests on one connection: a cut may lie in either, or between.
  const std::string both = test::http_text(http->port(), "POST", "/a%20b?c=d", {{"X-A", "b"}}, "{\"body\": 1}") +
                           test::http_text(http->port(), "GET", "/");
  const auto answers = [&](HttpConnection& connection) {
    const test::HttpAnswer first = connection.answer(), second = connection.answer();
    return first.status == 200 && first.body == "{\"body\": 1}" && second.status == 200 && second.body == "{}";
  };
  for (std::size_t cut = 0; cut <= both.size(); ++cut) {
    HttpConnection connection(http->port());
    ASSERT_TRUE(connection.send(std::string_view(both).substr(0, cut)));
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    ASSERT_TRUE(connection.send(std::string_view(both).substr(cut)));
    EXPECT_TRUE(answers(connection)) << cut;
  }
  HttpConnection by_bytes(http->port());
  for (const char byte : both) {
    ASSERT_TRUE(by_bytes.send({&byte, 1}));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_TRUE(answers(by_bytes));
}

// The client ends without a word at any byte of its request, and of the response.
TEST(HttpServer, OutlivesReadsAndWritesThatFail) {
  const auto http = server();
  const std::string request = test::http_text(http->port(), "POST", "/", {}, "{\"body\": 1}");
  for (std::size_t sent = 0; sent <= request.size(); ++sent) {
    HttpConnection connection(http->port());
    ASSERT_TRUE(connection.send(std::string_view(request).substr(0, sent)));
    connection.reset();
  }
  for (const char* path : {"/large", "/events", "/throws"}) {
    for (const char* seen : {"H", "\r\n", "\r\n\r\n", "\r\n\r\nx"}) {
      HttpConnection connection(http->port());
      ASSERT_TRUE(connection.send(test::http_text(http->port(), "GET", path)));
      static_cast<void>(connection.wait_for(seen, 0.2));  // of /events and /throws the last one does not come
      connection.reset();
      http->publish("news", std::string(1000, 'n'));
    }
  }
  EXPECT_TRUE(has_open(*http, 0));
  EXPECT_EQ(test::http_ask(http->port(), "GET", "/large").body.size(), large);
}

}  // namespace http_server_test
}  // namespace robomill::serve
