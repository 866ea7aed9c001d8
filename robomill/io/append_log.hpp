#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <string>

#include "robomill/io/descriptor.hpp"

// Method: robomill/io/README.md, "Logs"

namespace robomill::io {

/// A file of lines that is appended to while others read it, whatever the disk does. What is there stays. Each line is
/// one write(): what kills the process leaves whole ones. Lines that cannot be written wait, in their order, and go
/// with the next one that can. A device or a pipe is written through.
///
/// Any thread may write; none waits for another one's write().
class AppendLog {
 public:
  struct Options {
    std::size_t most_waiting = 4096;  ///< lines; more of them are lost, the oldest first
    /// The line that stands in the place of those that were lost; none: nothing does.
    std::function<std::string(std::uint64_t lost)> lost_line = {};
  };
  struct State {
    int error = 0;               ///< errno of the last write(); 0: all is written
    std::size_t waiting = 0;     ///< lines
    std::uint64_t lost = 0;      ///< lines, of all that were written
    std::uint64_t failures = 0;  ///< times that writing became impossible
  };

  /// A last line that was not finished is ended with the first line written.
  /// @throws InvalidInput if the place cannot be written
  AppendLog(std::filesystem::path path, Options options);
  AppendLog(const AppendLog&) = delete;
  AppendLog& operator=(const AppendLog&) = delete;

  /// A text with its line's end.
  State write(std::string line);
  /// Those that wait, once more.
  State retry();
  [[nodiscard]] State state() const;
  /// What is said of an error: "No space left on device".
  [[nodiscard]] static std::string reason(int error);
  /// Whether the file's last line was not finished when it was opened.
  [[nodiscard]] bool was_unfinished() const { return was_unfinished_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  void open();
  void write_waiting(std::unique_lock<std::mutex>& lock);
  int append(const std::string& line);
  void take_back(std::size_t bytes);

  std::filesystem::path path_;
  Options options_;
  Descriptor file_;
  bool is_regular_ = false, was_unfinished_ = false;
  mutable std::mutex mutex_;  ///< of the rest
  std::deque<std::string> waiting_;
  std::uint64_t unreported_ = 0;  ///< lines lost, ahead of those that wait
  State state_;
  bool busy_ = false;        ///< a thread writes, and takes along what comes meanwhile
  bool unfinished_ = false;  ///< the file's last line, now; of the thread that writes
};

}  // namespace robomill::io
