#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

// Method: robomill/serve/README.md, "HTTP"

namespace robomill::serve {

struct HttpRequest {
  std::string method;                                       ///< "GET"
  std::string path;                                         ///< without the query, decoded: "/api/file"
  std::map<std::string, std::string, std::less<>> query;    ///< decoded
  std::map<std::string, std::string, std::less<>> headers;  ///< names in lower case; the first of each
  std::string body = {};                                    ///< empty until it was admitted and read

  /// Empty where there is none.
  [[nodiscard]] const std::string& header(std::string_view name) const;
};

struct HttpResponse {
  int status = 200;
  std::string type = "application/json";
  std::string body = {};
  std::string_view lasting = {};                                  ///< in place of body: outlives the server
  std::vector<std::pair<std::string, std::string>> headers = {};  ///< beside those that every response has
  bool events = false;                                            ///< in place of a body: a stream of events
};

/// May be called from any thread, once.
using Reply = std::function<void(HttpResponse)>;

struct Listener;

/// HTTP/1.1 on one address, by one thread of its own. Everything that a client can make grow is bounded.
class HttpServer {
 public:
  struct Options {
    std::string host = "127.0.0.1";  ///< an address, not a name
    int port = 0;                    ///< 0: any that is free
    /// At a time, event streams included; the rest is answered with 503. Of one address three quarters; the last eighth
    /// is for clients that are known.
    std::size_t connections = 128;
    std::size_t streams = 32;                ///< of events, at a time
    double header_s = 5.0;                   ///< from a header's first byte to its end, and before that without a byte
    std::size_t header_bytes = 16384;        ///< longest header, longest target
    std::size_t large_body_bytes = 1 << 20;  ///< bodies that may be longer are read two at a time
    std::vector<std::pair<std::string, std::string>> headers = {};  ///< of every response
  };
  struct Handlers {
    /// After the header: how long the body may be [bytes], or the answer at once.
    std::function<std::variant<std::uint64_t, HttpResponse>(const HttpRequest&)> admit;
    /// After the body. On the server's thread: what takes longer than a millisecond goes elsewhere and replies later.
    std::function<void(HttpRequest, Reply)> handle;
    /// After the header of one that came where places are few: whether its client may ask. None: nobody is known.
    std::function<bool(const HttpRequest&)> knows = {};
  };

  /// Listens. @throws InvalidInput if it cannot there
  explicit HttpServer(Options options);
  /// Closes every connection.
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] int port() const;
  /// Once: answers from now on. Until then clients wait.
  void start(Handlers handlers);
  /// An event to every stream, from any thread. A client that does not read loses its stream.
  /// @param data  without line ends
  void publish(std::string_view event, std::string_view data);
  /// Connections that are open, streams among them; for tests.
  [[nodiscard]] std::size_t open_connections() const;

 private:
  std::shared_ptr<Listener> listener_;
};

}  // namespace robomill::serve
