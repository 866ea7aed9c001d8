#include "robomill/stability/collocation/mesh/finished_profile.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "robomill/base/units.hpp"
#include "robomill/stability/collocation/mesh/contacts.hpp"

namespace robomill::stability::detail {
namespace {

using std::numbers::pi;
using Stretch = Silhouette::Stretch;
using Test = std::function<bool(const Stretch&, const SilhouettePoint&, int side)>;

/// sin x / x and (1 - cos x) / x.
double sine_ratio(double x) {
  return x == 0.0 ? 1.0 : std::sin(x) / x;
}
double cosine_ratio(double x) {
  return std::sin(0.5 * x) * sine_ratio(0.5 * x);
}

/// Passes over a plane, or a cylinder that the surface is like nearby.
class Passes {
 public:
  Passes(const cutting::Cut& cut, double depth_m, const Silhouette& silhouette)
      : cut_(cut), depth_m_(depth_m), outline_(silhouette) {
    side_ = cut.direction == cutting::MillingDirection::up ? -1.0 : 1.0;
  }
  [[nodiscard]] bool leave(const Eigen::Vector3d& place) const {
    const double along = cut_.curvature_along_feed_per_m;
    const double across = cut_.curvature_across_feed_per_m;
    const double h = depth_m_;
    const double sideways = along != 0.0 ? place.x() : place.y();
    const double room =
        2.0 * (h - place.z()) + (along + across) * (h * h - place.z() * place.z() - sideways * sideways);
    return room > 0.0 && !(has_neighbour() && takes(side_, place));
  }
  [[nodiscard]] bool keep(const Eigen::Vector3d& place) const { return !(has_neighbour() && takes(-side_, place)); }

 private:
  [[nodiscard]] bool has_neighbour() const { return cut_.direction != cutting::MillingDirection::slot; }
  /// Whether the pass on that side covers a place.
  [[nodiscard]] bool takes(double side, const Eigen::Vector3d& place) const {
    const double turn = side * cut_.curvature_across_feed_per_m * cut_.radial_depth_m;
    const double y = place.y() - side * cut_.radial_depth_m * sine_ratio(turn);
    const double z = place.z() + side * cut_.radial_depth_m * cosine_ratio(turn);
    return outline_.covers(y * std::cos(turn) - z * std::sin(turn), y * std::sin(turn) + z * std::cos(turn));
  }

  const cutting::Cut& cut_;
  double depth_m_, side_ = -1.0;
  Outline outline_;
};

/// Of a given engagement: whether it ends at a place of the silhouette.
class RingEnds {
 public:
  RingEnds(const cutting::Engagement& engagement, const Silhouette& silhouette)
      : engagement_(engagement), silhouette_(silhouette) {}

  [[nodiscard]] bool leave(const Stretch& stretch, const SilhouettePoint& place, int side) const {
    const bool corner = stretch.kind == Stretch::Kind::corner;
    for (std::size_t i = 0; i < engagement_.slices.size(); ++i) {
      const cutting::EdgeSlice& ring = engagement_.slices[i];
      const double reach_m = (corner ? 0.75 : 0.55) * ring.width_m;
      const double up_m = ring.height_m - place.on_profile.height_m;
      const double out_m = ring.radius_m - place.on_profile.radius_m;
      if (up_m * up_m + out_m * out_m > reach_m * reach_m) continue;
      if (corner ? covers(i, place.angle_rad) : ends(i, silhouette_.angle_rad(ring.position_rad, side))) return true;
    }
    return false;
  }

 private:
  static constexpr double beside = 0.05;     // n·x_F of an arc's end that is taken for 0
  static constexpr double beside_rad = 0.5;  // and by how much its φ may differ at most

  [[nodiscard]] bool ends(std::size_t ring, double angle_rad) const {
    const double sine = std::sin(engagement_.slices[ring].position_rad);
    return std::ranges::any_of(engagement_.of(ring), [&](const cutting::Arc& arc) {
      if (arc.exit_rad - arc.entry_rad > units::revolution - 1e-6) return false;
      const auto near = [&](double end) {
        const double apart = std::abs(wrap(end - angle_rad + pi, units::revolution) - pi);
        return apart < beside_rad && sine * apart < beside;
      };
      return near(arc.entry_rad) || near(arc.exit_rad);
    });
  }
  [[nodiscard]] bool covers(std::size_t ring, double angle_rad) const {
    return std::ranges::any_of(engagement_.of(ring), [&](const cutting::Arc& arc) {
      return wrap(angle_rad - arc.entry_rad, units::revolution) <= arc.exit_rad - arc.entry_rad;
    });
  }

