#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "robomill/base/export.hpp"
#include "robomill/serve/http/server.hpp"

// Method: robomill/serve/README.md, "Who may ask"

namespace robomill::serve {

/// Decides from a request's header whether it comes from the page of this server.
class Guard {
 public:
  /// @param host   address of the server
  /// @param token  that others than loopback need; empty: none
  Guard(std::string host, std::string token);
  void set_port(int port) { port_ = port; }

  /// What the page writes with: random, new with each server.
  [[nodiscard]] const std::string& write_token() const { return write_token_; }
  /// The answer where the request is rejected: a foreign Host (a name that was made to point here), another origin, a
  /// write without the page's token, no or a wrong access token.
  [[nodiscard]] std::optional<HttpResponse> reject(const HttpRequest& request) const;
  /// Whether a request proves that it comes from who may ask, whatever it asks: by the access token, or where there is
  /// none by the page's.
  [[nodiscard]] bool knows(const HttpRequest& request) const;
  /// The header that makes a browser remember the access token, where the page was asked for with it in its address.
  [[nodiscard]] std::optional<std::string> cookie_for(const HttpRequest& request) const;

 private:
  /// "robomill-8437=": cookies are of a host, not of a port, and another server may run there.
  [[nodiscard]] std::string cookie_name() const;
  [[nodiscard]] bool has_access(const HttpRequest& request) const;
  std::string host_, token_, write_token_;
  int port_ = 0;
};

/// Whether a request's header Host names this server, and not a name that was made to point here (DNS rebinding). One
/// that other machines reach is asked for by any name.
/// @param given      the header
/// @param listening  address of the server
[[nodiscard]] ROBOMILL_API bool is_own_host(std::string_view given, const std::string& listening, int port);

/// The address that a server listens at: 127.0.0.1 of "localhost", otherwise as it is.
[[nodiscard]] ROBOMILL_API std::string host_address(const std::string& host);

/// Whether an address reaches this machine alone: 127.0.0.0/8 or ::1.
[[nodiscard]] ROBOMILL_API bool is_loopback(const std::string& host);

/// Takes as long whatever the texts have in common.
[[nodiscard]] bool equal_secrets(std::string_view given, std::string_view secret);

}  // namespace robomill::serve
