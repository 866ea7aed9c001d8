// Every write of the server to a client fails once: nobody else is kept waiting, and no connection stays. The calls of
// the C library are replaced in this program; those of the test's own thread work. A write of a part alone is not
// tried: Asio then waits until there is room again, which there always was.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <thread>

#include "robomill/io/system/sanitized.hpp"
#include "robomill/serve/http/server.hpp"
#include "testing/serve/http_client.hpp"

namespace robomill::serve {
namespace http_write_faults_test {

struct Fault {
  std::thread::id client = {};  ///< whose calls do not count
  std::atomic<int> calls{0};    ///< that count
  std::atomic<int> failing{0};  ///< the number of the one that fails; 0: none
  std::atomic<int> error{0};
};
Fault fault;

/// Whether the call that is made now fails, with errno.
bool fails() {
  if (std::this_thread::get_id() == fault.client || ++fault.calls != fault.failing) return false;
  errno = fault.error;
  return true;
}

}  // namespace http_write_faults_test
}  // namespace robomill::serve

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which replace them too
extern "C" ssize_t send(int socket, const void* bytes, std::size_t size, int flags) {
  if (robomill::serve::http_write_faults_test::fails()) return -1;
  return ::syscall(SYS_sendto, socket, bytes, size, flags, nullptr, 0);
}

extern "C" ssize_t sendmsg(int socket, const msghdr* message, int flags) {
  if (robomill::serve::http_write_faults_test::fails()) return -1;
  return ::syscall(SYS_sendmsg, socket, message, flags);
}
#endif

namespace robomill::serve {
namespace http_write_faults_test {

using test::HttpConnection;

constexpr std::size_t large = std::size_t{1} << 20;

/// What a page does: a file, a stream of events with one of them, an error. Whether all of it came.
bool visit(HttpServer& http) {
  bool all = true;
  HttpConnection stream(http.port());
  all = stream.send(test::http_text(http.port(), "GET", "/events")) && stream.wait_for("retry: ", 1.0) && all;
  http.publish("news", std::string(5000, 'n') + "end");
  all = stream.wait_for("nend", 1.0) && all;
  HttpConnection once(http.port());
  for (const char* path : {"/large", "/none", "/large"}) {
    if (!once.send(test::http_text(http.port(), "GET", path))) return false;
    const test::HttpAnswer answer = once.answer(5.0);
    all = answer.status == (std::string(path) == "/none" ? 404 : 200) && all;
    if (answer.status == 200) all = answer.body == std::string(large, 'x') && all;
  }
  return all;
}

TEST(HttpServer, OutlivesEveryWriteThatFails) {
  if (io::sanitized) GTEST_SKIP() << "sanitizers have calls of their own";
  HttpServer http(HttpServer::Options{});
  http.start({.admit = [](const HttpRequest&) { return std::uint64_t{0}; },
              .handle =
                  [](const HttpRequest& request, const Reply& reply) {
                    if (request.path == "/events") return reply({.events = true});
                    if (request.path == "/none") return reply({.status = 404, .body = "{}"});
                    reply({.body = std::string(large, 'x')});
                  },
              .knows = [](const HttpRequest&) { return true; }});
  fault.client = std::this_thread::get_id();
  fault.failing = 0;
  fault.calls = 0;
  ASSERT_TRUE(visit(http));
  const int calls = fault.calls;
  ASSERT_GE(calls, 5);
  for (const int error : {EINTR, EPIPE, ECONNRESET, ENOBUFS}) {
    for (int n = 1; n <= calls; ++n) {
      fault.error = error;
      fault.calls = 0;
      fault.failing = n;
      const bool all = visit(http);
      EXPECT_TRUE(all || error != EINTR) << n;
      fault.failing = 0;
      EXPECT_TRUE(visit(http)) << error << " at call " << n;
    }
  }
  for (int tries = 0; http.open_connections() > 0 && tries < 6000; ++tries) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(http.open_connections(), 0U);
}

}  // namespace http_write_faults_test
}  // namespace robomill::serve
