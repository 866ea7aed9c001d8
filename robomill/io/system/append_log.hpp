#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <list>
#include <mutex>
#include <string>
#include <string_view>

#include "robomill/base/export.hpp"
#include "robomill/io/system/descriptor.hpp"

// Method: robomill/io/README.md, "Logs"

namespace robomill::io {

/// A file of lines that is appended to while others read it, whatever the disk does. What is there stays. Each line is
/// one write(): what kills the process cuts the last one at most, and the next log that opens the file ends it. Lines
/// that cannot be written wait, in their order, and go with the next one that can. Where the file was removed or
/// another one stands in its place, as after a rotation, the log goes on in that one, or in a new one. A device or a
/// pipe is written through.
///
/// Any thread may write; none waits for another one's write().
class ROBOMILL_API AppendLog {
 public:
  struct Options {
    std::size_t most_waiting = 4096;  ///< lines; more of them are lost: the oldest minor one, else the oldest
    /// The line that stands in the place of those that were lost; none: nothing does.
    std::function<std::string(std::uint64_t lost)> lost_line = {};
  };
  struct State {
    int error = 0;               ///< errno of the last write(); 0: all is written
    std::size_t waiting = 0;     ///< lines
    std::uint64_t lost = 0;      ///< lines, of all that were written
    std::uint64_t failures = 0;  ///< times that writing became impossible
    std::uint64_t moved = 0;     ///< times that the file was gone from its place, and another one was begun or found
  };

  /// A last line that was not finished is ended with the first line written.
  /// @throws InvalidInput if the place cannot be written
  AppendLog(std::filesystem::path path, Options options);
  AppendLog(const AppendLog&) = delete;
  AppendLog& operator=(const AppendLog&) = delete;

  /// A text with its line's end. @param minor  lost before lines that are not
  State write(std::string line, bool minor = false);
  /// Those that wait, once more.
  State retry();
  [[nodiscard]] State state() const;
  /// Those that wait once more; then all is made durable, and nothing can be written any more.
  State close();
  /// Whether the file's last line was not finished when it was opened.
  [[nodiscard]] bool was_unfinished() const { return was_unfinished_; }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  struct Line {
    std::string text;  ///< behind the end of the line before
    bool minor = false;
  };
  struct Place {
    std::uint64_t device = 0, inode = 0;
    bool operator==(const Place&) const = default;
  };

  void open();
  int open_file(int flags, const char*& rule);
  int follow();
  void drop_surplus();
  void write_waiting(std::unique_lock<std::mutex>& lock);
  int append(std::string_view text);
  void take_back(std::size_t bytes);

  std::filesystem::path path_;
  Options options_;
  Descriptor file_;
  Place place_;  ///< of the file
  bool is_regular_ = false, was_unfinished_ = false;
  mutable std::mutex mutex_;      ///< of the rest
  std::list<Line> waiting_;       ///< a line leaves it and comes back without a copy
  std::uint64_t unreported_ = 0;  ///< lines lost, ahead of those that wait
  State state_;
  bool busy_ = false;        ///< a thread writes, and takes along what comes meanwhile
  bool unfinished_ = false;  ///< the file's last line, now; of the thread that writes, as the next
  std::uint64_t moved_ = 0;
};

}  // namespace robomill::io
