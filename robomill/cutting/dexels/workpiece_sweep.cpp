#include "robomill/cutting/dexels/workpiece_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace robomill::cutting {
namespace {

using Eigen::Vector3d;

constexpr double none = std::numeric_limits<double>::infinity();

/// Columns of one row within the hull of two discs of one radius.
void join_columns(double c0, double r0, double c1, double r1, double row, double radius, Span& out) {
  const auto disc = [&](double c, double r) {
    const double away = row - r;
    const double half = radius * radius - away * away;
    if (half < 0.0) return;
    const double chord = std::sqrt(half);
    out.from = std::min(out.from, c - chord);
    out.to = std::max(out.to, c + chord);
  };
  disc(c0, r0);
  disc(c1, r1);
  const double dc = c1 - c0;
  const double dr = r1 - r0;
  const double length = std::hypot(dc, dr);
  if (!(length > 0.0)) return;
  for (const double side : {-radius, radius}) {
    const double c = c0 - side * dr / length;
    const double r = r0 + side * dc / length;
    if ((row - r) * (row - r - dr) > 0.0 || dr == 0.0) continue;
    const double at = c + dc * (row - r) / dr;
    out.from = std::min(out.from, at);
    out.to = std::max(out.to, at);
  }
}

}  // namespace

SweptSolid::SweptSolid(Kind kind, const Vector3d& origin, const Vector3d& axis, double low, double high, double radius,
                       const Vector3d& way)
    : kind_(kind), origin_(origin), axis_(axis), way_(way), low_(low), high_(high), radius_(radius) {}

SweptSolid SweptSolid::ball(const Vector3d& center, double radius, const Vector3d& way) {
  return {Kind::ball, center, Vector3d::Zero(), 0.0, 0.0, radius, way};
}

SweptSolid SweptSolid::cylinder(const program::Pose& pose, double low, double high, double radius,
                                const Vector3d& way) {
  return {Kind::cylinder, pose.tip_m, pose.axis, low, high, radius, way};
}

SweptSolid SweptSolid::convex(const program::Pose& pose, const Profile& profile, const Vector3d& way) {
  SweptSolid solid(Kind::convex, pose.tip_m, pose.axis, 0.0, profile.height_m(), profile.max_radius_m(), way);
  solid.facets_.reserve(profile.pieces().size());
  for (const Profile::Piece& piece : profile.pieces()) {
    const double s0 = std::sin(piece.first.position_rad);
    const double c0 = std::cos(piece.first.position_rad);
    solid.facets_.push_back({.r = piece.first.radius_m - piece.arc_radius_m * s0,
                             .z = piece.first.height_m + piece.arc_radius_m * c0,
                             .arc = piece.arc_radius_m,
                             .s0 = s0,
                             .c0 = c0,
                             .s1 = std::sin(piece.last.position_rad),
                             .c1 = std::cos(piece.last.position_rad)});
  }
  return solid;
}

void SweptSolid::aim(int axis) {
  using Tilt = detail::Meeting::Tilt;
  using Way = detail::Meeting::Way;
  ray_ = axis;
  column_ = axis == 0 ? 1 : 0;
  row_ = axis == 2 ? 1 : 2;
  detail::Meeting& m = aimed_;
  const bool ball = kind_ == Kind::ball;
  m.faces = !ball;
  m.radius = radius_;
  m.low = low_;
  m.high = high_;
  m.uz = axis_[axis];
  m.dz = way_.dot(axis_);
  Vector3d others = axis_;  // 1 - uz² would lose what is left of u where it runs along the axis
  others[axis] = 0.0;
  m.uu = ball ? 1.0 : others.squaredNorm();
  m.ud = way_[axis] - m.uz * m.dz;
  m.dd = (way_ - m.dz * axis_).squaredNorm();
  m.axis_column = axis_[column_];
  m.axis_row = axis_[row_];
  m.axis_ray = axis_[ray_];
  m.way_column = way_[column_];
  m.way_row = way_[row_];
  m.way_ray = way_[ray_];
  m.tilt = m.uu < 1e-20 ? Tilt::along : ball || std::abs(m.uz) < 1e-12 ? Tilt::across : Tilt::oblique;
  m.way = !(m.dd > 1e-24) ? Way::none : !(m.uu * m.dd - m.ud * m.ud > 1e-14 * m.uu * m.dd) ? Way::along : Way::free;
}

