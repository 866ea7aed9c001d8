#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/cutting/force.hpp"
#include "robomill/cutting/milling.hpp"

/// What sources state of materials: force coefficients, orthogonal cutting tests, speeds and feeds. The table of those
/// known is in files/materials_toml.hpp.
// Method: robomill/cutting/README.md, "Coefficients (`coefficients.hpp`, `material.hpp`)"
namespace robomill::cutting {

/// An orthogonal cut, its edge square to its motion, described by its thin shear plane.
struct ROBOMILL_API OrthogonalCut {
  double shear_stress_n_per_m2 = 0.0;  ///< τ_s on the shear plane [N/m^2], > 0; required
  double friction_angle_rad = 0.0;     ///< β_a between chip and rake face, in (-π/2, π/2), > 0 but for slips
  double shear_angle_rad = 0.0;        ///< φ_c of the shear plane to the motion, in (0, π/2); required
  double rake_rad = 0.0;               ///< α of the rake face, in (-π/2, π/2)
  /// @throws InvalidInput naming the member, also where φ_c + β_a - α reaches π/2: the chip would be held for ever
  void validate() const;
};

/// Cutting coefficients of one element of edge per width of cut square to its motion.
struct ObliqueCoefficients {
  double tangential_n_per_m2 = 0.0;
  double radial_n_per_m2 = 0.0;
  double axial_n_per_m2 = 0.0;  ///< > 0 towards the spindle
};

/// tan φ_c = r cos α / (1 - r sin α), with the chip ratio r of uncut to cut thickness.
/// @throws InvalidInput unless r > 0 and r sin α < 1
[[nodiscard]] ROBOMILL_API double shear_angle_rad(double chip_ratio, double rake_rad);

/// The same shear plane under an edge inclined by i: with the chip's flow angle η = i (Stabler), φ_n = φ_c, α_n = α,
/// tan β_n = tan β_a cos η and c = sqrt(cos²(φ_n + β_n - α_n) + tan²η sin²β_n),
///     Kt = τ_s / (c sin φ_n) (cos(β_n - α_n) + tan i tan η sin β_n),
///     Kr = τ_s / (c sin φ_n cos i) sin(β_n - α_n),
///     Ka = -τ_s / (c sin φ_n) (cos(β_n - α_n) tan i - tan η sin β_n).
/// The sign of Ka is ours: a right-hand helix (i > 0) lifts the chip, which pulls the tool down, out of its holder;
/// the source counts that as positive.
/// @param inclination_rad  i, of a milling edge its helix β, |i| < π/2
/// @throws InvalidInput as OrthogonalCut::validate
/// Source: [BudakAltintasArmarego1996]
[[nodiscard]] ROBOMILL_API ObliqueCoefficients oblique_coefficients(const OrthogonalCut& cut, double inclination_rad);

/// What orthogonal tests have measured of a material, so that no cutter need be calibrated.
struct ROBOMILL_API OrthogonalTests {
  std::string source = {};  ///< a key of docs/bibliography.md
  double shear_stress_n_per_m2 = 0.0;
  double friction_angle_rad = 0.0;  ///< at rake 0
  double friction_angle_per_rake = 0.0;
  /// r = C0 (h / 1 mm)^C1 with C0 = c0 + c0' α and C1 = c1 + c1' α.
  double chip_ratio = 0.0, chip_ratio_per_rad = 0.0;
  double chip_ratio_power = 0.0, chip_ratio_power_per_rad = 0.0;
  double tangential_edge_n_per_m = 0.0, radial_edge_n_per_m = 0.0;
  /// @throws InvalidInput unless 0 < h, or where chip ratio or shear angle come out impossible
  [[nodiscard]] OrthogonalCut cut(double rake_rad, double chip_thickness_m) const;
};

/// Constants for a cutter: those of the oblique cut at a mean chip thickness, and the orthogonal edge forces along the
/// edge; none of these tests measures an axial edge force.
/// @param helix_rad         β
/// @param chip_thickness_m  mean of the cut, in a slot 2 c / π with the feed per tooth c
/// @throws InvalidInput as OrthogonalTests::cut and oblique_coefficients
[[nodiscard]] ROBOMILL_API MillingCoefficients milling_coefficients(const OrthogonalTests& tests, double rake_rad,
                                                                    double helix_rad, double chip_thickness_m);

using FromTo = std::array<double, 2>;  ///< from, to

/// One set of force coefficients as a source states them: a straight line over the chip, K h + Ke; or Kienzle's power
/// of it, F = k b h (h / 1 mm)^-m, which is the tangential force alone.
struct ROBOMILL_API PublishedCoefficients {
  std::string cutter = {};                               ///< in words
  std::optional<CutterKind> kind = {};                   ///< where the source states it
  std::string source = {};                               ///< a key of docs/bibliography.md
  MillingCoefficients line = {};                         ///< no tangential one where it is a power
  double specific_force_n_per_m2 = 0.0;                  ///< k at 1 mm [N/m^2]; 0 where it is a line
  double thickness_power = 0.0;                          ///< m, in [0, 1)
  double tangential_std_n_per_m2 = 0.0;                  ///< of K over the tests [N/m^2]; 0: not stated
  std::optional<FromTo> tangential_range_n_per_m2 = {};  ///< of K or k over the tests
  std::optional<FromTo> tested_speed_m_per_s = {}, tested_feed_per_tooth_m = {}, tested_chip_m = {};
  [[nodiscard]] bool is_power() const { return specific_force_n_per_m2 > 0.0; }
  [[nodiscard]] bool has_radial() const { return !line.radial_n_per_m2.empty(); }
  /// The line; of a power its tangent at h: K = (1 - m) k (h / 1 mm)^-m and Ke = m k h (h / 1 mm)^-m, which has its
  /// value and its slope there.
  /// @throws InvalidInput "chip_thickness_m" where it is a power, unless 0 < h
  [[nodiscard]] MillingCoefficients at(double chip_thickness_m) const;
};

/// What a handbook or a maker recommends.
struct ROBOMILL_API CuttingConditions {
  std::string cutter = {};  ///< in words
  std::string source = {};  ///< a key of docs/bibliography.md
  std::optional<FromTo> cutting_speed_m_per_s = {};
  std::vector<double> diameter_m = {}, feed_per_tooth_m = {};  ///< a feed for each diameter; empty: not stated
  /// On straight lines between the diameters, beyond them as at the outermost one [m]; none where no feed is stated.
  [[nodiscard]] std::optional<double> feed_at(double cutter_diameter_m) const;
};

/// A material and what sources state of it.
struct Material {
  std::string name = {};  ///< "7075-t6"
  std::vector<std::string> other_names = {};
  std::string description = {};
  std::vector<PublishedCoefficients> coefficients = {};
  std::optional<OrthogonalTests> orthogonal = {};
  std::vector<CuttingConditions> conditions = {};
};

/// Which set is taken for a kind of cutter where nobody chose one, from 0; none where there are no sets. One with a
/// radial coefficient before one without, then one for this kind or any before one for another kind; of those the one
/// with the largest force, sqrt(Ft² + Fr²) at a chip of 0.05 mm on the side of the cutter: the others would promise
/// depths and loads that it does not. The chip is the same whatever the cut, so that every file of a job gets one set.
[[nodiscard]] ROBOMILL_API std::optional<std::size_t> best_set(const Material& material, CutterKind kind);

/// How many sets serve a kind of cutter as well as the one of best_set, but for the force.
[[nodiscard]] ROBOMILL_API std::size_t sets_alike(const Material& material, CutterKind kind);

/// How far the sets of a material that are lines lie apart, and how many those are.
struct SetSpread {
  std::size_t sets = 0;
  FromTo tangential_n_per_m2 = {0.0, 0.0};
  double std_ratio = 0.0;  ///< standard deviation of the tangential ones over their mean; of two half their distance
};
[[nodiscard]] ROBOMILL_API SetSpread spread_of_sets(const Material& material);

/// Mean over the arc in the cut, c (cos entry - cos exit) / (exit - entry) [m]. @param feed_per_tooth_m  c
/// @throws InvalidInput as Immersion::validate
[[nodiscard]] ROBOMILL_API double mean_chip_thickness_m(const Immersion& immersion, double feed_per_tooth_m);

}  // namespace robomill::cutting
