#include "robomill/live/intake.hpp"

#include <algorithm>
#include <utility>

namespace robomill::live {

Intake::Intake(HopQueue& queue, std::size_t channels, std::size_t hop_frames, bool can_wait,
               std::function<void(std::uint64_t hops)> dropped)
    : queue_(&queue),
      channels_(channels),
      hop_samples_(hop_frames * channels),
      can_wait_(can_wait),
      dropped_(std::move(dropped)) {
  filling_.samples.reserve(hop_samples_);
}

bool Intake::add(std::span<const float> samples) {
  while (!samples.empty()) {
    const std::size_t count = std::min(samples.size(), hop_samples_ - filling_.samples.size());
    filling_.samples.insert(filling_.samples.end(), samples.begin(),
                            samples.begin() + static_cast<std::ptrdiff_t>(count));
    samples = samples.subspan(count);
    if (filling_.samples.size() == hop_samples_ && !hand_over()) return false;
  }
  return true;
}

bool Intake::gap(std::uint64_t frames, std::uint64_t most_filled) {
  if (frames > most_filled) {
    filling_.frames_before += frames + filling_.samples.size() / channels_;
    filling_.samples.clear();
    return true;
  }
  const std::vector<float> missing(frames * channels_, std::numeric_limits<float>::quiet_NaN());
  return add(missing);
}

void Intake::restart() {
  filling_.frames_before += filling_.samples.size() / channels_;
  filling_.samples.clear();
  filling_.restarted = true;
}

bool Intake::finish() {
  return filling_.samples.empty() || hand_over();
}

/// The next hop begins with the speed of this one.
bool Intake::hand_over() {
  Hop next;
  next.spindle_speed_rad_per_s = filling_.spindle_speed_rad_per_s;
  if (can_wait_) {
    const bool open = queue_->push(std::move(filling_));
    filling_ = std::move(next);
    filling_.samples.reserve(hop_samples_);
    return open;
  }
  const std::uint64_t frames = filling_.frames_before + filling_.samples.size() / channels_;
  const bool restarted = filling_.restarted;
  if (!queue_->offer(filling_)) {
    dropped_(1);
    next.frames_before = frames;
    next.dropped = true;
    next.restarted = restarted;
    next.samples = std::move(filling_.samples);
    next.samples.clear();
  }
  filling_ = std::move(next);
  filling_.samples.reserve(hop_samples_);
  return true;
}

}  // namespace robomill::live
