#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "robomill/base/progress.hpp"
#include "robomill/io/json.hpp"
#include "robomill/serve/jobs/verbs.hpp"

// Method: robomill/serve/README.md, "Jobs"

namespace robomill::serve {

/// Answers the body of POST /api/program of one job, from one thread after the other.
using TurnProgram = std::function<std::string(const std::string& body, Progress& progress)>;

/// What a job that was run came to. The outcome's plan is not kept.
struct JobRun {
  JobOutcome outcome = {};
  std::size_t blocks = 0;  ///< of its program that were judged
  TurnProgram turn = {};   ///< with another γ; none: no program was judged
};

/// Runs a request that was checked. @throws as run_verb
using RunJob =
    std::function<JobRun(const JobRequest& request, const Progress::Report& report, const std::atomic<bool>& stop)>;

/// By run_verb, in this process.
/// @param root  the folder that is served
[[nodiscard]] RunJob run_here(std::filesystem::path root);

/// Runs jobs, one at a time, in their order; keeps what the last ones came to.
class JobRunner {
 public:
  /// One that was cancelled has no place among those that are queued.
  static constexpr std::size_t most_queued = 4, most_kept = 16, most_reports = 2;
  /// Plans of programs that are kept: the last, and the one before where both have no more blocks than that.
  static constexpr std::size_t most_plans = 2, most_plan_blocks = 50000;
  /// @param changed  is given a job's JSON on every change, at most five times a second while it runs; from any thread
  JobRunner(std::filesystem::path root, std::function<void(const std::string&)> changed, RunJob run_job);
  ~JobRunner();  ///< stops the job that runs
  JobRunner(const JobRunner&) = delete;
  JobRunner& operator=(const JobRunner&) = delete;

  /// Its number; none where too many are queued.
  /// @param request  as read_job_request() checked it
  [[nodiscard]] std::optional<int> submit(const JobRequest& request);
  /// Every job that is remembered, oldest first.
  [[nodiscard]] io::Json list() const;
  /// Null where it is not remembered.
  [[nodiscard]] io::Json job(int id) const;
  /// The data of its page; empty where there is none.
  [[nodiscard]] std::string report(int id) const;
  /// How a job's program is judged with another γ; none where there is no program, or it was forgotten.
  [[nodiscard]] TurnProgram turn(int id) const;
  /// False where it is not remembered.
  bool cancel(int id);

 private:
  struct Job;
  void work(const std::stop_token& stop);
  void run(const std::shared_ptr<Job>& job);
  void announce(const Job& job) const;
  void forget_old();
  [[nodiscard]] std::shared_ptr<Job> find(int id) const;

  std::filesystem::path root_;
  std::function<void(const std::string&)> changed_;
  RunJob run_job_;
  mutable std::mutex mutex_;
  std::deque<std::shared_ptr<Job>> jobs_;
  int last_ = 0;
  std::condition_variable_any arrived_;
  std::jthread thread_;
};

}  // namespace robomill::serve
