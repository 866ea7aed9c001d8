#include "robomill/monitor/comb_cusum/synchronous_detector.hpp"

#include <algorithm>
#include <complex>

namespace robomill::monitor {
namespace {

constexpr double growth = 8.0;    // of its power against what was learnt, beyond that of tooth passing
constexpr double share = 0.25;    // of the whole power
constexpr double left_cut = 0.3;  // of tooth passing's power, below which the tool leaves
constexpr double over = 0.1;      // of its greatest power
constexpr double learns = 0.02, learns_first = 0.2;

double power_of(std::span<const Comb> combs, std::size_t k) {
  double power = 0.0;
  for (const Comb& comb : combs) power += 0.5 * std::norm(comb.amplitude(k));
  return power;
}

}  // namespace

SynchronousDetector::SynchronousDetector(std::size_t max_harmonics, int teeth)
    : teeth_(static_cast<std::size_t>(std::max(teeth, 0))), now_(max_harmonics), learnt_(max_harmonics) {}

void SynchronousDetector::reset() noexcept {
  std::fill(learnt_.begin(), learnt_.end(), 0.0);
  harmonic_ = standing_ = 0;
  greatest_ = 0.0;
}

SynchronousChatter SynchronousDetector::kind() const noexcept {
  return 2 * (harmonic_ % teeth_) == teeth_ ? SynchronousChatter::period_doubling : SynchronousChatter::locked;
}

bool SynchronousDetector::step(std::span<const Comb> combs, double power, bool known) noexcept {
  if (teeth_ < 2) return false;
  const std::size_t count = combs.front().harmonics();
  double cutting = 0.0;
  double cutting_learnt = 0.0;
  for (std::size_t k = 1; k <= count; ++k) {
    now_[k - 1] = power_of(combs, k);
    if (k % teeth_ != 0) continue;
    cutting += now_[k - 1];
    cutting_learnt += learnt_[k - 1];
  }
  const double grown = growth * std::max(1.0, cutting / std::max(1e-300, cutting_learnt));
  double most = 0.0;
  std::size_t at = 0;
  for (std::size_t k = 2; k <= count; ++k) {
    if (k % teeth_ != 0 && now_[k - 1] > grown * learnt_[k - 1] && now_[k - 1] > most) {
      most = now_[k - 1];
      at = k;
    }
  }
  standing_ = known && most > share * power && at == harmonic_ ? standing_ + 1 : 0;
  harmonic_ = at;
  if (standing_ == 0) {
    for (std::size_t k = 0; k < count; ++k) learnt_[k] += (known ? learns : learns_first) * (now_[k] - learnt_[k]);
  }
  if (standing_ < hops) return false;
  greatest_ = most;
  return cutting >= left_cut * cutting_learnt;
}

bool SynchronousDetector::falls(std::span<const Comb> combs) noexcept {
  const double power = power_of(combs, harmonic_);
  greatest_ = std::max(greatest_, power);
  return power < over * greatest_;
}

}  // namespace robomill::monitor
