// Every read and write of the server's in pieces, and each failing once. The system's calls of this test program pass
// through here.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <string>
#include <thread>
#include <utility>
#include <variant>

#include "robomill/serve/http/server.hpp"
#include "testing/serve/http_client.hpp"

namespace robomill::serve {
namespace socket_faults_test {

/// What happens to the calls of other threads than the test's.
struct Faults {
  std::atomic<std::size_t> most_bytes{0};  ///< of a call; 0: as many as it wants
  std::atomic<int> reads{0}, writes{0};    ///< so many calls more, then one fails; 0: none does
};
Faults faults;
thread_local bool is_client = false;

/// Whether this call is the one that fails.
bool fails(std::atomic<int>& calls) {
  if (is_client) return false;
  int left = calls.load();
  while (left > 0 && !calls.compare_exchange_weak(left, left - 1)) {
  }
  if (left != 1) return false;
  errno = ECONNRESET;
  return true;
}

std::size_t fewer(std::size_t bytes) {
  const std::size_t most = faults.most_bytes;
  return is_client || most == 0 ? bytes : std::min(bytes, most);
}

/// A message with its first buffer alone, and not all of that; none where it is to go as it is.
bool is_cut(const msghdr& message, msghdr& first, iovec& part) {
  if (is_client || faults.most_bytes == 0) return false;
  first = message;
  for (std::size_t i = 0; i < message.msg_iovlen; ++i) {
    if (message.msg_iov[i].iov_len == 0) continue;
    part = {.iov_base = message.msg_iov[i].iov_base, .iov_len = fewer(message.msg_iov[i].iov_len)};
    first.msg_iov = &part;
    first.msg_iovlen = 1;
    return true;
  }
  return false;
}

extern "C" ssize_t send(int socket, const void* bytes, size_t count, int flags) {
  if (fails(faults.writes)) return -1;
  return ::syscall(SYS_sendto, socket, bytes, fewer(count), flags, nullptr, 0);
}

extern "C" ssize_t sendmsg(int socket, const msghdr* message, int flags) {
  if (fails(faults.writes)) return -1;
  msghdr first = {};
  iovec part = {};
  return ::syscall(SYS_sendmsg, socket, is_cut(*message, first, part) ? &first : message, flags);
}

extern "C" ssize_t recv(int socket, void* bytes, size_t count, int flags) {
  if (fails(faults.reads)) return -1;
  return ::syscall(SYS_recvfrom, socket, bytes, fewer(count), flags, nullptr, nullptr);
}

extern "C" ssize_t recvmsg(int socket, msghdr* message, int flags) {
  if (fails(faults.reads)) return -1;
  msghdr first = {};
  iovec part = {};
  return ::syscall(SYS_recvmsg, socket, is_cut(*message, first, part) ? &first : message, flags);
}

/// A server that gives back what it is given, and its streams; the thread of the test is the client.
class SocketFaults : public ::testing::Test {
 protected:
  SocketFaults() : http_({.headers = {{"X-Some", "header"}}}) {
    is_client = true;
    http_.start(
        {.admit = [](const HttpRequest&) -> std::variant<std::uint64_t, HttpResponse> { return std::uint64_t{10'000}; },
         .handle =
             [](const HttpRequest& request, const Reply& reply) {
               reply(request.path == "/events" ? HttpResponse{.events = true} : HttpResponse{.body = request.body});
             }});
  }
  ~SocketFaults() override {
    faults.most_bytes = 0;
    faults.reads = faults.writes = 0;
    is_client = false;
  }
  [[nodiscard]] std::string request() const { return test::http_text(http_.port(), "POST", "/a", {}, body_); }
  /// Whether no connection is left.
  [[nodiscard]] bool is_free() const {
    for (int tries = 0; tries < 6000; ++tries) {
      if (http_.open_connections() == 0) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  /// Answers others, with its calls as they are.
  void expect_well() {
    faults.most_bytes = 0;
    faults.reads = faults.writes = 0;
    const test::HttpAnswer answer = test::http_ask(http_.port(), "POST", "/a", {}, body_);
    EXPECT_EQ(answer.status, 200);
    EXPECT_EQ(answer.body, body_);
    EXPECT_TRUE(is_free());
  }

  HttpServer http_;
  std::string body_ = std::string(300, 'b');
};

TEST_F(SocketFaults, BytesThatComeAndGoOneByOne) {
  for (const std::size_t most : {std::size_t{1}, std::size_t{2}, std::size_t{7}}) {
    faults.most_bytes = most;
    test::HttpConnection connection(http_.port());
    for (int i = 0; i < 2; ++i) {
      ASSERT_TRUE(connection.send(request()));
      const test::HttpAnswer answer = connection.answer();
      EXPECT_EQ(answer.status, 200) << most;
      EXPECT_EQ(answer.body, body_) << most;
      EXPECT_EQ(answer.headers.at("x-some"), "header") << most;
    }
    test::HttpConnection events(http_.port());
    ASSERT_TRUE(events.send(test::http_text(http_.port(), "GET", "/events")));
    ASSERT_TRUE(events.wait_for("retry: 1000"));
    http_.publish("news", body_);
    EXPECT_TRUE(events.wait_for("event: news\ndata: " + body_ + "\n\n"));
  }
  expect_well();
}

TEST_F(SocketFaults, EveryCallFailsOnce) {
  for (std::atomic<int>* const calls : {&faults.reads, &faults.writes}) {
    int failed = 0;
    for (int place = 1;; ++place) {
      ASSERT_LT(place, 10'000);
      faults.most_bytes = 40;  // so that there are many
      *calls = place;
      bool whole = false;
      {
        test::HttpConnection connection(http_.port());
        ASSERT_TRUE(connection.send(request()));
        const test::HttpAnswer answer = connection.answer();
        whole = answer.status == 200 && answer.body == body_;
      }
      const bool happened = *calls == 0;
      ASSERT_TRUE(is_free()) << place;
      if (!happened) {
        EXPECT_TRUE(whole) << place;
        break;
      }
      if (!whole) ++failed;  // one of the last reads is after the response
    }
    EXPECT_GT(failed, 5);
    expect_well();
  }
}

TEST_F(SocketFaults, EveryWriteOfAStreamFailsOnce) {
  for (int place = 1;; ++place) {
    ASSERT_LT(place, 10'000);
    faults.most_bytes = 40;
    faults.writes = place;
    bool whole = false;
    {
      test::HttpConnection events(http_.port());
      ASSERT_TRUE(events.send(test::http_text(http_.port(), "GET", "/events")));
      if (events.wait_for("retry: 1000\n\n")) {
        http_.publish("news", body_);
        whole = events.wait_for(body_ + "\n\n");
      }
    }
    const bool happened = faults.writes == 0;
    ASSERT_TRUE(is_free()) << place;
    EXPECT_NE(whole, happened) << place;
    if (!happened) break;
  }
  expect_well();
}

}  // namespace socket_faults_test
}  // namespace robomill::serve
