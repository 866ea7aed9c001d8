#include "robomill/jobs/sweep/grid_values.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace robomill::jobs {
namespace {

/// Of a sum of four values, in the size of its terms.
constexpr double rounding = 8.0 * std::numeric_limits<double>::epsilon();

}  // namespace

std::size_t GridValues::axes_between(std::uint64_t point, std::uint64_t step) const {
  std::size_t out = 0;
  for (std::size_t axis = 0; axis < grid_.axes(); ++axis) out += grid_.place(point, axis) / step % 2 == 1 ? 1 : 0;
  return out;
}

const GridValue* GridValues::finite(std::uint64_t point) const {
  const auto found = values_.find(point);
  return found == values_.end() || !std::isfinite(found->second.value) ? nullptr : &found->second;
}

std::optional<GridValue> GridValues::interpolated(std::uint64_t point, std::uint64_t step) const {
  std::optional<GridValue> out;
  for (std::size_t axis = 0; axis < grid_.axes(); ++axis) {
    if (grid_.place(point, axis) / step % 2 == 0) continue;
    const std::optional<GridValue> one = along(point, step, axis);
    if (one && (!out || one->error < out->error)) out = one;
  }
  return out;
}

std::optional<GridValue> GridValues::along(std::uint64_t point, std::uint64_t step, std::size_t axis) const {
  const std::uint64_t away = step * grid_.stride(axis), place = grid_.place(point, axis);
  const GridValue *less = finite(point - away), *more = finite(point + away);
  if (less == nullptr || more == nullptr) return std::nullopt;
  const GridValue* before = place >= 3 * step ? finite(point - 3 * away) : nullptr;
  const GridValue* after = place + 3 * step < grid_.count(axis) ? finite(point + 3 * away) : nullptr;
  if (before == nullptr && after == nullptr) return std::nullopt;
  const double near = less->value + more->value, near_error = less->error + more->error;
  if (before != nullptr && after != nullptr) {
    const double bend = std::max(std::abs(before->value - 2.0 * less->value + more->value),
                                 std::abs(less->value - 2.0 * more->value + after->value));
    const double size = std::abs(near) + std::abs(before->value) + std::abs(after->value);
    return GridValue{.value = (9.0 * near - before->value - after->value) / 16.0,
                     .error = bend + (9.0 * near_error + before->error + after->error) / 16.0 + rounding * size};
  }
  if (before != nullptr) {
    std::swap(less, more);
    after = before;
  }
  const double bend = std::abs(less->value - 2.0 * more->value + after->value);
  const double size = std::abs(near) + std::abs(after->value);
  return GridValue{.value = (3.0 * less->value + 6.0 * more->value - after->value) / 8.0,
                   .error = bend + (3.0 * less->error + 6.0 * more->error + after->error) / 8.0 + rounding * size};
}

}  // namespace robomill::jobs
