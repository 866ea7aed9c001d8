#pragma once
#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/serve/http/server.hpp"
#include "robomill/serve/process/frames.hpp"

// Method: robomill/serve/README.md, "Processes"

namespace robomill::serve {

/// A process that worked for the server is no more, or was none: what() says what became of it.
class WorkerEnded : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A process of its own that does what is asked of it, one question at a time: what it dies of, nobody else does. It is
/// started when it is first asked.
class WorkerProcess {
 public:
  struct Options {
    std::vector<std::string> command = {};  ///< a program that calls work_for_server(), and its arguments
    std::filesystem::path root = {};        ///< the folder that is served
    std::uint64_t memory_bytes = 0;         ///< that it may have for itself
    bool remembers = false;                 ///< what it found before is asked for: one that died has no successor
  };
  struct Question {
    char kind = 0;  ///< Frame's
    std::string_view body = {};
    /// Becomes true when nobody waits for the answer any more; asked all `look`.
    std::function<bool()> stopped = {};
    Progress::Report report = {};
    std::chrono::milliseconds look{50};
    std::chrono::milliseconds most = std::chrono::hours(24 * 365);  ///< then it is stopped
    std::chrono::milliseconds patience{2000};                       ///< from there on; then it is killed
  };
  explicit WorkerProcess(Options options) : options_(std::move(options)) {}
  /// Ends the process.
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  /// What the process answers. From one thread after the other.
  /// @throws Interrupted if the question was stopped, WorkerEnded if the process died, cannot be started or took too
  ///     long
  [[nodiscard]] HttpResponse ask(const Question& question);
  /// Stops what is asked, and all that is asked later. From any thread.
  void end() { ended_ = true; }

 private:
  using Clock = std::chrono::steady_clock;
  void start();
  /// What has come, after `look` at most. False where the other end is gone.
  [[nodiscard]] bool read(std::chrono::milliseconds look);
  [[nodiscard]] std::optional<HttpResponse> answer_in_what_came(const Question& question);
  /// Ends the process where it does not by itself, and says what became of it.
  [[nodiscard]] std::string reap(bool kill_it);
  [[nodiscard]] bool is_gone_within(std::chrono::milliseconds time, int& status) const;

  Options options_;
  std::atomic<bool> ended_{false};
  std::mutex asking_;
  pid_t process_ = -1;
  int socket_ = -1;
  bool was_started_ = false;
  FrameReader frames_{longest_answer};
};

/// The body of an answer to one who would rather have the next one: of live views. Long work that a later question
/// needs too is let go on.
/// @throws Interrupted if progress was stopped, AnsweredElsewhere if the answer is no 200
[[nodiscard]] std::string live_answer(WorkerProcess& process, char kind, std::string_view body,
                                      const Progress& progress);

}  // namespace robomill::serve
