#include "robomill/serve/http/server.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <variant>

#include "testing/serve/http_client.hpp"

namespace robomill::serve {
namespace http_server_test {

using test::HttpConnection;

std::unique_ptr<HttpServer> server(HttpServer::Options options = {}) {
  auto out = std::make_unique<HttpServer>(std::move(options));
  out->start({.admit = [](const HttpRequest& request) -> std::variant<std::uint64_t, HttpResponse> {
                if (request.path == "/throws") throw std::runtime_error("an error");
                if (request.path == "/too-much") throw std::bad_alloc();
                return std::uint64_t{100};
              },
              .handle =
                  [](const HttpRequest& request, const Reply& reply) {
                    reply(request.path == "/events" ? HttpResponse{.events = true} : HttpResponse{.body = "{}"});
                  }});
  return out;
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
  for (int tries = 0; http->open_connections() < 1 && tries < 6000; ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ASSERT_EQ(http->open_connections(), 1U);
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

}  // namespace http_server_test
}  // namespace robomill::serve
