#include "robomill/coupling/beam_element.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/coupling/beam_element_kernel.hpp"
#include "robomill/coupling/section.hpp"

namespace robomill::coupling::detail {
namespace {

using Complex = std::complex<double>;

constexpr double series_radius2 = 16.0;
constexpr std::size_t groups_per_block = 16;

Complex get(const ComplexLanes& from, std::size_t lane) {
  return {from.re.v[lane], from.im.v[lane]};
}

void set(ComplexLanes& to, std::size_t lane, const Complex& value) {
  to.re.v[lane] = value.real();
  to.im.v[lane] = value.imag();
}

/// The square root of the discriminant, whose real part is >= 0 for every loss factor up to 1.
void find_roots(BeamElementWork& work) {
  for (std::size_t l = 0; l < lane_count; ++l) {
    const double re = work.discriminant.re.v[l];
    const double im = work.discriminant.im.v[l];
    const double root = std::sqrt(0.5 * (std::sqrt(re * re + im * im) + re));
    work.root.re.v[l] = root;
    work.root.im.v[l] = 0.5 * im / root;
  }
}

bool in_series(const BeamElementWork& work) {
  double greatest = 0.0;
  for (const ComplexLanes& q : work.q) {
    for (std::size_t l = 0; l < lane_count; ++l) {
      greatest = std::max(greatest, q.re.v[l] * q.re.v[l] + q.im.v[l] * q.im.v[l]);
    }
  }
  return greatest <= series_radius2;
}

/// For waves longer than the series reaches: cosh and sinh over exp, so that nothing overflows.
void waves_over_exp(BeamElementWork& work) {
  for (std::size_t l = 0; l < lane_count; ++l) {
    for (std::size_t i = 0; i < 2; ++i) {
      const Complex wave = std::sqrt(get(work.q[i], l));
      const Complex back = std::exp(-2.0 * wave);
      set(work.cosine[i], l, 0.5 * (1.0 + back));
      set(work.sine[i], l, std::abs(wave) > 0.0 ? 0.5 * (1.0 - back) / wave : Complex(1.0));
    }
    set(work.x, l, get(work.sine[0], l) * get(work.cosine[1], l) - get(work.sine[1], l) * get(work.cosine[0], l));
  }
}

void find_beam_element(BeamElementWork& work) {
  beam_element_numbers(work);
  find_roots(work);
  beam_element_waves(work);
  if (in_series(work)) {
    beam_element_series(work);
  } else {
    waves_over_exp(work);
  }
  beam_element_matrices(work);
}

void unpack(const ComplexLanes (&from)[4], std::size_t lane, Eigen::Matrix2cd& to) {
  to << get(from[0], lane), get(from[1], lane), get(from[2], lane), get(from[3], lane);
}

}  // namespace

Eigen::Matrix2cd flexibility(const Joint& joint, double frequency_hz) {
  const Complex i_omega(0.0, 2.0 * std::numbers::pi * frequency_hz);
  Eigen::Matrix2cd stiffness;
  stiffness << joint.translational_stiffness_n_per_m + i_omega * joint.translational_damping_n_s_per_m,
      joint.cross_stiffness_n_per_rad, joint.cross_stiffness_n_per_rad,
      joint.rotational_stiffness_n_m_per_rad + i_omega * joint.rotational_damping_n_m_s_per_rad;
  return stiffness.inverse();
}

std::vector<BeamElement> beam_elements(const std::vector<Segment>& segments, const Eigen::VectorXd& frequency_hz) {
  std::vector<Section> sections;
  sections.reserve(segments.size());
  for (const Segment& segment : segments) sections.push_back(section(segment));
  const std::size_t count = static_cast<std::size_t>(frequency_hz.size());
  std::vector<BeamElement> out(count);
  parallel_for((count + lane_count - 1) / lane_count, groups_per_block, [&](std::size_t begin, std::size_t end) {
    BeamElementWork work;
    BeamElementJoin join;
    for (std::size_t group = begin; group < end; ++group) {
      const std::size_t first = group * lane_count;
      const std::size_t used = std::min(lane_count, count - first);
      for (std::size_t l = 0; l < lane_count; ++l) {
        const double omega =
            2.0 * std::numbers::pi * frequency_hz(static_cast<Eigen::Index>(first + std::min(l, used - 1)));
        work.omega2.v[l] = omega * omega;
      }
      for (std::size_t i = 0; i < sections.size(); ++i) {
        work.section = sections[i];
        find_beam_element(work);
        (i == 0 ? join.front : join.back) = work.element;
        if (i > 0) beam_element_join(join);
      }
      for (std::size_t l = 0; l < used; ++l) {
        BeamElement& element = out[first + l];
        unpack(join.front.clamped, l, element.clamped);
        unpack(join.front.carry, l, element.carry);
        unpack(join.front.stiffness, l, element.stiffness);
      }
    }
  });
  return out;
}

std::vector<BeamElement> tool_elements(const Assembly& assembly, const Eigen::VectorXd& frequency_hz) {
  std::vector<BeamElement> out = beam_elements(assembly.tool, frequency_hz);
  const double mass_kg = assembly.accelerometer.mass_kg;
  if (mass_kg == 0.0) return out;
  const Eigen::Vector2d at(1.0, -assembly.accelerometer.offset_m);
  const Eigen::Matrix2d mass = mass_kg * at * at.transpose();
  for (std::size_t i = 0; i < out.size(); ++i) {
    BeamElement& element = out[i];
    const double omega = 2.0 * std::numbers::pi * frequency_hz(static_cast<Eigen::Index>(i));
    const Eigen::Matrix2cd inertia = (-omega * omega * mass).cast<Complex>();
    const Eigen::Matrix2cd loaded = (Eigen::Matrix2cd::Identity() + element.clamped * inertia).inverse();
    const Eigen::Matrix2cd carry = loaded * element.carry;
    element.stiffness += (element.carry.transpose() * inertia * carry).eval();
    element.clamped = (loaded * element.clamped).eval();
    element.carry = carry;
  }
  return out;
}

}  // namespace robomill::coupling::detail
