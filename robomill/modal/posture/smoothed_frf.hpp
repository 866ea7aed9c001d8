#pragma once
#include <Eigen/Core>
#include <complex>
#include <vector>

#include "robomill/modal/posture_model.hpp"

namespace robomill::modal::detail {

/// Receptances of one posture, smoothed: of s = σ + iω with σ = max(share · ω, a line's distance) the value
///     2 H(σ + iω) − H(2σ + iω),
/// and H itself where σ = 0.
struct SmoothedFrf {
  std::vector<std::complex<double>> s;
  Eigen::Matrix<std::complex<double>, 9, Eigen::Dynamic> value;  ///< column by column; 0 where not measured
  Eigen::Matrix<double, 9, Eigen::Dynamic> weight;               ///< over what an error counts; 0 where not measured
};

/// What was measured in one posture.
class PostureData {
 public:
  /// @throws InvalidInput as PostureModel
  PostureData(const MeasuredPosture& measured, const PostureModelOptions& options);
  [[nodiscard]] const Eigen::VectorXd& joints() const { return joints_; }
  /// From measured lines by Poisson's integral for the half plane, in which H is analytic,
  ///     H(σ + iω) = 1/π ∫ H(iν) σ / ((ω − ν)² + σ²) dν,
  /// or from modes by their sum. Of 2 H(σ) − H(2σ) the kernel falls with the fourth power of the distance, and what
  /// lies beyond the last line hardly counts.
  /// @param resolved  where the lines are too far apart for that width, or too near the last, they themselves, σ = 0
  [[nodiscard]] SmoothedFrf smoothed(double share, int lines, bool resolved = false) const;

 private:
  [[nodiscard]] Eigen::Matrix<std::complex<double>, 9, 1> of_modes(std::complex<double> s) const;
  [[nodiscard]] Eigen::Matrix<std::complex<double>, 9, 1> of_lines(double at_hz, double sigma_hz) const;
  Eigen::VectorXd joints_;
  Eigen::VectorXd frequency_hz_;                                  ///< length L; empty where modes are given
  Eigen::Matrix<std::complex<double>, 9, Eigen::Dynamic> value_;  ///< 9 x L
  Eigen::Matrix<bool, 9, 1> known_ = Eigen::Matrix<bool, 9, 1>::Constant(false);
  std::optional<ModalModel> modes_;
  double low_hz_ = 0.0, high_hz_ = 0.0;
};

}  // namespace robomill::modal::detail
