#include "robomill/cutting/published/swept_silhouette.hpp"

#include <cmath>
#include <numbers>

namespace robomill::cutting::detail {
namespace {

using std::numbers::pi;
constexpr double step = pi / 128.0;  // between the u that are looked at

Eigen::Vector2d unit(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

Extreme extreme(const Profile& profile, double across, double along) {
  Extreme best;
  bool found = false;
  const auto consider = [&](const Profile::Point& point, double length) {
    const double distance = point.radius_m * across + point.height_m * along;
    if (found && distance <= best.distance_m) return;
    best = {.distance_m = distance, .at = point, .length_m = length};
    found = true;
  };
  const double position = std::atan2(across, -along);
  for (const Profile::Piece& piece : profile.pieces()) {
    consider(piece.first, piece.start_m);
    const double past = position - piece.first.position_rad;
    if (piece.arc_radius_m > 0.0 && past > 0.0 && position < piece.last.position_rad) {
      const double length = piece.start_m + piece.arc_radius_m * past;
      consider(profile.at(length), length);
    }
    consider(piece.last, piece.start_m + piece.length_m);
  }
  return best;
}

/// For one u, the arc |φ - middle| < half that is outside.
struct SweptSilhouette::Reach {
  double middle = 0.0;
  double half = 0.0;    ///< 0: none; 2π: the whole ring
  double excess = 0.0;  ///< how far the ring's furthest point is outside along u
};

SweptSilhouette::SweptSilhouette(const Profile& profile, const Eigen::Matrix3d& feed_from_tool,
                                 const Eigen::Vector3d& origin_m)
    : profile_(&profile), rotation_(feed_from_tool), origin_(origin_m.tail<2>()) {
  undercut_ = profile.pieces().back().last.position_rad > 0.5 * pi + 1e-9;
  first_angle_ = undercut_ ? -1.5 * pi : std::atan2(rotation_(2, 2), rotation_(1, 2)) - 1.5 * pi;
  const auto count = static_cast<std::size_t>(std::lround(span() / step));
  border_.reserve(count + 1);
  for (std::size_t i = 0; i <= count; ++i) border_.push_back(tangent(first_angle_ + step * static_cast<double>(i)));
}

SweptSilhouette::Tangent SweptSilhouette::tangent(double angle) const {
  const Eigen::Vector2d u = unit(angle);
  const Extreme far = extreme_along(u);
  const Eigen::Vector3d along = rotation_.bottomRows<2>().transpose() * u;
  const double across = along.head<2>().norm();
  Eigen::Vector3d point(0.0, 0.0, far.at.height_m);
  if (across > 0.0) point.head<2>() = along.head<2>() * (far.at.radius_m / across);
  return {.direction = u, .point = origin_ + rotation_.bottomRows<2>() * point, .length_m = far.length_m};
}

Extreme SweptSilhouette::extreme_along(const Eigen::Vector2d& direction) const {
  const Eigen::Vector3d along = rotation_.bottomRows<2>().transpose() * direction;
  return extreme(*profile_, along.head<2>().norm(), undercut_ ? along.z() : std::min(along.z(), 0.0));
}

double SweptSilhouette::support(const Eigen::Vector2d& direction) const {
  return origin_.dot(direction) + extreme_along(direction).distance_m;
}

bool SweptSilhouette::contains(const Eigen::Vector2d& point) const {
  const auto beyond = [&](double angle) {
    const Eigen::Vector2d u = unit(angle);
    return point.dot(u) - support(u);
  };
  double most = -1e300;
  double where = first_angle_;
  for (std::size_t i = 0; i < border_.size(); ++i) {
    const double excess = (point - border_[i].point).dot(border_[i].direction);
    if (excess <= most) continue;
    most = excess;
    where = first_angle_ + step * static_cast<double>(i);
  }
  const double from = std::max(where - step, first_angle_);
  const double to = std::min(where + step, first_angle_ + span());
  return std::max(most, beyond(highest_between(beyond, from, to, 16))) <= 0.0;
}

SweptSilhouette::Reach SweptSilhouette::reach(double angle, const Eigen::Vector2d& center, const Eigen::Vector2d& sine,
                                              const Eigen::Vector2d& cosine) const {
  const Eigen::Vector2d u = unit(angle);
  const double along_sine = sine.dot(u);
  const double along_cosine = cosine.dot(u);
  const double amplitude = std::hypot(along_sine, along_cosine);
  const double gap = support(u) - center.dot(u);
  Reach reach = {.middle = std::atan2(along_sine, along_cosine), .half = 0.0, .excess = amplitude - gap};
  if (gap < -amplitude) {
    reach.half = full_turn;
  } else if (gap < amplitude) {
    reach.half = std::acos(gap / amplitude);
  }
  return reach;
}

/// Of the arcs of neighbouring u, which overlap, the ones that reach furthest back and furthest on.
struct SweptSilhouette::Run {
  bool any = false;
  double entry = 0.0, exit = 0.0;
  double entry_angle = 0.0, exit_angle = 0.0;    ///< of their u
  double entry_middle = 0.0, exit_middle = 0.0;  ///< counted on from the run's first
  double middle = 0.0;                           ///< of the last

  void add(double angle, double turn, double half) {
    middle = any ? middle + std::remainder(turn - middle, full_turn) : turn;
    if (!any || middle - half < entry) {
      entry = middle - half;
      entry_angle = angle;
      entry_middle = middle;
    }
    if (!any || middle + half > exit) {
      exit = middle + half;
      exit_angle = angle;
      exit_middle = middle;
    }
    any = true;
  }
};

/// The union of a run's arcs, its ends sought between the u that were looked at.
BoundedArc SweptSilhouette::sought(const Run& run, const Eigen::Vector2d& center, const Eigen::Vector2d& sine,
                                   const Eigen::Vector2d& cosine) const {
  const auto end = [&](double at, double near, double side) {
    const auto f = [&](double angle) {
      const Reach r = reach(angle, center, sine, cosine);
      if (!(r.half > 0.0)) return -1e3 + r.excess;  // leads to where there is an arc
      return side * (near + std::remainder(r.middle - near, full_turn)) + r.half;
    };
    const double best =
        highest_between(f, std::max(at - step, first_angle_), std::min(at + step, first_angle_ + span()), 32);
    return side * std::max(f(best), f(at));
  };
  return {.entry = end(run.entry_angle, run.entry_middle, -1.0),
          .exit = end(run.exit_angle, run.exit_middle, 1.0),
          .at_entry = Bound::neighbour,
          .at_exit = Bound::neighbour};
}

ArcList SweptSilhouette::outside(const Eigen::Vector2d& center, const Eigen::Vector2d& sine,
                                 const Eigen::Vector2d& cosine) const {
  ArcList arcs;
  Run run;
  const auto close = [&] {
    if (run.any) arcs.add(sought(run, center, sine, cosine));
    run = Run();
  };
  double most = -1e300;
  double where = first_angle_;
  for (std::size_t i = 0; i < border_.size(); ++i) {
    const Tangent& t = border_[i];
    const double angle = first_angle_ + step * static_cast<double>(i);
    const double along_sine = sine.dot(t.direction);
    const double along_cosine = cosine.dot(t.direction);
    const double amplitude = std::hypot(along_sine, along_cosine);
    const double gap = (t.point - center).dot(t.direction);
    if (gap < -amplitude) return ArcList::whole();
    if (amplitude - gap > most) {
      most = amplitude - gap;
      where = angle;
    }
    if (gap < amplitude) {
      run.add(angle, std::atan2(along_sine, along_cosine), std::acos(gap / amplitude));
    } else {
      close();
    }
  }
  close();
  if (arcs.empty()) {  // perhaps between two of the u
    const auto excess = [&](double angle) { return reach(angle, center, sine, cosine).excess; };
    const double best =
        highest_between(excess, std::max(where - step, first_angle_), std::min(where + step, first_angle_ + span()));
    const Reach r = reach(best, center, sine, cosine);
    if (r.half >= full_turn) return ArcList::whole();
    if (r.half > 0.0) run.add(best, r.middle, r.half);
    close();
  }
  return merged(arcs);
}

}  // namespace robomill::cutting::detail
