#pragma once
#include "robomill/serve/http/listener.hpp"  // before Boost.Asio, which it configures

#include <array>
#include <atomic>
#include <boost/asio/post.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <cstdint>
#include <deque>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>

namespace robomill::serve {

namespace beast = boost::beast;
namespace http = boost::beast::http;

/// A client: request, response, and again; or a stream of events. All of it on the server's thread.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  /// @param client, place  for server.places
  Connection(Tcp::socket socket, Listener& server, std::string client, Places::Place place)
      : stream_(std::move(socket)), server_(server), client_(std::move(client)), place_(place) {}

  void begin();
  void read_header();
  void close();
  void send_event(const std::shared_ptr<const std::string>& text);

 private:
  /// One response, from any thread. All that it needs but a few bytes was there before: without memory it is given
  /// later, since the connection waits for it without a limit of time.
  struct Answer {
    Answer(std::weak_ptr<Connection> asking, std::weak_ptr<Listener> of)
        : connection(std::move(asking)), server(std::move(of)) {}
    void give(const std::shared_ptr<Answer>& self, HttpResponse&& given) {
      const std::shared_ptr<Listener> there = server.lock();
      if (!there || is_given.exchange(true)) return;
      response = std::move(given);
      for (;;) {
        try {
          return asio::post(there->io, [self] {
            const std::shared_ptr<Connection> there_still = self->connection.lock();
            if (there_still) there_still->guarded([&] { there_still->respond(std::move(self->response)); });
          });
        } catch (const std::bad_alloc&) {
          std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
      }
    }
    std::weak_ptr<Connection> connection;
    std::weak_ptr<Listener> server;
    std::atomic<bool> is_given{false};
    HttpResponse response = {};
  };
  /// Without memory, say, one client loses its connection, and no other.
  template <class Step>
  void guarded(const Step& step) {
    try {
      step();
    } catch (const std::exception&) {
      close();
    }
  }
  static constexpr std::size_t first_bytes = 4096;
  [[nodiscard]] double header_s() const;
  void read_rest_of_header();
  void header_read(error_code error);
  [[nodiscard]] std::variant<std::uint64_t, HttpResponse> admit() const;
  [[nodiscard]] bool is_known() const { return server_.handlers.knows && server_.handlers.knows(request_); }
  void body_read(error_code error);
  void respond_and_close(HttpResponse response);
  void respond(HttpResponse response);
  std::string head_of(int status, const std::string& type) const;
  /// Closed at once, what the client still sends would take the response from it.
  void linger();
  void discard();
  void begin_events();
  /// A client says nothing more: its end is all that can come.
  void read_nothing();
  void beat();
  void write_event();
  void free_large_body();
  void leave();

  beast::tcp_stream stream_;
  Listener& server_;
  std::string client_;
  Places::Place place_;
  beast::flat_buffer buffer_{std::size_t{1} << 16};
  std::optional<http::request_parser<http::string_body>> parser_;
  HttpRequest request_;
  HttpResponse response_;
  std::string head_;
  bool keep_ = false, large_ = false;
  std::array<char, 4096> waste_ = {};
  std::deque<std::shared_ptr<const std::string>> queue_;  ///< of a stream; the first is being written
  std::size_t queued_bytes_ = 0;
  asio::steady_timer heart_{server_.io}, limit_{server_.io};
};

/// One more than there may be: answered with 503, and kept for a second, in which all is read that comes. Closed with
/// bytes that nobody read, it would be reset, and the response perhaps lost.
class RejectedConnection : public std::enable_shared_from_this<RejectedConnection> {
 public:
  RejectedConnection(Tcp::socket socket, Listener& server) : stream_(std::move(socket)), server_(server) {
    ++server_.rejected;
  }
  ~RejectedConnection() { --server_.rejected; }
  RejectedConnection(const RejectedConnection&) = delete;
  RejectedConnection& operator=(const RejectedConnection&) = delete;

  void begin();

 private:
  void discard();
  beast::tcp_stream stream_;
  Listener& server_;
  std::array<char, 4096> waste_ = {};
};

}  // namespace robomill::serve
