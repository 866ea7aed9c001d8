#include "robomill/live/record/state_log.hpp"

#include <algorithm>

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
  duration_s_[now_] += time_s - last_s_;
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

std::vector<StateTime> StateLog::times() const {
  std::vector<StateTime> out;
  for (const auto& [key, duration_s] : duration_s_) {
    if (duration_s > 0.0) out.push_back({.state = key.first, .reason = key.second, .duration_s = duration_s});
  }
  return out;
}

}  // namespace robomill::live
