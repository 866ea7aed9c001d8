#include "robomill/coupling/section.hpp"

#include <algorithm>
#include <numbers>

namespace robomill::coupling::detail {

double shear_coefficient(double poissons_ratio, double bore) {
  const double nu = poissons_ratio;
  const double m = bore * bore;
  return 6.0 * (1.0 + m) * (1.0 + m) * (1.0 + nu) * (1.0 + nu) /
         (7.0 + 34.0 * m + 7.0 * m * m + nu * (12.0 + 48.0 * m + 12.0 * m * m) +
          nu * nu * (4.0 + 16.0 * m + 4.0 * m * m));
}

Section section(const Segment& segment) {
  segment.validate();
  const double outer = segment.flutes > 0 ? segment.diameter_m * segment.flute_diameter_ratio : segment.diameter_m;
  const double inner = segment.inner_diameter_m;
  const double area = std::numbers::pi / 4.0 * (outer * outer - inner * inner);
  const double gyration2 = (outer * outer + inner * inner) / 16.0;  // I / A
  const double density =
      segment.mass_kg > 0.0 ? segment.mass_kg / (area * segment.length_m) : segment.density_kg_per_m3;
  const double h = segment.length_m / 2.0;
  const double inertia = density * h * h / segment.youngs_modulus_pa;
  Section out;
  out.half_length_m = h;
  out.bending_stiffness_n_m2 = segment.youngs_modulus_pa * area * gyration2;
  out.bending = inertia * h * h / gyration2;
  if (segment.beam == Beam::timoshenko) {
    out.rotary = inertia;
    out.shear =
        inertia * 2.0 * (1.0 + segment.poissons_ratio) / shear_coefficient(segment.poissons_ratio, inner / outer);
  }
  out.loss = {1.0, segment.loss_factor};
  return out;
}

double total_length(const std::vector<Segment>& segments) {
  double sum = 0.0;
  for (const Segment& segment : segments) sum += segment.length_m;
  return sum;
}

std::vector<Segment> piece(const std::vector<Segment>& segments, double from_m, double to_m) {
  std::vector<Segment> out;
  double start = 0.0;
  for (const Segment& segment : segments) {
    const double end = start + segment.length_m;
    const double length = std::min(end, to_m) - std::max(start, from_m);
    if (length > 1e-9 * segment.length_m) {
      out.push_back(segment);
      out.back().length_m = length;
      out.back().mass_kg *= length / segment.length_m;
    }
    start = end;
  }
  return out;
}

}  // namespace robomill::coupling::detail
