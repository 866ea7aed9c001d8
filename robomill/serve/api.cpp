#include "robomill/serve/api.hpp"

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/io/records/records.hpp"
#include "robomill/io/toml/edit.hpp"
#include "robomill/serve/error_json.hpp"
#include "robomill/serve/files/answers.hpp"
#include "robomill/serve/files/toml_literal.hpp"
#include "robomill/serve/http/target.hpp"
#include "robomill/serve/jobs/runner.hpp"
#include "robomill/serve/latest.hpp"
#include "robomill/serve/lobes/live_lobes.hpp"
#include "robomill/serve/monitor/sessions.hpp"
#include "robomill/serve/overview/overview.hpp"
#include "robomill/serve/process/job_process.hpp"
#include "robomill/serve/process/monitor_service.hpp"
#include "robomill/serve/program/live_program.hpp"
#include "robomill/serve/tap/tap_tests.hpp"
#include "robomill/serve/worker.hpp"
#include "robomill/version.hpp"

namespace robomill::serve {
namespace {

constexpr std::uint64_t live_body = std::uint64_t{1} << 16;  // so short that the thread of all connections reads it
constexpr std::uint64_t small_body = std::uint64_t{1} << 20;
constexpr std::uint64_t text_body = std::uint64_t{2} << 20;  // a text of 1 MB with its escapes

struct Route {
  std::string_view method, path;  ///< "/api/jobs/" takes a number behind it, and perhaps a word
  std::uint64_t most_body;
};
constexpr std::array<Route, 26> routes = {{{"GET", "/api/state", 0},
                                           {"GET", "/api/file", 0},
                                           {"PUT", "/api/file", Folder::most_file_bytes},
                                           {"POST", "/api/check", text_body},
                                           {"POST", "/api/edit", text_body},
                                           {"POST", "/api/inspect", small_body},
                                           {"GET", "/api/overview", 0},
                                           {"GET", "/api/verbs", 0},
                                           {"GET", "/api/jobs", 0},
                                           {"POST", "/api/jobs", small_body},
                                           {"GET", "/api/jobs/", 0},
                                           {"DELETE", "/api/jobs/", 0},
                                           {"POST", "/api/lobes", live_body},
                                           {"POST", "/api/program", live_body},
                                           {"GET", "/api/tap", 0},
                                           {"POST", "/api/tap", small_body},
                                           {"PUT", "/api/tap", small_body},
                                           {"DELETE", "/api/tap", 0},
                                           {"POST", "/api/tap/save", small_body},
                                           {"GET", "/api/tap/", 0},
                                           {"PUT", "/api/tap/", small_body},
                                           {"GET", "/api/monitors", 0},
                                           {"POST", "/api/monitors", small_body},
                                           {"GET", "/api/monitors/", 0},
                                           {"DELETE", "/api/monitors/", 0},
                                           {"GET", "/api/events", 0}}};

bool fits(const Route& route, std::string_view path) {
  return route.path.ends_with('/') ? path.starts_with(route.path) && path.size() > route.path.size()
                                   : path == route.path;
}

/// Whether what is asked reads or writes files, or lists them. What runs can be looked at and ended without its folder.
bool is_of_folder(const HttpRequest& request) {
  const std::string& path = request.path;
  if (request.method == "GET") return path == "/api/state" || path == "/api/file" || path == "/api/overview";
  return request.method != "DELETE" && path != "/api/edit";
}

io::Json file_object(const FolderFile& file) {
  return {{"path", file.path},
          {"kind", file.what.kind},
          {"document", io::text_or_null(file.what.document)},
          {"bytes", file.bytes},
          {"modified", time_text(file.modified)}};
}

/// How jobs are run: each in a process of its own where there is a program for that.
RunJob runner_of(const Folder& folder, const WorkerOptions& worker) {
  if (worker.command.empty()) return run_here(folder.root());
  return [worker](const JobRequest& request, const Progress::Report& report, const std::atomic<bool>& stop) {
    return run_in_process(worker, request, report, stop);
  };
}

/// One that is kept; none where there is no program for it.
std::unique_ptr<WorkerProcess> kept(const WorkerOptions& worker) {
  return worker.command.empty() ? nullptr : std::make_unique<WorkerProcess>(worker);
}

std::unique_ptr<MonitorService> service_of(WorkerOptions worker, const Api::Publish& publish) {
  if (worker.command.empty()) return nullptr;
  worker.connects = true;
  return std::make_unique<MonitorService>(std::move(worker), publish);
}

}  // namespace

struct Api::Parts {
  Parts(const Folder& served, OpenStream open_stream, const WorkerOptions& worker, Publish publisher)
      : folder(served),
        publish(std::move(publisher)),
        live(kept(worker)),
        reader(kept(worker)),
        jobs(
            folder.root(), [this](const std::string& job) { publish("job", job); }, runner_of(folder, worker)),
        taps(folder, open_stream, publish),
        monitors(folder, std::move(open_stream), publish),
        monitor_service(service_of(worker, publish)) {}
  /// So that no thread waits for an answer any more.
  ~Parts() {
    if (live) live->end();
    if (reader) reader->end();
    if (monitor_service) monitor_service->end();
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  [[nodiscard]] HttpResponse state();
  [[nodiscard]] HttpResponse get_file(const HttpRequest& request) const;
  [[nodiscard]] HttpResponse put_file(const HttpRequest& request);
  [[nodiscard]] HttpResponse read_file_of(const HttpRequest& request);
  [[nodiscard]] HttpResponse overview(const HttpRequest& request);
  [[nodiscard]] static HttpResponse edit(const io::Json& body);
  [[nodiscard]] HttpResponse start_job(const io::Json& body);
  [[nodiscard]] HttpResponse about_job(const HttpRequest& request);
  [[nodiscard]] HttpResponse answer(const HttpRequest& request);
  [[nodiscard]] HttpResponse answer_monitors(const HttpRequest& request);
  [[nodiscard]] Worker& worker_of(const HttpRequest& request);
  void answer_latest(const ClientOrder& order, std::function<std::string(Progress&)> compute, const Reply& reply);
  [[nodiscard]] HttpResponse answer_live(const HttpRequest& request, const Reply& reply);
  void watch(const std::stop_token& stop);

  std::mutex listing;  ///< of the folder's list, which remembers
  Folder folder;
  Publish publish;
  std::unique_ptr<WorkerProcess> live;    ///< lobes; null: in this process
  std::unique_ptr<WorkerProcess> reader;  ///< of files that a request names; null: in this process
  PlanReader plans;                       ///< of reader_worker alone
  JobRunner jobs;
  TapTests taps;                                    ///< of tap_worker alone
  MonitorSessions monitors;                         ///< of monitor_worker alone
  std::unique_ptr<MonitorService> monitor_service;  ///< in place of them; null: in this process
  LiveLobes lobes;                                  ///< of latest's thread alone
  Latest latest;
  // Each waits for another process or device, and no other for it. The first asks nobody: state and cancelled jobs are
  // answered whatever hangs.
  Worker at_hand{64}, reader_worker{64}, monitor_worker{64}, tap_worker{64};
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
                        {"record_endings", io::record_endings()},
                        {"jobs", jobs.list()}});
}

