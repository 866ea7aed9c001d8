#pragma once
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "robomill/base/export.hpp"

namespace robomill::live {

/// Keeps the last seconds of all channels and writes them as WAV when an alarm comes, on a thread of its own.
class ROBOMILL_API AlarmRing {
 public:
  struct Options {
    std::filesystem::path folder;  ///< made where it is missing
    double seconds = 60.0;
    int channels = 1;
    double sample_rate_hz = 0.0;  ///< WAV has whole numbers of Hz: rounded
  };
  /// @param reported  called by the writing thread: the file written, or an empty path and what went wrong
  /// @throws InvalidInput if the folder cannot be made
  AlarmRing(Options options, std::function<void(const std::filesystem::path& file, const std::string& error)> reported);
  /// What was asked for is still written.
  ~AlarmRing();
  AlarmRing(const AlarmRing&) = delete;
  AlarmRing& operator=(const AlarmRing&) = delete;

  void add(std::vector<float>&& samples);
  /// Writes what is kept as alarm_TIME.wav. False where two alarms still wait to be written: the disk is too slow.
  bool alarm(double time_s);
  /// Waits until what was asked for is written.
  void finish();

 private:
  using Piece = std::shared_ptr<const std::vector<float>>;
  struct Job {
    std::filesystem::path file;
    std::vector<Piece> pieces;
  };
  void write_jobs();
  void write(const Job& job) const;

  Options options_;
  std::function<void(const std::filesystem::path&, const std::string&)> reported_;
  std::deque<Piece> kept_;
  std::size_t kept_samples_ = 0, room_ = 0;

  std::mutex mutex_;
  std::condition_variable asked_, written_;
  std::deque<Job> jobs_;
  bool busy_ = false, ended_ = false;
  std::jthread thread_;
};

}  // namespace robomill::live
