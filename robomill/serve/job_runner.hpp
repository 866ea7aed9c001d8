#pragma once
#include <atomic>
#include <chrono>
#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "robomill/io/json.hpp"
#include "robomill/serve/worker.hpp"

// Method: robomill/serve/README.md, "Jobs"

namespace robomill::serve {

/// What a client asked to run.
struct JobRequest {
  std::string verb = "plan";
  std::string input = {};   ///< below the folder that is served
  std::string output = {};  ///< a folder below it; empty: nothing is written
};

/// Runs jobs, one at a time, in their order; keeps what the last ones came to.
class JobRunner {
 public:
  static constexpr std::size_t most_queued = 4, most_kept = 16, most_reports = 2;
  /// @param changed  is given a job's JSON on every change, at most five times a second while it runs; from any thread
  JobRunner(std::filesystem::path root, std::function<void(const std::string&)> changed);
  ~JobRunner();  ///< stops the job that runs
  JobRunner(const JobRunner&) = delete;
  JobRunner& operator=(const JobRunner&) = delete;

  /// Its number; none where too many are queued.
  /// @throws InvalidInput if there is no such verb
  [[nodiscard]] std::optional<int> submit(const JobRequest& request);
  /// Every job that is remembered, oldest first.
  [[nodiscard]] io::Json list() const;
  /// Null where it is not remembered.
  [[nodiscard]] io::Json job(int id) const;
  /// The data of its page; empty where there is none.
  [[nodiscard]] std::string report(int id) const;
  /// False where it is not remembered.
  bool cancel(int id);

 private:
  struct Job;
  void run(const std::shared_ptr<Job>& job);
  void announce(const Job& job) const;
  void forget_old();
  [[nodiscard]] std::shared_ptr<Job> find(int id) const;

  std::filesystem::path root_;
  std::function<void(const std::string&)> changed_;
  mutable std::mutex mutex_;
  std::deque<std::shared_ptr<Job>> jobs_;
  int last_ = 0;
  Worker worker_{most_queued};
};

}  // namespace robomill::serve
