#include "command_intake.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/serve/guard.hpp"

namespace robomill::app {
namespace {

constexpr std::size_t read_bytes = 512;
constexpr int waiting_clients = 8;
constexpr int highest_port = 65535;

[[noreturn]] void reject_place(const std::string& place, const std::string& rule, const std::string& hint) {
  throw InvalidInput(
      InvalidInput::Parts{.field = "--listen", .value = "\"" + printable(place) + "\"", .rule = rule, .hint = hint});
}

/// HOST:PORT, [HOST]:PORT or PORT as an address.
sockaddr_storage address_of(const std::string& place, socklen_t& size, std::string& host, int& port) {
  const std::size_t colon = place.rfind(':');
  host = colon == std::string::npos ? "127.0.0.1" : place.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  host = serve::host_address(host);
  const std::string digits = colon == std::string::npos ? place : place.substr(colon + 1);
  const std::from_chars_result read = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (digits.empty() || read.ec != std::errc() || read.ptr != digits.data() + digits.size() || port < 0 ||
      port > highest_port) {
    reject_place(place, "must be PORT (0 to 65535), HOST:PORT, or a path with a slash for a UNIX socket",
                 "For example 5005, or /run/robomill.sock");
  }
  sockaddr_storage out = {};
  sockaddr_in four = {};
  sockaddr_in6 six = {};
  if (::inet_pton(AF_INET, host.c_str(), &four.sin_addr) == 1) {
    four.sin_family = AF_INET;
    four.sin_port = htons(static_cast<std::uint16_t>(port));
    size = sizeof(four);
    std::memcpy(&out, &four, sizeof(four));
  } else if (::inet_pton(AF_INET6, host.c_str(), &six.sin6_addr) == 1) {
    six.sin6_family = AF_INET6;
    six.sin6_port = htons(static_cast<std::uint16_t>(port));
    size = sizeof(six);
    std::memcpy(&out, &six, sizeof(six));
  } else {
    reject_place(place, "names a host that is no address", "127.0.0.1 and ::1 are this machine");
  }
  return out;
}

int port_of(int socket) {
  sockaddr_storage bound = {};
  socklen_t size = sizeof(bound);
  if (::getsockname(socket, reinterpret_cast<sockaddr*>(&bound), &size) != 0) return 0;
  std::uint16_t port = 0;  // where both families have it
  std::memcpy(&port, reinterpret_cast<const char*>(&bound) + offsetof(sockaddr_in, sin_port), sizeof(port));
  return ntohs(port);
}

/// One that a process left behind is taken away; nothing else is.
void remove_dead_socket(const std::string& path, const sockaddr_un& address) {
  struct stat found = {};
  if (::lstat(path.c_str(), &found) != 0) return;
  const io::Descriptor probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const bool dead = S_ISSOCK(found.st_mode) &&
                    ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0 &&
                    errno == ECONNREFUSED;
  if (!dead) reject_place(path, "stands already", "Remove it, or listen elsewhere");
  ::unlink(path.c_str());
}

/// A page in a browser can send lines to a port of this machine; they begin with a request.
bool is_http(std::string_view line) {
  return line.find(" HTTP/") != std::string_view::npos;
}

}  // namespace

CommandIntake::CommandIntake(const Options& options, Answer answer, std::function<void(const std::string&)> print)
    : input_(options.input), answer_(std::move(answer)), print_(std::move(print)) {
  if (options.listen.empty()) return;
  if (options.listen.find('/') != std::string::npos) {
    listen_at_path(options.listen);
  } else {
    listen_at(options.listen);
  }
}

CommandIntake::~CommandIntake() {
  if (!path_.empty()) ::unlink(path_.c_str());
}

void CommandIntake::listen_at(const std::string& place) {
  socklen_t size = 0;
  std::string host;
  int port = 0;
  const sockaddr_storage address = address_of(place, size, host, port);
  listener_ = io::Descriptor(::socket(address.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int yes = 1;
  ::setsockopt(listener_.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  if (::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      ::listen(listener_.get(), waiting_clients) != 0) {
    reject_place(place, "cannot be listened at: " + io::error_text(errno), "Is the port taken?");
  }
  public_ = !serve::is_loopback(host);
  const bool bare = host.find(':') == std::string::npos;
  address_ = fmt::format("{}:{}", bare ? host : "[" + host + "]", port_of(listener_.get()));
}

void CommandIntake::listen_at_path(const std::string& path) {
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) {
    reject_place(path, fmt::format("is longer than {} bytes", sizeof(address.sun_path) - 1), "");
  }
  std::memcpy(address.sun_path, path.data(), path.size());
  remove_dead_socket(path, address);
  listener_ = io::Descriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  ::fchmod(listener_.get(), S_IRUSR | S_IWUSR);  // before there is a path: other users never reach it
  if (::bind(listener_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    reject_place(path, "cannot be listened at: " + io::error_text(errno), "");
  }
  path_ = path;
  if (::listen(listener_.get(), waiting_clients) != 0) {
    ::unlink(path_.c_str());
    reject_place(path, "cannot be listened at: " + io::error_text(errno), "");
  }
  address_ = path;
}

void CommandIntake::accept_client() {
  io::Descriptor socket(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (!socket.is_open()) return;
  if (clients_.size() >= most_clients) {
    constexpr std::string_view full = "error: too many connections\n";
    static_cast<void>(::send(socket.get(), full.data(), full.size(), MSG_NOSIGNAL));
    return;
  }
  clients_.push_back({.socket = std::move(socket)});
}

/// False: the connection ends.
bool CommandIntake::serve(Client& client) {
  std::array<char, read_bytes> bytes = {};
  const ssize_t count = ::recv(client.socket.get(), bytes.data(), bytes.size(), 0);
  if (count < 0) return errno == EAGAIN || errno == EINTR;
  bool stays = count > 0;
  const auto take = [&](std::optional<std::string_view> line) {
    if (line && is_http(*line)) stays = false;
    if (!stays && count > 0) return;
    const std::string answer = answer_(line);
    if (answer.empty()) return;
    const std::string text = answer + "\n";
    const ssize_t sent = ::send(client.socket.get(), text.data(), text.size(), MSG_NOSIGNAL);
    if (sent != static_cast<ssize_t>(text.size())) stays = false;
  };
  if (count > 0) {
    client.lines.add({bytes.data(), static_cast<std::size_t>(count)}, take);
  } else {
    client.lines.end(take);
    stays = false;
  }
  return stays;
}

void CommandIntake::read_input() {
  std::array<char, read_bytes> bytes = {};
  const ssize_t count = ::read(input_, bytes.data(), bytes.size());
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return;
  const auto take = [this](std::optional<std::string_view> line) {
    if (const std::string answer = answer_(line); !answer.empty()) print_(answer);
  };
  if (count > 0) {
    input_lines_.add({bytes.data(), static_cast<std::size_t>(count)}, take);
  } else {
    input_lines_.end(take);
    input_ = -1;
  }
}

void CommandIntake::poll(std::chrono::milliseconds time) {
  // A background process that reads the terminal would be stopped.
  const bool away = input_ >= 0 && ::isatty(input_) != 0 && ::tcgetpgrp(input_) != ::getpgrp();
  std::vector<pollfd> waited = {{.fd = away ? -1 : input_, .events = POLLIN, .revents = 0},
                                {.fd = listener_.get(), .events = POLLIN, .revents = 0}};
  for (const Client& client : clients_) waited.push_back({.fd = client.socket.get(), .events = POLLIN, .revents = 0});
  if (::poll(waited.data(), waited.size(), static_cast<int>(time.count())) <= 0) return;
  auto one = waited.begin() + 2;
  for (auto client = clients_.begin(); client != clients_.end(); ++one) {
    client = one->revents == 0 || serve(*client) ? std::next(client) : clients_.erase(client);
  }
  if (waited[1].revents != 0) accept_client();
  if (waited[0].revents != 0) read_input();
}

}  // namespace robomill::app