HttpResponse Api::Parts::get_file(const HttpRequest& request) const {
  const auto path = request.query.find("path");
  if (path == request.query.end()) return error_response(400, "path is missing");
  const std::filesystem::path place = folder.resolve(path->second);
  std::error_code ignored;
  if (!std::filesystem::exists(place, ignored)) return error_response(404, "there is no such file");
  std::string text = Folder::read(place, Folder::most_file_bytes);
  const std::string tag = Folder::tag_of(text);
  if (text.size() > Folder::most_text_bytes) {
    HttpResponse too_long = error_response(413, "the file is too long to be shown; it can be replaced");
    too_long.headers.emplace_back("ETag", tag);
    return too_long;
  }
  return {.type = "text/plain; charset=utf-8", .body = std::move(text), .headers = {{"ETag", tag}}};
}

/// Only what the client has seen is replaced.
HttpResponse Api::Parts::put_file(const HttpRequest& request) {
  const auto named = request.query.find("path");
  if (named == request.query.end()) return error_response(400, "path is missing");
  const std::filesystem::path path = folder.resolve(named->second);
  std::error_code ignored;
  const bool there = std::filesystem::exists(path, ignored);
  const std::string& seen = request.header("if-match");
  if (seen.empty() && request.header("if-none-match") != "*") {
    return error_response(400,
                          "If-Match with the version that was edited, or If-None-Match: * for a new file, is missing");
  }
  if (seen.empty() ? there : !there || Folder::tag_of(Folder::read(path, Folder::most_file_bytes)) != seen) {
    return error_response(409, there ? "the file is there already, or was changed by somebody else; load it again"
                                     : "the file is gone; save it as a new one");
  }
  Folder::write(path, request.body);
  publish("files", "{}");
  return json_response({{"etag", Folder::tag_of(request.body)}});
}

