#include "robomill/serve/http/server.hpp"

// ThreadSanitizer knows no fences; handlers run on one thread, in the order of the scheduler's mutex.
#ifdef __SANITIZE_THREAD__
#define BOOST_ASIO_DISABLE_FENCED_BLOCK
#endif

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <deque>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/serve/http/places.hpp"
#include "robomill/serve/http/target.hpp"

namespace robomill::serve {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using Tcp = asio::ip::tcp;
using boost::system::error_code;
using Seconds = std::chrono::duration<double>;

constexpr double write_s = 10.0;                                 ///< for a response, at a megabyte a second more
constexpr double bytes_per_s = 1e6;                              ///< that a client must take or give at least
constexpr double linger_s = 1.0;                                 ///< for a client to read its last response
constexpr double proof_s = 1.0;                                  ///< for a header where places are few
constexpr double heartbeat_s = 15.0;                             ///< of a stream
constexpr std::size_t most_rejected = 256;                       ///< connections, at a time
constexpr std::size_t most_queued_bytes = std::size_t{4} << 20;  ///< of a stream

auto after(double seconds) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(Seconds(seconds));
}

/// As error_response, which knows this header.
HttpResponse failure(int status, std::string_view text) {
  return {.status = status,
          .body = fmt::format("{{\"error\":{{\"text\":\"{}\",\"file\":null,\"line\":null,\"field\":null,\"value\":null,"
                              "\"unit\":null,\"rule\":null,\"hint\":null}}}}\n",
                              text)};
}

HttpResponse too_many_connections() {
  HttpResponse response = failure(503, "too many connections; try later");
  response.headers.emplace_back("Retry-After", "1");
  return response;
}

/// To a connection that is rejected.
const std::string& busy() {
  static const std::string response = [] {
    const std::string body = too_many_connections().body;
    return fmt::format(
        "HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/json\r\nContent-Length: {}\r\n"
        "Retry-After: 1\r\nConnection: close\r\n\r\n{}",
        body.size(), body);
  }();
  return response;
}

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

using Parser = http::request_parser<http::string_body>;

std::optional<HttpRequest> request_of(const Parser& parser) {
  const auto& message = parser.get();
  HttpRequest out;
  out.method = std::string(message.method_string());
  const auto target = message.target();
  if (!split_target({target.data(), target.size()}, out.path, out.query)) return std::nullopt;
  for (const auto& field : message) {
    std::string name(field.name_string());
    std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const bool first = out.headers.emplace(name, std::string(field.value())).second;
    if (!first && name == "host") return std::nullopt;  // two hosts: which one is meant?
  }
  return out;
}

}  // namespace

