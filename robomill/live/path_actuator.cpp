#include "robomill/live/path_actuator.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::live {

bool PathActuator::apply(const Command& command) noexcept {
  using Kind = Command::Kind;
  if (command.kind == Kind::none) return true;
  if (command.kind == Kind::hold) {
    if (retract_ == nullptr || !(command.retract_m > 0.0)) return false;
    hold_m_.store(command.retract_m);
    return true;
  }
  const bool follows = command.kind == Kind::spindle_speed && !command.feed_first;
  feed_.store({.share = static_cast<float>(command.feed_override),
               .with_rad_per_s = follows ? static_cast<float>(command.spindle_speed_rad_per_s) : 0.0F});
  return true;
}

path::PathInterpolator::State PathActuator::next(path::Sample& sample) noexcept {
  const Feed feed = feed_.load();
  const double measured = measured_rad_per_s_.load(), with = static_cast<double>(feed.with_rad_per_s);
  if (with == 0.0) {
    share_ = static_cast<double>(feed.share);
  } else if (measured > 0.0) {
    share_ = static_cast<double>(feed.share) * std::min(1.0, measured / with);
  }
  path_.set_override(operator_share_.load() * share_);
  const double hold_m = hold_m_.load();
  // Again each time: whoever resumes the path itself must not run it beside the cut.
  if (hold_m > 0.0) path_.hold();
  if (hold_m == 0.0 && held_) {
    path_.resume();
    retracted_ = false;
  }
  held_ = hold_m > 0.0;
  using State = path::PathInterpolator::State;
  const State state = path_.next(sample);
  if (held_ && !retracted_ && state != State::running && state != State::finished) {
    retracted_ = true;
    retract_->retract(hold_m);
  }
  return state;
}

void PathActuator::set_operator_override(double share) noexcept {
  if (!std::isnan(share)) operator_share_.store(std::max(0.0, share));
}

void PathActuator::set_spindle_speed(double rad_per_s) noexcept {
  measured_rad_per_s_.store(rad_per_s);
}

void PathActuator::resume() noexcept {
  hold_m_.store(0.0);
}

}  // namespace robomill::live
