#include <algorithm>
#include <array>
#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/cutting/workpiece.hpp"

namespace robomill::cutting {
namespace {

double widest(const Stock& stock) {
  double radius = stock.radius_m;
  if (stock.shape == Stock::Shape::turned) {
    radius = 0.0;
    for (const Eigen::Vector2d& point : stock.outline_m) radius = std::max(radius, point.x());
  }
  return radius;
}

void validate_box(const Stock& stock) {
  static constexpr std::array<const char*, 3> low = {"min_m[1]", "min_m[2]", "min_m[3]"};
  static constexpr std::array<const char*, 3> high = {"max_m[1]", "max_m[2]", "max_m[3]"};
  for (int i = 0; i < 3; ++i) {
    const auto name = static_cast<std::size_t>(i);
    require_finite(low[name], stock.min_m[i], "m");
    require_finite(high[name], stock.max_m[i], "m");
    if (!(stock.max_m[i] > stock.min_m[i])) {
      throw InvalidInput(high[name], stock.max_m[i], "m", "must be above the lowest corner");
    }
  }
}

void validate_outline(const std::vector<Eigen::Vector2d>& outline) {
  if (outline.size() < 2) throw InvalidInput("outline_m", "must hold two points (r, z) or more");
  double before = -1e300;
  for (const Eigen::Vector2d& point : outline) {
    require_non_negative("outline_m.r", point.x(), "m");
    require_finite("outline_m.z", point.y(), "m");
    if (point.y() < before) throw InvalidInput("outline_m.z", point.y(), "m", "must not fall from point to point");
    before = point.y();
  }
  if (!(outline.back().y() > outline.front().y())) {
    throw InvalidInput("outline_m.z", outline.back().y(), "m", "must rise from the first point to the last");
  }
}

}  // namespace

void Stock::validate() const {
  if (shape == Shape::box) {
    validate_box(*this);
    return;
  }
  require_finite("center_m[1]", center_m.x(), "m");
  require_finite("center_m[2]", center_m.y(), "m");
  if (shape == Shape::turned) {
    validate_outline(outline_m);
    if (!(widest(*this) > 0.0)) throw InvalidInput("outline_m.r", 0.0, "m", "must be > 0 somewhere");
    return;
  }
  require_positive("radius_m", radius_m, "m");
  require_finite("bottom_m", bottom_m, "m");
  require_finite("top_m", top_m, "m");
  if (!(top_m > bottom_m)) throw InvalidInput("top_m", top_m, "m", "must be above the bottom");
}

Eigen::Vector3d Stock::lowest_m() const {
  if (shape == Shape::box) return min_m;
  const double bottom = shape == Shape::turned ? outline_m.front().y() : bottom_m;
  return {center_m.x() - widest(*this), center_m.y() - widest(*this), bottom};
}

Eigen::Vector3d Stock::highest_m() const {
  if (shape == Shape::box) return max_m;
  const double top = shape == Shape::turned ? outline_m.back().y() : top_m;
  return {center_m.x() + widest(*this), center_m.y() + widest(*this), top};
}

}  // namespace robomill::cutting