void SweptSolid::about(double row, const Lanes& columns, std::array<Span, lane_count>& spans) const {
  detail::Meeting m = aimed_;
  m.w_row = row - origin_[row_];
  for (std::size_t i = 0; i < lane_count; ++i) m.w_column.v[i] = columns.v[i] - origin_[column_];
  detail::meet(m);
  for (std::size_t i = 0; i < lane_count; ++i) {
    spans[i] = {.from = m.from.v[i] + origin_[ray_], .to = m.to.v[i] + origin_[ray_]};
  }
}

void SweptSolid::meet(double row, const Lanes& columns, std::array<Span, lane_count>& spans) const {
  about(row, columns, spans);
  if (exact_about()) return;
  for (std::size_t i = 0; i < lane_count; ++i) {
    if (!spans[i].empty()) spans[i] = refine(row, columns.v[i], spans[i]);
  }
}

/// sup over the outline's normals κ of (r - r(κ)) sin κ - (z - z(κ)) cos κ: convex, of slope 1 outside, zero on the
/// body.
SweptSolid::Value SweptSolid::outline(const Ray& ray, double t, double lambda) const {
  const double squared =
      ray.ww + t * t * aimed_.uu + lambda * lambda * aimed_.dd + 2.0 * (t * ray.wu - lambda * (ray.wd + t * aimed_.ud));
  const double r = std::sqrt(std::max(squared, 0.0));
  const double z = ray.wz + t * aimed_.uz - lambda * aimed_.dz;
  double f = z - high_;
  double sine = 0.0;
  double cosine = -1.0;
  const auto consider = [&](double value, double s, double c) {
    if (value <= f) return;
    f = value;
    sine = s;
    cosine = c;
  };
  for (const Facet& facet : facets_) {
    const double out = r - facet.r;
    const double down = facet.z - z;
    const double length = facet.arc > 0.0 ? std::hypot(out, down) : 0.0;
    if (length > 0.0 && out * facet.c0 >= down * facet.s0 && out * facet.c1 <= down * facet.s1) {
      consider(length - facet.arc, out / length, down / length);
    } else {
      consider(out * facet.s0 + down * facet.c0 - facet.arc, facet.s0, facet.c0);
      consider(out * facet.s1 + down * facet.c1 - facet.arc, facet.s1, facet.c1);
    }
  }
  const double per_r = r > 0.0 ? sine / r : 0.0;
  return {.f = f,
          .slope_t = per_r * (ray.wu + t * aimed_.uu - lambda * aimed_.ud) - cosine * aimed_.uz,
          .slope_lambda = -per_r * (ray.wd + t * aimed_.ud - lambda * aimed_.dd) + cosine * aimed_.dz};
}

/// A line in t below the least over λ in [0, 1], which it touches at t to within a twentieth: where λ lies between two
/// tangents that lean towards each other, the mean of them that does not depend on λ.
SweptSolid::Value SweptSolid::nearest_outline(const Ray& ray, double t, double close) const {
  Value low = outline(ray, t, 0.0);
  if (low.slope_lambda >= 0.0 || low.f <= close) return low;
  Value high = outline(ray, t, 1.0);
  if (high.slope_lambda <= 0.0 || high.f <= close) return high;
  double at_low = 0.0;
  double at_high = 1.0;
  Value below;
  for (int i = 0; i < 60; ++i) {
    const double share = high.slope_lambda / (high.slope_lambda - low.slope_lambda);
    below.f = share * (low.f - low.slope_lambda * at_low) + (1.0 - share) * (high.f - high.slope_lambda * at_high);
    below.slope_t = share * low.slope_t + (1.0 - share) * high.slope_t;
    const double reached = std::min(low.f, high.f);
    if (reached - below.f <= 0.05 * reached || at_high - at_low < 1e-12) break;
    const double crossing = (below.f - low.f) / low.slope_lambda + at_low;
    const double margin = 0.02 * (at_high - at_low);
    const double at = std::clamp(crossing, at_low + margin, at_high - margin);
    const Value value = outline(ray, t, at);
    if (value.f <= close) return value;
    (value.slope_lambda < 0.0 ? low : high) = value;
    (value.slope_lambda < 0.0 ? at_low : at_high) = at;
  }
  return below;
}

