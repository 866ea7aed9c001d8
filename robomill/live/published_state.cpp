#include "robomill/live/published_state.hpp"

#include <utility>

namespace robomill::live {

void PublishedState::begin(bool overloaded) {
  const std::scoped_lock lock(mutex_);
  overloaded_ = overloaded;
  stall_.published = false;
  publishing_ = true;
  ++begun_;
}

void PublishedState::end() {
  const std::scoped_lock lock(mutex_);
  publishing_ = false;
}

bool PublishedState::begin_stall() {
  const std::scoped_lock lock(mutex_);
  stall_.was = true;
  if (std::exchange(overloaded_, true)) return false;
  stall_.published = true;
  begun_before_stall_ = publishing_ ? begun_ - 1 : begun_;
  return true;
}

void PublishedState::end_stall() {
  const std::scoped_lock lock(mutex_);
  if (begun_ != begun_before_stall_) doubt_ = true;
}

PublishedState::Stall PublishedState::take_stall() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(stall_, {});
}

bool PublishedState::take_doubt() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(doubt_, false);
}

}  // namespace robomill::live
