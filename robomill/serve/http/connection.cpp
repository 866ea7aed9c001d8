#include "robomill/serve/http/connection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/write.hpp>
#include <cctype>
#include <limits>
#include <string_view>

#include "robomill/serve/http/target.hpp"

namespace robomill::serve {
namespace {

constexpr double write_s = 10.0;                                 ///< for a response, at a megabyte a second more
constexpr double bytes_per_s = 1e6;                              ///< that a client must take or give at least
constexpr double linger_s = 1.0;                                 ///< for a client to read its last response
constexpr double proof_s = 1.0;                                  ///< for a header where places are few
constexpr double heartbeat_s = 15.0;                             ///< of a stream
constexpr std::size_t most_queued_bytes = std::size_t{4} << 20;  ///< of a stream

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

void Connection::begin() {
  guarded([this] { read_header(); });
}

void Connection::read_header() {
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

void Connection::close() {
  error_code ignored;
  stream_.socket().shutdown(Tcp::socket::shutdown_both, ignored);
  stream_.socket().close(ignored);
  leave();
}

void Connection::send_event(const std::shared_ptr<const std::string>& text) {
  guarded([&] {
    queued_bytes_ += text->size();
    if (queued_bytes_ > most_queued_bytes) return close();
    queue_.push_back(text);
    if (queue_.size() == 1) write_event();
  });
}

double Connection::header_s() const {
  return place_ == Places::Place::reserved ? proof_s : server_.options.header_s;
}

void Connection::read_rest_of_header() {
  stream_.expires_after(after(header_s()));
  http::async_read_header(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
    self->guarded([&] { self->header_read(error); });
  });
}

void Connection::header_read(error_code error) {
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

std::variant<std::uint64_t, HttpResponse> Connection::admit() const {
  try {
    return server_.handlers.admit(request_);
  } catch (const std::exception&) {
    return failure(500, "an error in the server");
  }
}

void Connection::body_read(error_code error) {
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

void Connection::respond_and_close(HttpResponse response) {
  keep_ = false;
  respond(std::move(response));
}

void Connection::respond(HttpResponse response) {
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

std::string Connection::head_of(int status, const std::string& type) const {
  const auto reason = http::obsolete_reason(static_cast<http::status>(status));
  std::string head = fmt::format("HTTP/1.1 {} {}\r\nContent-Type: {}\r\n", status,
                                 std::string_view(reason.data(), reason.size()), type);
  for (const auto& [name, value] : server_.options.headers) head += fmt::format("{}: {}\r\n", name, value);
  for (const auto& [name, value] : response_.headers) head += fmt::format("{}: {}\r\n", name, value);
  return head;
}

void Connection::linger() {
  error_code ignored;
  stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
  stream_.expires_after(after(linger_s));
  discard();
}

void Connection::discard() {
  stream_.async_read_some(asio::buffer(waste_), [self = shared_from_this()](error_code error, std::size_t) {
    if (error) return self->close();
    self->guarded([&] { self->discard(); });
  });
}

void Connection::begin_events() {
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

void Connection::read_nothing() {
  stream_.socket().async_read_some(asio::buffer(waste_), [self = shared_from_this()](error_code error, std::size_t) {
    if (error) return self->close();
    self->guarded([&] { self->read_nothing(); });
  });
}

void Connection::beat() {
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

void Connection::write_event() {
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

void Connection::free_large_body() {
  if (large_) --server_.large_bodies;
  large_ = false;
}

void Connection::leave() {
  free_large_body();
  heart_.cancel();
  limit_.cancel();
  server_.streams.erase(shared_from_this());
  if (server_.connections.erase(shared_from_this()) == 0) return;
  --server_.open;
  server_.places.leave(client_, place_);
}

void RejectedConnection::begin() {
  stream_.expires_after(after(linger_s));
  asio::async_write(stream_, asio::buffer(busy()), [self = shared_from_this()](error_code error, std::size_t) {
    if (error) return;
    error_code ignored;
    self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
    self->discard();
  });
}

void RejectedConnection::discard() {
  stream_.async_read_some(asio::buffer(waste_), [self = shared_from_this()](error_code error, std::size_t) {
    if (!error) self->discard();
  });
}

}  // namespace robomill::serve
