#include "robomill/monitor/orders/cut_state.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/monitor/orders/hops.hpp"
#include "robomill/monitor/orders/thresholds.hpp"

namespace robomill::monitor {
namespace {

constexpr double leaving_s = 0.4, swing_s = 0.3, speed_s = 0.3, entry_s = 0.4;
constexpr double quiet_memory_s = 10.0;
constexpr double above_air = 4.0;     // of the quietest energy: the tool cuts
constexpr double enters_by = 4.0;     // growth of the energy within swing_s …
constexpr double of_entry = 0.5;      // of that growth, at tooth passing
constexpr double least_anchor = 0.2;  // of all energy, in the multiples of rotation
constexpr double least_comb = 0.12;   // SpeedTracker::seen: the lines are there, however little energy they hold
constexpr double keeps = 0.5, follows = 0.1;  // of them, where they held that before; a hop
// A comb that was found: in air one of the machine may be, which the cut hides.
constexpr double least_of_found = 0.01;  // of all energy
constexpr double learnt_at = 0.03;       // of the speed
constexpr double enters_above = 2.0;     // … to so much of the quietest

}  // namespace

CutState::CutState(double hop_s, double quiet)
    : hop_s_(hop_s),
      first_quiet_(quiet),
      energy_(hops_of(leaving_s, hop_s) + 1),
      teeth_(energy_.size()),
      short_synchronous_(hops_of(swing_s, hop_s)),
      rotation_hz_(hops_of(speed_s, hop_s)) {
  reset();
}

void CutState::reset() noexcept {
  for (auto* ring : {&energy_, &teeth_, &short_synchronous_, &rotation_hz_}) std::ranges::fill(*ring, 0.0);
  hops_ = 0;
  since_entry_ = hops_of(entry_s, hop_s_);
  usual_synchronous_ = usual_hz_ = 0.0;
  quiet_ = first_quiet_;
  now_ = {};
}

void CutState::step(const Measured& now, bool chatter) noexcept {
  now_ = now;
  const std::size_t back = hops_of(swing_s, hop_s_);
  const std::size_t then = (hops_ + energy_.size() - back) % energy_.size();
  const double before = energy_[then];
  const double teeth_before = teeth_[then];
  const bool seen = hops_ >= back;
  energy_[hops_ % energy_.size()] = now.energy;
  teeth_[hops_ % energy_.size()] = now.teeth;
  short_synchronous_[hops_ % short_synchronous_.size()] = now.short_synchronous;
  rotation_hz_[hops_ % rotation_hz_.size()] = now.rotation_hz;
  ++hops_;
  if (now.full) {
    const double forgotten = chatter ? 1.0 : std::exp(hop_s_ / quiet_memory_s);  // chatter does not become the calm
    quiet_ = quiet_ == 0.0 ? now.energy : std::min(now.energy, quiet_ * forgotten);
  }
  // What the tool brings with it stands at tooth passing; what chatter brings does not.
  const bool enters = seen && !chatter && now.energy > enters_by * before && now.energy > enters_above * quiet_ &&
                      now.teeth * before > of_entry * now.energy * teeth_before;
  if (enters && since_entry_ >= hops_of(entry_s, hop_s_)) {
    since_entry_ = 0;
    usual_synchronous_ = 0.0;
  } else {
    ++since_entry_;
  }
  // Of another speed than that it was learnt at it says nothing.
  if (std::abs(now.rotation_hz - usual_hz_) > learnt_at * usual_hz_) usual_synchronous_ = 0.0;
  if (!chatter && synchronous_share() >= least_anchor && cutting() >= 1.0) {
    usual_hz_ = now.rotation_hz;
    usual_synchronous_ += (usual_synchronous_ == 0.0 ? 1.0 : follows) * (now.synchronous - usual_synchronous_);
  }
}

double CutState::anchored() const noexcept {
  const double of_whole = synchronous_share() / least_anchor;
  if (!now_.given && synchronous_share() < least_of_found) return of_whole;
  const double of_lines = now_.comb / least_comb;
  if (usual_synchronous_ <= 0.0) return std::max(of_whole, of_lines);
  const bool both = now_.synchronous + now_.family >= thresholds::explains * now_.whole || of_lines >= 1.0;
  return both ? std::max(of_whole, now_.synchronous / (keeps * usual_synchronous_)) : of_whole;
}

double CutState::above_quiet() const noexcept {
  return quiet_ > 0.0 ? now_.energy / quiet_ : 1.0;
}

double CutState::synchronous_share() const noexcept {
  return now_.whole > 0.0 ? now_.synchronous / now_.whole : 0.0;
}

double CutState::cutting() const noexcept {
  return std::max(above_quiet() / above_air, synchronous_share() / thresholds::explains);
}

double CutState::staying() const noexcept {
  const double most = *std::ranges::max_element(energy_);
  return most > 0.0 ? now_.energy / most : 1.0;
}

double CutState::entered_s() const noexcept {
  return static_cast<double>(since_entry_) * hop_s_;
}

double CutState::swing() const noexcept {
  const auto seen = std::min(hops_, short_synchronous_.size());
  if (seen == 0) return 0.0;
  const auto end = short_synchronous_.begin() + static_cast<std::ptrdiff_t>(seen);
  const auto [least, most] = std::minmax_element(short_synchronous_.begin(), end);
  return *most - *least;
}

double CutState::speed_change() const noexcept {
  const auto [slowest, fastest] = std::ranges::minmax_element(rotation_hz_);
  return *fastest > 0.0 ? (*fastest - *slowest) / *fastest : 1.0;
}

}  // namespace robomill::monitor
