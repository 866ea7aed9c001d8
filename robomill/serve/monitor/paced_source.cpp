#include "robomill/serve/monitor/paced_source.hpp"

#include <utility>

namespace robomill::serve {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr Seconds shortest_wait(5e-3);  ///< a hop at fifty times its speed is half a millisecond
constexpr Seconds most_behind(0.25);

}  // namespace

PacedSource::PacedSource(std::unique_ptr<io::SampleSource> source, std::size_t channels, double frames_per_s,
                         std::stop_token stop)
    : source_(std::move(source)), channels_(channels), frames_per_s_(frames_per_s), stop_(std::move(stop)) {
  sample_rate_hz_ = source_->sample_rate_hz();
  full_scale_ = source_->full_scale();
  notes_ = source_->notes();
}

bool PacedSource::wait() {
  const Seconds ahead = Seconds(frames_ / frames_per_s_) - (Clock::now() - begin_);
  if (ahead < -most_behind) {
    begin_ = Clock::now();
    frames_ = 0.0;
  }
  if (ahead > shortest_wait) {
    std::unique_lock lock(waiting_);
    ended_.wait_for(lock, stop_, ahead, [] { return false; });
  }
  return !stop_.stop_requested();
}

bool PacedSource::next(std::size_t frames, io::SampleBlock& block) {
  if (!wait() || !source_->next(frames, block)) return false;
  const std::size_t frames_read = block.samples.size() / channels_;
  frames_ += static_cast<double>(frames_read);
  unreadable_rows_ = source_->unreadable_rows();
  first_unreadable_line_ = source_->first_unreadable_line();
  misaligned_frames_ = source_->misaligned_frames();
  return true;
}

}  // namespace robomill::serve
