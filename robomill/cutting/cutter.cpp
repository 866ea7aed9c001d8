#include "robomill/cutting/cutter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "robomill/base/error.hpp"

namespace robomill::cutting {
namespace {

using std::numbers::pi;
using Point = Profile::Point;
using Piece = Profile::Piece;

/// The corner's circle and what it lies between, whatever kind the cutter is of.
struct Outline {
  double radius = 0.0, center_radius = 0.0, center_height = 0.0;
  double bottom_angle = 0.0, side_angle = 0.0;
  double half_diameter = 0.0, height = 0.0;
};

Outline outline_of(const Cutter& cutter) {
  const double half = 0.5 * cutter.mill.diameter_m;
  Outline o;
  o.half_diameter = half;
  o.height = cutter.cutting_height_m > 0.0 ? cutter.cutting_height_m : 4.0 * half;
  switch (cutter.kind) {
    case CutterKind::flat_end:
      break;
    case CutterKind::ball_end:
      o.radius = o.center_height = half;
      break;
    case CutterKind::bull_nose:
      o.radius = o.center_height = cutter.corner_radius_m;
      o.center_radius = half - cutter.corner_radius_m;
      break;
    case CutterKind::general:
      o.radius = cutter.corner_radius_m;
      o.center_radius = cutter.corner_center_radius_m;
      o.center_height = cutter.corner_center_height_m;
      o.bottom_angle = cutter.bottom_angle_rad;
      o.side_angle = cutter.side_angle_rad;
      break;
  }
  return o;
}

/// Where the line through (r, z) along (dr, dz), a unit vector, leaves the corner's circle (forward) or enters it; the
/// foot of the perpendicular where it only touches.
std::optional<Point> meet(const Outline& o, double r, double z, double dr, double dz, bool forward) {
  const double along = (o.center_radius - r) * dr + (o.center_height - z) * dz;
  const double away = (o.center_radius - r) * dz - (o.center_height - z) * dr;
  const double half_chord_squared = o.radius * o.radius - away * away;
  if (half_chord_squared < -1e-9 * o.radius * o.radius) return std::nullopt;
  const double half_chord = std::sqrt(std::max(half_chord_squared, 0.0));
  const double s = forward ? along + half_chord : along - half_chord;
  Point point = {.radius_m = r + s * dr, .height_m = z + s * dz};
  point.position_rad = std::atan2(point.radius_m - o.center_radius, o.center_height - point.height_m);
  return point;
}

void add(std::vector<Piece>& pieces, const Point& first, const Point& last, double arc_radius, double scale) {
  const double length = arc_radius > 0.0 ? arc_radius * (last.position_rad - first.position_rad)
                                         : std::hypot(last.radius_m - first.radius_m, last.height_m - first.height_m);
  if (!(length > 1e-12 * scale)) return;
  const double start = pieces.empty() ? 0.0 : pieces.back().start_m + pieces.back().length_m;
  pieces.push_back({.start_m = start, .length_m = length, .first = first, .last = last, .arc_radius_m = arc_radius});
}

[[noreturn]] void reject_corner(const char* what) {
  throw InvalidInput("corner_radius_m", std::string("must leave a convex outline: ") + what,
                     "Its centre stands at corner_center_radius_m from the axis, corner_center_height_m above the tip");
}

std::vector<Piece> pieces_of(const Outline& o) {
  const double tan_bottom = std::tan(o.bottom_angle);
  const double tan_side = std::tan(o.side_angle);
  const double side_position = 0.5 * pi - o.side_angle;
  Point leave = {.radius_m = o.half_diameter, .height_m = o.half_diameter * tan_bottom, .position_rad = o.bottom_angle};
  Point arrive = leave;
  if (o.radius > 0.0) {
    const std::optional<Point> bottom = meet(o, 0.0, 0.0, std::cos(o.bottom_angle), std::sin(o.bottom_angle), true);
    const double foot = o.half_diameter * (1.0 - tan_bottom * tan_side);  // the side, produced, at the tip's height
    const std::optional<Point> side = meet(o, foot, 0.0, std::sin(o.side_angle), std::cos(o.side_angle), false);
    if (!bottom) reject_corner("it does not reach the bottom");
    if (!side) reject_corner("it does not reach the side");
    leave = *bottom;
    arrive = *side;
    constexpr double slack = 1e-4;  // of an angle where a line only touches: the square root of what rounds
    if (leave.radius_m < -1e-9 * o.half_diameter) reject_corner("it crosses the axis");
    if (leave.position_rad < o.bottom_angle - slack) reject_corner("the bottom meets it from within");
    if (arrive.position_rad > side_position + slack) reject_corner("the side meets it from within");
    if (arrive.position_rad < leave.position_rad - slack) reject_corner("it ends before it begins");
    leave.radius_m = std::max(leave.radius_m, 0.0);
    arrive.position_rad = std::max(arrive.position_rad, leave.position_rad);
  }
  if (!(o.height > leave.height_m)) {
    throw InvalidInput("cutting_height_m", o.height, "m", "must reach above the bottom of the cutter");
  }
  std::vector<Piece> pieces;
  Point tip = {.position_rad = o.bottom_angle};
  Point bottom_end = leave;
  bottom_end.position_rad = o.bottom_angle;
  add(pieces, tip, bottom_end, 0.0, o.half_diameter);
  if (o.radius > 0.0) {
    if (o.height < arrive.height_m) {
      const double cosine = std::clamp((o.center_height - o.height) / o.radius, -1.0, 1.0);
      arrive.position_rad = std::acos(cosine);
      arrive.radius_m = o.center_radius + o.radius * std::sin(arrive.position_rad);
      arrive.height_m = o.height;
    }
    add(pieces, leave, arrive, o.radius, o.half_diameter);
  }
  if (o.height > arrive.height_m) {
    arrive.position_rad = side_position;
    const Point top = {.radius_m = arrive.radius_m + (o.height - arrive.height_m) * tan_side,
                       .height_m = o.height,
                       .position_rad = side_position};
    if (!(top.radius_m > 0.0)) {
      throw InvalidInput("side_angle_rad", o.side_angle, "rad",
                         "must leave the cutter thicker than nothing at its top");
    }
    add(pieces, arrive, top, 0.0, o.half_diameter);
  }
  return pieces;
}

}  // namespace

void Cutter::validate() const {
  mill.validate();
  require_non_negative("cutting_height_m", cutting_height_m, "m");
  if (cutting_height_m > 1.0) {
    throw InvalidInput("cutting_height_m", cutting_height_m, "m", "is too long for a cutter's edges",
                       "Are the units mixed up?");
  }
  if (kind == CutterKind::bull_nose) {
    require_positive("corner_radius_m", corner_radius_m, "m");
    if (!(corner_radius_m < 0.5 * mill.diameter_m)) {
      throw InvalidInput("corner_radius_m", corner_radius_m, "m", "must be less than half the diameter",
                         "A corner of half the diameter is a ball end");
    }
  }
  if (kind == CutterKind::general) {
    require_non_negative("corner_radius_m", corner_radius_m, "m");
    require_non_negative("corner_center_radius_m", corner_center_radius_m, "m");
    require_finite("corner_center_height_m", corner_center_height_m, "m");
    if (!(bottom_angle_rad >= 0.0 && bottom_angle_rad < 0.48 * pi)) {
      throw InvalidInput("bottom_angle_rad", bottom_angle_rad, "rad", "must lie between 0 and 86 degrees");
    }
    if (!(std::abs(side_angle_rad) < 0.48 * pi)) {
      throw InvalidInput("side_angle_rad", side_angle_rad, "rad", "must lie between -86 and 86 degrees");
    }
    if (!(bottom_angle_rad + side_angle_rad < 0.5 * pi)) {
      throw InvalidInput("side_angle_rad", side_angle_rad, "rad",
                         "must be less than 90 degrees less the bottom's angle");
    }
  }
  static_cast<void>(pieces_of(outline_of(*this)));
}

Profile::Profile(const Cutter& cutter) {
  cutter.validate();
  pieces_ = pieces_of(outline_of(cutter));
}

Profile::Point Profile::at(double length_m) const {
  const auto after = std::ranges::find_if(pieces_, [&](const Piece& p) { return length_m <= p.start_m + p.length_m; });
  const Piece& piece = after == pieces_.end() ? pieces_.back() : *after;
  const double share = std::clamp((length_m - piece.start_m) / piece.length_m, 0.0, 1.0);
  const double position = piece.first.position_rad + share * (piece.last.position_rad - piece.first.position_rad);
  if (piece.arc_radius_m > 0.0) {
    const double from = piece.first.position_rad;
    return {.radius_m = piece.first.radius_m + piece.arc_radius_m * (std::sin(position) - std::sin(from)),
            .height_m = piece.first.height_m + piece.arc_radius_m * (std::cos(from) - std::cos(position)),
            .position_rad = position};
  }
  return {.radius_m = piece.first.radius_m + share * (piece.last.radius_m - piece.first.radius_m),
          .height_m = piece.first.height_m + share * (piece.last.height_m - piece.first.height_m),
          .position_rad = position};
}

double Profile::radius_m(double height_m) const {
  for (const Piece& piece : pieces_) {
    if (height_m > piece.last.height_m || piece.last.height_m == piece.first.height_m) continue;
    if (piece.arc_radius_m > 0.0) {
      const double rise = std::max(height_m - piece.first.height_m, 0.0) / piece.arc_radius_m;
      const double from = piece.first.position_rad;
      const double cosine = std::clamp(std::cos(from) - rise, -1.0, 1.0);
      return piece.first.radius_m + piece.arc_radius_m * (std::sqrt((1.0 - cosine) * (1.0 + cosine)) - std::sin(from));
    }
    const double share = std::max(height_m - piece.first.height_m, 0.0) / (piece.last.height_m - piece.first.height_m);
    return piece.first.radius_m + share * (piece.last.radius_m - piece.first.radius_m);
  }
  return pieces_.back().last.radius_m;
}

double Profile::max_radius_m() const {
  double most = 0.0;
  for (const Piece& piece : pieces_) {
    const bool passes_equator = piece.arc_radius_m > 0.0 && piece.last.position_rad > 0.5 * pi;
    most = std::max({most, piece.first.radius_m, piece.last.radius_m,
                     passes_equator
                         ? radius_m(piece.first.height_m + piece.arc_radius_m * std::cos(piece.first.position_rad))
                         : 0.0});
  }
  return most;
}

double edge_length_per_width(const FlatEndMill& mill, int tooth, const Profile::Point& point) {
  return std::hypot(1.0, point.radius_m * std::sin(point.position_rad) * mill.lag_rad_per_m(tooth));
}

}  // namespace robomill::cutting
