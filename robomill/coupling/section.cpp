#include "robomill/coupling/section.hpp"

#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"

namespace robomill::coupling {

void Segment::validate() const {
  require_positive("length_m", length_m, "m");
  require_positive("diameter_m", diameter_m, "m");
  if (!(inner_diameter_m >= 0.0 && inner_diameter_m < diameter_m)) {
    throw InvalidInput("inner_diameter_m", inner_diameter_m, "m", "must be >= 0 and below the diameter");
  }
  require_positive("youngs_modulus_pa", youngs_modulus_pa, "Pa",
                   "Steel is near 200 GPa, cemented carbide near 600 GPa");
  require_non_negative("mass_kg", mass_kg, "kg");
  if (mass_kg == 0.0) {
    require_positive("density_kg_per_m3", density_kg_per_m3, "kg/m^3",
                     "Steel is near 7800, cemented carbide near 14500");
  }
  if (!(poissons_ratio > -1.0 && poissons_ratio <= 0.5)) {
    throw InvalidInput("poissons_ratio", poissons_ratio, "", "must be above -1 and at most 0.5", "Steel is near 0.3");
  }
  if (!(loss_factor >= 0.0 && loss_factor <= 1.0)) {
    throw InvalidInput("loss_factor", loss_factor, "", "must be in [0, 1]",
                       "It is twice the damping ratio, not a percentage");
  }
  if (flutes < 0) throw InvalidInput("flutes", flutes, "", "must be >= 0");
  if (!(flute_diameter_ratio > 0.0 && flute_diameter_ratio <= 1.0)) {
    throw InvalidInput("flute_diameter_ratio", flute_diameter_ratio, "", "must be above 0 and at most 1");
  }
  if (flutes > 0 && inner_diameter_m >= diameter_m * flute_diameter_ratio) {
    throw InvalidInput("inner_diameter_m", inner_diameter_m, "m", "must be below the fluted part's core",
                       "The core counts as flute_diameter_ratio of the diameter");
  }
}

namespace detail {

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

}  // namespace detail
}  // namespace robomill::coupling
