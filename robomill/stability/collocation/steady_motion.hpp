#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "robomill/stability/collocation/steady_force.hpp"
#include "robomill/stability/vibration/tip_dynamics.hpp"

// Derived in docs/theory/three-directions.md
namespace robomill::stability::detail {

/// The structure's periodic answer to a steady force, exactly: between two borders of stretches the force is five
/// harmonics, and each mode's state a sum of their answers and of its own decay.
class SteadyMotion {
 public:
  SteadyMotion(const TipDynamicsIn<3>& tip, const SteadyForce& force, double spindle_speed_rad_per_s);
  /// Displacement at a rotation [m], periodic; at a border of stretches the side on which more cuts counts.
  [[nodiscard]] Eigen::Vector3d at(double rotation_rad) const;

 private:
  /// Between two borders.
  struct Segment {
    double from_rad = 0.0, to_rad = 0.0;
    ForceStretch force;       ///< of all that cut
    Eigen::ArrayXcd decays;   ///< at its start: of each mode what is no answer to the force
    Eigen::ArrayXXcd answer;  ///< n x 5: of e^{-2iθ}, e^{-iθ}, 1, e^{iθ}, e^{2iθ}
  };
  void divide(const SteadyForce& force);
  void answer(const TipDynamicsIn<3>& tip, Segment& segment) const;
  void make_periodic();

  Eigen::ArrayXcd pole_per_rad_;
  Eigen::Matrix3Xcd right_;
  Eigen::Matrix3d compliance_;
  double speed_rad_per_s_, period_rad_;
  std::vector<Segment> segments_;
};

}  // namespace robomill::stability::detail
