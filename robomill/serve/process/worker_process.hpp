#pragma once
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "robomill/base/progress.hpp"
#include "robomill/serve/http/server.hpp"
#include "robomill/serve/process/frames.hpp"
#include "robomill/serve/process/program.hpp"

// Method: robomill/serve/README.md, "Processes"

namespace robomill::serve {

/// A process of its own that does what is asked of it, one question at a time: what it dies of, nobody else does. It is
/// started when it is first asked.
class WorkerProcess {
 public:
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
  /// @param remembers  what it found before is asked for: one that died has no successor
  explicit WorkerProcess(WorkerOptions options, bool remembers = false)
      : options_(std::move(options)), remembers_(remembers) {}
  /// Ends the process.
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  /// What the process answers. From one thread after the other.
  /// @throws Interrupted if the question was stopped, WorkerEnded if the process died, cannot be started or took too
  ///     long; what report throws: the process is ended then
  [[nodiscard]] HttpResponse ask(const Question& question);
  /// Stops what is asked, and all that is asked later. From any thread.
  void end() { ended_ = true; }

 private:
  using Clock = std::chrono::steady_clock;
  void start();
  [[nodiscard]] bool is_gone() const;
  /// What has come, after `look` at most. False where the other end is gone.
  [[nodiscard]] bool read(std::chrono::milliseconds look);
  [[nodiscard]] std::optional<HttpResponse> answer_in_what_came(const Question& question);
  [[nodiscard]] HttpResponse answer_to(const Question& question);
  /// WorkerProgram::end.
  [[nodiscard]] std::string reap(bool kill_it);

  WorkerOptions options_;
  bool remembers_;
  std::atomic<bool> ended_{false};
  std::mutex asking_;
  std::unique_ptr<WorkerProgram> program_;
  bool was_started_ = false;
  bool open_ = false;  ///< a question was sent, and its answer has not come
  FrameReader frames_{longest_answer};
};

/// The body of an answer to one who would rather have the next one: of live views. Long work that a later question
/// needs too is let go on.
/// @throws Interrupted if progress was stopped, AnsweredElsewhere if the answer is no 200
[[nodiscard]] std::string live_answer(WorkerProcess& process, char kind, std::string_view body,
                                      const Progress& progress);

}  // namespace robomill::serve
