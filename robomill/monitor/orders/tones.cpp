#include "robomill/monitor/orders/tones.hpp"

#include <algorithm>

namespace robomill::monitor {
namespace {

constexpr double memory_s = 1.0, learning_s = 0.3;
constexpr double known_growth = 4.0;  // of the energy
constexpr std::size_t beside = 2;     // cells, to each side

}  // namespace

void Tones::learn(std::span<const double> energy) noexcept {
  ++learnt_;
  const double share = std::min(1.0, std::max(hop_s_ / memory_s, 1.0 / static_cast<double>(learnt_)));
  for (std::size_t i = 0; i < usual_.size(); ++i) usual_[i] += share * (energy[i] - usual_[i]);
}

bool Tones::stood(std::size_t cell, std::span<const double> energy) const noexcept {
  if (static_cast<double>(learnt_) * hop_s_ < learning_s) return false;
  double now = 0.0;
  double before = 0.0;
  for (std::size_t i = cell > beside ? cell - beside : 0; i < std::min(usual_.size(), cell + beside + 1); ++i) {
    now += energy[i];
    before += usual_[i];
  }
  return now < known_growth * before;
}

}  // namespace robomill::monitor
