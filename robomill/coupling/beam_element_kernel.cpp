#include "robomill/coupling/beam_element_kernel.hpp"

#include <array>

// Every function with vectors in its signature is inlined always, so that no call ever passes one.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace robomill::coupling::detail {
namespace {

#define INLINE __attribute__((always_inline)) inline

template <class V>
struct Z {
  V re, im;
};

template <class V>
INLINE Z<V> operator+(const Z<V>& a, const Z<V>& b) {
  return {a.re + b.re, a.im + b.im};
}
template <class V>
INLINE Z<V> operator-(const Z<V>& a, const Z<V>& b) {
  return {a.re - b.re, a.im - b.im};
}
template <class V>
INLINE Z<V> operator*(const Z<V>& a, const Z<V>& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
template <class V>
INLINE Z<V> operator*(double a, const Z<V>& b) {
  return {a * b.re, a * b.im};
}
template <class V>
INLINE Z<V> operator*(const std::complex<double>& a, const Z<V>& b) {
  return {a.real() * b.re - a.imag() * b.im, a.real() * b.im + a.imag() * b.re};
}
template <class V>
INLINE Z<V> inverse(const Z<V>& a) {
  const V size = 1.0 / (a.re * a.re + a.im * a.im);
  return {a.re * size, -a.im * size};
}

/// 2 x 2, in the order (u, θ).
template <class V>
struct M {
  Z<V> uu, ut, tu, tt;
};
template <class V>
INLINE M<V> operator*(const M<V>& a, const M<V>& b) {
  return {a.uu * b.uu + a.ut * b.tu, a.uu * b.ut + a.ut * b.tt, a.tu * b.uu + a.tt * b.tu, a.tu * b.ut + a.tt * b.tt};
}
template <class V>
INLINE M<V> operator+(const M<V>& a, const M<V>& b) {
  return {a.uu + b.uu, a.ut + b.ut, a.tu + b.tu, a.tt + b.tt};
}
/// A symmetric one.
template <class V>
struct S {
  Z<V> uu, ut, tt;
};
template <class V>
INLINE S<V> operator+(const S<V>& a, const S<V>& b) {
  return {a.uu + b.uu, a.ut + b.ut, a.tt + b.tt};
}
template <class V>
INLINE S<V> operator-(const S<V>& a, const S<V>& b) {
  return {a.uu - b.uu, a.ut - b.ut, a.tt - b.tt};
}
template <class V>
INLINE M<V> full(const S<V>& a) {
  return {a.uu, a.ut, a.ut, a.tt};
}
template <class V>
INLINE M<V> transpose(const M<V>& a) {
  return {a.uu, a.tu, a.ut, a.tt};
}
template <class V>
INLINE M<V> inverse(const M<V>& a) {
  const Z<V> d = inverse(a.uu * a.tt - a.ut * a.tu);
  return {a.tt * d, -1.0 * (a.ut * d), -1.0 * (a.tu * d), a.uu * d};
}

template <class V>
INLINE Z<V> load(const ComplexLanes& from, std::size_t lane) {
  return {*reinterpret_cast<const V*>(from.re.v + lane), *reinterpret_cast<const V*>(from.im.v + lane)};
}
template <class V>
INLINE void store(const Z<V>& value, ComplexLanes& to, std::size_t lane) {
  *reinterpret_cast<V*>(to.re.v + lane) = value.re;
  *reinterpret_cast<V*>(to.im.v + lane) = value.im;
}
template <class V>
INLINE M<V> load(const ComplexLanes (&from)[4], std::size_t lane) {
  return {load<V>(from[0], lane), load<V>(from[1], lane), load<V>(from[2], lane), load<V>(from[3], lane)};
}
template <class V>
INLINE void store(const M<V>& value, ComplexLanes (&to)[4], std::size_t lane) {
  store(value.uu, to[0], lane);
  store(value.ut, to[1], lane);
  store(value.tu, to[2], lane);
  store(value.tt, to[3], lane);
}

constexpr int series_terms = 13;  // 4^13 / 28! is below the last bit
/// 1 / (2k + first)!
constexpr std::array<double, series_terms> inverse_factorials(int first) {
  std::array<double, series_terms> out{};
  double factorial = 1.0;
  for (int i = 2; i <= first; ++i) factorial *= i;
  for (int k = 0; k < series_terms; ++k) {
    out[static_cast<std::size_t>(k)] = 1.0 / factorial;
    factorial *= (2.0 * k + first + 1.0) * (2.0 * k + first + 2.0);
  }
  return out;
}
constexpr std::array<double, series_terms> cosine_terms = inverse_factorials(2);
constexpr std::array<double, series_terms> sine_terms = inverse_factorials(3);

template <class V>
INLINE Z<V> series(const std::array<double, series_terms>& terms, const Z<V>& q) {
  Z<V> sum = {V{} + terms.back(), V{}};
  for (std::size_t k = terms.size() - 1; k-- > 0;) {
    sum = sum * q;
    sum.re += terms[k];
  }
  return sum;
}

ROBOMILL_KERNEL_CORE void beam_element_numbers_core(BeamElementWork& w, std::size_t lane) {
  const Section& s = w.section;
  const std::complex<double> compliance = 1.0 / s.loss;
  const V omega2 = *reinterpret_cast<const V*>(w.omega2.v + lane);
  const Z<V> unit = {compliance.real() * omega2, compliance.imag() * omega2};
  const Z<V> bending = s.bending * unit;
  const Z<V> difference = (0.5 * (s.rotary - s.shear)) * unit;
  store(bending, w.bending, lane);
  store(s.rotary * unit, w.rotary, lane);
  store(s.shear * unit, w.shear, lane);
  store(difference * difference + bending, w.discriminant, lane);
}

ROBOMILL_KERNEL_CORE void beam_element_waves_core(BeamElementWork& w, std::size_t lane) {
  const Z<V> mean = -0.5 * (load<V>(w.rotary, lane) + load<V>(w.shear, lane));
  const Z<V> root = load<V>(w.root, lane);
  store(mean + root, w.q[0], lane);
  store(mean - root, w.q[1], lane);
}

ROBOMILL_KERNEL_CORE void beam_element_series_core(BeamElementWork& w, std::size_t lane) {
  const Z<V> one = {V{} + 1.0, V{}};
  const Z<V> q1 = load<V>(w.q[0], lane);
  const Z<V> q2 = load<V>(w.q[1], lane);
  const Z<V> c1 = series(cosine_terms, q1);
  const Z<V> c2 = series(cosine_terms, q2);
  const Z<V> s1 = series(sine_terms, q1);
  const Z<V> s2 = series(sine_terms, q2);
  store(one + q1 * c1, w.cosine[0], lane);
  store(one + q2 * c2, w.cosine[1], lane);
  store(one + q1 * s1, w.sine[0], lane);
  store(one + q2 * s2, w.sine[1], lane);
  // T_1 C_2 - T_2 C_1 with the ones, which cancel, left out.
  store(q1 * (s1 - c1) - q2 * (s2 - c2) + q1 * q2 * (s1 * c2 - s2 * c1), w.x, lane);
}

ROBOMILL_KERNEL_CORE void beam_element_matrices_core(BeamElementWork& w, std::size_t lane) {
  const Z<V> bending = load<V>(w.bending, lane);
  const Z<V> rotary = load<V>(w.rotary, lane);
  const Z<V> shear = load<V>(w.shear, lane);
  const Z<V> c1 = load<V>(w.cosine[0], lane);
  const Z<V> c2 = load<V>(w.cosine[1], lane);
  const Z<V> s1 = load<V>(w.sine[0], lane);
  const Z<V> s2 = load<V>(w.sine[1], lane);
  const Z<V> d = 2.0 * load<V>(w.root, lane);
  const Z<V> x = load<V>(w.x, lane);
  const Z<V> y = load<V>(w.q[0], lane) * s1 * c2 - load<V>(w.q[1], lane) * s2 * c1;
  const Z<V> cc = d * c1 * c2;
  const Z<V> ss = d * s1 * s2;
  const Z<V> mu = bending - shear * rotary;
  // Dynamic stiffness of an end in motion symmetric and antisymmetric about the middle, and the inverses.
  const Z<V> even = inverse(y + shear * x);
  const Z<V> odd = inverse(shear * y - mu * x);
  const S<V> stiff_even = {-1.0 * (bending * ss * even), -1.0 * (bending * x * even), cc * even};
  const S<V> stiff_odd = {bending * cc * odd, -1.0 * (bending * y * odd), mu * ss * odd};
  const Z<V> even_free = inverse(y + rotary * x);
  const Z<V> odd_free = inverse(mu * x - rotary * y);
  const Z<V> inertance = inverse(bending);
  const S<V> soft_even = {-1.0 * (cc * inertance * even_free), -1.0 * (x * even_free), ss * even_free};
  const S<V> soft_odd = {mu * ss * inertance * odd_free, y * odd_free, cc * odd_free};
  // An end stands for half of each motion.
  const M<V> compliance = inverse(full(stiff_even + stiff_odd));
  const M<V> free = inverse(full(soft_even + soft_odd));
  const M<V> carry = compliance * full(stiff_even - stiff_odd);
  // From half lengths and E I to SI; the first end's slope turns its sign in the mirror.
  const double h = w.section.half_length_m;
  const std::complex<double> stiffness = 2.0 * w.section.bending_stiffness_n_m2 * w.section.loss / (h * h * h);
  const std::complex<double> softness = 4.0 / stiffness;
  const M<V> clamped = {softness * compliance.uu, (-1.0 / h) * (softness * compliance.ut),
                        (-1.0 / h) * (softness * compliance.tu), (1.0 / (h * h)) * (softness * compliance.tt)};
  store(clamped, w.element.clamped, lane);
  store(M<V>{-1.0 * carry.uu, -h * carry.ut, (1.0 / h) * carry.tu, carry.tt}, w.element.carry, lane);
  store(
      M<V>{stiffness * free.uu, h * (stiffness * free.ut), h * (stiffness * free.tu), (h * h) * (stiffness * free.tt)},
      w.element.stiffness, lane);
}

ROBOMILL_KERNEL_CORE void beam_element_join_core(BeamElementJoin& join, std::size_t lane) {
  const M<V> front_clamped = load<V>(join.front.clamped, lane);
  const M<V> front_carry = load<V>(join.front.carry, lane);
  const M<V> front_stiffness = load<V>(join.front.stiffness, lane);
  const M<V> back_clamped = load<V>(join.back.clamped, lane);
  const M<V> back_carry = load<V>(join.back.carry, lane);
  M<V> moved = back_clamped * front_stiffness;
  moved.uu.re += 1.0;
  moved.tt.re += 1.0;
  const M<V> share = inverse(moved);
  const M<V> through = share * back_carry;
  store(front_clamped + front_carry * (share * back_clamped) * transpose(front_carry), join.front.clamped, lane);
  store(front_carry * through, join.front.carry, lane);
  store(load<V>(join.back.stiffness, lane) + transpose(back_carry) * (front_stiffness * through), join.front.stiffness,
        lane);
}

}  // namespace

ROBOMILL_KERNEL(beam_element_numbers, BeamElementWork)
ROBOMILL_KERNEL(beam_element_waves, BeamElementWork)
ROBOMILL_KERNEL(beam_element_series, BeamElementWork)
ROBOMILL_KERNEL(beam_element_matrices, BeamElementWork)
ROBOMILL_KERNEL(beam_element_join, BeamElementJoin)

}  // namespace robomill::coupling::detail
