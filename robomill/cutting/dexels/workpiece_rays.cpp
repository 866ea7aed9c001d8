#include "robomill/cutting/dexels/workpiece_rays.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace robomill::cutting {
namespace {

constexpr double sliver_m = 1e-9;  ///< a thinner rest is rounding, not material

/// Between two rays, the parabola less the chord; of the parabolas through the ray before them and through the one
/// behind, the flatter: where they bend apart, at a corner of the material, there is none.
template <class Depth>
double bend_between(double share, std::ptrdiff_t first, std::ptrdiff_t count, Depth&& depth_of) {
  if (first < 1 || first + 2 >= count) return 0.0;
  const std::array<double, 4> d = {depth_of(first - 1), depth_of(first), depth_of(first + 1), depth_of(first + 2)};
  const double before = d[0] - 2.0 * d[1] + d[2];
  const double behind = d[1] - 2.0 * d[2] + d[3];
  if (before * behind <= 0.0) return 0.0;
  const double least = std::abs(before) < std::abs(behind) ? before : behind;
  return -0.5 * share * (1.0 - share) * least;
}

}  // namespace

Rays::Rays(int axis, const Eigen::Vector3d& lowest, const Eigen::Vector3d& spacing,
           const Eigen::Array<std::ptrdiff_t, 3, 1>& cells)
    : axis_(axis),
      lowest_(lowest),
      spacing_(spacing),
      columns_(cells[column_axis()]),
      rows_(cells[row_axis()]),
      rays_(static_cast<std::size_t>(columns_ * rows_)),
      pools_(static_cast<std::size_t>(rows_)) {}

Eigen::Vector3d Rays::point(std::ptrdiff_t row, std::ptrdiff_t column) const {
  Eigen::Vector3d out = Eigen::Vector3d::Zero();
  const int c = column_axis();
  const int r = row_axis();
  out[c] = lowest_[c] + (static_cast<double>(column) + 0.5) * spacing_[c];
  out[r] = lowest_[r] + (static_cast<double>(row) + 0.5) * spacing_[r];
  return out;
}

Rays::Range Rays::cells_in(const Span& span, int axis, std::ptrdiff_t count) const {
  if (!(span.from <= span.to)) return {};
  const double most = static_cast<double>(count);
  const double first = std::ceil((span.from - lowest_[axis]) / spacing_[axis] - 0.5 - 1e-9);
  const double last = std::floor((span.to - lowest_[axis]) / spacing_[axis] - 0.5 + 1e-9);
  return {.first = static_cast<std::ptrdiff_t>(std::clamp(first, 0.0, most)),
          .last = static_cast<std::ptrdiff_t>(std::clamp(last, -1.0, most - 1.0))};
}

std::uint32_t Rays::take(Pool& pool, const Ray& node) {
  if (pool.free == nil) {
    pool.nodes.push_back(node);
    return static_cast<std::uint32_t>(pool.nodes.size() - 1);
  }
  const std::uint32_t slot = pool.free;
  pool.free = pool.nodes[slot].next;
  pool.nodes[slot] = node;
  return slot;
}

void Rays::add(std::ptrdiff_t row, std::ptrdiff_t column, const Span& span) {
  if (!(span.to - span.from > sliver_m)) return;
  Ray& first = rays_[index(row, column)];
  if (!(first.from < first.to)) {
    first.from = span.from;
    first.to = span.to;
    return;
  }
  Pool& pool = pools_[static_cast<std::size_t>(row)];
  const std::uint32_t slot = take(pool, {.from = span.from, .to = span.to, .next = nil});
  std::uint32_t* link = &first.next;
  while (*link != nil) link = &pool.nodes[*link].next;
  *link = slot;
}

bool Rays::touches(std::ptrdiff_t row, std::ptrdiff_t column, const Span& span) const {
  const Ray* ray = &rays_[index(row, column)];
  const Pool& pool = pools_[static_cast<std::size_t>(row)];
  while (true) {
    if (span.from < ray->to && span.to > ray->from && ray->from < ray->to) return true;
    if (ray->next == nil || span.to <= ray->from) return false;
    ray = &pool.nodes[ray->next];
  }
}

