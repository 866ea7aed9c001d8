#pragma once
// A client that sends what it is told to, byte by byte if need be.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace robomill::test {

struct HttpAnswer {
  int status = 0;  ///< 0: the connection ended without one
  std::map<std::string, std::string> headers = {};
  std::string body = {};
};

/// A connection to a port of this machine.
class HttpConnection {
 public:
  /// @param from  the last number of the address that it comes from, 127.0.0.N
  explicit HttpConnection(int port, std::uint32_t from = 1) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK - 1 + from);
    const bool bound = from == 1 || ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    open_ = socket_ >= 0 && bound && connect(address);
  }
  ~HttpConnection() {
    if (socket_ >= 0) ::close(socket_);
  }
  HttpConnection(HttpConnection&& other) noexcept
      : socket_(std::exchange(other.socket_, -1)), open_(other.open_), got_(std::move(other.got_)) {}
  HttpConnection(const HttpConnection&) = delete;
  HttpConnection& operator=(const HttpConnection&) = delete;
  HttpConnection& operator=(HttpConnection&&) = delete;

  [[nodiscard]] bool is_open() const { return open_; }
  /// Ends it without a word: what the other end still sends fails.
  void reset() {
    const linger at_once = {.l_onoff = 1, .l_linger = 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &at_once, sizeof(at_once));
    ::close(std::exchange(socket_, -1));
    open_ = false;
  }
  /// False where the other end closed.
  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }
  /// Sends nothing more; what the other end still sends can be read.
  void send_end() { ::shutdown(socket_, SHUT_WR); }
  /// Reads until `wanted` stands in what came, the end, or a time; true where it does.
  bool wait_for(std::string_view wanted, double seconds = 20.0) {
    const Clock::time_point end = after(seconds);
    while (got_.find(wanted) == std::string::npos) {
      if (!read_some(end)) return false;
    }
    return true;
  }
  [[nodiscard]] const std::string& got() const { return got_; }
  void forget() { got_.clear(); }

  /// One response.
  HttpAnswer answer(double seconds = 60.0) {
    HttpAnswer out;
    if (!wait_for("\r\n\r\n", seconds)) return out;
    const std::size_t head = got_.find("\r\n\r\n");
    out.status = std::atoi(got_.c_str() + got_.find(' '));
    std::size_t at = got_.find("\r\n") + 2;
    while (at < head) {
      const std::size_t line_end = got_.find("\r\n", at);
      const std::size_t colon = got_.find(": ", at);
      std::string name = got_.substr(at, colon - at);
      std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
      out.headers[name] = got_.substr(colon + 2, line_end - colon - 2);
      at = line_end + 2;
    }
    const std::size_t length = std::strtoul(out.headers["content-length"].c_str(), nullptr, 10);
    const Clock::time_point end = after(seconds);
    while (got_.size() < head + 4 + length) {
      if (!read_some(end)) return {};
    }
    out.body = got_.substr(head + 4, length);
    got_.erase(0, head + 4 + length);
    return out;
  }
  /// Whether the other end closes within a time.
  bool ends(double seconds) {
    const Clock::time_point end = after(seconds);
    while (read_some(end)) {
    }
    return !timed_out_;
  }

 private:
  using Clock = std::chrono::steady_clock;
  static Clock::time_point after(double seconds) {
    return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }
  /// A signal, a fuzzer's alarm say, ends the call alone: the connection comes about all the same.
  bool connect(const sockaddr_in& address) {
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) return true;
    pollfd waiting = {.fd = socket_, .events = POLLOUT, .revents = 0};
    int error = errno;
    while (error == EINTR) {
      if (::poll(&waiting, 1, -1) < 0) continue;
      socklen_t length = sizeof(error);
      ::getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &length);
    }
    return error == 0;
  }
  bool read_some(Clock::time_point end) {
    pollfd waiting = {.fd = socket_, .events = POLLIN, .revents = 0};
    int ready = -1;
    do {  // a signal ends a wait, too
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
      timed_out_ = left.count() <= 0;
      ready = timed_out_ ? 0 : ::poll(&waiting, 1, static_cast<int>(left.count()));
    } while (ready < 0 && errno == EINTR);
    timed_out_ = ready <= 0;
    if (timed_out_) return false;
    char block[65536];
    const ssize_t read = ::recv(socket_, block, sizeof(block), 0);
    if (read <= 0) return false;
    got_.append(block, static_cast<std::size_t>(read));
    return true;
  }

  int socket_ = -1;
  bool open_ = false, timed_out_ = false;
  std::string got_;
};

using HttpHeaders = std::vector<std::pair<std::string, std::string>>;

/// A request as text; Host and Content-Length unless the headers have them.
inline std::string http_text(int port, std::string_view method, std::string_view target,
                             const HttpHeaders& headers = {}, std::string_view body = {}) {
  std::string out = std::string(method) + " " + std::string(target) + " HTTP/1.1\r\n";
  const auto has = [&headers](std::string_view name) {
    return std::ranges::any_of(headers, [name](const auto& header) { return header.first == name; });
  };
  if (!has("Host")) out += "Host: 127.0.0.1:" + std::to_string(port) + "\r\n";
  for (const auto& [name, value] : headers) out += name + ": " + value + "\r\n";
  if (!body.empty() && !has("Content-Length")) out += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  return out + "\r\n" + std::string(body);
}

/// A request by a connection of its own.
inline HttpAnswer http_ask(int port, std::string_view method, std::string_view target, const HttpHeaders& headers = {},
                           std::string_view body = {}) {
  HttpConnection connection(port);
  if (!connection.is_open() || !connection.send(http_text(port, method, target, headers, body))) {
    // What was rejected early may close before all of it was sent; its answer is there all the same.
    return connection.answer(5.0);
  }
  return connection.answer();
}

}  // namespace robomill::test
