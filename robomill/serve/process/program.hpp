#pragma once
#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

// Method: robomill/serve/README.md, "Processes"

namespace robomill::serve {

/// A process that worked for the server is no more, or was none: what() says what became of it.
class WorkerEnded : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a process that works for the server is, and what it may do.
struct WorkerOptions {
  std::vector<std::string> command = {};  ///< a program that calls work_for_server(), and its arguments
  int library = -1;                 ///< the shared library that it runs from, open (own_library()); -1: as installed
  std::filesystem::path root = {};  ///< the folder that is served
  std::uint64_t memory_bytes = 0;   ///< that it may have for itself
  bool connects = false;            ///< to brokers
  int last_id = 0;                  ///< of a spindle that is monitored; the next has the next one
};

/// Such a process while it runs.
class WorkerProgram {
 public:
  /// Starts it. @throws WorkerEnded if that fails
  explicit WorkerProgram(const WorkerOptions& options);
  /// Ends it.
  ~WorkerProgram();
  WorkerProgram(const WorkerProgram&) = delete;
  WorkerProgram& operator=(const WorkerProgram&) = delete;

  /// Where it is spoken to.
  [[nodiscard]] int socket() const { return socket_; }
  /// Once; says what became of it. One that does not end by itself is killed; asked to end, it takes its temporary
  /// files away.
  std::string end(bool ask_it);

 private:
  enum class State { runs, gone, unknown };
  [[nodiscard]] State state_within(std::chrono::milliseconds time, int& status) const;
  pid_t process_ = -1;
  int socket_ = -1;
};

}  // namespace robomill::serve
