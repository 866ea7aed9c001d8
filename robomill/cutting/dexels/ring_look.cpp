#include "robomill/cutting/dexels/ring_look.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <optional>

namespace robomill::cutting::detail {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double sliding = 1e-9;  ///< n·v of a face that slides along, from rounding, per speed

/// a sin φ + b cos φ + c > 0 on at most one range of φ.
std::optional<Arc> positive_arc(double a, double b, double c) {
  const double size = std::hypot(a, b);
  if (c >= size) return c > 0.0 ? std::optional(Arc{.entry_rad = 0.0, .exit_rad = 2.0 * pi}) : std::nullopt;
  if (c <= -size) return std::nullopt;
  const double middle = std::atan2(a, b);
  const double half = std::acos(-c / size);
  return Arc{.entry_rad = middle - half, .exit_rad = middle + half};
}

/// The part of a ring whose points move outwards: at most one range.
std::optional<Arc> front_of(const EdgeSlice& slice, const Stand& stand) {
  const double sine = std::sin(slice.position_rad);
  const double cosine = std::cos(slice.position_rad);
  // n·v = n·v_tip + ω·(p × n), p × n = (r cos κ + z sin κ) e_z × e_r
  const double lever = slice.radius_m * cosine + slice.height_m * sine;
  return positive_arc(sine * stand.velocity.dot(stand.x) + lever * stand.turn.dot(stand.z.cross(stand.x)),
                      sine * stand.velocity.dot(stand.y) + lever * stand.turn.dot(stand.z.cross(stand.y)),
                      -cosine * stand.velocity.dot(stand.z) - sliding * stand.speed(slice));
}

}  // namespace

Arc normalised(double entry_rad, double exit_rad) {
  const double turn = 2.0 * pi;
  double start = entry_rad - turn * std::floor(entry_rad / turn);
  if (start >= turn) start = 0.0;  // what lies a rounding below 0
  return {.entry_rad = start, .exit_rad = start + std::min(exit_rad - entry_rad, turn)};
}

void RingLook::at(const EdgeSlice& slice, double angle_step_rad, Seen& seen) const {
  seen.arcs.clear();
  seen.depth_m = -part.dexel_m();
  const std::optional<Arc> front = front_of(slice, stand);
  if (!front) return;
  const Vector3d middle = stand.tip + slice.height_m * stand.z;
  const Vector3d reach =
      Vector3d::Constant(ahead_m) + slice.radius_m * (stand.x.cwiseAbs2() + stand.y.cwiseAbs2()).cwiseSqrt();
  if (part.is_far_off(middle - reach, middle + reach)) {
    seen.depth_m = part.farthest_m();
    return;
  }
  const auto depth_at = [&](double phi) {
    Vector3d p =
        stand.tip + slice.radius_m * (std::sin(phi) * stand.x + std::cos(phi) * stand.y) + slice.height_m * stand.z;
    if (ahead_m > 0.0) {
      const Vector3d v = stand.velocity + stand.turn.cross(p - stand.tip);
      if (const double speed = v.norm(); speed > 0.0) p += ahead_m / speed * v;
    }
    return part.depth_m(p);
  };
  const double length = front->exit_rad - front->entry_rad;
  const int cells = std::max(static_cast<int>(std::ceil(length / std::max(angle_step_rad, 1e-3))), 2);
  const double close_rad = close_m / std::max(slice.radius_m, close_m);
  double before = front->entry_rad;
  double depth_before = depth_at(before);
  double entry = before;
  seen.depth_m = depth_before;
  for (int i = 1; i <= cells; ++i) {
    const double phi = front->entry_rad + length * i / cells;
    const double depth = depth_at(phi);
    seen.depth_m = std::max(seen.depth_m, depth);
    if ((depth > 0.0) != (depth_before > 0.0)) {
      const double edge = crossing(depth_at, before, depth_before, phi, depth, close_rad);
      if (depth > 0.0) {
        entry = edge;
      } else {
        seen.arcs.push_back(normalised(entry, edge));
      }
    }
    before = phi;
    depth_before = depth;
  }
  if (depth_before > 0.0) seen.arcs.push_back(normalised(entry, before));
}

}  // namespace robomill::cutting::detail
