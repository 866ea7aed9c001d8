#pragma once
// Beams that several tests share.
#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "robomill/coupling/assembly.hpp"

namespace robomill::coupling::testing {

/// The published bar: steel, 12 mm round.
inline Segment bar(double length_m, Beam beam = Beam::euler_bernoulli) {
  return {.length_m = length_m,
          .diameter_m = 0.012,
          .youngs_modulus_pa = 200e9,
          .density_kg_per_m3 = 7800.0,
          .loss_factor = 0.02,
          .beam = beam};
}

/// EI without its loss, of a solid bar.
inline double bending_stiffness(const Segment& s) {
  return s.youngs_modulus_pa * std::numbers::pi * std::pow(s.diameter_m, 4) / 64.0;
}
/// ρA of a solid bar.
inline double mass_per_length(const Segment& s) {
  return s.density_kg_per_m3 * std::numbers::pi * s.diameter_m * s.diameter_m / 4.0;
}

/// 118.92 mm of it on 50.90 mm clamped at a wall.
inline Assembly published_pair() {
  return {.tool = {bar(0.11892)}, .joint = {}, .holder = {.segments = {bar(0.05090)}, .receptances = {}}};
}

/// 1, 2, … Hz.
inline Eigen::VectorXd hertz(Eigen::Index last, Eigen::Index first = 1) {
  return Eigen::VectorXd::LinSpaced(last - first + 1, static_cast<double>(first), static_cast<double>(last));
}

inline const Eigen::VectorXcd& receptance(const modal::FrfSet& set, const char* name) {
  return set.find(modal::parse_frf_name(name))->receptance;
}

/// The axis value at which |H| is greatest.
inline double peak_hz(const Eigen::VectorXd& frequency_hz, const Eigen::VectorXcd& h) {
  Eigen::Index at = 0;
  h.cwiseAbs().maxCoeff(&at);
  return frequency_hz(at);
}

/// The axis value at which |Im H| is greatest.
inline double resonance_hz(const Eigen::VectorXd& frequency_hz, const Eigen::VectorXcd& h) {
  return peak_hz(frequency_hz, h.imag().cast<std::complex<double>>());
}

}  // namespace robomill::coupling::testing
