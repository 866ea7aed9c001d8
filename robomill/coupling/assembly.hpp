#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/names.hpp"
#include "robomill/modal/frf.hpp"

// Method: robomill/coupling/README.md, "Coupling"

namespace robomill::coupling {

/// What a segment's cross-section does in bending.
enum class Beam {
  euler_bernoulli,  ///< no shear, no rotary inertia
  timoshenko  ///< both; shear coefficient of a round section, 6 (1 + ν)² / (7 + 12 ν + 4 ν²) if solid [Hutchinson2001]
};
inline constexpr Name<Beam> beam_names[] = {{"timoshenko", Beam::timoshenko},
                                            {"euler-bernoulli", Beam::euler_bernoulli}};

/// A round, uniform piece of a tool or holder. Its material has the complex moduli E (1 + iη) and G (1 + iη), with
/// G = E / (2 (1 + ν)). The fluted part of a cutter is a solid round of flute_diameter_ratio × its diameter.
struct Segment {
  double length_m = 0.0;              ///< > 0; required
  double diameter_m = 0.0;            ///< > 0; required
  double inner_diameter_m = 0.0;      ///< of a bore, >= 0 and below diameter_m
  double youngs_modulus_pa = 0.0;     ///< > 0; required
  double density_kg_per_m3 = 0.0;     ///< > 0; required unless mass_kg says it
  double mass_kg = 0.0;               ///< of the segment, where it was weighed: stands before the density; 0: not known
  double poissons_ratio = 0.3;        ///< in (-1, 0.5]
  double loss_factor = 0.0;           ///< η, in [0, 1]
  int flutes = 0;                     ///< 0: a plain shank
  double flute_diameter_ratio = 0.8;  ///< in (0, 1]; of a fluted segment alone [KopsVo1990]
  Beam beam = Beam::timoshenko;
  /// @throws InvalidInput naming the member
  ROBOMILL_API void validate() const;
};

/// The elastic joint between tool and holder: force and moment [f; m] = Kc [u_tool - u_holder; θ_tool - θ_holder],
///   Kc = [k_u + iωc_u, k_uθ; k_uθ, k_θ + iωc_θ],  θ = ∂u/∂z, z from the tip towards the spindle.
struct Joint {
  double translational_stiffness_n_per_m = 0.0;   ///< k_u, > 0; required
  double translational_damping_n_s_per_m = 0.0;   ///< c_u, >= 0
  double rotational_stiffness_n_m_per_rad = 0.0;  ///< k_θ, > 0; required
  double rotational_damping_n_m_s_per_rad = 0.0;  ///< c_θ, >= 0
  double cross_stiffness_n_per_rad = 0.0;         ///< k_uθ, k_uθ² < k_u k_θ
  /// A distributed joint: so many points, evenly over insertion_length_m from its deep end to its mouth, each with an
  /// equal share of Kc. 1: at the mouth.
  int points = 1;                   ///< in 1 … 100
  double insertion_length_m = 0.0;  ///< > 0 where points > 1
  /// The shank that stands in the holder over insertion_length_m; empty where points is 1.
  std::vector<Segment> shank = {};
  /// @throws InvalidInput naming the member
  ROBOMILL_API void validate() const;
};

/// What the joint stands on. Of both, one: segments to the wall, or measured receptances at the mouth of the holder.
/// Neither: a rigid wall, or nothing at all.
struct Holder {
  std::vector<Segment> segments = {};  ///< from the joint to the wall
  /// xx, x:my, ry:x, ry:my, or these and yy, y:mx, rx:y, rx:mx, or all sixteen; of two reciprocal ones one will do. Of
  /// one plane alone, the other is the same.
  modal::FrfSet receptances = {};
  bool free = false;  ///< nothing holds the tool: without segments, receptances and joint
};

/// An accelerometer that was glued to the tip: a point mass on the tool's axis.
struct Accelerometer {
  double mass_kg = 0.0;   ///< in [0, 1]; 0: none
  double offset_m = 0.0;  ///< of its centre of mass, beyond the tip; >= 0
  /// @throws InvalidInput naming the member
  ROBOMILL_API void validate() const;
};

/// A tool in a holder.
struct Assembly {
  std::vector<Segment> tool;   ///< from the tip to the joint, at least one
  std::optional<Joint> joint;  ///< none: rigid
  Holder holder;
  Accelerometer accelerometer = {};  ///< moves with the tip, as it did when the FRFs were measured
  /// @throws InvalidInput naming the member, as "tool[2].length_m" (segments from 1)
  ROBOMILL_API void validate() const;
};

/// What else than xx and yy to give.
struct TipOptions {
  bool rotations = false;  ///< also x:my, ry:x, ry:my and y:mx, rx:y, rx:mx
};

/// Receptances at the tip of an assembly and what to know of them.
struct TipResult {
  modal::FrfSet frfs;              ///< xx, yy; xy, yx where the holder's receptances have them; rotations if asked
  std::vector<double> suspect_hz;  ///< lines where the measured holder would create energy, beyond its noise
  std::vector<std::string> notes;  ///< sentences for the user
};

/// Receptances at the tip, by coupling of the tool (a) through the joint to the holder (b):
///   G11 = R11 - R12 (R22a + R22b + Kc⁻¹)⁻¹ R21,
/// exactly for each beam, in the form of README.md that neither cancels at low nor overflows at high frequencies. A
/// round tool: yy = xx and xy = yx = 0 unless the holder's receptances say otherwise. Of a tool that hangs free it is
/// R11.
/// @param frequency_hz  length n, strictly increasing, > 0 [Hz]; with a measured holder lines of its axis
/// @throws InvalidInput if the assembly is not valid, or a frequency is not > 0, outside the measured holder's range or
///     none of its lines (naming both steps), or an undamped assembly resonates at it
/// Source: [SchmitzDonaldson2000], [ParkAltintasMovahhedy2003]; derivation in docs/theory/receptance-coupling.md
[[nodiscard]] ROBOMILL_API TipResult tip_frfs(const Assembly& assembly, const Eigen::VectorXd& frequency_hz,
                                              const TipOptions& options = {});

}  // namespace robomill::coupling
