#pragma once
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/cutting/cutter.hpp"
#include "robomill/cutting/engagement.hpp"

/// Forces are those on the tool, in F: x along the feed, y to its left, z towards the spindle; docs/frames.md.
// Method: robomill/cutting/README.md, "Forces (`force.hpp`)"
namespace robomill::cutting {

/// The length that edge forces are referred to.
enum class EdgeMeasure {
  by_kind,      ///< width on a flat end, whose mean slotting forces are per axial depth; edge_length on every other
  edge_length,  ///< the length ds of the helical edge, as models of ball ends have it
  width         ///< the width db of cut along the profile, whatever the helix
};
/// Whether the edge's length counts on a cutter of that kind, and not its width.
[[nodiscard]] ROBOMILL_API bool counts_edge_length(EdgeMeasure measure, CutterKind kind);

/// What an edge element of width db and length ds with a chip t feels on the tool: K t db + Ke ds (or Ke db),
/// tangentially against its motion, radially along -n and axially along (cos κ sin φ, cos κ cos φ, sin κ) in T, n =
/// (sin κ sin φ, sin κ cos φ, -cos κ). Each is a polynomial in κ [rad], highest power first: one entry is a constant,
/// none is 0.
struct ROBOMILL_API MillingCoefficients {
  std::vector<double> tangential_n_per_m2 = {};  ///< Kt(κ) [N/m^2]; required
  std::vector<double> radial_n_per_m2 = {};      ///< Kr(κ) [N/m^2]
  std::vector<double> axial_n_per_m2 = {};       ///< Ka(κ) [N/m^2]; > 0 pushes a cylinder towards the spindle
  std::vector<double> tangential_edge_n_per_m = {};
  std::vector<double> radial_edge_n_per_m = {};
  std::vector<double> axial_edge_n_per_m = {};
  EdgeMeasure edge_measure = EdgeMeasure::by_kind;
  /// Over the angles κ in use.
  /// @throws InvalidInput naming the member: none tangential, tangential or radial negative (at which angle), units
  /// mixed up: the largest |K| > 0 is < 1e6 or > 1e12 N/m^2, the largest |Ke| is > 1e7 N/m
  void validate(double from_position_rad, double to_position_rad) const;
};

/// How the cutter goes through the material.
struct ROBOMILL_API CutMotion {
  double feed_per_tooth_m = 0.0;         ///< feed of a revolution over N [m], in [0, 0.01]
  double spindle_speed_rad_per_s = 0.0;  ///< Ω [rad/s], >= 0
  /// @throws InvalidInput naming the member
  void validate() const;
};

struct ROBOMILL_API ForceOptions {
  int steps = 360;  ///< of a revolution, 8 to 100,000
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// One revolution in a few numbers; forces on the tool in F.
struct ForceSummary {
  Eigen::Vector3d mean_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d peak_n =
      Eigen::Vector3d::Zero();  ///< of each component the value of largest magnitude, with its sign
  Eigen::Vector3d rms_n = Eigen::Vector3d::Zero();
  double peak_force_n = 0.0;  ///< largest magnitude of the force
  double mean_torque_n_m = 0.0;
  double peak_torque_n_m = 0.0;
  double power_w = 0.0;                ///< mean torque times Ω
  double chip_area_m2 = 0.0;           ///< of the cut across the feed, ∫ (n·x_F) dA
  double removal_rate_m3_per_s = 0.0;  ///< that times the feed's speed
  double missed_share = 0.0;           ///< of the engaged edge, the share that cuts nothing because of runout
};

/// One revolution. Values are means over a step, centred at the rotation, so that sums over them are exact.
struct CuttingForce : ForceSummary {
  Eigen::VectorXd rotation_rad;  ///< length steps: of tooth 0 at the tip, from φ = 0 [rad]
  Eigen::Matrix3Xd force_n;      ///< 3 x steps
  Eigen::VectorXd torque_n_m;    ///< length steps: about the spindle, > 0 where it brakes
};

/// Forces of many cuts by one cutter, with memory of its own: nothing is allocated once the largest engagement has been
/// seen. One a thread.
class ROBOMILL_API ForceKernel {
 public:
  /// @throws InvalidInput as the validate() of each
  ForceKernel(const Cutter& cutter, const MillingCoefficients& coefficients, const ForceOptions& options = {});
  ~ForceKernel();
  ForceKernel(ForceKernel&&) noexcept;
  ForceKernel& operator=(ForceKernel&&) noexcept;

  /// @throws InvalidInput as CutMotion::validate; coefficients negative at an engaged angle
  [[nodiscard]] ForceSummary summary(const Engagement& engagement, const CutMotion& motion);
  /// The same and the course of the revolution, into a result whose memory is used again.
  void revolution(const Engagement& engagement, const CutMotion& motion, CuttingForce& result);

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

/// One revolution of a steady cut. Tooth j on a ring at φ cuts, with ρ its radius beyond the nominal and f_m the feed
/// since the tooth m before it: t = max(0, min over m = 1..N of f_m (n·x_F) + (ρ_j - ρ_{j+m}) sin κ), tooth j + m being
/// the m-th before it.
/// @throws InvalidInput as the validate() of each; coefficients negative at an engaged angle
/// Source: [EnginAltintas2001], signs of docs/frames.md; runout derived in cutting/README.md
[[nodiscard]] ROBOMILL_API CuttingForce cutting_force(const Cutter& cutter, const Engagement& engagement,
                                                      const MillingCoefficients& coefficients, const CutMotion& motion,
                                                      const ForceOptions& options = {});

}  // namespace robomill::cutting
