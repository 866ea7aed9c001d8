#include "robomill/serve/serve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/system/confinement.hpp"
#include "robomill/io/system/sandbox.hpp"
#include "robomill/page/app_page.hpp"
#include "robomill/serve/api.hpp"
#include "robomill/serve/error_json.hpp"
#include "robomill/serve/guard.hpp"
#include "robomill/serve/process/own_library.hpp"
#include "robomill/serve/process/worker_process.hpp"

namespace robomill::serve {
namespace {

constexpr std::size_t least_token = 16;

/// Of every response: nothing from elsewhere runs, is shown, or shows this in a frame.
const std::vector<std::pair<std::string, std::string>> safe_headers = {
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
     "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cache-Control", "no-store"}};

/// The page's own files; none for another path.
std::optional<HttpResponse> page_file(const std::string& path) {
  const page::AppFiles files = page::app_files();
  const auto file = [](const char* type, std::string_view content) {
    return HttpResponse{.status = content.empty() ? 404 : 200, .type = type, .lasting = content};
  };
  if (path == "/page.js") return file("text/javascript; charset=utf-8", files.script);
  if (path == "/page-path.js") return file("text/javascript; charset=utf-8", files.path_script);
  if (path == "/page.css") return file("text/css; charset=utf-8", files.style);
  if (path == "/favicon.ico") return HttpResponse{.status = 204, .type = "image/x-icon"};
  return std::nullopt;
}

WorkerOptions worker_of(const ServeOptions& options, const Folder& folder) {
  return {.command = options.worker,
          .library = own_library(),
          .root = folder.root(),
          .memory_bytes = options.memory_bytes > 0 ? options.memory_bytes : io::machine_memory_bytes() / 2};
}

}  // namespace

void ServeOptions::validate() const {
  if (port < 0 || port > 65535) throw InvalidInput("port", port, "", "must lie between 0 and 65535");
  const bool plain = std::ranges::all_of(token, [](char letter) {
    return std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '-' || letter == '_';
  });
  if (!token.empty() && (token.size() < least_token || !plain)) {
    throw InvalidInput("token", fmt::format("must be {} or more letters, digits, - or _", least_token));
  }
  if (!is_loopback(host_address(host)) && token.empty()) {
    throw InvalidInput("host", fmt::format("{} can be reached from other machines and needs a token", host),
                       "Give --token TEXT, or leave --host out");
  }
}

struct Server::Parts {
  explicit Parts(const ServeOptions& options)
      : folder(options.folder),
        confinement(folder.root()),
        host(host_address(options.host)),
        token(options.token),
        guard(host, token) {}
  /// Also where the constructor of Server fails: jobs and streams of api publish until they are gone.
  ~Parts() {
    {
      const std::lock_guard lock(publishing);
      outlet = nullptr;
    }
    http.reset();  // no request comes any more
    api.reset();
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  std::variant<std::uint64_t, HttpResponse> admit(const HttpRequest& request) const {
    if (std::optional<HttpResponse> rejected = guard.reject(request)) return *std::move(rejected);
    if (request.path.starts_with("/api/")) return api->admit(request);
    if (request.method != "GET") return error_response(405, "this address has no such method");
    return std::uint64_t{0};
  }
  void handle(HttpRequest request, const Reply& reply) {
    if (request.path.starts_with("/api/")) return api->handle(std::move(request), reply);
    if (std::optional<HttpResponse> file = page_file(request.path)) return reply(*std::move(file));
    if (request.path != "/") return reply(error_response(404, "there is no such address"));
    const std::optional<std::string> cookie = guard.cookie_for(request);
    if (!cookie) return reply({.type = "text/html; charset=utf-8", .body = page});
    // Without the token in the address, where it would stand in the browser's history.
    reply({.status = 303, .type = "text/plain", .headers = {{"Location", "/"}, {"Set-Cookie", *cookie}}});
  }

  /// Of the jobs' threads too.
  void publish(std::string_view event, std::string_view data) {
    const std::lock_guard lock(publishing);
    if (outlet != nullptr) outlet->publish(event, data);
  }

  Folder folder;
  io::Confinement confinement;
  std::string host, token, page;
  Guard guard;
  std::mutex publishing;
  HttpServer* outlet = nullptr;  ///< http while it lives
  std::unique_ptr<Api> api;
  std::unique_ptr<HttpServer> http;
};

Server::Server(const ServeOptions& options) {
  options.validate();
  parts_ = std::make_unique<Parts>(options);
  Parts& parts = *parts_;
  parts.http = std::make_unique<HttpServer>(
      HttpServer::Options{.host = parts.host, .port = options.port, .headers = safe_headers});
  parts.guard.set_port(parts.http->port());
  parts.page = page::app_html(parts.folder.root().filename().string(), parts.guard.write_token());
  parts.outlet = parts.http.get();
  parts.api =
      std::make_unique<Api>(parts.folder, options.open_stream, worker_of(options, parts.folder),
                            [&parts](std::string_view event, std::string_view data) { parts.publish(event, data); });
  parts.http->start(
      {.admit = [&parts](const HttpRequest& request) { return parts.admit(request); },
       .handle = [&parts](HttpRequest request, const Reply& reply) { parts.handle(std::move(request), reply); },
       .knows = [&parts](const HttpRequest& request) { return parts.guard.knows(request); }});
}

Server::~Server() = default;

bool restrict_to_folder(const std::filesystem::path& folder) {
  const Folder served(folder);
  // Names of hosts and certificates of brokers, libraries that are loaded late, what libraries ask of the machine.
  return io::restrict_files({.readable = {"/etc", "/usr", "/lib", "/lib64", "/run/systemd/resolve", "/run/resolvconf",
                                          "/proc", "/sys/devices/system", "/sys/fs/cgroup", "/dev/urandom"},
                             .writable = {served.root(), "/dev/null"},
                             .programs = io::loaded_files()});
}

int Server::port() const {
  return parts_->http->port();
}

std::string Server::address() const {
  const std::string host = parts_->host.find(':') == std::string::npos ? parts_->host : "[" + parts_->host + "]";
  const std::string base = fmt::format("http://{}:{}/", host, port());
  return parts_->token.empty() ? base : base + "?token=" + parts_->token;
}

}  // namespace robomill::serve