  const cutting::Engagement& engagement_;
  const Silhouette& silhouette_;
};

double highest_m(const cutting::Engagement& engagement) {
  double low = 1e300;
  double high = -1e300;
  for (const cutting::EdgeSlice& ring : engagement.slices) {
    const double half = 0.5 * ring.width_m * std::sin(ring.position_rad);
    low = std::min(low, ring.height_m - half);
    high = std::max(high, ring.height_m + half);
  }
  return high + 0.1 * (high - low);
}

/// A stretch up to a height, which lines alone need.
Stretch below(Stretch stretch, double height_m) {
  const double rise = stretch.last.height_m - stretch.first.height_m;
  if (stretch.kind != Stretch::Kind::line || !(stretch.last.height_m > height_m) || !(rise > 0.0)) return stretch;
  stretch.last = stretch.at((height_m - stretch.first.height_m) / rise);
  return stretch;
}

/// Adds the places of a stretch that pass a test, and the ends of the parts that do.
void add(const Silhouette& silhouette, const Stretch& stretch, int side, const std::vector<double>& parameters,
         const Test& test, std::vector<SilhouettePoint>& out) {
  constexpr double off_end = 1e-6;  // the foot of a wall stands on the floor as well
  const auto place = [&](double parameter) { return silhouette.at(stretch.at(std::max(parameter, off_end)), side); };
  const auto holds = [&](double parameter) { return test(stretch, place(parameter), side); };
  bool before = false;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const bool here = holds(parameters[i]);
    if (i > 0 && here != before) {
      double in = here ? parameters[i] : parameters[i - 1];
      double beyond = here ? parameters[i - 1] : parameters[i];
      for (int k = 0; k < 25; ++k) {
        const double middle = 0.5 * (in + beyond);
        (holds(middle) ? in : beyond) = middle;
      }
      out.push_back(place(in));
    }
    if (here) out.push_back(place(parameters[i]));
    before = here;
  }
}

}  // namespace

FinishedProfile finished_profile(const SpatialMilling& milling, double depth_m, const cutting::Engagement& engagement,
                                 double step_rad) {
  FinishedProfile out;
  if (engagement.empty()) return out;
  const cutting::Profile profile(milling.cutter);
  const Silhouette silhouette(profile, engagement.feed_from_tool);
  const double top_m = highest_m(engagement);
  double lag_rad_per_m = 0.0;
  for (int j = 0; j < milling.cutter.mill.teeth; ++j) {
    lag_rad_per_m = std::max(lag_rad_per_m, std::abs(milling.cutter.mill.lag_rad_per_m(j)));
  }
  const auto gather = [&](const Test& test) {
    for (const int side : {-1, 1}) {
      for (const Stretch& whole : silhouette.stretches()) {
        if (whole.first.height_m > top_m) continue;
        const Stretch stretch = below(whole, top_m);
        const double lag_rad = lag_rad_per_m * (stretch.last.height_m - stretch.first.height_m);
        const double turning_rad = std::max(stretch.last.position_rad - stretch.first.position_rad, 1e-9);
        const double angle_step = step_rad / (1.0 + lag_rad / turning_rad);
        const double line_share = std::clamp(step_rad / std::max(lag_rad, 1e-9), 1e-3, 0.1);
        add(silhouette, stretch, side, silhouette.parameters(stretch, side, angle_step, line_share), test, out.places);
      }
    }
  };
  if (milling.engagement) {
    const RingEnds rings(engagement, silhouette);
    gather([&](const Stretch& stretch, const SilhouettePoint& place, int side) {
      return rings.leave(stretch, place, side);
    });
    return out;
  }
  const Passes passes(milling.cut, depth_m, silhouette);
  const auto leave = [&](const Stretch&, const SilhouettePoint& place, int) { return passes.leave(place.position_m); };
  gather([&](const Stretch& stretch, const SilhouettePoint& place, int side) {
    return leave(stretch, place, side) && passes.keep(place.position_m);
  });
  out.remains = !out.places.empty();
  if (!out.remains) gather(leave);
  return out;
}

}  // namespace robomill::stability::detail
