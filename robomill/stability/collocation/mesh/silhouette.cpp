#include "robomill/stability/collocation/mesh/silhouette.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "robomill/stability/collocation/mesh/contacts.hpp"

namespace robomill::stability::detail {
namespace {

using cutting::Profile;
using std::numbers::pi;
constexpr double least_lean = 1e-6;       // of axis along the feed, below which it stands square to it
constexpr double from_bottom_rad = 1e-5;  // of κ, from where both sides meet

/// Where the profile has the normal κ.
Profile::Point supporting(const Profile& profile, double position_rad) {
  for (const Profile::Piece& piece : profile.pieces()) {
    if (position_rad < piece.first.position_rad) return piece.first;
    if (piece.arc_radius_m > 0.0 && position_rad <= piece.last.position_rad) {
      return profile.at(piece.start_m + (position_rad - piece.first.position_rad) * piece.arc_radius_m);
    }
    if (piece.arc_radius_m == 0.0 && position_rad <= piece.first.position_rad + 1e-12) return piece.first;
  }
  return profile.pieces().back().last;
}

}  // namespace

Profile::Point Silhouette::Stretch::at(double parameter) const {
  if (kind == Kind::line) {
    return {.radius_m = first.radius_m + parameter * (last.radius_m - first.radius_m),
            .height_m = first.height_m + parameter * (last.height_m - first.height_m),
            .position_rad = first.position_rad};
  }
  if (kind == Kind::corner) {
    return {.radius_m = first.radius_m, .height_m = first.height_m, .position_rad = parameter};
  }
  return {.radius_m = first.radius_m + arc_radius_m * (std::sin(parameter) - std::sin(first.position_rad)),
          .height_m = first.height_m + arc_radius_m * (std::cos(first.position_rad) - std::cos(parameter)),
          .position_rad = parameter};
}

Silhouette::Silhouette(const Profile& profile, const Eigen::Matrix3d& feed_from_tool) : turn_(feed_from_tool) {
  const Eigen::Vector3d axis = turn_.col(2);
  reach_ = std::hypot(axis.y(), axis.z());
  shift_rad_ = std::atan2(axis.y(), axis.z());
  least_rad_ = std::acos(std::min(reach_, 1.0));
  if (reach_ < least_lean) return;
  const bool leans = std::abs(axis.x()) > least_lean;
  const std::vector<Profile::Piece>& pieces = profile.pieces();
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Profile::Piece& piece = pieces[i];
    const double before = i > 0 ? pieces[i - 1].last.position_rad : 0.0;
    if (leans && piece.first.radius_m > 0.0 && piece.first.position_rad > before + 1e-9) {
      Stretch corner = {.kind = Stretch::Kind::corner, .first = piece.first, .last = piece.first};
      corner.first.position_rad = before;
      stretches_.push_back(corner);
    }
    stretches_.push_back({.kind = piece.arc_radius_m > 0.0 ? Stretch::Kind::arc : Stretch::Kind::line,
                          .first = piece.first,
                          .last = piece.last,
                          .arc_radius_m = piece.arc_radius_m});
  }
  const Eigen::Vector3d down = -turn_.row(2).transpose();  // in T
  const Profile::Point touching = supporting(profile, std::acos(std::clamp(-down.z(), -1.0, 1.0)));
  Eigen::Vector3d lowest(0.0, 0.0, touching.height_m);
  if (const double across = down.head<2>().norm(); across > 0.0) {
    lowest.head<2>() = down.head<2>() * (touching.radius_m / across);
  }
  lowest_m_ = turn_ * lowest;
}

Eigen::Vector3d Silhouette::normal(double position_rad, int side) const {
  const double away = std::acos(std::clamp(std::cos(position_rad) / reach_, -1.0, 1.0));
  const double psi = side * away - shift_rad_;
  return {0.0, std::sin(psi), -std::cos(psi)};
}

double Silhouette::angle_rad(double position_rad, int side) const {
  if (position_rad < least_rad_ || position_rad > pi - least_rad_) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector3d in_tool = turn_.transpose() * normal(position_rad, side);
  return std::atan2(in_tool.x(), in_tool.y());
}

