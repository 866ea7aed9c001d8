#pragma once
#include <cstddef>
#include <vector>

#include "robomill/base/lanes.hpp"

namespace robomill::stability::detail {

/// The map of a state over one period, for eight points at once, without its matrix.
class PeriodMap {
 public:
  virtual ~PeriodMap() = default;
  /// Length of the state.
  [[nodiscard]] virtual std::size_t size() const = 0;
  /// Number of entries that belong to the modes, 2n; they come first: Re z_1, Im z_1, ….
  [[nodiscard]] virtual std::size_t modal_size() const = 0;
  /// out = state after one period. Lengths size(); they must not overlap.
  virtual void apply(const Lanes* in, Lanes* out) = 0;
  /// About how many multiplications that takes; 0: not known.
  [[nodiscard]] virtual double work() const { return 0.0; }
};

/// One that goes through the period in equal time steps.
class SteppedMap : public PeriodMap {
 public:
  /// The time steps that cut, and after apply the mean force during each of them [N]: x, y.
  [[nodiscard]] virtual const std::vector<int>& cut_steps() const = 0;
  [[nodiscard]] virtual const Lanes* force(std::size_t cut) const = 0;
};

}  // namespace robomill::stability::detail
