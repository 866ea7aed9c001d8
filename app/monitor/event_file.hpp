#pragma once
#include <atomic>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include "robomill/io/append_log.hpp"
#include "robomill/io/file.hpp"
#include "robomill/live/metrics.hpp"
#include "robomill/live/notices.hpp"

namespace robomill::app {

/// Lines of events. Of a recording the file appears whole at the end. That of a stream is appended to, from one session
/// to the next, each of which begins with an event "started"; what cannot be written waits until there is room again,
/// and the metrics, standard error and a notice say so.
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
  /// False where nobody reads any more, or a recording's file cannot be written.
  bool write(const std::string& line);
  /// The same from another thread, which waits for nobody: of a recording nothing is written.
  void write_beside(const std::string& line);
  /// What waits, at most once a second.
  void retry();
  /// @throws InvalidInput if standard output or the file of a recording could not be written
  void close();
  /// Tries the rest of a stream's. @throws InvalidInput if some of it still waits
  void require_saved();

 private:
  void begin(const Options& options);
  void note(const io::AppendLog::State& state);

  bool to_stdout_, failed_ = false;
  std::optional<io::LineFile> whole_;
  std::optional<io::AppendLog> log_;
  live::Notices* notices_ = nullptr;
  live::MetricValues* metrics_ = nullptr;
  std::atomic<bool> unsaved_{false};  ///< as it was said last
  std::chrono::steady_clock::time_point tried_ = {};
};

}  // namespace robomill::app
