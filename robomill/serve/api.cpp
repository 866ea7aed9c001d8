#include "robomill/serve/api.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <array>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/toml_edit.hpp"
#include "robomill/io/toml_values.hpp"
#include "robomill/serve/documents.hpp"
#include "robomill/serve/error_json.hpp"
#include "robomill/serve/files/inspect.hpp"
#include "robomill/serve/job_runner.hpp"
#include "robomill/serve/latest.hpp"
#include "robomill/serve/live_lobes.hpp"
#include "robomill/serve/monitor_sessions.hpp"
#include "robomill/serve/tap_session.hpp"
#include "robomill/serve/worker.hpp"
#include "robomill/version.hpp"

namespace robomill::serve {
namespace {

constexpr std::uint64_t small_body = std::uint64_t{1} << 20;
constexpr std::uint64_t text_body = std::uint64_t{8} << 20;
constexpr std::uint64_t file_body = std::uint64_t{32} << 20;

struct Route {
  std::string_view method, path;  ///< "/api/jobs/" takes a number behind it, and perhaps a word
  std::uint64_t most_body;
};
constexpr std::array<Route, 19> routes = {{{"GET", "/api/state", 0},
                                           {"GET", "/api/file", 0},
                                           {"PUT", "/api/file", file_body},
                                           {"POST", "/api/check", text_body},
                                           {"POST", "/api/edit", text_body},
                                           {"POST", "/api/inspect", small_body},
                                           {"GET", "/api/jobs", 0},
                                           {"POST", "/api/jobs", small_body},
                                           {"GET", "/api/jobs/", 0},
                                           {"DELETE", "/api/jobs/", 0},
                                           {"POST", "/api/lobes", small_body},
                                           {"GET", "/api/tap", 0},
                                           {"POST", "/api/tap", small_body},
                                           {"DELETE", "/api/tap", 0},
                                           {"GET", "/api/monitors", 0},
                                           {"POST", "/api/monitors", small_body},
                                           {"GET", "/api/monitors/", 0},
                                           {"DELETE", "/api/monitors/", 0},
                                           {"GET", "/api/events", 0}}};

bool fits(const Route& route, std::string_view path) {
  return route.path.ends_with('/') ? path.starts_with(route.path) && path.size() > route.path.size()
                                   : path == route.path;
}

/// "/api/jobs/12/report" as 12 and "report".
struct JobPath {
  int id = 0;  ///< 0: none
  std::string_view word = {};
};
JobPath job_path(std::string_view path) {
  path.remove_prefix(std::string_view("/api/jobs/").size());
  const std::string_view number = path.substr(0, path.find('/'));
  JobPath out;
  const std::from_chars_result read = std::from_chars(number.data(), number.data() + number.size(), out.id);
  if (read.ec != std::errc() || read.ptr != number.data() + number.size() || out.id < 1) return {};
  if (number.size() < path.size()) out.word = path.substr(number.size() + 1);
  return out;
}

io::Json file_object(const FolderFile& file) {
  const std::time_t time = file.modified_s;
  return {{"path", file.path},
          {"kind", file.kind},
          {"bytes", file.bytes},
          {"modified", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(time))}};
}

io::Json fields_of(const std::string& text, const std::string& name) {
  io::Json out = io::Json::array();
  for (const io::TomlValue& value : io::toml_values(text, name)) {
    out.push_back({{"key", value.key},
                   {"value", value.value},
                   {"line", value.line},
                   {"comment", value.comment.empty() ? io::Json(nullptr) : io::Json(value.comment)}});
  }
  return out;
}

/// A JSON value as TOML writes it.
std::string toml_literal(const io::Json& value) {
  if (value.is_string()) return io::toml_quoted(value.get<std::string>());
  if (!value.is_array()) {
    if (value.is_object() || value.is_null()) {
      throw InvalidInput("value", "must be a number, a text, true or false, or a list of them");
    }
    return value.dump();
  }
  std::string out;
  for (const io::Json& entry : value) out += (out.empty() ? "" : ", ") + toml_literal(entry);
  return "[" + out + "]";
}

}  // namespace

struct Api::Parts {
  Parts(const Folder& served, OpenStream open_stream, Publish publisher)
      : folder(served),
        publish(std::move(publisher)),
        jobs(folder.root(), [this](const std::string& job) { publish("job", job); }),
        monitors(folder, std::move(open_stream), publish) {}