SilhouettePoint Silhouette::at(const Profile::Point& point, int side) const {
  SilhouettePoint out = {.on_profile = point, .normal = normal(point.position_rad, side), .position_m = {}};
  const Eigen::Vector3d in_tool = turn_.transpose() * out.normal;
  out.angle_rad = std::atan2(in_tool.x(), in_tool.y());
  const Eigen::Vector3d place(point.radius_m * std::sin(out.angle_rad), point.radius_m * std::cos(out.angle_rad),
                              point.height_m);
  out.position_m = turn_ * place - lowest_m_;
  return out;
}

std::vector<double> Silhouette::parameters(const Stretch& stretch, int side, double angle_step_rad,
                                           double line_share) const {
  std::vector<double> out;
  if (stretch.kind == Stretch::Kind::line) {
    const double kappa = stretch.first.position_rad;
    if (kappa < least_rad_ + from_bottom_rad || kappa > pi - least_rad_) return out;
    const int steps = static_cast<int>(std::ceil(1.0 / line_share));
    for (int i = 0; i <= steps; ++i) out.push_back(static_cast<double>(i) / steps);
    return out;
  }
  const double from = std::max(stretch.first.position_rad, least_rad_ + from_bottom_rad);
  const double to = std::min(stretch.last.position_rad, pi - least_rad_);
  if (!(to > from)) return out;
  const int steps = static_cast<int>(std::ceil((to - from) / angle_step_rad)) + 1;
  for (int i = 0; i <= steps; ++i) out.push_back(from + (to - from) * i / steps);
  // κ where φ goes on in even steps: near the bottom of the silhouette φ turns quickly. n·x_F = 0.
  const Eigen::RowVector3d feed = turn_.row(0);
  if (std::abs(feed.z()) > least_lean) {
    const double start = angle_rad(from, side);
    const double turned = wrap(angle_rad(to, side) - start + pi, 2.0 * pi) - pi;
    const int turns = static_cast<int>(std::ceil(std::abs(turned) / angle_step_rad));
    for (int i = 1; i < turns; ++i) {
      const double angle = start + turned * i / turns;
      const double across = feed.x() * std::sin(angle) + feed.y() * std::cos(angle);
      const double kappa = std::atan2(std::abs(feed.z()), feed.z() > 0.0 ? across : -across);
      if (kappa > from && kappa < to) out.push_back(kappa);
    }
    std::ranges::sort(out);
  }
  return out;
}

Outline::Outline(const Silhouette& silhouette) {
  constexpr double step_rad = 0.01;
  constexpr double flat = 0.05;  // of cos ψ: steeper is a wall
  for (const int side : {-1, 1}) {
    std::vector<Node> part;
    for (const Silhouette::Stretch& stretch : silhouette.stretches()) {
      for (const double parameter : silhouette.parameters(stretch, side, step_rad, 1.0)) {
        const SilhouettePoint p = silhouette.at(stretch.at(parameter), side);
        const double down = -p.normal.z();
        if (down < -1e-9) continue;
        part.push_back({p.position_m.y(), p.position_m.z(),
                        down > flat ? p.normal.y() / down : std::numeric_limits<double>::infinity()});
      }
    }
    if (side < 0) std::ranges::reverse(part);
    nodes_.insert(nodes_.end(), part.begin(), part.end());
  }
  std::ranges::stable_sort(nodes_, {}, &Node::y_m);
}

bool Outline::covers(double y_m, double z_m) const {
  if (nodes_.size() < 2 || !(y_m > nodes_.front().y_m && y_m < nodes_.back().y_m)) return false;
  const auto after = std::ranges::upper_bound(nodes_, y_m, {}, &Node::y_m);
  const Node& high = *after;
  const Node& low = *std::prev(after);
  const double width = high.y_m - low.y_m;
  const double share = (y_m - low.y_m) / width;
  double outline = low.z_m + share * (high.z_m - low.z_m);
  if (std::isfinite(low.slope) && std::isfinite(high.slope)) {
    // By Hermite's cubic, what it has beside the chord.
    const double chord = (high.z_m - low.z_m) / width;
    outline += width * share * (1.0 - share) * ((low.slope - chord) * (1.0 - share) - (high.slope - chord) * share);
  }
  return z_m > outline;
}

}  // namespace robomill::stability::detail
