#include "robomill/monitor/learning/calm_cells.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::monitor {
namespace {

constexpr double lowest_octave = -50.0, bins_an_octave = 2.0;
constexpr std::size_t bins = 180;
constexpr double exceeding = 0.01;  // of the hops

void sum_counts(const std::vector<std::uint32_t>& from, std::vector<std::uint32_t>& to) {
  if (to.empty()) to.resize(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) to[i] += from[i];
}

}  // namespace

double rounded(double value) {
  if (!(value > 0.0)) return 0.0;
  const double unit = std::pow(10.0, 3.0 - std::floor(std::log10(value)));
  return std::round(value * unit) / unit;
}

void CalmCells::count(std::span<const double> energies, Counts& counts) const {
  if (energies.empty()) return;
  counts.resize(cells_ * bins);
  for (std::size_t i = 0; i < cells_; ++i) {
    const double place = energies[i] > 0.0 ? bins_an_octave * (std::log2(energies[i]) - lowest_octave) : 0.0;
    ++counts[i * bins + static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(bins - 1)))];
  }
}

void CalmCells::add(double rotation_hz, std::span<const double> all, std::span<const double> beside) {
  count(all, all_);
  count(beside, beside_);
  ++hops_;
  rotation_sum_ += rotation_hz;
}

void CalmCells::add(const CalmCells& other) {
  add_unknown(other);
  sum_counts(other.beside_, beside_);
  rotation_sum_ += other.rotation_sum_;
}

void CalmCells::add_unknown(const CalmCells& other) {
  sum_counts(other.all_, all_);
  hops_ += other.hops_;
}

std::vector<double> CalmCells::exceeded(const Counts& counts) const {
  std::vector<double> out;
  if (counts.empty()) return out;
  out.resize(cells_);
  const double most = exceeding * hops_;  // hops above
  for (std::size_t i = 0; i < cells_; ++i) {
    double above = 0.0;
    std::size_t bin = bins;
    double here = 0.0;
    while (bin > 1) {
      here = counts[i * bins + --bin];
      if (above + here > most) break;
      above += here;
    }
    // The lowest bin holds what is nothing.
    if (bin <= 1 && above + here <= most) continue;
    const double part = std::clamp(1.0 - (most - above) / here, 0.0, 1.0);
    out[i] = rounded(std::exp2(lowest_octave + (static_cast<double>(bin) + part) / bins_an_octave));
  }
  return out;
}

LearntRow CalmCells::exceeded() const {
  return {.rotation_hz = rounded(rotation_hz()), .hops = hops_, .beside = exceeded(beside_), .all = exceeded(all_)};
}

}  // namespace robomill::monitor