  [[nodiscard]] std::filesystem::path path_of(const io::Json& body, const char* key) const {
    return folder.resolve(body.at(key).get<std::string>());
  }
  [[nodiscard]] HttpResponse state();
  [[nodiscard]] HttpResponse get_file(const HttpRequest& request) const;
  [[nodiscard]] HttpResponse put_file(const HttpRequest& request);
  [[nodiscard]] HttpResponse check(const io::Json& body) const;
  [[nodiscard]] HttpResponse start_job(const io::Json& body);
  [[nodiscard]] HttpResponse about_job(const HttpRequest& request);
  [[nodiscard]] HttpResponse start_tap(const io::Json& body);
  [[nodiscard]] HttpResponse about_tap(const HttpRequest& request);
  [[nodiscard]] HttpResponse answer(const HttpRequest& request);
  void answer_lobes(const HttpRequest& request, const Reply& reply);
  void watch(const std::stop_token& stop);

  std::mutex listing;  ///< of the folder's list, which remembers
  Folder folder;
  Publish publish;
  JobRunner jobs;
  std::unique_ptr<TapSession> tap;  ///< of the worker alone
  MonitorSessions monitors;         ///< of the worker alone
  LiveLobes lobes;                  ///< of latest's thread alone
  Latest latest;
  Worker files{64};
  std::mutex waiting;
  std::condition_variable_any ended;
  std::jthread watcher{[this](const std::stop_token& stop) { watch(stop); }};
};

HttpResponse Api::Parts::state() {
  io::Json list = io::Json::array();
  std::size_t left_out = 0;
  {
    const std::lock_guard lock(listing);
    for (const FolderFile& file : folder.list(left_out)) list.push_back(file_object(file));
  }
  return json_response({{"version", ROBOMILL_VERSION},
                        {"folder", folder.root().filename().string()},
                        {"files", std::move(list)},
                        {"files_left_out", left_out},
                        {"jobs", jobs.list()}});
}

HttpResponse Api::Parts::get_file(const HttpRequest& request) const {
  const auto path = request.query.find("path");
  if (path == request.query.end()) return error_response(400, "path is missing");
  std::string text = Folder::read(folder.resolve(path->second));
  const std::string tag = Folder::tag_of(text);
  return {.type = "text/plain; charset=utf-8", .body = std::move(text), .headers = {{"ETag", tag}}};
}

/// Only what the client has seen is replaced.
HttpResponse Api::Parts::put_file(const HttpRequest& request) {
  const auto named = request.query.find("path");
  if (named == request.query.end()) return error_response(400, "path is missing");
  const std::filesystem::path path = folder.resolve(named->second);
  const bool there = std::filesystem::exists(path);
  const std::string& seen = request.header("if-match");
  if (seen.empty() && request.header("if-none-match") != "*") {
    return error_response(400,
                          "If-Match with the version that was edited, or If-None-Match: * for a new file, is missing");
  }
  if (seen.empty() ? there : !there || Folder::tag_of(Folder::read(path)) != seen) {
    return error_response(409, there ? "the file is there already, or was changed by somebody else; load it again"
                                     : "the file is gone; save it as a new one");
  }
  Folder::write(path, request.body);
  publish("files", "{}");
  return json_response({{"etag", Folder::tag_of(request.body)}});
}

HttpResponse Api::Parts::check(const io::Json& body) const {
  const std::filesystem::path path = path_of(body, "path");
  const std::string text = body.at("text");
  const std::string kind = kind_of_toml(text);
  std::optional<InvalidInput> error;
  io::Json fields = io::Json::array();
  try {
    fields = fields_of(text, path.string());
    error = check_document(kind, path, text);
  } catch (const InvalidInput& found) {
    error = found;
  }
  return json_response({{"kind", kind},
                        {"error", error ? error_object(*error, folder.root()) : io::Json(nullptr)},
                        {"fields", std::move(fields)}});
}

HttpResponse Api::Parts::start_job(const io::Json& body) {
  JobRequest request = {
      .verb = body.value("verb", "plan"), .input = body.at("input"), .output = body.value("output", "")};
  static_cast<void>(folder.resolve(request.input));
  if (!request.output.empty()) static_cast<void>(folder.resolve(request.output));
  const std::optional<int> id = jobs.submit(request);
  if (!id) return error_response(429, "too many jobs wait; try later");
  return json_response({{"id", *id}});
}

HttpResponse Api::Parts::about_job(const HttpRequest& request) {
  const JobPath path = job_path(request.path);
  const io::Json job = jobs.job(path.id);
  if (job.is_null()) return error_response(404, "there is no such job, or it was forgotten");
  if (request.method == "DELETE") {
    jobs.cancel(path.id);
    return json_response(jobs.job(path.id));
  }
  if (path.word.empty()) return json_response(job);
  std::string report = path.word == "report" ? jobs.report(path.id) : std::string();
  if (report.empty()) return error_response(404, "there is no such report, or it was forgotten; see the job's files");
  return {.body = std::move(report)};
}

