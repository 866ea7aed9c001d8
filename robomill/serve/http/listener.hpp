#pragma once

// ThreadSanitizer knows no fences; handlers run on one thread, in the order of the scheduler's mutex.
#ifdef __SANITIZE_THREAD__
#define BOOST_ASIO_DISABLE_FENCED_BLOCK
#endif

#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "robomill/serve/http/places.hpp"
#include "robomill/serve/http/server.hpp"

namespace robomill::serve {

namespace asio = boost::asio;
using Tcp = asio::ip::tcp;
using boost::system::error_code;

inline std::chrono::steady_clock::duration after(double seconds) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds));
}

class Connection;

/// What accepts and owns the connections.
struct Listener : std::enable_shared_from_this<Listener> {
  explicit Listener(HttpServer::Options wanted) : options(std::move(wanted)) {}

  HttpServer::Options options;
  HttpServer::Handlers handlers;
  Places places{options.connections};
  std::size_t rejected = 0;  ///< connections; these are gone last
  asio::io_context io{1};
  Tcp::acceptor acceptor{io};
  asio::steady_timer pause{io};
  std::set<std::shared_ptr<Connection>> connections, streams;  ///< of the io thread alone
  std::size_t large_bodies = 0;
  bool accepts = false;  ///< or waits to do so
  std::atomic<std::size_t> open{0};
  std::jthread thread;

  void listen();
  void accept();
  void take(Tcp::socket socket);
  void reject(Tcp::socket socket);
  void run();
  void publish(const std::shared_ptr<const std::string>& text);
  void stop();
};

}  // namespace robomill::serve
