#pragma once
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include "robomill/serve/http/server.hpp"
#include "robomill/serve/process/frames.hpp"
#include "robomill/serve/process/program.hpp"

// Method: robomill/serve/README.md, "Processes"

namespace robomill::serve {

/// A process that works while nobody asks it, and has news of its own.
class Service {
 public:
  /// An event for the pages.
  using Publish = std::function<void(std::string_view event, std::string_view data)>;
  /// Starts it.
  /// @param publish  its events; from another thread, as died, which is called once where the process ends first
  /// @throws WorkerEnded if it cannot be started
  Service(const WorkerOptions& options, Publish publish, std::function<void()> died);
  /// Ends it.
  ~Service();
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  /// Ends it before; its end is no news then. From any thread.
  void end();
  /// What it answers. From one thread. @throws WorkerEnded if it is over, or did not answer for a minute
  [[nodiscard]] HttpResponse ask(char kind, std::string_view body);
  /// What became of it; nothing while it runs.
  [[nodiscard]] std::optional<std::string> fate() const;

 private:
  void listen();
  void take(const Frame& frame);
  void end_because(const char* reason);

  WorkerProgram program_;
  const Publish publish_;
  const std::function<void()> died_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<HttpResponse> answer_ = {};
  std::optional<std::string> fate_ = {};
  std::string reason_ = {};  ///< why it is ended, where that is known better than from how it ends
  bool ending_ = false;
  std::thread listener_;
};

}  // namespace robomill::serve
