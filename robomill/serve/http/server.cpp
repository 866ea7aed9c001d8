#include "robomill/serve/http/server.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/serve/http/connection.hpp"
#include "robomill/serve/http/listener.hpp"

namespace robomill::serve {
namespace {

constexpr std::size_t most_rejected = 256;  ///< connections, at a time

/// The client that a connection comes from: a whole /64 of IPv6 addresses is one client's.
std::string client_of(const Tcp::socket& socket) {
  error_code error;
  const asio::ip::address address = socket.remote_endpoint(error).address();
  if (error) return {};
  if (!address.is_v6()) return address.to_string();
  const asio::ip::address_v6 six = address.to_v6();
  if (six.is_v4_mapped()) return asio::ip::make_address_v4(asio::ip::v4_mapped, six).to_string();
  asio::ip::address_v6::bytes_type bytes = six.to_bytes();
  std::fill(bytes.begin() + 8, bytes.end(), static_cast<unsigned char>(0));
  return asio::ip::address_v6(bytes).to_string();
}

}  // namespace

const std::string& HttpRequest::header(std::string_view name) const {
  static const std::string none;
  const auto found = headers.find(name);
  return found == headers.end() ? none : found->second;
}

void Listener::listen() {
  error_code error;
  const asio::ip::address address = asio::ip::make_address(options.host, error);
  if (error) {
    throw InvalidInput(
        InvalidInput::Parts{.field = "host",
                            .value = options.host,
                            .rule = "must be an address of this machine, as 127.0.0.1, or localhost",
                            .hint = "Names are not looked up: give the address that this one stands for"});
  }
  const Tcp::endpoint endpoint(address, static_cast<std::uint16_t>(options.port));
  const auto step = [&](const char* what) {
    if (!error) return;
    throw InvalidInput("port", fmt::format("cannot {} at {}:{}: {}", what, options.host, options.port, error.message()),
                       "Is the port taken? Give another: --port 0 takes any that is free");
  };
  acceptor.open(endpoint.protocol(), error);
  step("open a socket");
  acceptor.set_option(Tcp::acceptor::reuse_address(true), error);
  acceptor.bind(endpoint, error);
  step("listen");
  acceptor.listen(asio::socket_base::max_listen_connections, error);
  step("listen");
}

void Listener::accept() {
  acceptor.async_accept([this](error_code error, Tcp::socket socket) {
    accepts = false;
    if (error == asio::error::operation_aborted || !acceptor.is_open()) return;
    if (error) {  // no descriptor left, for one: wait until connections end
      pause.expires_after(after(0.05));
      pause.async_wait([this](error_code ended) {
        accepts = false;
        if (!ended) accept();
      });
      accepts = true;
      return;
    }
    try {
      take(std::move(socket));
    } catch (const std::exception&) {
      // No memory for one more: the next may find some.
    }
    accept();
  });
  accepts = true;
}

void Listener::take(Tcp::socket socket) {
  const std::string client = client_of(socket);
  const Places::Place place = places.take(client);
  if (place == Places::Place::none) return reject(std::move(socket));
  error_code ignored;
  socket.set_option(Tcp::no_delay(true), ignored);
  std::shared_ptr<Connection> connection;
  try {
    connection = std::make_shared<Connection>(std::move(socket), *this, client, place);
    connections.insert(connection);
  } catch (const std::exception&) {
    places.leave(client, place);
    throw;
  }
  ++open;
  connection->begin();
}

/// 503, and a second to read it; beyond most_rejected the connection is only closed.
void Listener::reject(Tcp::socket socket) {
  if (rejected >= most_rejected) return;
  const auto connection = std::make_shared<RejectedConnection>(std::move(socket), *this);
  connection->begin();
}

/// Until it is stopped, whatever a step of a connection throws.
void Listener::run() {
  constexpr std::chrono::milliseconds pause_without_memory(50);
  for (;;) {
    try {
      if (!accepts && acceptor.is_open()) accept();
      io.run();
      return;
    } catch (const std::exception&) {
      // No memory for one step, say: the others go on.
      std::this_thread::sleep_for(pause_without_memory);
    }
  }
}

void Listener::publish(const std::shared_ptr<const std::string>& text) {
  const std::vector<std::shared_ptr<Connection>> all(streams.begin(), streams.end());  // one that closes leaves the set
  for (const std::shared_ptr<Connection>& stream : all) stream->send_event(text);
}

void Listener::stop() {
  error_code ignored;
  acceptor.close(ignored);
  pause.cancel();
  const std::vector<std::shared_ptr<Connection>> all(connections.begin(), connections.end());
  for (const std::shared_ptr<Connection>& connection : all) connection->close();
  io.stop();
}

HttpServer::HttpServer(Options options) : listener_(std::make_shared<Listener>(std::move(options))) {
  listener_->listen();
}

void HttpServer::start(Handlers handlers) {
  listener_->handlers = std::move(handlers);
  listener_->accept();
  listener_->thread = std::jthread([listener = listener_.get()] { listener->run(); });
}

HttpServer::~HttpServer() {
  if (!listener_->thread.joinable()) return;  // never started
  asio::post(listener_->io, [listener = listener_.get()] { listener->stop(); });
  listener_->thread.join();
}

int HttpServer::port() const {
  return listener_->acceptor.local_endpoint().port();
}

void HttpServer::publish(std::string_view event, std::string_view data) {
  const auto text = std::make_shared<const std::string>(fmt::format("event: {}\ndata: {}\n\n", event, data));
  asio::post(listener_->io, [listener = listener_.get(), text] { listener->publish(text); });
}

std::size_t HttpServer::open_connections() const {
  return listener_->open;
}

}  // namespace robomill::serve
