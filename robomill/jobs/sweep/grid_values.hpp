#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "robomill/jobs/sweep/boundary_grid.hpp"

// Method: robomill/jobs/README.md, "A boundary (`sweep/boundary.hpp`)"

namespace robomill::jobs {

struct GridValue {
  double value = 0.0;  ///< in any unit; NaN: the function has none
  double error = 0.0;  ///< estimated, >= 0; 0: it was evaluated
};

/// What is known of a function at points of a grid.
class GridValues {
 public:
  explicit GridValues(const BoundaryGrid& grid) : grid_(grid) {}

  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] bool has(std::uint64_t point) const { return values_.contains(point); }
  /// Of a point that it has.
  [[nodiscard]] double at(std::uint64_t point) const { return value(point).value; }
  [[nodiscard]] const GridValue& value(std::uint64_t point) const { return values_.at(point); }
  void set(std::uint64_t point, const GridValue& value) { values_[point] = value; }

  /// Along how many axes a point lies between those of the grid with steps of 2 `step`.
  [[nodiscard]] std::size_t axes_between(std::uint64_t point, std::uint64_t step) const;

  /// From points one and three steps away, along each of the axes on which the point lies between those of the grid
  /// with steps of 2 `step`: the cubic through four values, or the parabola through three where a far one is not known.
  /// Its estimated error is the second difference |f(-3) - 2 f(-1) + f(1)| or |f(-1) - 2 f(1) + f(3)|, the larger of
  /// both where both are known, plus the errors of the values times their weights, and rounding. Of several axes that
  /// with the least error counts.
  ///
  /// Of a line with one kink or one step the true error is at most 1/2 of the estimate by the cubic, 5/8 by the
  /// parabola; a kink and a step at one place can cancel in the parabola's.
  /// @returns none where too few points are known, or not finite, along each axis
  [[nodiscard]] std::optional<GridValue> interpolated(std::uint64_t point, std::uint64_t step) const;

 private:
  [[nodiscard]] std::optional<GridValue> along(std::uint64_t point, std::uint64_t step, std::size_t axis) const;
  [[nodiscard]] const GridValue* finite(std::uint64_t point) const;

  const BoundaryGrid& grid_;
  std::unordered_map<std::uint64_t, GridValue, GridPointHash> values_ = {};
};

}  // namespace robomill::jobs
