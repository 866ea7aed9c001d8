#include "robomill/cutting/material.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/cutting/polynomial.hpp"

namespace robomill::cutting {
namespace {

using std::numbers::pi;

/// Powers of the chip thickness are published for h in mm.
constexpr double thickness_unit_m = 1e-3;

void require_acute(const char* field, double angle_rad) {
  if (!(std::abs(angle_rad) < 0.5 * pi)) throw InvalidInput(field, angle_rad, "rad", "must lie between -π/2 and π/2");
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Standard deviation of a sample over its mean. Of two values, which say little of one, half their distance.
double spread_ratio(const std::vector<double>& values) {
  if (values.size() < 2) return 0.0;
  const double mean = mean_of(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  const std::size_t freedom = values.size() == 2 ? 2 : values.size() - 1;
  return std::sqrt(sum / static_cast<double>(freedom)) / mean;
}

void require_chip(double chip_thickness_m) {
  require_positive("chip_thickness_m", chip_thickness_m, "m", "In a slot the mean is 2/π of the feed per tooth");
}

/// Force per width on the side of a cutter at a usual chip.
double compared_force_n_per_m(const PublishedCoefficients& set) {
  constexpr double chip_m = 0.05e-3;
  const MillingCoefficients k = set.at(chip_m);
  const auto at_side = [](const std::vector<double>& values) { return detail::polynomial(values, 0.5 * pi); };
  return std::hypot(at_side(k.tangential_n_per_m2) * chip_m + at_side(k.tangential_edge_n_per_m),
                    at_side(k.radial_n_per_m2) * chip_m + at_side(k.radial_edge_n_per_m));
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

OrthogonalCut OrthogonalTests::cut(double rake_rad, double chip_thickness_m) const {
  require_chip(chip_thickness_m);
  require_acute("rake_rad", rake_rad);
  const double factor = chip_ratio + chip_ratio_per_rad * rake_rad;
  const double power = chip_ratio_power + chip_ratio_power_per_rad * rake_rad;
  const double ratio = factor * std::pow(chip_thickness_m / thickness_unit_m, power);
  if (!(ratio > 0.0) || !std::isfinite(ratio)) {
    throw InvalidInput("rake_rad", rake_rad, "rad", "is beyond what the tests of [" + source + "] reached");
  }
  OrthogonalCut out{.shear_stress_n_per_m2 = shear_stress_n_per_m2,
                    .friction_angle_rad = friction_angle_rad + friction_angle_per_rake * rake_rad,
                    .shear_angle_rad = cutting::shear_angle_rad(ratio, rake_rad),
                    .rake_rad = rake_rad};
  out.validate();
  return out;
}

MillingCoefficients milling_coefficients(const OrthogonalTests& tests, double rake_rad, double helix_rad,
                                         double chip_thickness_m) {
  require_acute("helix_rad", helix_rad);
  const ObliqueCoefficients oblique = oblique_coefficients(tests.cut(rake_rad, chip_thickness_m), helix_rad);
  return {.tangential_n_per_m2 = {oblique.tangential_n_per_m2},
          .radial_n_per_m2 = {oblique.radial_n_per_m2},
          .axial_n_per_m2 = {oblique.axial_n_per_m2},
          .tangential_edge_n_per_m = {tests.tangential_edge_n_per_m},
          .radial_edge_n_per_m = {tests.radial_edge_n_per_m},
          .axial_edge_n_per_m = {}};
}

MillingCoefficients PublishedCoefficients::at(double chip_thickness_m) const {
  if (!is_power()) return line;
  require_chip(chip_thickness_m);
  const double secant = specific_force_n_per_m2 * std::pow(chip_thickness_m / thickness_unit_m, -thickness_power);
  MillingCoefficients out;
  out.tangential_n_per_m2 = {(1.0 - thickness_power) * secant};
  out.tangential_edge_n_per_m = {thickness_power * secant * chip_thickness_m};
  return out;
}

std::optional<double> CuttingConditions::feed_at(double cutter_diameter_m) const {
  const std::vector<double>&x = diameter_m, &y = feed_per_tooth_m;
  if (x.empty()) return std::nullopt;
  const auto i = static_cast<std::size_t>(std::ranges::lower_bound(x, cutter_diameter_m) - x.begin());
  if (i == 0) return y.front();
  if (i == x.size()) return y.back();
  return std::lerp(y[i - 1], y[i], (cutter_diameter_m - x[i - 1]) / (x[i] - x[i - 1]));
}

namespace {

/// How well a set serves a kind of cutter.
int fit_of(const PublishedCoefficients& set, CutterKind kind) {
  return (set.has_radial() ? 2 : 0) + (!set.kind || *set.kind == kind ? 1 : 0);
}

}  // namespace

std::optional<std::size_t> best_set(const Material& material, CutterKind kind) {
  std::optional<std::size_t> best;
  std::pair<int, double> best_rank = {-1, 0.0};
  for (std::size_t i = 0; i < material.coefficients.size(); ++i) {
    const PublishedCoefficients& set = material.coefficients[i];
    const std::pair<int, double> rank = {fit_of(set, kind), compared_force_n_per_m(set)};
    if (best && rank <= best_rank) continue;
    best = i;
    best_rank = rank;
  }
  return best;
}

std::size_t sets_alike(const Material& material, CutterKind kind) {
  const std::optional<std::size_t> best = best_set(material, kind);
  if (!best) return 0;
  const int fit = fit_of(material.coefficients[*best], kind);
  return static_cast<std::size_t>(std::ranges::count_if(
      material.coefficients, [&](const PublishedCoefficients& set) { return fit_of(set, kind) == fit; }));
}

SetSpread spread_of_sets(const Material& material) {
  std::vector<double> tangential;
  for (const PublishedCoefficients& set : material.coefficients) {
    if (set.is_power()) continue;
    tangential.push_back(set.line.tangential_n_per_m2.front());
  }
  SetSpread out;
  if (tangential.empty()) return out;
  const auto [low, high] = std::ranges::minmax(tangential);
  out = {.sets = tangential.size(), .tangential_n_per_m2 = {low, high}, .std_ratio = spread_ratio(tangential)};
  return out;
}

double mean_chip_thickness_m(const Immersion& immersion, double feed_per_tooth_m) {
  immersion.validate();
  return feed_per_tooth_m * (std::cos(immersion.entry_rad) - std::cos(immersion.exit_rad)) /
         (immersion.exit_rad - immersion.entry_rad);
}

}  // namespace robomill::cutting
