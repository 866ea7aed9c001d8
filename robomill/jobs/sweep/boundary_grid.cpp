#include "robomill/jobs/sweep/boundary_grid.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "robomill/base/error.hpp"

namespace robomill::jobs {
namespace {

constexpr std::size_t most_axes = 8;
constexpr int most_halvings = 20;
/// An edge has a number of its own: that of its point, and its axis.
constexpr double most_grid_points = 9.0e18 / most_axes;

}  // namespace

void BoundaryOptions::validate() const {
  if (axes.empty() || axes.size() > most_axes) {
    throw InvalidInput("axes", static_cast<double>(axes.size()), "", fmt::format("must be 1 to {}", most_axes));
  }
  if (halvings < 0 || halvings > most_halvings) {
    throw InvalidInput("halvings", halvings, "", fmt::format("must lie between 0 and {}", most_halvings));
  }
  double coarse = 1.0, finest = 1.0;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const std::string member = fmt::format("axes[{}]", i);
    const BoundaryAxis& axis = axes[i];
    if (!std::isfinite(axis.low) || !std::isfinite(axis.high) || !(axis.low < axis.high)) {
      throw InvalidInput(member, "must have a range that rises");
    }
    if (axis.count < 2) throw InvalidInput(member + ".count", axis.count, "", "must be >= 2");
    coarse *= axis.count;
    finest *= std::ldexp(axis.count - 1.0, halvings) + 1.0;
  }
  if (coarse > static_cast<double>(most_points)) {
    throw InvalidInput("most_points", static_cast<double>(most_points), "points",
                       fmt::format("must be at least the {} of the coarse grid", coarse));
  }
  if (finest > most_grid_points) {
    throw InvalidInput("halvings", halvings, "",
                       fmt::format("must leave the finest grid below {:.0e} points", most_grid_points));
  }
}

BoundaryGrid::BoundaryGrid(const BoundaryOptions& options) : axes_(options.axes) {
  options.validate();
  for (const BoundaryAxis& axis : axes_) {
    counts_.push_back((static_cast<std::uint64_t>(axis.count - 1) << static_cast<unsigned>(options.halvings)) + 1);
  }
  strides_.assign(axes_.size(), 1);
  for (std::size_t i = axes_.size() - 1; i > 0; --i) strides_[i - 1] = strides_[i] * counts_[i];
}

double BoundaryGrid::at(std::size_t axis, double place) const {
  const BoundaryAxis& one = axes_[axis];
  const double share = place / static_cast<double>(counts_[axis] - 1);
  return share >= 1.0 ? one.high : one.low + (one.high - one.low) * share;
}

double BoundaryGrid::points_of(std::uint64_t step) const {
  double out = 1.0;
  for (const std::uint64_t count : counts_) {
    const std::uint64_t places = (count - 1) / step + 1;
    out *= static_cast<double>(places);
  }
  return out;
}

}  // namespace robomill::jobs
