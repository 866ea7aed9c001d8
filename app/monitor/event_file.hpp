#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

#include "robomill/io/file.hpp"
#include "robomill/io/system/append_log.hpp"
#include "robomill/live/health/metrics.hpp"
#include "robomill/live/notices.hpp"

namespace robomill::app {

/// Lines of events. Of a recording the file appears whole at the end. That of a stream is appended to, from one session
/// to the next, each of which begins with an event "started"; what cannot be written waits until there is room again,
/// and the metrics, standard error and a notice say so. Nor does standard output that takes none end a stream.
class EventFile {
 public:
  struct Options {
    std::filesystem::path place = {};  ///< "-": standard output; empty: nowhere
    bool is_stream = false;
    std::string input = {}, config = {};  ///< that "started" names
  };
  /// @throws InvalidInput if the place cannot be written
  explicit EventFile(const Options& options);
  EventFile(const EventFile&) = delete;
  EventFile& operator=(const EventFile&) = delete;

  /// Where it says that a stream's events cannot be saved.
  void report_to(live::Notices& notices, live::MetricValues& metrics);
  /// A stream's session begins; its first event would say so too.
  void begin();
  /// False where nobody reads any more, or what a recording writes to takes no more.
  /// @param minor  lost first, where there are too many to keep
  bool write(const std::string& line, bool minor = false);
  /// The same from another thread, which waits for nobody: of a recording nothing is written.
  void write_beside(const std::string& line);
  /// What waits, at most once a second.
  void retry();
  /// @throws InvalidInput if standard output or the file of a recording could not be written
  void close();
  /// Tries the rest of a stream's, and makes all durable. @throws InvalidInput if some of it is not
  void require_saved();

 private:
  bool print(const std::string& line);
  void note();

  Options options_;
  bool to_stdout_, begun_ = false;
  std::uint64_t unprinted_ = 0;  ///< events that standard output did not take
  bool cut_ = false;             ///< the last of these perhaps in the middle
  std::optional<io::LineFile> whole_;
  std::optional<io::AppendLog> log_;
  live::Notices* notices_ = nullptr;
  live::MetricValues* metrics_ = nullptr;
  std::mutex noting_;  ///< of what was said last:
  bool unsaved_ = false;
  std::uint64_t moved_ = 0;
  std::chrono::steady_clock::time_point tried_ = {};
};

}  // namespace robomill::app
