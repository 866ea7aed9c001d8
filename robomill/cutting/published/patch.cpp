#include "robomill/cutting/published/patch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace robomill::cutting::detail {
namespace {

using std::numbers::pi;
constexpr int samples_around = 32;

/// sin x / x and (1 - cos x) / x.
double sine_ratio(double x) {
  return x == 0.0 ? 1.0 : std::sin(x) / x;
}
double cosine_ratio(double x) {
  return std::sin(0.5 * x) * sine_ratio(0.5 * x);
}

}  // namespace

Patch::Patch(const Cutter& cutter, const Cut& cut)
    : profile_(cutter), cut_(cut), rotation_(cutting::feed_from_tool(cut.lead_rad, cut.tilt_rad)) {
  const Eigen::Vector3d down = -rotation_.row(2).transpose();  // in T
  const double across = down.head<2>().norm();
  touching_ = extreme(profile_, across, down.z());
  Eigen::Vector3d touches(0.0, 0.0, touching_.at.height_m);
  if (across > 0.0) touches.head<2>() = down.head<2>() * (touching_.at.radius_m / across);
  origin_ = -(rotation_ * touches);
  const bool is_ball = cutter.kind == CutterKind::ball_end;
  if (is_ball) ball_radius_ = 0.5 * cutter.mill.diameter_m;
  const bool flat = cut.curvature_along_feed_per_m == 0.0 && cut.curvature_across_feed_per_m == 0.0;
  if (cut.direction != MillingDirection::slot) add_neighbour(cut, is_ball, flat);
  const bool whole_ball = is_ball && profile_.height_m() >= ball_radius_;
  if (whole_ball && flat && !reaches_from(ball_radius_)) ball_.emplace(ball_radius_, cut, rotation_);
}

void Patch::add_neighbour(const Cut& cut, bool is_ball, bool flat) {
  side_ = cut.direction == MillingDirection::up ? -1.0 : 1.0;
  const double turn = side_ * cut.curvature_across_feed_per_m * cut.radial_depth_m;
  neighbour_normal_ = Eigen::Vector2d(std::sin(turn), std::cos(turn));
  neighbour_origin_ = side_ * cut.radial_depth_m * Eigen::Vector2d(sine_ratio(turn), -cosine_ratio(turn));
  neighbour_ = flat && cut.lead_rad == 0.0 && cut.tilt_rad == 0.0 ? Neighbour::upright : Neighbour::silhouette;
  silhouette_ = std::make_unique<SweptSilhouette>(profile_, rotation_, origin_);
  if (is_ball && (cut.curvature_along_feed_per_m != 0.0 || !reaches_from(ball_radius_))) neighbour_ = Neighbour::ball;
}

Ring Patch::ring(const Profile::Point& point) const {
  return {.center = origin_ + rotation_.col(2) * point.height_m,
          .sine = rotation_.col(0) * point.radius_m,
          .cosine = rotation_.col(1) * point.radius_m};
}

ArcList Patch::below_surface(const Profile::Point& point) const {
  const Ring r = ring(point);
  const double h = cut_.axial_depth_m;
  const double along = cut_.curvature_along_feed_per_m;
  const double across = cut_.curvature_across_feed_per_m;
  if (along == 0.0 && across == 0.0) {
    return where_positive(-r.sine.z(), -r.cosine.z(), h - r.center.z(), Bound::surface);
  }
  const int sideways = along != 0.0 ? 0 : 1;
  const auto room = [&](double angle) {
    const Eigen::Vector3d p = r.at(angle);
    return room_above(p[sideways], p.z());
  };
  return where_positive(room, ArcList::whole(), Bound::surface, 2 * samples_around);
}

/// > 0 below the unmachined surface, a plane or a cylinder of curvature κ / (1 + κ h) about the finished one's axis:
/// with a the height above the finished surface, 2 z + κ (y² + z²) = 2 a + κ a². Sideways is x where the feed is
/// curved.
double Patch::room_above(double sideways, double z) const {
  const double h = cut_.axial_depth_m;
  const double curvature = cut_.curvature_along_feed_per_m + cut_.curvature_across_feed_per_m;  // one of them is 0
  return 2.0 * (h - z) + curvature * (h * h - z * z - sideways * sideways);
}

ArcList Patch::arcs(const Profile::Point& point) const {
  if (ball_) return point.height_m <= ball_radius_ ? ball_->arcs(point.position_rad) : ArcList();
  ArcList found = below_surface(point);
  if (found.empty()) return found;
  const double sine = std::sin(point.position_rad);
  const ArcList forwards = where_positive(sine * rotation_(0, 0), sine * rotation_(0, 1),
                                          -std::cos(point.position_rad) * rotation_(0, 2), Bound::feed);
  found = intersection(found, forwards);
  if (found.empty() || neighbour_ == Neighbour::none) return found;
  return outside_neighbour(point, found);
}

