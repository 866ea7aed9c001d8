#include "robomill/path/speed/speed_kernels.hpp"

namespace robomill::path {
namespace {

/// Lanes from k on, as one register.
template <class V>
__attribute__((always_inline)) inline const V& load(const double* from) {
  return *reinterpret_cast<const V*>(from);
}
template <class V>
__attribute__((always_inline)) inline V& store(double* to) {
  return *reinterpret_cast<V*>(to);
}

}  // namespace

ROBOMILL_KERNEL_CORE void assemble_core(Assembly& a, std::size_t k) {
  const V c1 = load<V>(a.c1 + k), c2 = load<V>(a.c2 + k), c3 = load<V>(a.c3 + k);
  V z[sides];
  for (std::size_t side = 0; side < sides; ++side) {
    z[side] = load<V>((*a.z)[side].data() + k) + a.dual_step * load<V>((*a.dz)[side].data() + k);
    store<V>((*a.z)[side].data() + k) = z[side];
  }
  // Acceleration: g = A ∓ (c2 b + c1 b' / 2).
  const V half = 0.5 * c1;
  const V value = c2 * a.at.b + half * a.at.first;
  const V limit = load<V>(a.acceleration + k) * a.acceleration_scale;
  const V up = 1.0 / (limit - value), down = 1.0 / (limit + value);
  V w = z[0] * up + z[1] * down;
  V pull = a.mu * (down - up);
  V bb = w * c2 * c2, bf = w * c2 * half, ff = w * half * half;
  V rb = pull * c2, rf = pull * half;
  V gap = z[0] * (limit - value) + z[1] * (limit + value);
  // Jerk: g = R ∓ (c3 b + 3/2 c2 b' + c1 b''/2), R = J / √b, dR/db = −R / (2 b).
  const V c2x = 1.5 * c2;
  const V of = c3 * a.at.b + c2x * a.at.first + half * a.at.second;
  const V r = load<V>(a.jerk + k) * a.root_b_inverse_scale;
  const V dr = r * (-0.5 / a.at.b);
  const V above = 1.0 / (r - of), below = 1.0 / (r + of);
  const V wa = z[2] * above, wb = z[3] * below;
  w = wa + wb;
  const V skew = (wb - wa) * dr;
  bb += w * (dr * dr + c3 * c3) + 2.0 * skew * c3;
  bf += w * c3 * c2x + skew * c2x;
  const V bs = w * c3 * half + skew * half;
  ff += w * c2x * c2x;
  const V fs = w * c2x * half;
  const V ss = w * half * half;
  pull = a.mu * (below - above);
  rb += pull * c3 + a.mu * (above + below) * dr;
  rf += pull * c2x;
  const V rs = pull * half;
  gap += z[2] * (r - of) + z[3] * (r + of);
  const V sums[10] = {bb, bf, bs, ff, fs, ss, rb, rf, rs, gap};
  for (std::size_t i = 0; i < 10; ++i) store<V>(a.sum[i] + k) = sums[i];
}
ROBOMILL_KERNEL(assemble, Assembly)

/// One side: how far it may go, and its dual's step.
template <class V>
__attribute__((always_inline)) inline void step_side(const Stepping& a, std::size_t side, std::size_t k, const V& g,
                                                     const V& dg, V& primal, V& dual) {
  const V z = load<V>((*a.z)[side].data() + k);
  const V inverse = 1.0 / g;
  const V dz = inverse * (a.mu - z * dg) - z;
  store<V>((*a.dz)[side].data() + k) = dz;
  const V way = -dg * inverse, dual_way = -dz / z;
  primal = primal > way ? primal : way;
  dual = dual > dual_way ? dual : dual_way;
}

ROBOMILL_KERNEL_CORE void step_core(Stepping& a, std::size_t k) {
  const V c1 = load<V>(a.c1 + k), c2 = load<V>(a.c2 + k), c3 = load<V>(a.c3 + k);
  const V half = 0.5 * c1;
  V primal = load<V>(a.primal + k), dual = load<V>(a.dual + k);
  const V value = c2 * a.at.b + half * a.at.first, change = c2 * a.change.b + half * a.change.first;
  const V limit = load<V>(a.acceleration + k) * a.acceleration_scale;
  step_side<V>(a, 0, k, limit - value, -change, primal, dual);
  step_side<V>(a, 1, k, limit + value, change, primal, dual);
  const V c2x = 1.5 * c2;
  const V of = c3 * a.at.b + c2x * a.at.first + half * a.at.second;
  const V dof = c3 * a.change.b + c2x * a.change.first + half * a.change.second;
  const V r = load<V>(a.jerk + k) * a.root_b_inverse_scale;
  const V dr = r * (-0.5 / a.at.b * a.change.b);
  step_side<V>(a, 2, k, r - of, dr - dof, primal, dual);
  step_side<V>(a, 3, k, r + of, dr + dof, primal, dual);
  store<V>(a.primal + k) = primal;
  store<V>(a.dual + k) = dual;
}
ROBOMILL_KERNEL(step, Stepping)

void add_lanes(const double (&lanes)[10][lane_count], double (&sum)[10]) {
  using Two = Register<2>::Type;
  for (std::size_t i = 0; i < 10; ++i) {
    const double* v = lanes[i];
    const Two pair = (load<Two>(v) + load<Two>(v + 2)) + (load<Two>(v + 4) + load<Two>(v + 6));
    sum[i] = pair[0] + pair[1];
  }
}

}  // namespace robomill::path
