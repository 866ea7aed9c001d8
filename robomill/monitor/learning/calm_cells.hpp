#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "robomill/monitor/machine.hpp"

namespace robomill::monitor {

/// 4 significant digits, so that a document holds it as it is.
[[nodiscard]] double rounded(double value);

/// Counts how often energies were seen in cells, at one speed: half octaves from 2^-50 to 2^40.
class CalmCells {
 public:
  explicit CalmCells(std::size_t cells) : cells_(cells) {}
  /// A hop. @param beside  empty: not known
  void add(double rotation_hz, std::span<const double> all, std::span<const double> beside);
  void add(const CalmCells& other);
  /// The hops of another one, whose speed is forgotten.
  void add_unknown(const CalmCells& other);
  [[nodiscard]] int hops() const { return hops_; }
  [[nodiscard]] double rotation_hz() const { return hops_ > 0 ? rotation_sum_ / hops_ : 0.0; }
  /// Of each cell the energy that one hop in a hundred exceeds.
  [[nodiscard]] LearntRow exceeded() const;

 private:
  using Counts = std::vector<std::uint32_t>;  // of each cell, by half octave; empty: nothing was added
  void count(std::span<const double> energies, Counts& counts) const;
  [[nodiscard]] std::vector<double> exceeded(const Counts& counts) const;

  std::size_t cells_;
  Counts all_, beside_;
  int hops_ = 0;
  double rotation_sum_ = 0.0;
};

}  // namespace robomill::monitor
