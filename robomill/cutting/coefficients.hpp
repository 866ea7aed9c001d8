#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/cutting/cutter.hpp"
#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/force.hpp"

/// Force coefficients from measured forces. Forces are those on the tool, in F: x along the feed, y to its left, z
/// towards the spindle; docs/frames.md. A dynamometer under the workpiece feels them with the other sign.
// Method: robomill/cutting/README.md, "Coefficients (`coefficients.hpp`, `material.hpp`)"
namespace robomill::cutting {

/// A slot over the whole diameter of a flat end mill, and the mean of its force over whole revolutions.
struct ROBOMILL_API SlotForce {
  double feed_per_tooth_m = 0.0;         ///< c [m], > 0; required
  double axial_depth_m = 0.0;            ///< a [m], > 0; required
  double spindle_speed_rad_per_s = 0.0;  ///< Ω [rad/s], >= 0; 0: not known
  Eigen::Vector3d mean_force_n = Eigen::Vector3d::Zero();
  /// @throws InvalidInput naming the member
  void validate() const;
};

struct ROBOMILL_API SlotOptions {
  int teeth = 0;               ///< N, >= 1; required
  bool edge_forces = true;     ///< false: the edge is taken to push nothing, and one feed is enough
  double significance = 0.01;  ///< in (0, 1); coefficients depend on the speed where speed_probability < this
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Cutting and edge coefficient of one direction, from the one component of force that they alone make.
struct CoefficientPair {
  double cutting_n_per_m2 = 0.0, edge_n_per_m = 0.0;
  /// Standard deviations, from the residuals; infinite where the data do not determine the coefficient.
  double cutting_deviation_n_per_m2 = 0.0, edge_deviation_n_per_m = 0.0;
  double correlation = 0.0;  ///< of the two estimates, in [-1, 1]
  double r_squared = 0.0;    ///< share of the force's variance that is explained; NaN where the force does not vary
  double noise_n = 0.0;      ///< standard deviation of a mean force about the fit; NaN where no row is left over
};

/// The fit of the slots at one speed.
struct SpeedGroup {
  double spindle_speed_rad_per_s = 0.0;  ///< mean of its rows
  int rows = 0;
  CoefficientPair tangential, radial, axial;
};

struct SlotFit {
  CoefficientPair tangential, radial, axial;
  enum class Status {
    identified,   ///< all six, or the three cutting ones without edge_forces
    edge_unknown  ///< slots of one feed, max c - min c <= 1e-3 max c, cannot part cutting from edge: the cutting
                  ///< coefficients are those without any edge force, so upper bounds
  };
  Status status = Status::identified;
  Eigen::Matrix3Xd residual_n;       ///< measured less fitted, 3 x rows
  std::vector<SpeedGroup> by_speed;  ///< of the speeds with two feeds or more; empty where there are fewer than two
  double speed_probability = 1.0;    ///< of differences between the speeds as large as these, were there none
  bool depends_on_speed = false;     ///< speed_probability < SlotOptions::significance
  std::vector<std::string> notes;    ///< what the user should know: signs, units, feeds, speeds
  [[nodiscard]] ROBOMILL_API MillingCoefficients coefficients() const;
};

/// Least squares for Kt, Kr, Ka and their edge parts from
///     F̄x = -(N a / 4) Kr c - (N a / π) Kre,   F̄y = (N a / 4) Kt c + (N a / π) Kte,
///     F̄z = (N a / π) Ka c + (N a / 2) Kae,
/// the means over φ of the tangential force against the motion, the radial one inwards, and h = c sin φ. They hold for
/// any helix, with edge forces per axial depth (EdgeMeasure::width), for any pitch and with runout as long as every
/// tooth cuts.
/// @throws InvalidInput if a row is out of range ("slots[2].axial_depth_m"), there are fewer than two rows, or a force
/// does not follow the model at all: R² < 0
/// Source: [BudakAltintasArmarego1996]
[[nodiscard]] ROBOMILL_API SlotFit identify_from_slots(const std::vector<SlotForce>& slots, const SlotOptions& options);

/// Highest powers of κ in each coefficient, 0 to 6; -1: there is none.
struct CoefficientDegrees {
  int tangential = 0, radial = 0, axial = 0;
  int tangential_edge = 0, radial_edge = 0, axial_edge = 0;
};

/// What is sought in a signal.
struct ROBOMILL_API SignalOptions {
  CoefficientDegrees degrees = {};
  bool find_offset = true;  ///< the signal's zero of rotation is not known
  int steps = 1440;         ///< of the modelled revolution, 8 to 100,000
  /// In (0, 1); a direction counts as undetermined where its singular value σ < this · the largest σ.
  double rank_tolerance = 1e-8;
  /// @throws InvalidInput naming the member
  void validate() const;
};

struct SignalFit {
  MillingCoefficients coefficients;
  /// Of the same shape: standard deviations from the residuals, taken as independent from sample to sample; infinite
  /// where the signal does not determine the coefficient.
  MillingCoefficients deviations;
  bool identifiable = true;  ///< every one of them
  double offset_rad = 0.0;   ///< tooth 0 stood at rotation + offset, in [0, a period of the cutter)
  double offset_deviation_rad = 0.0;
  Eigen::Vector3d r_squared = Eigen::Vector3d::Zero();  ///< by component; NaN where it does not vary
  double noise_n = 0.0;                                 ///< standard deviation of the signal about the fit
  double condition = 0.0;                               ///< of the scaled design, over the determined directions
  Eigen::Matrix3Xd residual_n;                          ///< measured less fitted, 3 x n
  std::vector<std::string> notes;                       ///< what the signal does not determine; impossible signs
};

/// Coefficients as polynomials in κ from the force over a revolution, for any cutter in any cut: the force is linear
/// in them, F(φ + δ) = Σ_k F_k(φ + δ) p_k, with F_k from cutting_force, and the offset δ is searched over a period
/// of the cutter. Where columns depend on each other the answer is the one of least norm.
/// @param rotation_rad  length n, of tooth 0 at the tip [rad], any order, n at least the number of unknowns
/// @param force_n       3 x n, on the tool, in F
/// @throws InvalidInput as cutting_force and SignalOptions::validate; lengths that differ, values that are not finite,
///     too few samples, a cutter that is not in the cut
[[nodiscard]] ROBOMILL_API SignalFit identify_from_signal(const Cutter& cutter, const Engagement& engagement,
                                                          const CutMotion& motion,
                                                          const Eigen::Ref<const Eigen::VectorXd>& rotation_rad,
                                                          const Eigen::Ref<const Eigen::Matrix3Xd>& force_n,
                                                          const SignalOptions& options = {});

}  // namespace robomill::cutting
