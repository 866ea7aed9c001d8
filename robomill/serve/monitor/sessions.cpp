#include "robomill/serve/monitor/sessions.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/serve/error_json.hpp"
#include "robomill/serve/files/monitor_input.hpp"
#include "robomill/serve/http/target.hpp"

namespace robomill::serve {
namespace {

constexpr double fastest = 50.0;

}  // namespace

MonitorSessions::MonitorSessions(const Folder& folder, OpenStream open_stream, MonitorSession::Publish publish,
                                 int last)
    : folder_(folder), open_stream_(std::move(open_stream)), publish_(std::move(publish)), last_(last) {}

MonitorSessions::~MonitorSessions() {
  for (const auto& [id, session] : sessions_) session->stop();
}

/// On another thread, or here where many end already.
void MonitorSessions::end(std::map<int, std::shared_ptr<MonitorSession>>::iterator session) {
  std::shared_ptr<MonitorSession> ending = std::move(session->second);
  sessions_.erase(session);
  ending->stop();
  static_cast<void>(endings_.post([ending = std::move(ending)]() mutable { ending.reset(); }));
}

HttpResponse MonitorSessions::list() const {
  io::Json out = io::Json::array();
  for (const auto& [id, session] : sessions_) out.push_back(session->summary());
  return json_response(out);
}

HttpResponse MonitorSessions::start(const io::Json& body) {
  const std::string config = body.at("config");
  const double speed = body.value("speed", 1.0);
  if (!(speed >= 1.0 && speed <= fastest)) throw InvalidInput("speed", speed, "", "must lie between 1 and 50");
  const auto over = std::ranges::find_if(sessions_, [](const auto& entry) { return entry.second->over(); });
  if (sessions_.size() == most && over == sessions_.end()) {
    return error_response(429, "8 spindles are monitored already; end one of them");
  }
  MonitorInput input = open_monitor_input(folder_, config, body.value("input", std::string()));
  if (sessions_.size() == most) end(over);
  const int id = last_ + 1;
  sessions_[id] = std::make_shared<MonitorSession>(
      MonitorSession::Options{
          .id = id, .config = config, .speed = speed, .root = folder_.root(), .open_stream = open_stream_},
      std::move(input), publish_);
  last_ = id;
  publish_("monitors", "{}");
  return json_response({{"id", id}});
}

HttpResponse MonitorSessions::answer(const HttpRequest& request) {
  if (request.path == "/api/monitors") {
    return request.method == "GET" ? list() : start(io::parse_json(request.body, "request"));
  }
  const auto session = sessions_.find(number_of(request.path, "/api/monitors/"));
  if (session == sessions_.end()) return error_response(404, "there is no such spindle, or it was ended");
  if (request.method == "GET") return json_response(session->second->all());
  end(session);
  publish_("monitors", "{}");
  return list();
}

}  // namespace robomill::serve
