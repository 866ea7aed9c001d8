#pragma once
#include <Eigen/Core>
#include <complex>

#include "robomill/stability/collocation/steady_force.hpp"
#include "robomill/stability/forced_vibration.hpp"
#include "robomill/stability/vibration/tip_dynamics.hpp"

namespace robomill::stability::detail {

/// ∫ e^{iwφ} dφ from..to.
[[nodiscard]] std::complex<double> turned(double w, double from_rad, double to_rad);
/// Greatest |Re(2 q e^{iωt})| over t.
[[nodiscard]] double greatest(const Eigen::Vector3cd& q);
/// Half the greatest distance between two of the places, which is half the peak to peak in the direction in which that
/// is greatest: widened from 13 directions on, each turned to the line through the two places farthest apart in it.
/// @param path  3 x n, n >= 1
[[nodiscard]] double half_extent(const Eigen::Matrix3Xd& path);
void set_mode(ForcedVibration& vibration, const MovedMode& mode);

/// A steady motion that has been found.
struct SteadyPath {
  const SteadyForce& force;
  Eigen::Matrix3Xd path;  ///< in the structure's axes, at even rotations over the force's period
  double spindle_speed_rad_per_s = 0.0;
};
/// Of that motion, about its mean.
[[nodiscard]] ForcedVibration vibration_of(const TipDynamicsIn<3>& tip, const SteadyPath& steady);

}  // namespace robomill::stability::detail
