#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/base/export.hpp"

/// Angles: φ is a tooth's angle, clockwise from +y as seen from the spindle; x points along the feed, y to its left, z
/// towards the spindle. The cutter turns clockwise, so φ grows with time. Convention of [Altintas1995].
namespace robomill::cutting {

/// A cylindrical cutter with teeth of one helix angle.
struct ROBOMILL_API FlatEndMill {
  int teeth = 0;                       ///< N, >= 1; required
  double diameter_m = 0.0;             ///< D [m], > 0; required
  double helix_rad = 0.0;              ///< β [rad], |β| < π/2; a point at height z lags the tip by 2 z tan(β) / D
  std::vector<double> pitch_rad = {};  ///< empty (equal), or N angles > 0 that sum to 2π [rad]: tooth j stands at
                                       ///< Σ_{k<j} pitch_k and cuts what the tooth pitch_j before it left
  /// @throws InvalidInput naming the member
  void validate() const;
  /// Angle between tooth j and the one before it, j from 0 [rad].
  [[nodiscard]] double pitch(int tooth) const;
  /// Whether all pitches are 2π / N, to within 1e-9.
  [[nodiscard]] bool has_equal_pitch() const;
  /// Lag of the angle per axial height, 2 tan(β) / D [rad/m].
  [[nodiscard]] double lag_rad_per_m() const;
};

enum class MillingDirection { up, down, slot };

/// Where a tooth cuts: from entry to exit.
struct ROBOMILL_API Immersion {
  double entry_rad = 0.0;  ///< [rad], in [0, π)
  double exit_rad = 0.0;   ///< [rad], in (entry, π]
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Up-milling cuts from 0 to acos(1 - 2 b/D), down-milling from acos(2 b/D - 1) to π, a slot from 0 to π.
/// @param radial_depth_m  b [m], 0 < b <= D; a slot ignores it
/// @throws InvalidInput if b or D is out of range
[[nodiscard]] ROBOMILL_API Immersion immersion(MillingDirection direction, double radial_depth_m, double diameter_m);
/// Radial depth that belongs to these angles, D/2 (cos entry - cos exit) [m].
[[nodiscard]] ROBOMILL_API double radial_depth(const Immersion& immersion, double diameter_m);

/// Linear cutting force on a tooth: tangential Kt h, radial Kr h, per axial depth, with chip thickness h.
struct ROBOMILL_API ForceCoefficients {
  double tangential_n_per_m2 = 0.0;  ///< Kt [N/m^2], > 0; required
  double radial_n_per_m2 = 0.0;      ///< Kr [N/m^2]
  /// @throws InvalidInput naming the member, also where the value cannot be that of a material (units mixed up)
  void validate() const;
};

/// A cut: who cuts, where and against what.
struct ROBOMILL_API Milling {
  FlatEndMill tool;
  Immersion immersion;
  ForceCoefficients coefficients;
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// One tooth in cut, per axial depth: F/a = κ(φ) Δ [N/m^2], with Δ = q(t) - q(t - τ), 2x2 in x, y:
/// κ_xx = -sin φ (Kt cos φ + Kr sin φ), κ_xy = -cos φ (Kt cos φ + Kr sin φ),
/// κ_yx = sin φ (Kt sin φ - Kr cos φ), κ_yy = cos φ (Kt sin φ - Kr cos φ).
/// Force on the tool; chip thickness grows by Δx sin φ + Δy cos φ. Source: [Altintas1995].
[[nodiscard]] ROBOMILL_API Eigen::Matrix2d directional_coefficients(const ForceCoefficients& coefficients,
                                                                    double angle_rad);

/// All of tooth j's height at one rotation angle: F = K Δ [N/m], K = ∫_0^a g(φ) κ(φ) dz with φ = rotation + Σ_{k<j}
/// pitch_k
/// - 2 z tan(β)/D and g = 1 between entry and exit, else 0; in closed form, the limit of infinitely thin axial slices.
/// @param tooth  j, from 0
[[nodiscard]] ROBOMILL_API Eigen::Matrix2d cutting_stiffness(const Milling& milling, int tooth, double rotation_rad,
                                                             double axial_depth_m);

/// Mean of cutting_stiffness over from <= rotation <= to [N/m], in closed form. to > from.
[[nodiscard]] ROBOMILL_API Eigen::Matrix2d mean_cutting_stiffness(const Milling& milling, int tooth, double from_rad,
                                                                  double to_rad, double axial_depth_m);

/// What a steady cut asks of the spindle, on average over a revolution.
struct CutLoad {
  double torque_n_m = 0.0;             ///< N D Kt a f (cos entry - cos exit) / 4π
  double power_w = 0.0;                ///< torque times spindle speed
  double removal_rate_m3_per_s = 0.0;  ///< a b f N Ω / 2π
  double peak_tooth_force_n = 0.0;     ///< greatest sqrt(Kt² + Kr²) a f sin φ of one tooth without helix
};

/// @param axial_depth_m            a [m], >= 0
/// @param feed_per_tooth_m         f [m], >= 0
/// @param spindle_speed_rad_per_s  Ω [rad/s], >= 0
/// @throws InvalidInput if a value is out of range
[[nodiscard]] ROBOMILL_API CutLoad mean_load(const Milling& milling, double axial_depth_m, double feed_per_tooth_m,
                                             double spindle_speed_rad_per_s);

}  // namespace robomill::cutting
