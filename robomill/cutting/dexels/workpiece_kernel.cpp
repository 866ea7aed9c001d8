#include "robomill/cutting/dexels/workpiece_kernel.hpp"

#include <cmath>
#include <limits>

// Every function with vectors in its signature is inlined always, so that no call ever passes one.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace robomill::cutting::detail {
namespace {

#define INLINE __attribute__((always_inline)) inline

constexpr double none = std::numeric_limits<double>::infinity();
constexpr double rounding_m = 1e-12;  ///< where circle and face meet, one of both must be found

template <class V>
INLINE V all(double x) {
  return V{} + x;
}
template <class V>
INLINE V least(V a, V b) {
  return a < b ? a : b;
}
template <class V>
INLINE V most(V a, V b) {
  return a > b ? a : b;
}
template <class V>
INLINE V root_of(V x) {
  V out = {};
  for (std::size_t i = 0; i < sizeof(V) / sizeof(double); ++i) out[i] = std::sqrt(x[i]);
  return out;
}

template <class V>
struct Reach {
  V from, to;
};

/// Roots of a t² + 2 b t + c with inverse = 1 / a > 0; none where there is none.
template <class V>
INLINE Reach<V> roots(double inverse, V b, V ac) {
  const V discriminant = b * b - ac;
  const V root = root_of<V>(most<V>(discriminant, all<V>(0.0)));
  const V far = all<V>(none);
  return {discriminant < 0.0 ? far : (-b - root) * inverse, discriminant < 0.0 ? -far : (root - b) * inverse};
}

template <class V>
struct Rays {
  V ww, wu, wd, wz;
};

/// Circle at one λ.
template <class V>
INLINE Reach<V> standing(const Meeting& m, const Rays<V>& r, V lambda) {
  const V c = r.ww - 2.0 * lambda * r.wd + lambda * lambda * m.dd - m.radius * m.radius;
  return roots<V>(1.0 / m.uu, r.wu - lambda * m.ud, m.uu * c);
}

/// Circle swept over λ in [first, last]; at_from and at_to are where its ends stand. An endless sweep ends where λ need
/// not be in [first, last]; the ends of the bounded one are at the λ there nearest.
template <class V>
INLINE Reach<V> round_sweep(const Meeting& m, const Rays<V>& r, V first, V last, V& at_from, V& at_to) {
  at_from = first;
  at_to = first;
  if (m.way == Meeting::Way::none) return standing<V>(m, r, first);
  if (m.way == Meeting::Way::along) {
    const Reach<V> begin = standing<V>(m, r, first);
    const Reach<V> end = standing<V>(m, r, last);
    at_from = begin.from <= end.from ? first : last;
    at_to = begin.to >= end.to ? first : last;
    return {least<V>(begin.from, end.from), most<V>(begin.to, end.to)};
  }
  const double per_dd = 1.0 / m.dd;
  const double a = m.uu - m.ud * m.ud * per_dd;
  const V b = r.wu - r.wd * (m.ud * per_dd);
  const V c = r.ww - r.wd * r.wd * per_dd - m.radius * m.radius;
  const Reach<V> endless = roots<V>(1.0 / a, b, a * c);
  const auto misses = endless.from > endless.to;
  at_from = misses ? first : least<V>(most<V>((r.wd + endless.from * m.ud) * per_dd, first), last);
  at_to = misses ? first : least<V>(most<V>((r.wd + endless.to * m.ud) * per_dd, first), last);
  const Reach<V> from = standing<V>(m, r, at_from);
  const Reach<V> to = standing<V>(m, r, at_to);
  return {misses ? all<V>(none) : from.from, misses ? all<V>(-none) : to.to};
}

/// λ of the circle about a place that moves along: |p - λ g| <= radius.
template <class V>
INLINE Reach<V> within_circle(const Meeting& m, double gg, V pg, V pp) {
  if (gg > 1e-24) {
    const Reach<V> inside = roots<V>(1.0 / gg, -pg, gg * (pp - m.radius * m.radius));
    return {most<V>(inside.from, all<V>(0.0)), least<V>(inside.to, all<V>(1.0))};
  }
  const auto out = pp > m.radius * m.radius;
  return {out ? all<V>(none) : all<V>(0.0), out ? all<V>(-none) : all<V>(1.0)};
}

/// Rays along the axis: both ends stand on a face.
template <class V>
INLINE Reach<V> along_axis(const Meeting& m, const Rays<V>& r) {
  const Reach<V> lambda = within_circle<V>(m, m.dd, r.wd, r.ww);
  const auto misses = lambda.from > lambda.to;
  const V first = m.dz * (misses ? all<V>(0.0) : lambda.from);
  const V last = m.dz * (misses ? all<V>(0.0) : lambda.to);
  const V bottom = m.low - r.wz + least<V>(first, last);
  const V top = m.high - r.wz + most<V>(first, last);
  return {misses ? all<V>(none) : m.uz > 0.0 ? bottom : -top, misses ? all<V>(-none) : m.uz > 0.0 ? top : -bottom};
}

/// Ends on a face: t is linear in λ there, and λ bounded by the circle and [0, 1].
template <class V>
INLINE Reach<V> on_face(const Meeting& m, const Rays<V>& r, double face) {
  const double rate = m.dz / m.uz;
  const V t0 = (face - r.wz) * (1.0 / m.uz);
  const double gg = rate * rate * m.uu - 2.0 * rate * m.ud + m.dd;
  const V pg = r.wd + t0 * m.ud - rate * (r.wu + t0 * m.uu);
  const V pp = r.ww + 2.0 * t0 * r.wu + t0 * t0 * m.uu;
  const Reach<V> lambda = within_circle<V>(m, gg, pg, pp);
  const auto misses = lambda.from > lambda.to;
  const V a = t0 + rate * (misses ? all<V>(0.0) : lambda.from);
  const V b = t0 + rate * (misses ? all<V>(0.0) : lambda.to);
  return {misses ? all<V>(none) : least<V>(a, b), misses ? all<V>(-none) : most<V>(a, b)};
}

template <class V>
INLINE Reach<V> oblique(const Meeting& m, const Rays<V>& r) {
  V at_from = {};
  V at_to = {};
  const Reach<V> round = round_sweep<V>(m, r, all<V>(0.0), all<V>(1.0), at_from, at_to);
  const auto misses = round.from > round.to;
  const V z_from = misses ? all<V>(m.low) : r.wz + round.from * m.uz - at_from * m.dz;
  const V z_to = misses ? all<V>(m.low) : r.wz + round.to * m.uz - at_to * m.dz;
  const V from_off = most<V>(m.low - z_from, z_from - m.high);
  const V to_off = most<V>(m.low - z_to, z_to - m.high);
  bool all_within = true;
  for (std::size_t i = 0; i < sizeof(V) / sizeof(double); ++i) {
    all_within = all_within && from_off[i] <= rounding_m && to_off[i] <= rounding_m;
  }
  if (all_within) return round;
  const Reach<V> low = on_face<V>(m, r, m.low);
  const Reach<V> high = on_face<V>(m, r, m.high);
  const V face_from = least<V>(low.from, high.from);
  const V face_to = most<V>(low.to, high.to);
  const auto gone = face_from > face_to;
  const V from = from_off <= rounding_m ? round.from : face_from;
  const V to = to_off <= rounding_m ? round.to : face_to;
  const auto keep = (from_off <= rounding_m) & (to_off <= rounding_m);
  return {misses ? all<V>(none)
          : keep ? round.from
          : gone ? all<V>(none)
                 : from,
          misses ? all<V>(-none)
          : keep ? round.to
          : gone ? all<V>(-none)
                 : to};
}

/// Rays across the axis, and those that meet a ball.
template <class V>
INLINE Reach<V> across_axis(const Meeting& m, const Rays<V>& r) {
  V first = all<V>(0.0);
  V last = all<V>(1.0);
  auto out = first > last;
  if (m.faces && std::abs(m.dz) < 1e-15) {
    out = (r.wz < m.low) | (r.wz > m.high);
  } else if (m.faces) {
    const V a = (r.wz - m.high) * (1.0 / m.dz);
    const V b = (r.wz - m.low) * (1.0 / m.dz);
    first = most<V>(first, least<V>(a, b));
    last = least<V>(last, most<V>(a, b));
    out = first > last;
    first = out ? all<V>(0.0) : first;
    last = out ? all<V>(1.0) : last;
  }
  V at_from = {};
  V at_to = {};
  const Reach<V> round = round_sweep<V>(m, r, first, last, at_from, at_to);
  return {out ? all<V>(none) : round.from, out ? all<V>(-none) : round.to};
}

ROBOMILL_KERNEL_CORE void meet_kernel_core(Meeting& m, std::size_t offset) {
  const V w_column = *reinterpret_cast<const V*>(m.w_column.v + offset);
  Rays<V> r = {};
  r.wz = w_column * m.axis_column + m.w_row * m.axis_row;
  const V column = w_column - r.wz * m.axis_column;
  const V row = m.w_row - r.wz * m.axis_row;
  r.wu = -r.wz * m.axis_ray;
  r.ww = column * column + row * row + r.wu * r.wu;
  r.wd = column * m.way_column + row * m.way_row + r.wu * m.way_ray;
  const Reach<V> reach = m.tilt == Meeting::Tilt::across    ? across_axis<V>(m, r)
                         : m.tilt == Meeting::Tilt::oblique ? oblique<V>(m, r)
                                                            : along_axis<V>(m, r);
  *reinterpret_cast<V*>(m.from.v + offset) = reach.from;
  *reinterpret_cast<V*>(m.to.v + offset) = reach.to;
}

ROBOMILL_KERNEL(meet_kernel, Meeting)

}  // namespace

void meet(Meeting& meeting) {
  meet_kernel(meeting);
}

}  // namespace robomill::cutting::detail