/// What a file says is read where it can do no harm.
HttpResponse Api::Parts::read_file_of(const HttpRequest& request) {
  const bool checks = request.path == "/api/check";
  if (!reader) return checks ? check_text(folder, request.body) : inspect_file(folder, request.body);
  return reader->ask({.kind = checks ? Frame::check : Frame::inspect,
                      .body = request.body,
                      .most = std::chrono::seconds(30),
                      .patience = std::chrono::milliseconds(500)});
}

/// Of a job, by the runs of it that are remembered.
HttpResponse Api::Parts::overview(const HttpRequest& request) {
  const auto named = request.query.find("file");
  if (named == request.query.end()) return error_response(400, "file is missing");
  io::Json written = io::Json::array();
  for (const io::Json& job : jobs.list()) {
    const bool is_its = job["verb"] == "plan" && job["input"] == named->second && job["state"] == "done";
    if (is_its && job["output"].is_string()) written.push_back(job["output"]);
  }
  const std::string body = io::plain_text({{"file", named->second}, {"written", std::move(written)}});
  if (!reader) return answer_overview(folder, plans, body);
  return reader->ask({.kind = Frame::overview,
                      .body = body,
                      .most = std::chrono::seconds(30),
                      .patience = std::chrono::milliseconds(500)});
}

HttpResponse Api::Parts::edit(const io::Json& body) {
  const std::string text = body.at("text");
  if (text.size() > most_edited_bytes) return error_response(413, too_long_to_edit);
  const io::TomlSetting setting = {.key = body.at("key"),
                                   .value = toml_literal(io::JsonNode(body, "request").at("value"))};
  return json_response({{"text", io::with_setting(text, setting)}});
}

HttpResponse Api::Parts::start_job(const io::Json& body) {
  const std::optional<int> id =
      jobs.submit(read_job_request(body, [this](const std::string& path) { return folder.resolve(path); }));
  if (!id) return error_response(429, "too many jobs wait; try later");
  return json_response({{"id", *id}});
}

HttpResponse Api::Parts::about_job(const HttpRequest& request) {
  constexpr std::string_view before = "/api/jobs/", report_word = "/report";
  std::string_view path = request.path;
  const bool wants_report = request.method == "GET" && path.ends_with(report_word);
  if (wants_report) path.remove_suffix(report_word.size());
  const int id = number_of(path, before);
  const io::Json job = jobs.job(id);
  if (job.is_null()) return error_response(404, "there is no such job, or it was forgotten");
  if (request.method == "DELETE") {
    jobs.cancel(id);
    return json_response(jobs.job(id));
  }
  if (!wants_report) return json_response(job);
  std::string report = jobs.report(id);
  if (report.empty()) return error_response(404, "there is no such report, or it was forgotten; see the job's files");
  return {.body = std::move(report)};
}

HttpResponse Api::Parts::answer_monitors(const HttpRequest& request) {
  return monitor_service ? monitor_service->answer(request) : monitors.answer(request);
}

Worker& Api::Parts::worker_of(const HttpRequest& request) {
  const std::string& path = request.path;
  if (path.starts_with("/api/monitors")) return monitor_worker;
  if (path.starts_with("/api/tap")) return tap_worker;
  return path == "/api/check" || path == "/api/inspect" || path == "/api/overview" ? reader_worker : at_hand;
}

