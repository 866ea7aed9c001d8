// What a client may do to the server: it stays up, answers others, and holds no more than it may.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "robomill/base/random.hpp"
#include "robomill/serve/serve.hpp"
#include "testing/serve/http_client.hpp"
#include "testing/support.hpp"

namespace robomill::serve {
namespace hostile_test {

using test::HttpConnection;

/// Of this process, that is, of the server and the clients [bytes].
std::size_t resident_bytes() {
  std::size_t all = 0;
  std::size_t resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

class Hostile : public ::testing::Test {
 protected:
  Hostile() : server_({.folder = place_.path(), .port = 0}) {
    const std::string page = test::http_ask(port(), "GET", "/").body;
    const std::size_t begin = page.find("\"token\":\"") + 9;
    token_ = page.substr(begin, page.find('"', begin) - begin);
  }
  [[nodiscard]] int port() const { return server_.port(); }
  /// Others are answered.
  void expect_well() const { EXPECT_EQ(test::http_ask(port(), "GET", "/api/state").status, 200); }

  test::Folder place_;
  Server server_;
  std::string token_;
};

TEST_F(Hostile, MalformedRequests) {
  const std::string host = "Host: 127.0.0.1:" + std::to_string(port()) + "\r\n";
  const std::vector<std::pair<std::string, int>> requests = {
      {"\r\n\r\n", 400},
      {"hello\r\n\r\n", 400},
      {"GET / HTTP/9.9\r\n" + host + "\r\n", 400},
      {"GET  / HTTP/1.1\r\n" + host + "\r\n", 400},
      {"GET / HTTP/1.1\r\nHost\r\n\r\n", 400},
      {"GET / HTTP/1.1\r\n\r\n", 403},
      {"GET / HTTP/1.1\r\n" + host + "Host: evil.example\r\n\r\n", 400},
      {"GET http://evil.example/ HTTP/1.1\r\n" + host + "\r\n", 400},
      {"GET /%00 HTTP/1.1\r\n" + host + "\r\n", 400},
      {"GET /" + std::string(100000, 'a') + " HTTP/1.1\r\n" + host + "\r\n", 431},
      {"GET / HTTP/1.1\r\n" + host + "X: " + std::string(100000, 'a') + "\r\n\r\n", 431},
      {"CONNECT evil.example:443 HTTP/1.1\r\n" + host + "\r\n", 400},
      {"BREW / HTTP/1.1\r\n" + host + "X-Robomill-Token: " + token_ + "\r\n\r\n", 405},
      {"POST /api/check HTTP/1.1\r\n" + host + "Content-Length: -1\r\n\r\n", 400},
      {"POST /api/check HTTP/1.1\r\n" + host + "Content-Length: 1\r\nContent-Length: 2\r\n\r\n", 400},
      {"GET / HTTP/1.1\r\n" + host + "Content-Length: 5\r\n\r\nhello", 413}};
  for (const auto& [request, status] : requests) {
    HttpConnection connection(port());
    connection.send(request);
    EXPECT_EQ(connection.answer().status, status) << request.substr(0, 60);
  }
  expect_well();
}

TEST_F(Hostile, RandomBytes) {
  Random random(11);
  const std::string good =
      test::http_text(port(), "POST", "/api/check", {{"X-Robomill-Token", token_}}, "{\"path\":\"a.toml\"}");
  for (int i = 0; i < test::seeds(2000); ++i) {
    std::string request = good;
    for (std::uint64_t n = 1 + random.index(6); n > 0; --n) {
      request[random.index(request.size())] = static_cast<char>(random.index(256));
    }
    HttpConnection connection(port());
    connection.send(request.substr(0, random.index(request.size()) + 1));
  }
  expect_well();
}

TEST_F(Hostile, JsonOfAnyShape) {
  for (const std::string body :
       {"", "null", "[]", "1", "{\"path\":1,\"text\":2}", "{\"path\":\"gone.toml\",\"text\":{}}", "\"\\ud800\"",
        "{\"text\":\"a=1\",\"key\":\"a\",\"value\":{\"b\":1}}", "{\"text\":\"a=1\",\"key\":\"\",\"value\":1}",
        "{\"input\":[]}", "{\"file\":7}", "{\"job\":1,\"gamma\":[[0,1e999]]}"}) {
    for (const char* address :
         {"/api/check", "/api/edit", "/api/jobs", "/api/lobes", "/api/program", "/api/inspect", "/api/tap"}) {
      const int status = test::http_ask(port(), "POST", address, {{"X-Robomill-Token", token_}}, body).status;
      EXPECT_GE(status, 400) << address << body;
      EXPECT_LT(status, 500) << address << body;
    }
  }
  expect_well();
}

TEST_F(Hostile, JsonThatNestsDeeply) {
  const auto status = [&](const char* address, const std::string& body) {
    return test::http_ask(port(), "POST", address, {{"X-Robomill-Token", token_}}, body).status;
  };
  const auto nested = [](int depth) {
    const auto n = static_cast<std::size_t>(depth);
    return std::string(n, '[') + std::string(n, ']');
  };
  EXPECT_EQ(status("/api/check", std::string(500'000, '[')), 400);
  const std::string deep = nested(400'000);
  for (const auto& [address, before] : std::vector<std::pair<const char*, std::string>>{
           {"/api/check", R"({"path": "a.toml", "text": )"},
           {"/api/edit", R"({"text": "a = 1", "key": "a", "value": )"},
           {"/api/inspect", R"({"path": )"},
           {"/api/jobs", R"({"input": "a.toml", "options": )"},
           {"/api/jobs", R"({"input": "a.toml", "options": {"seed": )"},
           {"/api/jobs", R"({"verb": )"},
           {"/api/tap", R"({"hits": "a.toml", "wanted": )"},
           {"/api/monitors", R"({"config": "a.toml", "input": "a.csv", "speed": )"}}) {
    const std::string after = before.ends_with("\"seed\": ") ? "}}" : "}";
    EXPECT_EQ(status(address, before + deep + after), 400) << address << before;
  }
  for (const char* address : {"/api/lobes", "/api/program"}) {
    EXPECT_EQ(status(address, R"({"sequence": 1, "set": {"a": )" + nested(30'000) + "}}"), 400) << address;
  }
  EXPECT_EQ(status("/api/edit", R"({"text": "a = 1", "key": "a", "value": )" + nested(200) + "}"), 200);
  expect_well();
}

TEST_F(Hostile, TextsOfManyLines) {
  const auto check = [&](const std::string& line, std::size_t bytes) {
    std::string text = R"({"path": "a.toml", "text": ")";
    for (std::size_t i = 0; i * line.size() < bytes; ++i) text += line;
    return test::http_ask(port(), "POST", "/api/check", {{"X-Robomill-Token", token_}}, text + "\"}");
  };
  EXPECT_EQ(check("\\n", 1'900'000).status, 200);
  const test::HttpAnswer many = check("[[a]]\\nb=1\\n", 1'000'000);
  EXPECT_EQ(many.status, 200);
  EXPECT_LT(many.body.size(), std::size_t{1} << 20);  // not a field of each
  EXPECT_EQ(check("a", (1 << 20) + 1).status, 413);
  expect_well();
}

TEST_F(Hostile, PipesInTheFolder) {
  ASSERT_EQ(::mkfifo(place_.at("pipe.csv").c_str(), 0600), 0);
  place_.file("hits.toml",
              "[[hits]]\nfile = \"pipe.csv\"\nforce_direction = \"x\"\nforce = \"1\"\nresponses = { x = \"2\" }\n");
  EXPECT_EQ(test::http_ask(port(), "GET", "/api/file?path=pipe.csv").status, 400);
  const test::HttpHeaders headers = {{"X-Robomill-Token", token_}};
  EXPECT_EQ(test::http_ask(port(), "POST", "/api/inspect", headers, R"({"path": "pipe.csv"})").status, 400);
  EXPECT_EQ(test::http_ask(port(), "POST", "/api/jobs", headers, R"({"verb": "frf", "input": "hits.toml"})").status,
            200);
  std::string jobs;
  for (int tries = 0; tries < 6000 && jobs.find("\"failed\"") == std::string::npos; ++tries) {
    jobs = test::http_ask(port(), "GET", "/api/jobs").body;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_NE(jobs.find("a device or a pipe"), std::string::npos) << jobs;
  expect_well();
}

TEST_F(Hostile, BodyOfAGigabyte) {
  const std::size_t before = resident_bytes();
  const test::HttpHeaders headers = {
      {"X-Robomill-Token", token_}, {"If-None-Match", "*"}, {"Content-Length", "1073741824"}};
  EXPECT_EQ(test::http_ask(port(), "PUT", "/api/file?path=big", headers, "begins").status, 413);
  // Without a length it is read until it is too long.
  HttpConnection chunked(port());
  chunked.send(
      test::http_text(port(), "PUT", "/api/file?path=big",
                      {{"X-Robomill-Token", token_}, {"Transfer-Encoding", "chunked"}, {"If-None-Match", "*"}}));
  const std::string block(std::size_t{1} << 20, 'x');
  const std::string chunk = "100000\r\n" + block + "\r\n";
  for (int i = 0; i < 64 && chunked.send(chunk); ++i) {
  }
  EXPECT_EQ(chunked.answer().status, 413);
  EXPECT_FALSE(std::filesystem::exists(place_.at("big")));
  EXPECT_LT(resident_bytes(), before + (std::size_t{256} << 20));
  expect_well();
}

TEST_F(Hostile, HeadersMustComeWithinFiveSeconds) {
  HttpConnection slow(port());
  slow.send("GET / HTTP/1.1\r\nHo");
  HttpConnection silent(port());
  expect_well();
  EXPECT_TRUE(slow.ends(60.0));
  EXPECT_TRUE(silent.ends(60.0));
}

TEST_F(Hostile, FiveThousandConnections) {
  rlimit files = {};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &files), 0);
  const rlim_t before = files.rlim_cur;
  files.rlim_cur = std::min<rlim_t>(files.rlim_max, 12000);
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &files), 0);
  const std::size_t all = files.rlim_cur >= 12000 ? 5000 : static_cast<std::size_t>(files.rlim_cur) / 3;
  const std::size_t memory = resident_bytes();
  {
    std::vector<HttpConnection> connections;
    constexpr int enough = 100;
    int rejected = 0;
    for (std::size_t i = 0; i < all; ++i) connections.emplace_back(port());
    for (int tries = 0; tries < 100 && rejected <= enough; ++tries) {
      rejected = 0;
      for (HttpConnection& connection : connections) {
        if (connection.is_open() && connection.wait_for("HTTP/1.1 503", 0.02)) ++rejected;
        if (rejected > enough) break;
      }
    }
    EXPECT_GT(rejected, enough);
    EXPECT_LT(resident_bytes(), memory + (std::size_t{200} << 20));
  }
  files.rlim_cur = before;
  EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &files), 0);
  int status = 0;  // once those are gone
  for (int tries = 0; tries < 1200 && status != 200; ++tries) {
    status = test::http_ask(port(), "GET", "/api/state").status;
    if (status != 200) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_EQ(status, 200);
}

TEST_F(Hostile, StreamsAreBounded) {
  std::vector<HttpConnection> streams;
  int open = 0;
  for (int i = 0; i < 40; ++i) {
    streams.emplace_back(port());
    streams.back().send(test::http_text(port(), "GET", "/api/events"));
    EXPECT_TRUE(streams.back().wait_for("\r\n\r\n", 60.0));
    if (streams.back().got().find("text/event-stream") != std::string::npos) ++open;
    EXPECT_EQ(streams.back().got().find("503") != std::string::npos, i >= 32);
  }
  EXPECT_EQ(open, 32);
  expect_well();
}

}  // namespace hostile_test
}  // namespace robomill::serve
