#include "robomill/monitor/orders/growth_test.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::monitor {
namespace {

constexpr std::size_t width = 5;  // cells that a line's energy is summed over
constexpr double suspect_growth = 3.0;
constexpr double least_share = 0.05;  // of the synchronous energy: what is smaller marks no part
constexpr double first_s = 0.4;       // that are learnt before anything is judged
constexpr double usual_memory_s = 1.0, suspect_memory_s = 5.0;

constexpr double family_memory_s = 2.0;
constexpr double slower = 0.2;        // is what has grown learnt
constexpr double least_weight = 0.1;  // 0.2 s

}  // namespace

std::size_t GrowthTest::cells(double highest_hz) noexcept {
  return static_cast<std::size_t>(highest_hz / cell_hz) + width;
}

GrowthTest::GrowthTest(double highest_hz, double hop_s)
    : hop_s_(hop_s), cells_(cells(highest_hz)), usual_(cells_.size()) {}

std::span<double> GrowthTest::begin() noexcept {
  std::ranges::fill(cells_, 0.0);
  return cells_;
}

GrowthTest::Verdict GrowthTest::step(double synchronous) noexcept {
  Verdict out;
  synchronous_ = synchronous;
  suspect_ = false;
  if (static_cast<double>(learnt_) * hop_s_ < first_s) return out;
  const double cut = std::max(1.0, synchronous / (usual_synchronous_ + 1e-300));
  std::size_t from = 0;
  for (std::size_t i = 0; i + width <= cells_.size(); ++i) {
    double now = 0.0;
    double before = 0.0;
    for (std::size_t j = i; j < i + width; ++j) {
      now += cells_[j];
      before += usual_[j];
    }
    // A line that moved stands in some window without its past: only one that stands in the middle counts.
    if (*std::max_element(cells_.begin() + static_cast<std::ptrdiff_t>(i),
                          cells_.begin() + static_cast<std::ptrdiff_t>(i + width)) > cells_[i + width / 2]) {
      continue;
    }
    const double grown = now / (cut * before + 1e-300);
    if (now <= 0.0 || now < least_share * synchronous || grown < suspect_growth) continue;
    suspect_ = true;
    const bool clear = grown > least_growth;
    if (clear == (out.growth > least_growth) ? now > out.energy : clear) {
      out = {.energy = now, .growth = grown};
      from = i;
    }
  }
  if (out.energy > 0.0) {
    const auto first = cells_.begin() + static_cast<std::ptrdiff_t>(from);
    const auto most = std::max_element(first, first + width);
    out.frequency_hz = (static_cast<double>(most - cells_.begin()) + 0.5) * cell_hz;
  }
  return out;
}

void GrowthTest::learn() noexcept {
  const double memory = suspect_ ? suspect_memory_s : usual_memory_s;
  const double share =
      std::min(1.0, std::max(hop_s_ / memory, suspect_ ? 0.0 : 1.0 / static_cast<double>(learnt_ + 1)));
  for (std::size_t i = 0; i < cells_.size(); ++i) usual_[i] += share * (cells_[i] - usual_[i]);
  usual_synchronous_ += share * (synchronous_ - usual_synchronous_);
  ++learnt_;
}

double FamilyPast::growth(double family) const noexcept {
  return weight_ > least_weight ? family * weight_ / (sum_ + 1e-300) : 0.0;
}

void FamilyPast::learn(double family) noexcept {
  const double share = std::min(1.0, hop_s_ / family_memory_s) * (growth(family) >= family_growth ? slower : 1.0);
  sum_ += share * (family - sum_);
  weight_ += share * (1.0 - weight_);
}

}  // namespace robomill::monitor
