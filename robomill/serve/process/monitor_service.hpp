#pragma once
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "robomill/io/json.hpp"
#include "robomill/serve/http/server.hpp"
#include "robomill/serve/process/service.hpp"

// Method: robomill/serve/README.md, "Processes"

namespace robomill::serve {

/// What the addresses at /api/monitors answer (MonitorSessions), out of a process of its own. Where that dies, its
/// spindles stay listed as failed, with what it died of. Used by one thread, but for end().
class MonitorService {
 public:
  MonitorService(WorkerOptions options, Service::Publish publish)
      : options_(std::move(options)), publish_(std::move(publish)) {}

  /// @throws WorkerEnded if the process dies of it
  [[nodiscard]] HttpResponse answer(const HttpRequest& request);
  /// Ends the process, and with it what is asked; later there is none. From any thread.
  void end();

 private:
  [[nodiscard]] HttpResponse answer_of_all(const HttpRequest& request);
  [[nodiscard]] HttpResponse forward(const HttpRequest& request);
  [[nodiscard]] HttpResponse list();
  void remember_lost();
  void start();

  WorkerOptions options_;
  Service::Publish publish_;
  io::Json known_ = io::Json::array();  ///< spindles of the process, as it listed them last
  io::Json lost_ = io::Json::array();   ///< of processes that died
  int last_id_ = 0;
  std::mutex changing_;  ///< of process_, by the thread that asks, and of ended_
  bool ended_ = false;
  std::unique_ptr<Service> process_;
};

/// A request as forward() sends it: method, path and body.
[[nodiscard]] std::string text_of(const HttpRequest& request);
[[nodiscard]] HttpRequest http_request_of(const std::string& text);

}  // namespace robomill::serve
