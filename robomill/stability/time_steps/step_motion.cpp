#include "robomill/stability/time_steps/step_motion.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::stability::detail {
namespace {

using Complex = std::complex<double>;

bool finite(Complex value) {
  return std::isfinite(value.real()) && std::isfinite(value.imag());
}

}  // namespace

void StepMotion::apply(SteppedMap& map, std::span<const Eigen::VectorXcd> vectors, bool imaginary) {
  for (std::size_t i = 0; i < in_.size(); ++i) {
    for (std::size_t lane = 0; lane < vectors.size(); ++lane) {
      const Complex entry = vectors[lane](static_cast<Eigen::Index>(i));
      in_[i].v[lane] = imaginary ? entry.imag() : entry.real();
    }
  }
  map.apply(in_.data(), out_.data());
}

void StepMotion::find(const TipDynamics& tip, int steps, std::span<const double> step_s, SteppedMap& map,
                      Arnoldi& arnoldi, std::span<const Dominant> dominant, std::span<Motion> out) {
  std::array<Eigen::VectorXcd, lane_count> vectors;
  std::size_t known = 0;
  for (std::size_t lane = 0; lane < dominant.size(); ++lane) {
    vectors[lane] = arnoldi.vector(lane);
    if (finite(dominant[lane].multiplier) && vectors[lane].allFinite()) {
      ++known;
    } else {
      vectors[lane].setZero();
    }
  }
  std::ranges::fill(out, Motion{});
  if (known == 0) return;
  in_.assign(map.size(), Lanes{});
  out_.resize(map.size());
  forces_.resize(map.cut_steps().size());
  const std::span<const Eigen::VectorXcd> used = std::span(vectors).first(dominant.size());
  for (const bool imaginary : {false, true}) {
    apply(map, used, imaginary);
    for (std::size_t c = 0; c < forces_.size(); ++c) {
      for (std::size_t lane = 0; lane < lane_count; ++lane) {
        const Lanes* force = map.force(c);
        const Eigen::Vector2cd part(force[0].v[lane], force[1].v[lane]);
        forces_[c][lane] = imaginary ? (forces_[c][lane] + Complex(0.0, 1.0) * part).eval() : part;
      }
    }
  }
  for (std::size_t lane = 0; lane < dominant.size(); ++lane) {
    if (vectors[lane].isZero(0.0)) continue;
    out[lane] = find_motion(tip, dominant[lane].multiplier, step_s[lane] * steps, vectors[lane],
                            [&](Complex s) { return coefficient(map, lane, steps, s * step_s[lane]); });
  }
}

/// (1/T) ∫ F(t) exp(-s t) dt over the period, F held at its mean over each step. exponent: s times the step.
Eigen::Vector2cd StepMotion::coefficient(const SteppedMap& map, std::size_t lane, int steps, Complex exponent) const {
  const Complex weight = std::abs(exponent) > 1e-6 ? (1.0 - std::exp(-exponent)) / exponent : 1.0 - 0.5 * exponent;
  Eigen::Vector2cd sum = Eigen::Vector2cd::Zero();
  for (std::size_t c = 0; c < forces_.size(); ++c) {
    sum += forces_[c][lane] * std::exp(-exponent * static_cast<double>(map.cut_steps()[c]));
  }
  return sum * (weight / static_cast<double>(steps));
}

}  // namespace robomill::stability::detail
