#include "robomill/live/record/state_log.hpp"

#include <algorithm>
#include <utility>

namespace robomill::live {
namespace {

constexpr std::size_t most_stays = 2000;

}  // namespace

void StateLog::add(double time_s, monitor::State state, monitor::BlindReason reason) {
  const Key next = {state, state == monitor::State::blind ? reason : monitor::BlindReason::none};
  if (stays_.empty()) {
    stays_.push_back({.state = next.first, .reason = next.second, .from_s = 0.0, .to_s = 0.0});
    now_ = next;
  }
  time_s = std::max(time_s, last_s_);
  if (time_s > last_s_) duration_s_[now_] += std::max(0.0, time_s - last_s_ - std::exchange(silence_s_, 0.0));
  last_s_ = time_s;
  if (unlisted_ == 0) stays_.back().to_s = time_s;
  if (next == now_) return;
  now_ = next;
  if (stays_.size() < most_stays) {
    stays_.push_back({.state = next.first, .reason = next.second, .from_s = time_s, .to_s = time_s});
  } else {
    ++unlisted_;
  }
}

void StateLog::leave_out(double time_s, monitor::BlindReason reason) {
  add(time_s, monitor::State::blind, silence_s_ > 0.0 ? monitor::BlindReason::no_signal : reason);
}

void StateLog::silent(double time_s, double seconds) {
  add(time_s, monitor::State::blind, monitor::BlindReason::no_signal);
  duration_s_[now_] += seconds;
  silence_s_ += seconds;
}

std::vector<StateTime> StateLog::times() const {
  std::vector<StateTime> out;
  for (const auto& [key, duration_s] : duration_s_) {
    if (duration_s > 0.0) out.push_back({.state = key.first, .reason = key.second, .duration_s = duration_s});
  }
  return out;
}

}  // namespace robomill::live