HttpResponse Api::Parts::answer(const HttpRequest& request) {
  const std::string& path = request.path;
  if (is_of_folder(request)) require_folder(folder.root());
  if (path == "/api/state") return state();
  if (path == "/api/file") return request.method == "GET" ? get_file(request) : put_file(request);
  if (path == "/api/overview") return overview(request);
  if (path == "/api/verbs") return json_response(verbs_json());
  if (path.starts_with("/api/jobs/")) return about_job(request);
  if (path == "/api/jobs" && request.method == "GET") return json_response(jobs.list());
  if (path.starts_with("/api/tap")) return taps.answer(request);
  if (path.starts_with("/api/monitors")) return answer_monitors(request);
  if (path == "/api/check" || path == "/api/inspect") return read_file_of(request);
  const io::Json body = io::parse_json(request.body, "request");
  if (path == "/api/jobs") return start_job(body);
  if (path == "/api/edit") return edit(body);
  return error_response(404, "there is no such address");
}

/// As soon as it is the newest of its channel that waits.
void Api::Parts::answer_latest(const ClientOrder& order, std::function<std::string(Progress&)> compute,
                               const Reply& reply) {
  const auto answered = [this, reply](const Latest::Outcome& outcome) {
    using Kind = Latest::Outcome::Kind;
    reply(answer_of(folder.root(), [&]() -> HttpResponse {
      if (outcome.kind == Kind::answered) return {.body = outcome.answer};
      if (outcome.kind == Kind::full) return error_response(503, "too many requests wait; try later");
      if (outcome.kind == Kind::failed) std::rethrow_exception(outcome.error);
      return json_response({{"superseded", true}}, 409);
    }));
  };
  latest.submit({.client = order.client,
                 .channel = order.channel,
                 .sequence = order.sequence,
                 .compute = std::move(compute),
                 .done = answered});
}

/// Status 0: it replies by itself, later.
HttpResponse Api::Parts::answer_live(const HttpRequest& request, const Reply& reply) {
  if (request.path == "/api/lobes") {
    require_folder(folder.root());
    LiveLobesRequest asked = read_live_lobes_request(request.body);
    asked.file = folder.resolve(asked.file.string());
    answer_latest(
        asked.order,
        [this, asked, body = request.body](Progress& progress) {
          return live ? live_answer(*live, Frame::lobes, body, progress) : lobes.answer(asked, progress);
        },
        reply);
  } else {
    const LiveProgramRequest asked = read_live_program_request(request.body);
    TurnProgram turn = jobs.turn(asked.job);
    if (!turn) return error_response(404, "there is no such job with a program, or it was forgotten; run it again");
    answer_latest(
        asked.order, [turn = std::move(turn), body = request.body](Progress& progress) { return turn(body, progress); },
        reply);
  }
  return {.status = 0};
}

/// Says when files come, go or change.
void Api::Parts::watch(const std::stop_token& stop) {
  constexpr std::chrono::seconds pause(1);
  std::optional<std::vector<FolderFile>> last;
  while (!stop.stop_requested()) {
    try {
      std::vector<FolderFile> now;
      {
        const std::lock_guard lock(listing);
        std::size_t left_out = 0;
        now = folder.list(left_out);
      }
      if (last && now != *last) publish("files", "{}");
      last = std::move(now);
    } catch (const std::exception&) {
      // No memory, or a disk that is gone: the next look says more, and requests say what is wrong.
    }
    std::unique_lock lock(waiting);
    ended.wait_for(lock, stop, pause, [] { return false; });
  }
}

Api::Api(const Folder& folder, OpenStream open_stream, const WorkerOptions& worker, Publish publish)
    : parts_(std::make_unique<Parts>(folder, std::move(open_stream), worker, std::move(publish))) {}

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
  if (request.path == "/api/lobes" || request.path == "/api/program") {
    const HttpResponse at_once = answer_of(parts_->folder.root(), [&] { return parts_->answer_live(request, reply); });
    if (at_once.status != 0) reply(at_once);
    return;
  }
  Worker& worker = parts_->worker_of(request);
  auto work = [this, request = std::move(request), reply] {
    reply(answer_of(parts_->folder.root(), [&] { return parts_->answer(request); }));
  };
  if (!worker.post(std::move(work))) reply(error_response(503, "too many requests wait; try later"));
}

}  // namespace robomill::serve
