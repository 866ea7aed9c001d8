#include "metrics_server.hpp"

// Plain HTTP on loopback needs neither TLS nor compression.
#include <fmt/format.h>
#include <httplib.h>

#include <thread>

#include "robomill/base/error.hpp"
#include "robomill/serve/guard.hpp"

namespace robomill::app {
namespace {

constexpr std::size_t max_request_bytes = 4096;
/// A connection holds a thread until it has asked and was answered, or has been silent for this long.
constexpr std::size_t connections = 32;
constexpr time_t longest_silence_s = 1;

}  // namespace

struct MetricsServer::Parts {
  httplib::Server server;
  std::jthread thread;
};

MetricsServer::MetricsServer(const live::MetricValues& values, const std::string& host, int port)
    : parts_(std::make_unique<Parts>()) {
  httplib::Server& server = parts_->server;
  server.new_task_queue = [] { return new httplib::ThreadPool(connections); };  // NOLINT: httplib takes it over
  // Not shared with another server, as httplib would have it.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  server.set_payload_max_length(max_request_bytes);
  server.set_read_timeout(longest_silence_s);
  server.set_write_timeout(longest_silence_s);
  server.set_keep_alive_timeout(longest_silence_s);
  // Who asks every few seconds need not hold a thread in between.
  server.set_keep_alive_max_count(1);
  const std::string address = serve::host_address(host);
  // A name that was made to point here must not let a page of its own read them.
  server.set_pre_routing_handler([this, address](const httplib::Request& request, httplib::Response& response) {
    using Answer = httplib::Server::HandlerResponse;
    if (serve::is_own_host(request.get_header_value("Host"), address, port_)) return Answer::Unhandled;
    response.status = 403;
    response.set_content("this is not the host that is asked for\n", "text/plain");
    return Answer::Handled;
  });
  server.Get("/metrics", [&values](const httplib::Request&, httplib::Response& response) {
    response.set_content(values.text(), "text/plain; version=0.0.4");
  });
  port_ = port == 0 ? server.bind_to_any_port(address) : (server.bind_to_port(address, port) ? port : -1);
  if (port_ <= 0) {
    throw InvalidInput("metrics", fmt::format("cannot listen at {}:{}", host, port),
                       "Is the port taken? The host must be an address of this machine, as 127.0.0.1");
  }
  parts_->thread = std::jthread([&server] { server.listen_after_bind(); });
  // stop() before listen_after_bind has begun would be forgotten.
  while (!server.is_running()) std::this_thread::yield();
}

MetricsServer::~MetricsServer() {
  parts_->server.stop();
}

}  // namespace robomill::app
