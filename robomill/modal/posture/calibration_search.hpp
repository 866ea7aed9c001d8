#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/modal/posture/calibration.hpp"
#include "robomill/modal/posture/posture_normal.hpp"

namespace robomill::modal::detail {

/// Of what differs from posture to posture, the share that nearby postures do not have in common.
inline constexpr double own_share = 0.2;
/// The covariance of what differs between two postures, over that of one, less own_share.
[[nodiscard]] double posture_kernel(const Eigen::VectorXd& a, const Eigen::VectorXd& b);

/// The variance of a residual before anything is known, of 5 % each: the cell's numbers count until the data agree.
inline constexpr double first_noise = 40.0;

/// Everything that stays the same while the parameters are sought.
class CalibrationSearch {
 public:
  CalibrationSearch(const FlexibleArm& arm, const CalibrationData& data, bool varying, const Eigen::VectorXd& near);

  /// A stage of the data, 0 to last_stage.
  void stage(std::size_t i);
  /// Where another search ended. @param differing  of its size
  void resume(const Eigen::MatrixXd& differing, double noise);

  [[nodiscard]] Eigen::VectorXd parameters_of(std::size_t posture) const {
    return parameters_of(common_, differing_, posture);
  }

  /// Levenberg-Marquardt over θ (and u).
  /// @param least_gain  of the cost, a share: less ends it
  void descend(int iterations, double least_gain, bool with_differing, Progress& progress);

  /// From residuals: the variance of one, alike lines counted once.
  void estimate_noise();
  [[nodiscard]] double noise() const { return noise_; }
  void expect_noise(double noise) { noise_ = noise; }
  [[nodiscard]] double error() const;

  /// (θ, u) without one posture, from the Gauss-Newton matrices at the solution; its covariance too.
  struct LeftOut {
    Eigen::VectorXd parameters;  ///< φ of the posture left out
    Eigen::MatrixXd covariance;  ///< of them
  };
  [[nodiscard]] LeftOut without(std::size_t posture) const;
  [[nodiscard]] PostureNormal evaluate_at(std::size_t posture, const Eigen::VectorXd& parameters,
                                          bool derivatives) const;
  /// A posture's own parameters: its receptances, with a wide prior about what was predicted.
  [[nodiscard]] Eigen::VectorXd refined(std::size_t posture, const Eigen::VectorXd& predicted, PostureNormal at) const;
  [[nodiscard]] Eigen::MatrixXd covariance() const;
  [[nodiscard]] const Eigen::VectorXd& common() const { return common_; }
  [[nodiscard]] const Eigen::MatrixXd& differing() const { return differing_; }
  [[nodiscard]] const std::vector<Eigen::Index>& deviating() const { return deviating_; }

 private:
  [[nodiscard]] Eigen::VectorXd parameters_of(const Eigen::VectorXd& common, const Eigen::MatrixXd& differing,
                                              std::size_t posture) const;

  void evaluate();

  /// @param left_out  a posture that does not count
  [[nodiscard]] double trial_cost(const Eigen::VectorXd& common, const Eigen::MatrixXd& differing,
                                  std::size_t left_out = SIZE_MAX) const;
  double total(const Eigen::VectorXd& common, const Eigen::MatrixXd& differing, std::size_t left_out = SIZE_MAX) const;
  [[nodiscard]] double prior_cost(const Eigen::VectorXd& common, const Eigen::MatrixXd& differing) const;

  /// The precision of θ and u, or of θ alone. @param damping  Marquardt's, on the diagonal
  [[nodiscard]] Eigen::MatrixXd assemble(bool with_differing, double damping, std::size_t left_out) const;
  [[nodiscard]] Eigen::VectorXd gradient(bool with_differing, std::size_t left_out) const;
  [[nodiscard]] Eigen::VectorXd solve_step(bool with_differing, double damping, std::size_t left_out) const;
  /// φ of a posture from (θ, u).
  [[nodiscard]] Eigen::MatrixXd picked(std::size_t posture) const;

  const FlexibleArm& arm_;
  const CalibrationData& data_;
  Eigen::VectorXd start_, prior_;
  std::vector<Eigen::Index> deviating_;
  std::vector<double> deviation_;
  Eigen::MatrixXd inverse_kernel_;
  const std::vector<SmoothedFrf>* frfs_ = nullptr;
  std::vector<PostureNormal> normals_;
  Eigen::VectorXd common_;
  Eigen::MatrixXd differing_;
  std::vector<std::size_t> active_;
  double noise_ = first_noise, marquardt_ = 1e-3;
};

}  // namespace robomill::modal::detail
