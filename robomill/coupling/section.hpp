#pragma once
#include <complex>
#include <vector>

#include "robomill/coupling/assembly.hpp"

namespace robomill::coupling::detail {

/// A segment in numbers of its half length h, at ω² = 1: Λ = ρA ω² h⁴ / E*I, β_1 = ρ ω² h² / E*, β = ρ ω² h² / κG*,
/// with E* = E (1 + iη), G* = G (1 + iη); β_1 = β = 0 for Euler and Bernoulli.
struct Section {
  double half_length_m = 0.0;
  double bending_stiffness_n_m2 = 0.0;              ///< E I
  double bending = 0.0, rotary = 0.0, shear = 0.0;  ///< Λ, β_1 and β where η = 0
  std::complex<double> loss = 1.0;                  ///< 1 + iη
};

/// @throws InvalidInput as Segment::validate
[[nodiscard]] Section section(const Segment& segment);

/// Shear coefficient of a round tube, inner over outer diameter `bore`: [Hutchinson2001].
[[nodiscard]] double shear_coefficient(double poissons_ratio, double bore);

/// @throws InvalidInput naming the member as member[i].length_m (from 1)
void validate_segments(const char* member, const std::vector<Segment>& segments);

[[nodiscard]] double total_length(const std::vector<Segment>& segments);
/// The piece of segments between two distances from the first one's free end.
[[nodiscard]] std::vector<Segment> piece(const std::vector<Segment>& segments, double from_m, double to_m);

}  // namespace robomill::coupling::detail
