#include "robomill/serve/process/monitor_service.hpp"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <utility>

#include "robomill/serve/error_json.hpp"
#include "robomill/serve/http/target.hpp"
#include "robomill/serve/monitor/sessions.hpp"

namespace robomill::serve {
namespace {

constexpr std::string_view all_path = "/api/monitors";

int id_of(const io::Json& spindle) {
  return spindle.value("id", 0);
}

/// A spindle whose process died, as a session that failed.
io::Json failed(io::Json spindle, const std::string& fate) {
  const std::string status = spindle.value("status", std::string());
  if (status == "done" || status == "failed") return spindle;
  spindle["status"] = "failed";
  spindle["error"] = error_object(fate);
  return spindle;
}

}  // namespace

std::string text_of(const HttpRequest& request) {
  return request.method + " " + request.path + "\n" + request.body;
}

HttpRequest http_request_of(const std::string& text) {
  const std::size_t line_end = std::min(text.find('\n'), text.size());
  const std::size_t blank = std::min(text.find(' '), line_end);
  return {.method = text.substr(0, blank),
          .path = text.substr(std::min(blank + 1, line_end), line_end - std::min(blank + 1, line_end)),
          .query = {},
          .headers = {},
          .body = text.substr(std::min(line_end + 1, text.size()))};
}

void MonitorService::start() {
  options_.last_id = last_id_;
  const std::lock_guard lock(changing_);
  if (ended_) throw WorkerEnded("the server ends");
  process_ = std::make_unique<Service>(options_, publish_, [publish = publish_] { publish("monitors", "{}"); });
}

void MonitorService::end() {
  const std::lock_guard lock(changing_);
  ended_ = true;
  if (process_) process_->end();
}

/// Of a process that died since.
void MonitorService::remember_lost() {
  if (!process_) return;
  const std::optional<std::string> fate = process_->fate();
  if (!fate) return;
  {
    const std::lock_guard lock(changing_);
    process_.reset();
  }
  for (io::Json& spindle : known_) lost_.push_back(failed(std::move(spindle), *fate));
  known_ = io::Json::array();
  while (lost_.size() > MonitorSessions::most) lost_.erase(lost_.begin());
}

HttpResponse MonitorService::forward(const HttpRequest& request) {
  return process_->ask(Frame::monitors, text_of(request));
}

HttpResponse MonitorService::list() {
  if (process_) {
    HttpResponse listed = forward({.method = "GET", .path = std::string(all_path), .query = {}, .headers = {}});
    if (listed.status != 200) return listed;
    known_ = io::parsed(listed.body);
    for (const io::Json& spindle : known_) last_id_ = std::max(last_id_, id_of(spindle));
  }
  io::Json out = lost_;
  for (const io::Json& spindle : known_) out.push_back(spindle);
  return json_response(out);
}

HttpResponse MonitorService::answer_of_all(const HttpRequest& request) {
  if (request.method == "GET") return list();
  if (!process_) start();
  HttpResponse started = forward(request);
  static_cast<void>(list());  // to be known, whatever becomes of the process
  return started;
}

HttpResponse MonitorService::answer(const HttpRequest& request) {
  remember_lost();
  try {
    if (request.path == all_path) return answer_of_all(request);
    const int id = number_of(request.path, "/api/monitors/");
    const auto lost = std::ranges::find_if(lost_, [id](const io::Json& spindle) { return id_of(spindle) == id; });
    if (lost == lost_.end()) {
      if (!process_) return error_response(404, "there is no such spindle, or it was ended");
      HttpResponse answered = forward(request);
      return request.method == "DELETE" && answered.status == 200 ? list() : answered;
    }
    if (request.method == "GET") {
      io::Json spindle = *lost;
      for (const char* empty : {"edges_hz", "assumed", "warnings", "alarms", "frames"}) {
        spindle[empty] = io::Json::array();
      }
      return json_response(spindle);
    }
    lost_.erase(lost);
    publish_("monitors", "{}");
    return list();
  } catch (const WorkerEnded&) {
    remember_lost();
    throw;
  }
}

}  // namespace robomill::serve
