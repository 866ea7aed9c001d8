#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/base/export.hpp"

/// Angles: φ is a tooth's angle, clockwise from +y as seen from the spindle; x points along the feed, y to its left, z
/// towards the spindle. The cutter turns clockwise, so φ grows with time. Convention of [Altintas1995].
// Method: robomill/cutting/README.md, "Force and displacement of a cylindrical cutter (`milling.hpp`)"
namespace robomill::cutting {

/// A cylindrical cutter.
struct ROBOMILL_API FlatEndMill {
  int teeth = 0;            ///< N, 1 to 100; required
  double diameter_m = 0.0;  ///< D [m], in [1e-5, 1]; required
  double helix_rad = 0.0;   ///< β [rad], |β| < 0.48 π; a point at height z lags the tip by 2 z tan(β) / D
  std::vector<double> pitch_rad = {};  ///< empty (equal), or N angles > 0, |Σ pitch_k - 2π| <= 1e-6 · 2π [rad]: tooth j
                                       ///< stands at Σ_{k<j} pitch_k and cuts what the tooth pitch_j before it left
  std::vector<double> tooth_helix_rad = {};  ///< empty (helix_rad for all), or one helix angle a tooth [rad]
  double runout_m = 0.0;                     ///< offset of the cutter's axis from the spindle's [m], in [0, 0.1 D]
  double runout_angle_rad = 0.0;             ///< of that offset, from where tooth 0 stands at the tip, clockwise [rad]
  /// @throws InvalidInput naming the member
  void validate() const;
  /// Angle between tooth j and the one it follows, at the tip, j from 0 [rad].
  [[nodiscard]] double pitch(int tooth) const;
  /// Where tooth j stands on the cutter at the tip, Σ_{k<j} pitch_k [rad].
  [[nodiscard]] double standing_angle(int tooth) const;
  /// Whether all pitches are 2π / N: |pitch_j - 2π / N| <= 1e-9 rad.
  [[nodiscard]] bool has_equal_pitch() const;
  /// Whether all teeth have one helix angle.
  [[nodiscard]] bool has_equal_helix() const;
  /// Whether what it does repeats with every tooth: equal pitch and helix, no runout.
  [[nodiscard]] bool has_equal_teeth() const;
  /// Lag of tooth j's angle per axial height, 2 tan(β_j) / D [rad/m].
  [[nodiscard]] double lag_rad_per_m(int tooth) const;
  /// By how much tooth j's radius exceeds D / 2 at a height: e cos(σ_j - lag_j z - ρ), with the runout's offset e and
  /// angle ρ [m].
  [[nodiscard]] double radius_deviation_m(int tooth, double height_m) const;
};

/// On which side of the feed the cutter is engaged.
enum class MillingDirection {
  up,    ///< the chip begins at nothing: teeth cut from φ = 0 to acos(1 - 2 b/D)
  down,  ///< the chip ends at nothing: teeth cut from acos(2 b/D - 1) to φ = π
  slot   ///< over the whole diameter, from 0 to π; no neighbouring pass
};

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

/// Linear cutting force on a tooth, per axial depth: tangential Kt h + Kte, radial Kr h + Kre, with chip thickness h.
struct ROBOMILL_API ForceCoefficients {
  double tangential_n_per_m2 = 0.0;      ///< Kt [N/m^2], > 0; required
  double radial_n_per_m2 = 0.0;          ///< Kr [N/m^2]
  double tangential_edge_n_per_m = 0.0;  ///< Kte [N/m], >= 0; no part in stability
  double radial_edge_n_per_m = 0.0;      ///< Kre [N/m], >= 0; no part in stability
  /// @throws InvalidInput naming the member, also where the value cannot be that of a material (units mixed up): |K| <
  /// 1e6 or > 1e12 N/m^2, but for Kr = 0
  void validate() const;
};

/// A drill, or what bores out with one: n lips on a cone that cut all round, over the width b / sin p of each, p half
/// the point angle, from the pilot hole (or the core) to the rim; b is measured along the radius. A chip is cut along
/// (cos p sin φ, cos p cos φ, -sin p): Kt acts against the cut's motion, Kr against that (the thrust). Chisel edge,
/// margins and twisting are left out.
struct ROBOMILL_API Drill {
  int lips = 2;                                 ///< n, in [1, 20], evenly spaced
  double diameter_m = 0.0;                      ///< D [m], > 0; required
  double point_angle_rad = 2.0594885173533087;  ///< 2p [rad], in (0.1, π]; 118 degrees
  ForceCoefficients coefficients = {};          ///< edge forces per length of lip
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// The worn land under an edge is pressed into the wave that it rides over: the tooth is pushed back by the specific
/// indentation force on the displaced volume, in its equivalent viscous form for small vibration. Per axial depth, with
/// r the outward displacement of the tooth and V = Ω D / 2: radial K l² r' / (2 V), tangential μ times that, both
/// against the edge's motion. Source: [Ahmadi2011].
struct ROBOMILL_API ProcessDamping {
  double indentation_n_per_m3 = 0.0;  ///< K, specific indentation force [N/m^3], in [0, 1e16]; 0: none
  double wear_land_m = 0.0;           ///< l, length of the land [m], in [0, 1e-3]
  double friction = 0.3;              ///< μ, >= 0
  [[nodiscard]] bool active() const { return indentation_n_per_m3 > 0.0 && wear_land_m > 0.0; }
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// The spindle speed swings about its mean: Ω(t) = Ω_0 (1 + amplitude sin(ratio Ω_0 t)).
struct ROBOMILL_API SpeedVariation {
  double amplitude_ratio = 0.0;  ///< in [0, 0.9]; 0: none
  double frequency_ratio = 0.0;  ///< of the swing to the mean rotation, > 0 where there is an amplitude
  [[nodiscard]] bool active() const { return amplitude_ratio > 0.0; }
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// A cut: who cuts, where, against what, and how the spindle turns.
struct ROBOMILL_API Milling {
  FlatEndMill tool;
  Immersion immersion;
  ForceCoefficients coefficients;
  double feed_per_tooth_m = 0.0;  ///< f [m], >= 0; with runout it decides which teeth miss the cut
  ProcessDamping process_damping = {};
  SpeedVariation speed_variation = {};
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
/// - 2 z tan(β_j)/D and g = 1 between entry and exit, else 0; in closed form, the limit of infinitely thin axial
/// slices. Runout has no part in it.
/// @param tooth  j, from 0
[[nodiscard]] ROBOMILL_API Eigen::Matrix2d cutting_stiffness(const Milling& milling, int tooth, double rotation_rad,
                                                             double axial_depth_m);

/// The part of it between two heights: K = ∫_low^high g(φ) κ(φ) dz [N/m].
[[nodiscard]] ROBOMILL_API Eigen::Matrix2d cutting_stiffness(const Milling& milling, int tooth, double rotation_rad,
                                                             double low_m, double high_m);

/// Process damping of tooth j between two heights: F = C dq/dt [N s/m], C = ∫_low^high g(φ) c(φ) dz, c as κ with
/// μ K l² / (2 V) for Kt and K l² / (2 V) for Kr.
/// @param speed_rad_per_s  Ω at that moment, > 0
[[nodiscard]] ROBOMILL_API Eigen::Matrix2d cutting_damping(const Milling& milling, int tooth, double rotation_rad,
                                                           double low_m, double high_m, double speed_rad_per_s);

/// Mean of cutting_stiffness over from <= rotation <= to [N/m], in closed form. to > from.
[[nodiscard]] ROBOMILL_API Eigen::Matrix2d mean_cutting_stiffness(const Milling& milling, int tooth, double from_rad,
                                                                  double to_rad, double axial_depth_m);

/// What a steady cut asks of the spindle, on average over a revolution [N m]: that of cutting_force (force.hpp), in
/// closed form, N D a (Kt f (cos entry - cos exit) + Kte (exit - entry) (1 - missed share)) / 4π. Runout moves chip
/// from tooth to tooth and not out of the sum, so only the edges that miss the cut are left out.
/// @param axial_depth_m     a [m], >= 0
/// @param feed_per_tooth_m  f [m], >= 0
/// @throws InvalidInput if a value is out of range
[[nodiscard]] ROBOMILL_API double mean_torque_n_m(const Milling& milling, double axial_depth_m,
                                                  double feed_per_tooth_m);

}  // namespace robomill::cutting
