#pragma once
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "robomill/stability/collocation/collocation_case.hpp"

// Derived in docs/theory/three-directions.md
namespace robomill::stability::detail {

/// What teeth that differ add to the steady motion q_s by cutting each other's waves: the periodic r of
/// r = G * K (q_s + r - (q_s + r)(t - τ)), by the case's collocation. Of a Form::blocks case.
class RegeneratedMotion {
 public:
  /// @param at      must outlive this
  /// @param steady  q_s at a rotation [m]
  RegeneratedMotion(const CollocationCase& at, const TipDynamicsIn<3>& tip,
                    const std::function<Eigen::Vector3d(double rotation_rad)>& steady);
  /// r at a rotation [m]. NaN where no periodic motion was found.
  [[nodiscard]] Eigen::Vector3d at(double rotation_rad) const;
  /// ‖x - Φ x - p‖ / ‖p‖ of the state x that a period starts from.
  [[nodiscard]] double residual() const { return residual_; }

 private:
  [[nodiscard]] Eigen::Vector3d of_modes(const Eigen::VectorXcd& state, double time_s) const;

  const CollocationCase& case_;
  const TipDynamicsIn<3>& tip_;
  std::vector<double> places_;              ///< of a piece: its start, its nodes, its end
  std::vector<Eigen::VectorXcd> starts_;    ///< [piece]: the modes
  std::vector<Eigen::Matrix3Xd> recorded_;  ///< [piece]: r at the places; empty where nothing cuts or is looked back to
  double residual_ = 0.0;
};

}  // namespace robomill::stability::detail
