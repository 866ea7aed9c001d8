#include "robomill/robot/collision/revolution.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

namespace robomill::robot {
namespace {

constexpr int fewest_facets = 16, most_facets = 256;
constexpr double depth_accuracy_m = 1e-7;
constexpr double section_m = 1e-9;  // where a search by sections stops: well below depth_accuracy_m

/// How many facets around a circle stand off by at most the excess: r / cos(π/n) <= r + excess.
int facets_around(double radius_m, double excess_m) {
  const double n = std::ceil(std::numbers::pi / std::acos(radius_m / (radius_m + excess_m)));
  return static_cast<int>(std::clamp(n, double{fewest_facets}, double{most_facets}));
}

/// The greatest value of a concave function over [0, 1], by the golden section.
/// @param length_m  a change of 1 in the argument changes the function by at most this
template <class F>
double most_by_sections(double length_m, F&& value) {
  constexpr double part = 0.6180339887498949;
  double low = 0.0, high = 1.0;
  double x = high - part, y = low + part;
  double at_x = value(x), at_y = value(y);
  double best = std::max({value(low), value(high), at_x, at_y});
  while ((high - low) * length_m > section_m) {
    if (at_x < at_y) {
      low = x;
      x = y;
      at_x = at_y;
      y = low + part * (high - low);
      at_y = value(y);
      best = std::max(best, at_y);
    } else {
      high = y;
      y = x;
      at_y = at_x;
      x = high - part * (high - low);
      at_x = value(x);
      best = std::max(best, at_x);
    }
  }
  return best;
}

}  // namespace

io::TriangleMesh revolve(const std::vector<OutlinePoint>& outline, double excess_m) {
  double largest_m = 0.0;
  for (const OutlinePoint& point : outline) largest_m = std::max(largest_m, point.radius_m);
  const int facets = facets_around(largest_m, excess_m);
  const double outside = 1.0 / std::cos(std::numbers::pi / facets);
  io::TriangleMesh mesh;
  const auto vertex = [&](double radius_m, double angle_rad, double height_m) {
    mesh.vertices_m.emplace_back(radius_m * std::cos(angle_rad), radius_m * std::sin(angle_rad), height_m);
    return static_cast<std::uint32_t>(mesh.vertices_m.size() - 1);
  };
  // A ring of vertices; where the radius is 0, one vertex all around.
  const auto ring = [&](double radius_m, double height_m) {
    std::vector<std::uint32_t> out;
    if (radius_m <= 0.0) {
      out.assign(static_cast<std::size_t>(facets), vertex(0.0, 0.0, height_m));
    } else {
      for (int k = 0; k < facets; ++k) {
        out.push_back(vertex(radius_m * outside, 2.0 * std::numbers::pi * k / facets, height_m));
      }
    }
    return out;
  };
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a != b && b != c && c != a) mesh.triangles.push_back({a, b, c});
  };
  std::vector<std::uint32_t> below = ring(0.0, outline.front().height_m);
  const auto join = [&](std::vector<std::uint32_t> above) {
    for (std::size_t k = 0; k < above.size(); ++k) {
      const std::size_t next = k + 1 == above.size() ? 0 : k + 1;
      add(below[k], below[next], above[next]);
      add(below[k], above[next], above[k]);
    }
    below = std::move(above);
  };
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const bool pole = outline[i].radius_m <= 0.0;
    if (i == 0 && pole) continue;                         // the ring below is there
    if (i + 1 == outline.size() && pole && i > 0) break;  // so is the last
    join(ring(outline[i].radius_m, outline[i].height_m));
  }
  join(ring(0.0, outline.back().height_m));
  return mesh;
}

ConvexRevolution::ConvexRevolution(const std::vector<OutlinePoint>& outline, double beyond_top_m) {
  const auto side = [&](double outward, double up, const OutlinePoint& through) {
    sides_.push_back({outward, up, outward * through.radius_m + up * through.height_m});
  };
  const OutlinePoint &first = outline.front(), &last = outline.back();
  side(0.0, -1.0, first);
  for (std::size_t i = 1; i < outline.size(); ++i) {
    const double dr = outline[i].radius_m - outline[i - 1].radius_m, dz = outline[i].height_m - outline[i - 1].height_m,
                 length = std::hypot(dr, dz);
    if (length > 0.0) side(dz / length, -dr / length, outline[i]);
  }
  side(0.0, 1.0, {.height_m = last.height_m + beyond_top_m, .radius_m = last.radius_m});

  // The depth falls with the radius, so that the deepest point is on the axis.
  const double length_m = last.height_m + beyond_top_m - first.height_m;
  const auto on_axis = [&](double part) {
    const Eigen::Vector3d at_m(0.0, 0.0, first.height_m + part * length_m);
    const double depth = depth_m(at_m);
    if (depth > greatest_depth_m_) {
      greatest_depth_m_ = depth;
      deepest_m_ = at_m;
    }
    return depth;
  };
  most_by_sections(length_m, on_axis);
}

double ConvexRevolution::depth_m(const Eigen::Vector3d& at_m) const {
  const double radius_m = std::hypot(at_m.x(), at_m.y());
  double out = std::numeric_limits<double>::infinity();
  for (const HalfPlane& side : sides_) {
    out = std::min(out, side.offset_m - side.outward * radius_m - side.up * at_m.z());
  }
  return out;
}

template <class Extent>
double ConvexRevolution::bound(const Eigen::Vector3d& center_m, Extent&& extent) const {
  const double radius_m = std::hypot(center_m.x(), center_m.y());
  // On the axis, where r has no gradient, 0 is a subgradient of it.
  const double x = radius_m > 0.0 ? center_m.x() / radius_m : 0.0, y = radius_m > 0.0 ? center_m.y() / radius_m : 0.0;
  double out = std::numeric_limits<double>::infinity();
  for (const HalfPlane& side : sides_) {
    const Eigen::Vector3d gradient(-side.outward * x, -side.outward * y, -side.up);
    out = std::min(out, side.offset_m - side.outward * radius_m - side.up * center_m.z() + extent(gradient));
  }
  return out;
}

double ConvexRevolution::bound_over_box_m(const Eigen::Vector3d& center_m, const Eigen::Matrix3d& half_m) const {
  return bound(center_m, [&](const Eigen::Vector3d& gradient) -> double {
    return (half_m.transpose() * gradient).cwiseAbs().sum();
  });
}

double ConvexRevolution::most_over_triangle_m(const std::array<Eigen::Vector3d, 3>& corners_m, double above_m) const {
  const Eigen::Vector3d &a = corners_m[0], &b = corners_m[1], &c = corners_m[2];
  const Eigen::Vector3d center = (a + b + c) / 3.0;
  const double found = std::max({depth_m(a), depth_m(b), depth_m(c), depth_m(center), above_m});
  const auto most = [&](const Eigen::Vector3d& at_m) {
    return bound(at_m, [&](const Eigen::Vector3d& gradient) {
      return std::max({gradient.dot(a - at_m), gradient.dot(b - at_m), gradient.dot(c - at_m)});
    });
  };
  if (most(center) <= found + depth_accuracy_m) return found;
  const double length_m = std::max({(b - a).norm(), (c - a).norm(), (c - b).norm()});
  const double searched = most_by_sections(length_m, [&](double u) {
    const Eigen::Vector3d from = a + u * (b - a), to = a + u * (c - a);
    return most_by_sections(length_m, [&](double v) { return depth_m(from + v * (to - from)); });
  });
  return std::max(found, searched);
}

}  // namespace robomill::robot