ArcList Patch::outside_neighbour(const Profile::Point& point, const ArcList& within) const {
  if (neighbour_ == Neighbour::upright) {
    return intersection(
        within, where_positive(0.0, -side_ * point.radius_m, cut_.radial_depth_m - point.radius_m, Bound::neighbour));
  }
  const Ring r = ring(point);
  if (neighbour_ == Neighbour::ball) return outside_ball(r, within);
  const Eigen::Vector2d normal = neighbour_normal_;
  const Eigen::Vector2d left(normal.y(), -normal.x());
  const auto turned = [&](const Eigen::Vector3d& v) {
    return Eigen::Vector2d(v.tail<2>().dot(left), v.tail<2>().dot(normal));
  };
  const Eigen::Vector2d center = seen_by_neighbour(r.center.tail<2>());
  return intersection(within, silhouette_->outside(center, turned(r.sine), turned(r.cosine)));
}

/// |p - d|² > R² in y and z, p and the neighbour's centre d from the ball's own centre. On the ball y² + z² = R² - x²,
/// which leaves |d|² - 2 p·d > x². Where the feed follows a curve, the neighbour is a torus about the surface's centre.
ArcList Patch::outside_ball(const Ring& ring, const ArcList& within) const {
  const double radius = ball_radius_;
  const double curvature = cut_.curvature_along_feed_per_m;
  if (curvature != 0.0) {
    const double shift = -side_ * cut_.radial_depth_m;
    const auto gap = [&](double angle) {
      const Eigen::Vector3d p = ring.at(angle);
      const double rise = 2.0 * p.z() + curvature * (p.x() * p.x() + p.z() * p.z());
      const double above = rise / (1.0 + std::sqrt(std::max(1.0 + curvature * rise, 0.0)));  // the finished surface
      return (p.y() + shift) * (p.y() + shift) + above * above - 2.0 * radius * above;
    };
    return where_positive(gap, within, Bound::neighbour, samples_around);
  }
  const Eigen::Vector2d d = neighbour_origin_ + radius * (neighbour_normal_ - Eigen::Vector2d::UnitY());
  const double squared = d.squaredNorm();
  const auto gap = [&](double angle) {
    const double sine = std::sin(angle);
    const double cosine = std::cos(angle);
    const double x = ring.center.x() + ring.sine.x() * sine + ring.cosine.x() * cosine;
    const double y = ring.center.y() + ring.sine.y() * sine + ring.cosine.y() * cosine;
    const double z = ring.center.z() + ring.sine.z() * sine + ring.cosine.z() * cosine - radius;
    return squared - 2.0 * (y * d.x() + z * d.y()) - x * x;
  };
  return where_positive(gap, within, Bound::neighbour, samples_around);
}

Eigen::Vector2d Patch::seen_by_neighbour(const Eigen::Vector2d& point) const {
  const Eigen::Vector2d from = point - neighbour_origin_;
  return {from.x() * neighbour_normal_.y() - from.y() * neighbour_normal_.x(), from.dot(neighbour_normal_)};
}

/// A straight cylinder from this height up cuts somewhere only if its lower edge does: both the section that the
/// neighbour sweeps and the room above the surface go on along the axis.
bool Patch::reaches_from(double height_m) const {
  const double scale = 2.0 * profile_.max_radius_m();
  const Profile::Point edge = {
      .radius_m = profile_.radius_m(height_m), .height_m = height_m + 1e-9 * scale, .position_rad = 0.5 * pi};
  return arcs(edge).length() > 1e-9;
}

std::vector<double> Patch::places() const {
  const std::unique_ptr<SweptSilhouette> own =
      silhouette_ ? nullptr : std::make_unique<SweptSilhouette>(profile_, rotation_, origin_);
  const SweptSilhouette& silhouette = silhouette_ ? *silhouette_ : *own;
  const bool bent = cut_.curvature_across_feed_per_m != 0.0;
  const auto room = [&](double angle) {
    const SweptSilhouette::Tangent t = silhouette.tangent(angle);
    return room_above(bent ? t.point.x() : 0.0, t.point.y());
  };
  constexpr double down = -0.5 * pi;
  const auto limit = [&](double end) {  // how far from the lowest point the border stays below the surface
    if (room(end) >= 0.0) return end;
    double below = down;
    for (int i = 0; i < 40; ++i) (room(0.5 * (below + end)) >= 0.0 ? below : end) = 0.5 * (below + end);
    return below;
  };
  const double from = limit(silhouette.first_angle());
  const double to = limit(silhouette.first_angle() + silhouette.span());
  std::vector<double> places = {touching_.length_m};
  constexpr int count = 96;
  for (int i = 0; i <= count; ++i) {
    const SweptSilhouette::Tangent t = silhouette.tangent(from + (to - from) * i / count);
    if (neighbour_ != Neighbour::none && silhouette.contains(seen_by_neighbour(t.point))) continue;
    places.push_back(t.length_m);
  }
  std::ranges::sort(places);
  return places;
}

}  // namespace robomill::cutting::detail
