#pragma once
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <stop_token>

#include "robomill/io/sample_source.hpp"

namespace robomill::serve {

/// A recording whose samples come as many times faster than they were taken, by the clock. Where who takes them is
/// slower than that, the time is not caught up.
class PacedSource : public io::SampleSource {
 public:
  /// @param frames_per_s  by the clock; > 0
  /// @param stop          ends it
  PacedSource(std::unique_ptr<io::SampleSource> source, std::size_t channels, double frames_per_s,
              std::stop_token stop);
  bool next(std::size_t frames, io::SampleBlock& block) override;

 private:
  using Clock = std::chrono::steady_clock;
  /// False where it was asked to stop.
  bool wait();

  std::unique_ptr<io::SampleSource> source_;
  std::size_t channels_;
  double frames_per_s_;
  std::stop_token stop_;
  Clock::time_point begin_ = Clock::now();
  double frames_ = 0.0;  ///< since then
  std::mutex waiting_;
  std::condition_variable_any ended_;
};

}  // namespace robomill::serve
