#pragma once
#include <cstddef>
#include <map>
#include <memory>

#include "robomill/serve/files/folder.hpp"
#include "robomill/serve/http/server.hpp"
#include "robomill/serve/monitor/session.hpp"
#include "robomill/serve/serve.hpp"
#include "robomill/serve/worker.hpp"

// Method: robomill/serve/README.md, "Monitor"

namespace robomill::serve {

/// The spindles that are monitored, and what the addresses at /api/monitors answer. Used by one thread.
class MonitorSessions {
 public:
  static constexpr std::size_t most = 8;
  /// @param open_stream  none: there are no streams
  /// @param publish      MonitorSession's
  /// @param last         number of the last session before the first one
  MonitorSessions(const Folder& folder, OpenStream open_stream, MonitorSession::Publish publish, int last = 0);
  /// Ends all.
  ~MonitorSessions();
  MonitorSessions(const MonitorSessions&) = delete;
  MonitorSessions& operator=(const MonitorSessions&) = delete;

  /// Of GET and POST /api/monitors, GET and DELETE /api/monitors/N.
  /// @throws InvalidInput if a session cannot begin, io::Json::exception if the body is none
  [[nodiscard]] HttpResponse answer(const HttpRequest& request);

 private:
  [[nodiscard]] HttpResponse start(const io::Json& body);
  [[nodiscard]] HttpResponse list() const;
  void end(std::map<int, std::shared_ptr<MonitorSession>>::iterator session);

  const Folder& folder_;
  OpenStream open_stream_;
  MonitorSession::Publish publish_;
  std::map<int, std::shared_ptr<MonitorSession>> sessions_;
  int last_;
  Worker endings_{most};  ///< a broker may take seconds to let a session go, and nobody is to wait for that
};

}  // namespace robomill::serve
