#include "robomill/serve/guard.hpp"

#include <fmt/format.h>

#include <random>
#include <utility>

#include "robomill/serve/error_json.hpp"

namespace robomill::serve {
namespace {

std::string random_text() {
  std::random_device device;  // of the system, not seeded: nobody may guess it
  std::string out;
  for (int i = 0; i < 8; ++i) out += fmt::format("{:08x}", device());
  return out;
}

/// The value of the cookie whose name and "=" are given, among others; empty where it is not there.
std::string_view cookie_value(std::string_view cookies, std::string_view name) {
  while (!cookies.empty()) {
    const std::size_t end = cookies.find(';');
    std::string_view cookie = cookies.substr(0, end);
    while (cookie.starts_with(' ')) cookie.remove_prefix(1);
    if (cookie.starts_with(name)) return cookie.substr(name.size());
    cookies.remove_prefix(end == std::string_view::npos ? cookies.size() : end + 1);
  }
  return {};
}

}  // namespace

std::string host_address(const std::string& host) {
  return host == "localhost" ? "127.0.0.1" : host;
}

bool is_own_host(std::string_view given, const std::string& listening, int port) {
  if (!is_loopback(listening)) return !given.empty();
  for (const std::string& name :
       {listening, std::string("127.0.0.1"), std::string("localhost"), std::string("[::1]")}) {
    if (given == fmt::format("{}:{}", name, port)) return true;
    if (port == 80 && given == name) return true;
  }
  return false;
}

bool is_loopback(const std::string& host) {
  return host.starts_with("127.") || host == "::1";
}

bool equal_secrets(std::string_view given, std::string_view secret) {
  unsigned different = given.size() == secret.size() ? 0U : 1U;
  for (std::size_t i = 0; i < secret.size(); ++i) {
    const char other = i < given.size() ? given[i] : '\0';
    different |= static_cast<unsigned char>(other) ^ static_cast<unsigned char>(secret[i]);
  }
  return different == 0;
}

Guard::Guard(std::string host, std::string token)
    : host_(std::move(host)), token_(std::move(token)), write_token_(random_text()) {}

std::string Guard::cookie_name() const {
  return fmt::format("robomill-{}=", port_);
}

bool Guard::has_access(const HttpRequest& request) const {
  if (token_.empty()) return true;
  constexpr std::string_view bearer = "Bearer ";
  const std::string& authorization = request.header("authorization");
  if (authorization.starts_with(bearer)) {
    return equal_secrets(std::string_view(authorization).substr(bearer.size()), token_);
  }
  return equal_secrets(cookie_value(request.header("cookie"), cookie_name()), token_) ||
         cookie_for(request).has_value();
}

bool Guard::knows(const HttpRequest& request) const {
  if (!is_own_host(request.header("host"), host_, port_)) return false;
  if (!token_.empty()) return has_access(request);
  return equal_secrets(request.header("x-robomill-token"), write_token_);
}

std::optional<std::string> Guard::cookie_for(const HttpRequest& request) const {
  const auto given = request.query.find("token");
  if (token_.empty() || request.path != "/" || given == request.query.end()) return std::nullopt;
  if (!equal_secrets(given->second, token_)) return std::nullopt;
  return fmt::format("{}{}; HttpOnly; SameSite=Strict; Path=/", cookie_name(), token_);
}

std::optional<HttpResponse> Guard::reject(const HttpRequest& request) const {
  const std::string& host = request.header("host");
  // One that others reach is protected by its access token.
  if (!is_own_host(host, host_, port_)) return error_response(403, "this is not the host that is asked for");
  const std::string& origin = request.header("origin");
  if (!origin.empty() && origin != "http://" + host) return error_response(403, "another site must not ask");
  const std::string& site = request.header("sec-fetch-site");
  const bool opens_page = request.method == "GET" && request.path == "/";
  if (!site.empty() && site != "same-origin" && site != "none" && !opens_page) {
    return error_response(403, "another site must not ask");
  }
  if (!has_access(request)) return error_response(401, "the access token is missing or wrong");
  if (request.method == "GET") return std::nullopt;
  if (!equal_secrets(request.header("x-robomill-token"), write_token_)) {
    return error_response(403, "the page's token is missing or of an earlier server; load the page again");
  }
  return std::nullopt;
}

}  // namespace robomill::serve