HttpResponse Api::Parts::start_tap(const io::Json& body) {
  const std::string name = body.at("hits");
  const std::string watched = body.value("watch", "");
  const std::filesystem::path hits = folder.resolve(name);
  tap.reset();
  tap = std::make_unique<TapSession>(
      TapSession::Options{.hits = hits,
                          .text = Folder::read(hits),
                          .name = name,
                          .watch = watched.empty() ? hits.parent_path() : folder.resolve(watched),
                          .wanted = body.value("wanted", 0)},
      [this](const std::string& state) { publish("tap", state); });
  return {.body = "{\"state\":" + tap->state() + "}\n"};
}

HttpResponse Api::Parts::about_tap(const HttpRequest& request) {
  if (request.method == "DELETE") {
    tap.reset();
    publish("tap", "null");
  }
  return {.body = (tap ? tap->state() : "null") + "\n"};
}

HttpResponse Api::Parts::answer(const HttpRequest& request) {
  const std::string& path = request.path;
  if (path == "/api/state") return state();
  if (path == "/api/file") return request.method == "GET" ? get_file(request) : put_file(request);
  if (path.starts_with("/api/jobs/")) return about_job(request);
  if (path == "/api/jobs" && request.method == "GET") return json_response(jobs.list());
  if (path == "/api/tap" && request.method != "POST") return about_tap(request);
  if (path.starts_with("/api/monitors")) return monitors.answer(request);
  const io::Json body = io::Json::parse(request.body);
  if (path == "/api/tap") return start_tap(body);
  if (path == "/api/inspect") return json_response(inspect(path_of(body, "path")));
  if (path == "/api/check") return check(body);
  if (path == "/api/jobs") return start_job(body);
  if (path == "/api/edit") {
    const std::string text = body.at("text");
    return json_response(
        {{"text", io::with_setting(text, {.key = body.at("key"), .value = toml_literal(body.at("value"))})}});
  }
  return error_response(404, "there is no such address");
}

/// As soon as it is the newest of its channel that waits.
void Api::Parts::answer_lobes(const HttpRequest& request, const Reply& reply) {
  LiveLobesRequest asked = read_live_lobes_request(request.body);
  asked.file = folder.resolve(asked.file.string());
  const auto answered = [this, reply](const Latest::Outcome& outcome) {
    using Kind = Latest::Outcome::Kind;
    reply(answer_of(folder.root(), [&]() -> HttpResponse {
      if (outcome.kind == Kind::answered) return {.body = outcome.answer};
      if (outcome.kind == Kind::full) return error_response(503, "too many requests wait; try later");
      if (outcome.kind == Kind::failed) std::rethrow_exception(outcome.error);
      return json_response({{"superseded", true}}, 409);
    }));
  };
  latest.submit({.client = asked.client,
                 .channel = asked.channel,
                 .sequence = asked.sequence,
                 .compute = [this, asked](Progress& progress) { return lobes.answer(asked, progress); },
                 .done = answered});
}

/// Says when files come, go or change.
void Api::Parts::watch(const std::stop_token& stop) {
  constexpr std::chrono::seconds pause(1);
  std::vector<FolderFile> last;
  for (bool first = true; !stop.stop_requested(); first = false) {
    std::vector<FolderFile> now;
    {
      const std::lock_guard lock(listing);
      std::size_t left_out = 0;
      now = folder.list(left_out);
    }
    if (!first && now != last) publish("files", "{}");
    last = std::move(now);
    std::unique_lock lock(waiting);
    ended.wait_for(lock, stop, pause, [] { return false; });
  }
}

Api::Api(const Folder& folder, OpenStream open_stream, Publish publish)
    : parts_(std::make_unique<Parts>(folder, std::move(open_stream), std::move(publish))) {}

Api::~Api() = default;

std::variant<std::uint64_t, HttpResponse> Api::admit(const HttpRequest& request) const {
  bool known = false;
  for (const Route& route : routes) {
    if (!fits(route, request.path)) continue;
    if (route.method == request.method) return route.most_body;
    known = true;
  }
  return known ? error_response(405, "this address has no such method")
               : error_response(404, "there is no such address");
}

void Api::handle(HttpRequest request, const Reply& reply) {
  if (request.path == "/api/events") return reply({.events = true});
  if (request.path == "/api/lobes") {
    const HttpResponse failed = answer_of(parts_->folder.root(), [&]() -> HttpResponse {
      parts_->answer_lobes(request, reply);
      return {.status = 0};  // replies by itself
    });
    if (failed.status != 0) reply(failed);
    return;
  }
  auto work = [this, request = std::move(request), reply] {
    reply(answer_of(parts_->folder.root(), [&] { return parts_->answer(request); }));
  };
  if (!parts_->files.post(std::move(work))) reply(error_response(503, "too many requests wait; try later"));
}

}  // namespace robomill::serve
