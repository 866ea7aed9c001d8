#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/cutting/force.hpp"

/// Force coefficients of a milling cutter from orthogonal cutting tests of the material, so that no cutter need be
/// calibrated.
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

/// What orthogonal tests have measured of a material.
struct ROBOMILL_API Material {
  std::string name;
  std::string source;  ///< a key of docs/bibliography.md
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

/// Those that are known here.
[[nodiscard]] ROBOMILL_API const std::vector<Material>& materials();
/// By its name, whatever its case. @throws InvalidInput "material" that lists those known
[[nodiscard]] ROBOMILL_API const Material& material(std::string_view name);

/// Constants for a cutter: those of the oblique cut at a mean chip thickness, and the orthogonal edge forces along the
/// edge; none of these tests measures an axial edge force.
/// @param helix_rad         β
/// @param chip_thickness_m  mean of the cut, in a slot 2 c / π with the feed per tooth c
/// @throws InvalidInput as Material::cut and oblique_coefficients
[[nodiscard]] ROBOMILL_API MillingCoefficients milling_coefficients(const Material& material, double rake_rad,
                                                                    double helix_rad, double chip_thickness_m);

}  // namespace robomill::cutting
