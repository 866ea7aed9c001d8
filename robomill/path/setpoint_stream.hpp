#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/base/ring.hpp"
#include "robomill/path/interpolator.hpp"
#include "robomill/path/sample.hpp"

// Method: robomill/path/README.md, "Set-points by the clock"

namespace robomill::path {

inline constexpr Name<PathInterpolator::State> interpolator_state_names[] = {
    {"running", PathInterpolator::State::running},
    {"waiting", PathInterpolator::State::waiting},
    {"holding", PathInterpolator::State::holding},
    {"finished", PathInterpolator::State::finished},
    {"stopped", PathInterpolator::State::stopped}};

/// A sample as it is handed over.
struct Setpoint {
  Sample sample = {};
  double feed_override = 0.0;  ///< at which the plan is run
  PathInterpolator::State state = PathInterpolator::State::waiting;
  std::int64_t due_ns = 0;  ///< begin of its period by the stream's clock; its deadline is the period's end
};

/// The clock that a stream runs by.
class ROBOMILL_API StreamClock {
 public:
  StreamClock() = default;
  StreamClock(const StreamClock&) = delete;
  StreamClock& operator=(const StreamClock&) = delete;
  StreamClock(StreamClock&&) = delete;
  StreamClock& operator=(StreamClock&&) = delete;
  virtual ~StreamClock() = default;
  [[nodiscard]] virtual std::int64_t now_ns() noexcept = 0;
  /// Returns at that time or later, at once where it has passed.
  virtual void sleep_until(std::int64_t time_ns) noexcept = 0;
};

/// CLOCK_MONOTONIC; sleeps by clock_nanosleep to an absolute time, so that delays do not add up.
class ROBOMILL_API MonotonicClock final : public StreamClock {
 public:
  [[nodiscard]] std::int64_t now_ns() noexcept override;
  void sleep_until(std::int64_t time_ns) noexcept override;
};

struct ROBOMILL_API StreamOptions {
  double period_s = 0.0;  ///< in [1e-5, 0.1]; the interpolator's sample period; required
  double ring_s = 4.0;  ///< in (0, 60]; of set-points that a reader may be behind; from half of it on the motion holds
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Delays: mean and quantiles, in memory of fixed size. Quantiles are the upper end of a bin of 1 us below 1 ms, of 1
/// ms above, and never above the largest.
class ROBOMILL_API DelayStatistics {
 public:
  void add(std::int64_t delay_ns) noexcept;
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] double mean_s() const noexcept;
  /// @param share  in [0, 1]: as large a share of the delays is no larger
  [[nodiscard]] double quantile_s(double share) const noexcept;
  [[nodiscard]] double max_s() const noexcept { return 1e-9 * static_cast<double>(max_ns_); }

 private:
  static constexpr std::size_t fine = 1000, coarse = 1000;
  std::array<std::uint64_t, fine + coarse> bins_ = {};
  std::uint64_t count_ = 0;
  std::int64_t sum_ns_ = 0, max_ns_ = 0;
};

/// What a stream came to. Set-point n is due when its period begins, n periods after the first, and its deadline is the
/// end of that period.
struct StreamReport {
  double period_s = 0.0;
  std::uint64_t periods = 0;             ///< set-points
  std::uint64_t misses = 0;              ///< handed over to the reader's ring after their deadline
  std::uint64_t starved = 0;             ///< PathInterpolator::starved()
  std::uint64_t overruns = 0;            ///< lost, because the ring was full …
  std::uint64_t overruns_in_motion = 0;  ///< … of them while the path was run
  std::uint64_t reader_holds = 0;        ///< times that the motion was held because the reader was behind
  /// Times that the thread was more than longest_lag_periods late, and the schedule was moved on by that.
  std::uint64_t shifts = 0;
  double shifted_s = 0.0;
  DelayStatistics wake_up = {};    ///< of the thread, behind the begin of the period
  DelayStatistics hand_over = {};  ///< of the set-point, behind the begin of the period
  PathInterpolator::State state = PathInterpolator::State::waiting;  ///< the last
};

/// Runs an interpolator by the clock: one set-point a period, none ahead of its time.
///
/// Threads: run() is the loop of one thread, which alone calls the interpolator's next(), hold() and resume(); another
/// pushes blocks into the interpolator; one more reads set-points with wait() to drop(); commands come from any. run()
/// neither allocates nor waits for anything but the clock. A reader that is behind by half of the ring holds the motion
/// until it has caught up to an eighth, so that no set-point of a motion is lost unless the stop takes longer than the
/// other half.
class ROBOMILL_API SetpointStream {
 public:
  /// A later thread does not catch up: its schedule is moved on.
  static constexpr double longest_lag_periods = 10.0;

  /// @param path  outlives the stream, and is not run yet
  /// @throws InvalidInput if an option is invalid
  SetpointStream(PathInterpolator& path, const StreamOptions& options);
  SetpointStream(const SetpointStream&) = delete;
  SetpointStream& operator=(const SetpointStream&) = delete;

  /// From now on, once, until the path is finished or stopped; that set-point is the last.
  void run(StreamClock& clock) noexcept;

  void hold() noexcept { held_.store(true, std::memory_order_relaxed); }
  void resume() noexcept { held_.store(false, std::memory_order_relaxed); }
  void stop() noexcept { path_.stop(); }
  void set_override(double share) noexcept { path_.set_override(share); }

  /// Waits for set-points that were not dropped; false: none follows. Reader only, as the next four.
  [[nodiscard]] bool wait() noexcept;
  /// The first that was not dropped, and the one after the last that can be read.
  [[nodiscard]] std::size_t begin() const noexcept { return dropped_; }
  [[nodiscard]] std::size_t end() const noexcept { return ring_.end(); }
  [[nodiscard]] const Setpoint& operator[](std::size_t index) const noexcept { return ring_[index]; }
  void drop_before(std::size_t index) noexcept;

  /// While it runs, from any thread.
  [[nodiscard]] bool ended() const noexcept { return ended_.load(std::memory_order_acquire); }
  [[nodiscard]] std::uint64_t periods() const noexcept { return periods_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t misses() const noexcept { return misses_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t starved() const noexcept { return starved_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t overruns() const noexcept { return overruns_.load(std::memory_order_relaxed); }
  [[nodiscard]] bool held_for_reader() const noexcept { return behind_.load(std::memory_order_relaxed); }
  [[nodiscard]] PathInterpolator::State state() const noexcept { return state_.load(std::memory_order_relaxed); }
  /// After run() has returned.
  [[nodiscard]] const StreamReport& report() const noexcept { return report_; }

 private:
  void take_commands() noexcept;
  void hand_over(const Setpoint& setpoint) noexcept;

  PathInterpolator& path_;
  std::int64_t period_ns_;
  Ring<Setpoint> ring_;
  // Of the thread that runs.
  StreamReport report_;
  bool is_held_ = false;
  // Of the reader.
  alignas(64) std::size_t dropped_ = 0;
  // Of all.
  alignas(64) std::atomic<bool> held_{false};
  std::atomic<bool> behind_{false}, ended_{false};
  std::atomic<PathInterpolator::State> state_{PathInterpolator::State::waiting};
  std::atomic<std::uint64_t> periods_{0}, misses_{0}, starved_{0}, overruns_{0};
  std::atomic<std::uint32_t> news_{0};  ///< changes with every set-point and at the end
};

}  // namespace robomill::path
