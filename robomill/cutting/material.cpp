#include "robomill/cutting/material.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"

namespace robomill::cutting {
namespace {

using std::numbers::pi;

/// Orthogonal tests are published per degree of rake and for h in mm.
constexpr double per_degree = 180.0 / pi;
constexpr double thickness_unit_m = 1e-3;

void require_acute(const char* field, double angle_rad) {
  if (!(std::abs(angle_rad) < 0.5 * pi)) throw InvalidInput(field, angle_rad, "rad", "must lie between -π/2 and π/2");
}

bool same_word(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

}  // namespace

void OrthogonalCut::validate() const {
  require_positive("shear_stress_n_per_m2", shear_stress_n_per_m2, "N/m^2");
  require_acute("rake_rad", rake_rad);
  require_acute("friction_angle_rad", friction_angle_rad);
  if (!(shear_angle_rad > 0.0 && shear_angle_rad < 0.5 * pi)) {
    throw InvalidInput("shear_angle_rad", shear_angle_rad, "rad", "must lie between 0 and π/2");
  }
  const double sum = shear_angle_rad + friction_angle_rad - rake_rad;
  if (!(sum > -0.5 * pi && sum < 0.5 * pi)) {
    throw InvalidInput("shear_angle_rad", shear_angle_rad, "rad",
                       "plus the friction angle less the rake must lie between -π/2 and π/2",
                       "No chip flows beyond that: are the angles in rad?");
  }
}

double shear_angle_rad(double chip_ratio, double rake_rad) {
  require_positive("chip_ratio", chip_ratio, "");
  require_acute("rake_rad", rake_rad);
  const double depth = 1.0 - chip_ratio * std::sin(rake_rad);
  if (!(depth > 0.0)) {
    throw InvalidInput("chip_ratio", chip_ratio, "", "times sin of the rake must be < 1",
                       "The chip ratio is that of uncut to cut thickness, mostly below 1");
  }
  return std::atan(chip_ratio * std::cos(rake_rad) / depth);
}

ObliqueCoefficients oblique_coefficients(const OrthogonalCut& cut, double inclination_rad) {
  cut.validate();
  require_acute("inclination_rad", inclination_rad);
  const double tan_i = std::tan(inclination_rad);
  const double tan_flow = tan_i;  // Stabler
  const double friction = std::atan(std::tan(cut.friction_angle_rad) * std::cos(inclination_rad));
  const double lean = friction - cut.rake_rad;
  const double along_edge = tan_flow * std::sin(friction);
  const double share = std::hypot(std::cos(cut.shear_angle_rad + lean), along_edge);
  const double pressure = cut.shear_stress_n_per_m2 / (std::sin(cut.shear_angle_rad) * share);
  return {.tangential_n_per_m2 = pressure * (std::cos(lean) + tan_i * along_edge),
          .radial_n_per_m2 = pressure * std::sin(lean) / std::cos(inclination_rad),
          .axial_n_per_m2 = -pressure * (std::cos(lean) * tan_i - along_edge)};
}

OrthogonalCut Material::cut(double rake_rad, double chip_thickness_m) const {
  require_positive("chip_thickness_m", chip_thickness_m, "m", "In a slot the mean is 2/π of the feed per tooth");
  require_acute("rake_rad", rake_rad);
  const double factor = chip_ratio + chip_ratio_per_rad * rake_rad;
  const double power = chip_ratio_power + chip_ratio_power_per_rad * rake_rad;
  const double ratio = factor * std::pow(chip_thickness_m / thickness_unit_m, power);
  if (!(ratio > 0.0) || !std::isfinite(ratio)) {
    throw InvalidInput("rake_rad", rake_rad, "rad", "is beyond what the tests of " + name + " reached");
  }
  OrthogonalCut out{.shear_stress_n_per_m2 = shear_stress_n_per_m2,
                    .friction_angle_rad = friction_angle_rad + friction_angle_per_rake * rake_rad,
                    .shear_angle_rad = cutting::shear_angle_rad(ratio, rake_rad),
                    .rake_rad = rake_rad};
  out.validate();
  return out;
}

const std::vector<Material>& materials() {
  static const std::vector<Material> known = {{.name = "Ti6Al4V",
                                               .source = "BudakAltintasArmarego1996",
                                               .shear_stress_n_per_m2 = 613e6,
                                               .friction_angle_rad = 19.1 / per_degree,
                                               .friction_angle_per_rake = 0.29,
                                               .chip_ratio = 1.755,
                                               .chip_ratio_per_rad = -0.028 * per_degree,
                                               .chip_ratio_power = 0.331,
                                               .chip_ratio_power_per_rad = -0.0082 * per_degree,
                                               .tangential_edge_n_per_m = 24e3,
                                               .radial_edge_n_per_m = 43e3}};
  return known;
}

const Material& material(std::string_view name) {
  std::string names;
  for (const Material& known : materials()) {
    if (same_word(known.name, name)) return known;
    names += (names.empty() ? "" : ", ") + known.name;
  }
  throw InvalidInput("material", "must be one of " + names, "Give the coefficients of others");
}

MillingCoefficients milling_coefficients(const Material& material, double rake_rad, double helix_rad,
                                         double chip_thickness_m) {
  require_acute("helix_rad", helix_rad);
  const ObliqueCoefficients oblique = oblique_coefficients(material.cut(rake_rad, chip_thickness_m), helix_rad);
  return {.tangential_n_per_m2 = {oblique.tangential_n_per_m2},
          .radial_n_per_m2 = {oblique.radial_n_per_m2},
          .axial_n_per_m2 = {oblique.axial_n_per_m2},
          .tangential_edge_n_per_m = {material.tangential_edge_n_per_m},
          .radial_edge_n_per_m = {material.radial_edge_n_per_m},
          .axial_edge_n_per_m = {}};
}

}  // namespace robomill::cutting