const std::string& HttpRequest::header(std::string_view name) const {
  static const std::string none;
  const auto found = headers.find(name);
  return found == headers.end() ? none : found->second;
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

/// A client: request, response, and again; or a stream of events. All of it on the server's thread.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  /// @param client, place  for server.places
  Connection(Tcp::socket socket, Listener& server, std::string client, Places::Place place)
      : stream_(std::move(socket)), server_(server), client_(std::move(client)), place_(place) {}

  void begin() {
    guarded([this] { read_header(); });
  }
  void read_header() {
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(server_.options.header_bytes));
    parser_->body_limit(std::numeric_limits<std::uint64_t>::max());  // until the header says what it is for
    if (buffer_.size() > 0) return read_rest_of_header();            // came with the request before
    stream_.expires_after(after(header_s()));
    stream_.async_read_some(buffer_.prepare(first_bytes),
                            [self = shared_from_this()](error_code error, std::size_t count) {
                              if (error) return self->close();
                              self->guarded([&] {
                                self->buffer_.commit(count);
                                self->read_rest_of_header();
                              });
                            });
  }
  void close() {
    error_code ignored;
    stream_.socket().shutdown(Tcp::socket::shutdown_both, ignored);
    stream_.socket().close(ignored);
    leave();
  }
  void send_event(const std::shared_ptr<const std::string>& text) {
    guarded([&] {
      queued_bytes_ += text->size();
      if (queued_bytes_ > most_queued_bytes) return close();
      queue_.push_back(text);
      if (queue_.size() == 1) write_event();
    });
  }

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
  [[nodiscard]] double header_s() const {
    return place_ == Places::Place::reserved ? proof_s : server_.options.header_s;
  }
  void read_rest_of_header() {
    stream_.expires_after(after(header_s()));
    http::async_read_header(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
      self->guarded([&] { self->header_read(error); });
    });
  }
  void header_read(error_code error) {
    if (error == http::error::header_limit || error == http::error::buffer_overflow) {
      return respond_and_close(failure(431, "the header is too long"));
    }
    if (error.category() == http::make_error_code(http::error::end_of_stream).category() &&
        error != http::error::end_of_stream && error != http::error::partial_message) {
      return respond_and_close(failure(400, "this is no HTTP/1.1 request"));
    }
    if (error) return close();
    std::optional<HttpRequest> request = request_of(*parser_);
    if (!request || parser_->get().version() < 10 || parser_->get().version() > 11) {
      return respond_and_close(failure(400, "this request cannot be understood"));
    }
    request_ = std::move(*request);
    if (place_ == Places::Place::reserved && !is_known()) return respond_and_close(too_many_connections());
    const auto admitted = admit();
    if (const auto* answer = std::get_if<HttpResponse>(&admitted)) return respond_and_close(*answer);
    const std::uint64_t most = std::get<std::uint64_t>(admitted);
    const auto length = parser_->content_length();
    if (length && *length > most) return respond_and_close(failure(413, "the body is too long"));
    large_ = most > server_.options.large_body_bytes && (!length || *length > server_.options.large_body_bytes);
    if (large_ && server_.large_bodies >= 2) {
      large_ = false;
      return respond_and_close(failure(503, "other large bodies are being read; try later"));
    }
    if (large_) ++server_.large_bodies;
    parser_->body_limit(most);
    stream_.expires_after(after(write_s + static_cast<double>(most) / bytes_per_s));
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](error_code failed, std::size_t) {
      self->guarded([&] { self->body_read(failed); });
    });
  }
  [[nodiscard]] std::variant<std::uint64_t, HttpResponse> admit() const {
    try {
      return server_.handlers.admit(request_);
    } catch (const std::exception&) {
      return failure(500, "an error in the server");
    }
  }
  [[nodiscard]] bool is_known() const { return server_.handlers.knows && server_.handlers.knows(request_); }
  void body_read(error_code error) {
    if (error == http::error::body_limit) return respond_and_close(failure(413, "the body is too long"));
    if (error) return close();
    keep_ = parser_->get().keep_alive();
    request_.body = std::move(parser_->get().body());
    parser_.reset();
    stream_.expires_never();
    const Reply reply = [answer = std::make_shared<Answer>(weak_from_this(), server_.weak_from_this())](
                            HttpResponse response) { answer->give(answer, std::move(response)); };
    try {
      server_.handlers.handle(std::move(request_), reply);
    } catch (const std::exception&) {
      reply(failure(500, "an error in the server"));
    }
    request_ = {};
  }
  void respond_and_close(HttpResponse response) {
    keep_ = false;
    respond(std::move(response));
  }
  void respond(HttpResponse response) {
    free_large_body();
    response_ = std::move(response);
    if (response_.events) return begin_events();
    const std::string_view body = response_.lasting.empty() ? std::string_view(response_.body) : response_.lasting;
    std::string head = head_of(response_.status, response_.type);
    head += fmt::format("Content-Length: {}\r\nConnection: {}\r\n\r\n", body.size(), keep_ ? "keep-alive" : "close");
    head_ = std::move(head);
    stream_.expires_after(after(write_s + static_cast<double>(body.size()) / bytes_per_s));
    const std::array<asio::const_buffer, 2> parts = {asio::buffer(head_), asio::buffer(body.data(), body.size())};
    asio::async_write(stream_, parts, [self = shared_from_this()](error_code error, std::size_t) {
      self->response_ = {};
      if (error) return self->close();
      self->guarded([&] { self->keep_ ? self->read_header() : self->linger(); });
    });
  }
  std::string head_of(int status, const std::string& type) const {
    const auto reason = http::obsolete_reason(static_cast<http::status>(status));
    std::string head = fmt::format("HTTP/1.1 {} {}\r\nContent-Type: {}\r\n", status,
                                   std::string_view(reason.data(), reason.size()), type);
    for (const auto& [name, value] : server_.options.headers) head += fmt::format("{}: {}\r\n", name, value);
    for (const auto& [name, value] : response_.headers) head += fmt::format("{}: {}\r\n", name, value);
    return head;
  }
  /// Closed at once, what the client still sends would take the response from it.
  void linger() {
    error_code ignored;
    stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
    stream_.expires_after(after(linger_s));
    discard();
  }
  void discard() {
    stream_.async_read_some(asio::buffer(waste_), [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->close();
      self->guarded([&] { self->discard(); });
    });
  }
  void begin_events() {
    if (server_.streams.size() >= server_.options.streams) {
      return respond_and_close(failure(503, "too many streams of events; try later"));
    }
    send_event(std::make_shared<const std::string>(head_of(200, "text/event-stream") +
                                                   "Connection: close\r\n\r\nretry: 1000\n\n"));
    if (!stream_.socket().is_open()) return;
    server_.streams.insert(shared_from_this());
    read_nothing();
    beat();
  }
  /// A client says nothing more: its end is all that can come.
  void read_nothing() {
    stream_.socket().async_read_some(asio::buffer(waste_), [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->close();
      self->guarded([&] { self->read_nothing(); });
    });
  }
  void beat() {
    heart_.expires_after(after(heartbeat_s));
    heart_.async_wait([self = weak_from_this()](error_code error) {
      const std::shared_ptr<Connection> connection = self.lock();
      if (error || !connection || !connection->stream_.socket().is_open()) return;
      connection->guarded([&] {
        static const auto pulse = std::make_shared<const std::string>(":\n\n");
        connection->send_event(pulse);
        connection->beat();
      });
    });
  }
  void write_event() {
    limit_.expires_after(after(write_s));
    limit_.async_wait([self = weak_from_this()](error_code error) {
      if (const std::shared_ptr<Connection> connection = self.lock(); connection && !error) connection->close();
    });
    asio::async_write(stream_.socket(), asio::buffer(*queue_.front()),
                      [self = shared_from_this()](error_code error, std::size_t) {
                        self->limit_.cancel();
                        if (error) return self->close();
                        self->queued_bytes_ -= self->queue_.front()->size();
                        self->queue_.pop_front();
                        if (!self->queue_.empty()) self->guarded([&] { self->write_event(); });
                      });
  }
  void free_large_body() {
    if (large_) --server_.large_bodies;
    large_ = false;
  }
  void leave() {
    free_large_body();
    heart_.cancel();
    limit_.cancel();
    server_.streams.erase(shared_from_this());
    if (server_.connections.erase(shared_from_this()) == 0) return;
    --server_.open;
    server_.places.leave(client_, place_);
  }

  beast::tcp_stream stream_;
  Listener& server_;
  std::string client_;
  Places::Place place_;
  beast::flat_buffer buffer_{std::size_t{1} << 16};
  std::optional<Parser> parser_;
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

  void begin() {
    stream_.expires_after(after(linger_s));
    asio::async_write(stream_, asio::buffer(busy()), [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return;
      error_code ignored;
      self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
      self->discard();
    });
  }

 private:
  void discard() {
    stream_.async_read_some(asio::buffer(waste_), [self = shared_from_this()](error_code error, std::size_t) {
      if (!error) self->discard();
    });
  }
  beast::tcp_stream stream_;
  Listener& server_;
  std::array<char, 4096> waste_ = {};
};

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
