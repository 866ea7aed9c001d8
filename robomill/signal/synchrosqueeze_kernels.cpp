#include "robomill/signal/synchrosqueeze_kernels.hpp"

// Every function with vectors in its signature is inlined always, so that no call ever passes one.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace robomill::signal {
namespace {

#define INLINE __attribute__((always_inline)) inline

template <class V>
INLINE const V& load(const double* from) {
  return *reinterpret_cast<const V*>(from);
}
template <class V>
INLINE V& store(double* to) {
  return *reinterpret_cast<V*>(to);
}
/// From a place that is no multiple of the register's size.
template <class V>
INLINE V load_any(const double* from) {
  V out;
  __builtin_memcpy(&out, from, sizeof(V));
  return out;
}

template <class V>
struct Pair {
  V re, im;
};

// A comparison stands in the condition of one ?: alone: g++ 12 takes masks of 512 bits apart, lane by lane.
template <class V>
INLINE void add_to_bands(const Squeeze& a, std::size_t k, const V& to, const V& way, const V& share) {
  constexpr auto reach = static_cast<double>(band_reach);
  const std::size_t group = k / lane_count, lane = k % lane_count;
  const V none = {}, one = none + 1.0, distance = way > -way ? way : -way;
  const V far = distance > reach ? one : none;
  store<V>(a.far[group / far_groups].v + lane) += far * static_cast<double>(std::uint64_t{1} << (group % far_groups));
  const V near = share * (1.0 - far);
  const std::size_t lowest = a.lowest[group], highest = a.highest[group];
  V above = to >= a.edge[lowest] ? near : none;  // what is not below the band, then what is above it
  for (std::size_t b = lowest; b <= highest; ++b) {
    const V next = to >= a.edge[b + 1] ? near : none;
    store<V>(a.sums[b].v + lane) += above - next;
    above = next;
  }
}

template <class V>
INLINE void send(const Squeeze& a, std::size_t k, const Pair<V>& v, const Pair<V>& slope) {
  const V line = load<V>(a.line + k);
  const V power = v.re * v.re + v.im * v.im;
  const V shift = (slope.re * v.re + slope.im * v.im) / (power + power);
  V to = ((line - shift) + rounding_shift) - rounding_shift;
  to = power > a.threshold_squared ? to : line;
  to = to >= 0.0 ? to : line;  // not where it is no number
  to = to <= a.last_line ? to : line;
  const V share = load<V>(a.weight + k) * v.re;
  store<V>(a.target + k) = to + rounding_shift;
  store<V>(a.share + k) = share;
  if (a.bands != 0) add_to_bands<V>(a, k, to, to - line, share);
}

template <class V, std::size_t known_terms>
INLINE void squeeze_terms(const Squeeze& a, std::size_t at) {
  const std::size_t terms = known_terms == 0 ? a.terms : known_terms;
  for (std::size_t k = at; k < a.groups * lane_count; k += lane_count) {
    Pair<V> v = {a.mix[0] * load<V>(a.re + k), a.mix[0] * load<V>(a.im + k)};
    Pair<V> slope = {V{}, V{}};
    for (std::size_t j = 1; j < terms; ++j) {
      const Pair<V> below = {load_any<V>(a.re + k - j), load_any<V>(a.im + k - j)};
      const Pair<V> above = {load_any<V>(a.re + k + j), load_any<V>(a.im + k + j)};
      v.re += a.mix[j] * (below.re + above.re);
      v.im += a.mix[j] * (below.im + above.im);
      slope.re += a.slope[j] * (below.re - above.re);
      slope.im += a.slope[j] * (below.im - above.im);
    }
    store<V>(a.v_re + k) = v.re;
    store<V>(a.v_im + k) = v.im;
    send<V>(a, k, v, slope);
  }
}

}  // namespace

ROBOMILL_KERNEL_CORE void slide_core(Slide& given, std::size_t at) {
  const Slide a = given;  // its own, that no store may change
  for (std::size_t k = at; k < a.groups * lane_count; k += lane_count) {
    const V re = load<V>(a.re + k) + a.input, im = load<V>(a.im + k);
    const V c = load<V>(a.turn_re + k), s = load<V>(a.turn_im + k);
    store<V>(a.re + k) = re * c - im * s;
    store<V>(a.im + k) = re * s + im * c;
  }
}
ROBOMILL_KERNEL(slide, Slide)

ROBOMILL_KERNEL_CORE void squeeze_core(Squeeze& given, std::size_t at) {
  const Squeeze a = given;
  if (a.terms == 2) return squeeze_terms<V, 2>(a, at);
  squeeze_terms<V, 0>(a, at);
}
ROBOMILL_KERNEL(squeeze, Squeeze)

ROBOMILL_KERNEL_CORE void reassign_core(Squeeze& given, std::size_t at) {
  const Squeeze a = given;
  for (std::size_t k = at; k < a.groups * lane_count; k += lane_count) {
    send<V>(a, k, {load<V>(a.v_re + k), load<V>(a.v_im + k)}, {load<V>(a.a_re + k), load<V>(a.a_im + k)});
  }
}
ROBOMILL_KERNEL(reassign, Squeeze)

}  // namespace robomill::signal
