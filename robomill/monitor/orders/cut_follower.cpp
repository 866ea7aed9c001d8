#include "robomill/monitor/orders/cut_follower.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/monitor/orders/hops.hpp"

namespace robomill::monitor {
namespace {

constexpr double rings_s = 0.3;
constexpr double enters_by = 4.0;  // growth of the energy over the rings
constexpr double entry_s = 0.4;
constexpr double locks_at = 0.4;      // probability
constexpr double locks_share = 0.35;  // of the energy, in the comb
constexpr double follows = 0.1;       // a hop, of cut_
constexpr double leaves = 0.1;        // of cut_
constexpr double vanishes = 0.4;      // of S over the rings
constexpr double stays = 0.5;         // of cut_, of the whole, or of the whole before
constexpr double least_anchor = 0.1;  // of the whole, in S: less does not hold the speed
constexpr double unsettled_s = 1.0;
constexpr double loudest_memory_s = 10.0;
constexpr double idle = 0.03;           // of loudest_, in S
constexpr double steady_ratio = 0.008;  // of the speed, over the rings

}  // namespace

CutFollower::CutFollower(double hop_s)
    : hop_s_(hop_s),
      synchronous_(hops_of(rings_s, hop_s)),
      whole_(synchronous_.size()),
      rotation_hz_(synchronous_.size()) {}

void CutFollower::reset() noexcept {
  for (auto* ring : {&synchronous_, &whole_, &rotation_hz_}) std::ranges::fill(*ring, 0.0);
  at_ = entry_hops_ = unsettled_hops_ = 0;
  cut_ = loudest_ = 0.0;
  locked_ = false;
}

bool CutFollower::anchored(const ResidualFamily& now) const noexcept {
  return known() && now.synchronous > std::max(stays * cut_, least_anchor * now.whole);
}

double CutFollower::swing() const noexcept {
  const auto [least, most] = std::ranges::minmax_element(synchronous_);
  return *most - *least;
}

double CutFollower::speed_range() const noexcept {
  const auto [slowest, fastest] = std::ranges::minmax_element(rotation_hz_);
  return *fastest > 0.0 ? 1.0 - *slowest / *fastest : 1.0;
}

bool CutFollower::steady() const noexcept {
  return speed_range() < steady_ratio;
}

void CutFollower::chatter_ended() noexcept {
  unsettled_hops_ = hops_of(unsettled_s, hop_s_);
}

void CutFollower::step(const ResidualFamily& now, const SpeedPosterior& speed, bool chatter) noexcept {
  const double whole_before = whole_[at_];
  synchronous_[at_] = now.synchronous;
  whole_[at_] = now.whole;
  rotation_hz_[at_] = speed.rotation_hz();
  at_ = at_ + 1 == whole_.size() ? 0 : at_ + 1;
  if (now.whole > enters_by * whole_before && !chatter && !known()) {
    entry_hops_ = hops_of(entry_s, hop_s_);
  } else if (entry_hops_ > 0) {
    --entry_hops_;
  }
  if (unsettled_hops_ > 0) --unsettled_hops_;
  locked_ = speed.known() > locks_at && speed.share() > locks_share;
  const bool cuts = now.synchronous > idle * loudest_;
  if (locked_ && cuts && !chatter) cut_ = known() ? cut_ + follows * (now.synchronous - cut_) : now.synchronous;
  loudest_ = std::max(cut_, loudest_ * std::exp(-hop_s_ / loudest_memory_s));
  // Chatter may leave next to nothing of S, while it holds the whole.
  if ((chatter ? now.whole : now.synchronous) < leaves * cut_) cut_ = 0.0;
  if (known() && !chatter && now.synchronous < vanishes * *std::ranges::max_element(synchronous_) &&
      now.synchronous < stays * now.whole && now.whole > stays * whole_before) {
    cut_ = 0.0;
    unsettled_hops_ = hops_of(unsettled_s, hop_s_);
  }
}

}  // namespace robomill::monitor