/// Newton from outside, along lines below a convex function, which cannot pass its root.
Span SweptSolid::refine(double row, double column, const Span& about) const {
  Vector3d w = -origin_;
  w[ray_] = 0.0;
  w[row_] += row;
  w[column_] += column;
  Ray ray;
  ray.wz = w.dot(axis_);
  const Vector3d across = w - ray.wz * axis_;
  ray.ww = across.squaredNorm();
  ray.wu = across[ray_];
  ray.wd = across.dot(way_);
  const double first = about.from - origin_[ray_];
  const double last = about.to - origin_[ray_];
  const double close = 1e-9 * radius_;
  const auto approach = [&](double t, double sign) {
    for (int i = 0; i < 40; ++i) {
      const Value value = nearest_outline(ray, t, close);
      if (value.f <= close) return t;
      if (!(sign * value.slope_t < 0.0)) return none;
      const double next = t - value.f / value.slope_t;
      if (!(sign * next < sign * (sign > 0.0 ? last : first))) return none;
      t = next;
    }
    return t;
  };
  const double from = approach(first, 1.0);
  if (from == none) return {};
  const double to = approach(last, -1.0);
  return to == none ? Span{} : Span{.from = from + origin_[ray_], .to = to + origin_[ray_]};
}

Span SweptSolid::columns(double row) const {
  Span out;
  const Vector3d low = origin_ + low_ * axis_;
  const Vector3d high = origin_ + high_ * axis_;
  const std::array<Vector3d, 4> centers = {low, low + way_, high, high + way_};
  const std::size_t count = kind_ == Kind::ball ? 2 : 4;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i + 1; j < count; ++j) {
      join_columns(centers[i][column_], centers[i][row_], centers[j][column_], centers[j][row_], row, radius_, out);
    }
  }
  return out;
}

Span SweptSolid::extent(int axis) const {
  const double low = origin_[axis] + low_ * axis_[axis];
  const double high = origin_[axis] + high_ * axis_[axis];
  const double least = std::min(low, high) + std::min(0.0, way_[axis]);
  const double most = std::max(low, high) + std::max(0.0, way_[axis]);
  return {.from = least - radius_, .to = most + radius_};
}

double SweptSolid::silhouette_m2() const {
  const double length = high_ - low_;
  const double way = way_.norm();
  return 2.0 * radius_ * (length + way + 2.0 * radius_) + length * way;
}

double SweptSolid::depth_in_side(const Vector3d& point) const {
  const Vector3d from = point - origin_;
  const Vector3d across = from - from.dot(axis_) * axis_;
  const Vector3d way = way_ - way_.dot(axis_) * axis_;
  const double squared = way.squaredNorm();
  const double lambda = squared > 0.0 ? std::clamp(across.dot(way) / squared, 0.0, 1.0) : 0.0;
  return radius_ - (across - lambda * way).norm();
}

SweptCutter swept_cutter(const Profile& profile, const program::Pose& pose, const Vector3d& way, double top_m) {
  SweptCutter out;
  const std::vector<Profile::Piece>& pieces = profile.pieces();
  const Profile::Piece& first = pieces.front();
  const Profile::Piece& last = pieces.back();
  const double height = profile.height_m();
  const double radius = last.last.radius_m;
  const bool straight = last.arc_radius_m == 0.0 && last.first.radius_m == radius;
  const bool from_pole = first.arc_radius_m > 0.0 && first.first.radius_m == 0.0 && first.first.position_rad == 0.0;
  if (straight && pieces.size() == 2 && from_pole && first.arc_radius_m == radius) {
    // The upper half of the ball lies in the cylinder or in the shank above it.
    out.edges.push_back(SweptSolid::ball(pose.tip_m + radius * pose.axis, radius, way));
    out.edges.push_back(SweptSolid::cylinder(pose, radius, height, radius, way));
  } else if (straight && pieces.size() == 2 && first.arc_radius_m == 0.0 && first.last.height_m == 0.0) {
    out.edges.push_back(SweptSolid::cylinder(pose, 0.0, height, radius, way));
  } else {
    out.edges.push_back(SweptSolid::convex(pose, profile, way));
  }
  if (top_m > height) out.shank.push_back(SweptSolid::cylinder(pose, height, top_m, radius, way));
  return out;
}

}  // namespace robomill::cutting
