#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "robomill/coupling/assembly.hpp"

// Method: robomill/coupling/README.md, "Measured holders"

namespace robomill::coupling {

/// Receptances at a holder's mouth, found from measurements that lack rotations or still carry a tool.
struct HolderResult {
  modal::FrfSet receptances;  ///< xx, x:my, ry:x, ry:my, and y's four where measured
  Eigen::VectorXd
      amplification;  ///< length n: how much more of itself a small error of the measurement is in the receptances
  std::vector<double> unreliable_hz;  ///< lines where the amplification is above HolderOptions::max_amplification
  double truncation_error =
      0.0;  ///< of the finite difference with three points: ‖second order - first‖ / ‖first‖ of x:my; 0 elsewhere
  std::vector<std::string> notes;
};

struct HolderOptions {
  double max_amplification = 100.0;  ///< > 0; a line is unreliable where amplification > max_amplification
  /// Tikhonov's, as a share of the largest singular value, >= 0; a line whose condition is κ is biased by (share κ)².
  double regularisation = 1e-5;
};

/// Completes rotations by finite difference of translations at two or three points near the mouth:
///   u = Σ a_k u_k,  θ = Σ b_k u_k,  R = W H Wᵀ,  W = [a; b],
/// with the weights of the polynomial through the points. Positions count from the mouth towards the spindle.
/// @param measured  1x:1x, 2x:1x, 2x:2x, …; of two reciprocal ones one will do
/// @param position_m  of points 1, 2 (and 3), no two equal [m]
/// @throws InvalidInput if a set, position or FRF is missing or not valid
/// Source: [DuarteEwins2000]
[[nodiscard]] ROBOMILL_API HolderResult complete_rotations(const modal::FrfSet& measured,
                                                           const std::vector<double>& position_m,
                                                           const HolderOptions& options = {});

/// Takes a known artefact off a measured assembly: the receptances of what it stood on, joint included. Every
/// translation measured at a point of the artefact is one linear equation for the three unknowns of
///   M = (B⁻¹ + K)⁻¹,  h_ij = g_ij + t_i M t_jᵀ,  B = (M⁻¹ - K)⁻¹,
/// with g_ij the artefact's receptance when clamped at the joint, t_i its transmissibility and K its dynamic stiffness
/// there; no finite difference is taken. README.md says more.
/// @param artefact  its segments from the free end to the joint
/// @param measured  as of complete_rotations, in positions from the free end towards the spindle; at least three FRFs
///     of two points a plane
/// @throws InvalidInput if a set, position, segment or FRF is missing or not valid
/// Source: [ParkAltintasMovahhedy2003], with the artefact's own shape in place of finite differences
[[nodiscard]] ROBOMILL_API HolderResult remove_artefact(const modal::FrfSet& measured,
                                                        const std::vector<double>& position_m,
                                                        const std::vector<Segment>& artefact,
                                                        const HolderOptions& options = {});

}  // namespace robomill::coupling
