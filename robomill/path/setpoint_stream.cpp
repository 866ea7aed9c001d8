#include "robomill/path/setpoint_stream.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <ctime>

#include "robomill/base/error.hpp"

namespace robomill::path {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000, millisecond_ns = 1'000'000, microsecond_ns = 1'000;
constexpr std::size_t least_ring = 64;
/// Of the ring: from where on a reader's delay holds the motion, and where it goes on.
constexpr std::size_t hold_part = 2, go_on_part = 8;

void count(std::atomic<std::uint64_t>& shown, std::uint64_t& counter) noexcept {
  shown.store(++counter, std::memory_order_relaxed);
}

}  // namespace

std::int64_t MonotonicClock::now_ns() noexcept {
  timespec now = {};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::int64_t>(now.tv_sec) * second_ns + now.tv_nsec;
}

void MonotonicClock::sleep_until(std::int64_t time_ns) noexcept {
  timespec until = {};
  until.tv_sec = static_cast<time_t>(time_ns / second_ns);
  until.tv_nsec = static_cast<long>(time_ns % second_ns);
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

void StreamOptions::validate() const {
  if (!(period_s >= 1e-5 && period_s <= 0.1)) {
    throw InvalidInput("period_s", period_s, "s", "must be between 1e-5 and 0.1");
  }
  if (!(ring_s > 0.0 && ring_s <= 60.0)) throw InvalidInput("ring_s", ring_s, "s", "must be > 0 and <= 60");
}

void DelayStatistics::add(std::int64_t delay_ns) noexcept {
  const std::int64_t delay = std::max<std::int64_t>(delay_ns, 0);
  const auto us = static_cast<std::size_t>(delay / microsecond_ns);
  ++bins_[us < fine ? us : std::min(fine + us / 1000 - 1, bins_.size() - 1)];
  ++count_;
  sum_ns_ += delay;
  max_ns_ = std::max(max_ns_, delay);
}

double DelayStatistics::mean_s() const noexcept {
  return count_ > 0 ? 1e-9 * static_cast<double>(sum_ns_) / static_cast<double>(count_) : 0.0;
}

double DelayStatistics::quantile_s(double share) const noexcept {
  const double wanted = share * static_cast<double>(count_);
  std::uint64_t below = 0;
  for (std::size_t i = 0; i + 1 < bins_.size(); ++i) {
    below += bins_[i];
    if (below == 0 || static_cast<double>(below) < wanted) continue;
    const std::int64_t end_ns = i < fine ? static_cast<std::int64_t>(i + 1) * microsecond_ns
                                         : static_cast<std::int64_t>(i - fine + 2) * millisecond_ns;
    return 1e-9 * static_cast<double>(std::min(end_ns, max_ns_));
  }
  return max_s();
}

SetpointStream::SetpointStream(PathInterpolator& path, const StreamOptions& options)
    : path_(path), period_ns_(0), ring_([&options] {
        options.validate();
        return std::max(least_ring, static_cast<std::size_t>(std::ceil(options.ring_s / options.period_s)));
      }()) {
  report_.period_s = options.period_s;
  period_ns_ = static_cast<std::int64_t>(std::llround(1e9 * options.period_s));
}

void SetpointStream::take_commands() noexcept {
  const std::size_t behind = ring_.capacity() - ring_.room();
  const bool was = behind_.load(std::memory_order_relaxed);
  const bool is = behind > ring_.capacity() / (was ? go_on_part : hold_part);
  if (is != was) behind_.store(is, std::memory_order_relaxed);
  if (is && !was) ++report_.reader_holds;
  const bool hold = is || held_.load(std::memory_order_relaxed);
  if (hold == is_held_) return;
  is_held_ = hold;
  if (hold) {
    path_.hold();
  } else {
    path_.resume();
  }
}

void SetpointStream::hand_over(const Setpoint& setpoint) noexcept {
  if (ring_.room() == 0) {
    count(overruns_, report_.overruns);
    if (setpoint.state == PathInterpolator::State::running) ++report_.overruns_in_motion;
    return;
  }
  ring_.put(setpoint);
  ring_.publish();
  news_.fetch_add(1, std::memory_order_release);
  news_.notify_one();
}

void SetpointStream::run(StreamClock& clock) noexcept {
  using State = PathInterpolator::State;
  std::int64_t start_ns = clock.now_ns();
  const auto longest_lag_ns = static_cast<std::int64_t>(longest_lag_periods * static_cast<double>(period_ns_));
  for (std::uint64_t n = 0;; ++n) {
    // From the first one, so that a period that is no whole number of nanoseconds does not add up.
    const std::int64_t due_ns =
        start_ns + static_cast<std::int64_t>(std::llround(1e9 * report_.period_s * static_cast<double>(n)));
    clock.sleep_until(due_ns);
    const std::int64_t delay_ns = clock.now_ns() - due_ns;
    report_.wake_up.add(delay_ns);
    if (delay_ns > longest_lag_ns) {
      ++report_.shifts;
      report_.shifted_s += 1e-9 * static_cast<double>(delay_ns);
      start_ns += delay_ns;
    }
    take_commands();
    Setpoint setpoint;
    setpoint.due_ns = due_ns;
    setpoint.state = path_.next(setpoint.sample);
    setpoint.feed_override = path_.feed_override();
    if (path_.starved()) count(starved_, report_.starved);
    state_.store(setpoint.state, std::memory_order_relaxed);
    hand_over(setpoint);
    const std::int64_t handed_ns = clock.now_ns() - due_ns;
    report_.hand_over.add(handed_ns);
    if (handed_ns > period_ns_) count(misses_, report_.misses);
    count(periods_, report_.periods);
    report_.state = setpoint.state;
    if (setpoint.state == State::finished || setpoint.state == State::stopped) break;
  }
  ended_.store(true, std::memory_order_release);
  news_.fetch_add(1, std::memory_order_release);
  news_.notify_one();
}

bool SetpointStream::wait() noexcept {
  for (;;) {
    const std::uint32_t seen = news_.load(std::memory_order_acquire);
    const bool last = ended();  // before the ring is looked at: nothing is put after it
    if (ring_.end() > dropped_) return true;
    if (last) return false;
    news_.wait(seen, std::memory_order_acquire);
  }
}

void SetpointStream::drop_before(std::size_t index) noexcept {
  dropped_ = index;
  ring_.drop_before(index);
}

}  // namespace robomill::path