double Rays::cut(std::ptrdiff_t row, std::ptrdiff_t column, const Span& span, std::vector<Span>& cut) {
  cut.clear();
  if (!touches(row, column, span)) return 0.0;
  Ray& first = rays_[index(row, column)];
  Pool& pool = pools_[static_cast<std::size_t>(row)];
  double length = 0.0;
  // What stays is written over the ray from its beginning; a span leaves at most one interval more than it found.
  std::uint32_t reading = first.next;
  Ray held = first;
  first = {};
  std::uint32_t last = nil;  // node written last; nil: the ray's own interval
  bool empty = true;
  const auto keep = [&](double from, double to) {
    if (!(to - from > sliver_m)) return;
    if (empty) {
      first = {.from = from, .to = to, .next = nil};
      empty = false;
      return;
    }
    const std::uint32_t slot = take(pool, {.from = from, .to = to, .next = nil});
    (last == nil ? first.next : pool.nodes[last].next) = slot;
    last = slot;
  };
  while (true) {
    const Span taken = {.from = std::max(held.from, span.from), .to = std::min(held.to, span.to)};
    if (taken.empty()) {
      keep(held.from, held.to);
    } else {
      keep(held.from, taken.from);
      keep(taken.to, held.to);
      cut.push_back(taken);
      length += taken.to - taken.from;
    }
    if (reading == nil) return length;
    held = pool.nodes[reading];
    pool.nodes[reading].next = pool.free;
    pool.free = reading;
    reading = held.next;
  }
}

double Rays::depth(std::ptrdiff_t row, std::ptrdiff_t column, double at, double limit) const {
  const Ray* ray = &rays_[index(row, column)];
  if (!(ray->from < ray->to)) return -limit;
  const Pool& pool = pools_[static_cast<std::size_t>(row)];
  double outside = limit;
  while (true) {
    if (at < ray->from) return -std::min(outside, ray->from - at);
    if (at <= ray->to) return std::min({limit, at - ray->from, ray->to - at});
    outside = std::min(outside, at - ray->to);
    if (ray->next == nil) return -outside;
    ray = &pool.nodes[ray->next];
  }
}

Rays::Place Rays::place_of(const Eigen::Vector3d& point) const {
  const int c = column_axis();
  const int r = row_axis();
  const double u = std::clamp((point[c] - lowest_[c]) / spacing_[c] - 0.5, 0.0, static_cast<double>(columns_ - 1));
  const double v = std::clamp((point[r] - lowest_[r]) / spacing_[r] - 0.5, 0.0, static_cast<double>(rows_ - 1));
  const auto column = static_cast<std::ptrdiff_t>(u);
  const auto row = static_cast<std::ptrdiff_t>(v);
  return {.column = column,
          .row = row,
          .across_columns = u - static_cast<double>(column),
          .across_rows = v - static_cast<double>(row)};
}

double Rays::depth(const Eigen::Vector3d& point, double limit, double& spread) const {
  const auto [column, row, cu, rv] = place_of(point);
  const std::ptrdiff_t next_column = std::min(column + 1, columns_ - 1);
  const std::ptrdiff_t next_row = std::min(row + 1, rows_ - 1);
  const double at = point[axis_];
  const std::array<double, 4> near = {depth(row, column, at, limit), depth(row, next_column, at, limit),
                                      depth(next_row, column, at, limit), depth(next_row, next_column, at, limit)};
  const auto [least, most] = std::ranges::minmax(near);
  spread = most - least;
  return (1.0 - rv) * ((1.0 - cu) * near[0] + cu * near[1]) + rv * ((1.0 - cu) * near[2] + cu * near[3]);
}

double Rays::bend(const Eigen::Vector3d& point, double limit) const {
  const Place place = place_of(point);
  const double at = point[axis_];
  const bool by_rows = place.across_rows > 0.5;
  const bool by_columns = place.across_columns > 0.5;
  const std::ptrdiff_t nearest_row = std::min(place.row + (by_rows ? 1 : 0), rows_ - 1);
  const std::ptrdiff_t nearest_column = std::min(place.column + (by_columns ? 1 : 0), columns_ - 1);
  return bend_between(place.across_columns, place.column, columns_,
                      [&](std::ptrdiff_t column) { return depth(nearest_row, column, at, limit); }) +
         bend_between(place.across_rows, place.row, rows_,
                      [&](std::ptrdiff_t row) { return depth(row, nearest_column, at, limit); });
}

double Rays::volume() const {
  double length = 0.0;
  for (std::ptrdiff_t row = 0; row < rows_; ++row) {
    const Pool& pool = pools_[static_cast<std::size_t>(row)];
    for (std::ptrdiff_t column = 0; column < columns_; ++column) {
      const Ray* ray = &rays_[index(row, column)];
      length += std::max(ray->to - ray->from, 0.0);
      while (ray->next != nil) {
        ray = &pool.nodes[ray->next];
        length += ray->to - ray->from;
      }
    }
  }
  return length * cell_area();
}

std::size_t Rays::memory_bytes() const {
  std::size_t bytes = rays_.capacity() * sizeof(Ray) + pools_.capacity() * sizeof(Pool);
  for (const Pool& pool : pools_) bytes += pool.nodes.capacity() * sizeof(Ray);
  return bytes;
}

}  // namespace robomill::cutting
