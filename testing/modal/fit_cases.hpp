#pragma once
// Structures that the tests and benchmarks of fits share.
#include <cmath>
#include <complex>
#include <cstdint>

#include "robomill/base/random.hpp"
#include "robomill/modal/modes.hpp"

namespace robomill::modal::cases {

/// 5 to 1,000 Hz, 0.25 Hz apart.
inline Eigen::VectorXd robot_lines() {
  return Eigen::VectorXd::LinSpaced(3981, 5.0, 1000.0);
}

/// ‖a − b‖ / ‖a‖ over all lines and FRFs of a.
inline double relative_error(const FrfSet& a, const FrfSet& b) {
  double difference = 0.0;
  double size = 0.0;
  for (const Frf& frf : a.frfs) {
    difference += (frf.receptance - b.find(frf.name)->receptance).squaredNorm();
    size += frf.receptance.squaredNorm();
  }
  return std::sqrt(difference / size);
}

/// Adds complex Gaussian noise e, E|e|² = (relative |H|)², to every line.
inline void add_noise(FrfSet& set, double relative, std::uint64_t seed) {
  Random random(seed);
  for (Frf& frf : set.frfs) {
    for (std::complex<double>& value : frf.receptance) {
      const double scale = relative * std::abs(value) / std::sqrt(2.0);
      const double re = random.normal();
      value += scale * std::complex<double>(re, random.normal());
    }
  }
}

}  // namespace robomill::modal::cases
