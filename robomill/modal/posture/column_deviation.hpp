#pragma once
#include <Eigen/Core>
#include <complex>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/modal/posture/calibration.hpp"

namespace robomill::modal::detail {

/// Whether the direct receptance xx, yy, zz was measured, by its axis 0, 1, 2.
[[nodiscard]] bool is_measured(const CalibrationData& data, int axis);

/// Σ |ΔH_aa| and Σ |H_aa| of a posture over the lines of the last stage; both 0 where it was not measured.
struct DirectError {
  double error = 0.0, size = 0.0;
  [[nodiscard]] double ratio() const { return size > 0.0 ? error / size : 0.0; }
};
[[nodiscard]] DirectError direct_error(const FlexibleArm::System& system, const SmoothedFrf& frf, int axis);

/// Σ E|δH_aa| over Σ |H_aa| at these lines that deviations of the parameters leave, of xx, yy and zz: δH = ∂H/∂φ δφ, of
/// complex Gaussian errors E|δ| = sqrt(π / 4 · E|δ|²).
/// @param covariance  of the parameters in this posture
[[nodiscard]] Eigen::Vector3d direct_deviation(const FlexibleArm& arm, const FlexibleArm::System& system,
                                               const Eigen::MatrixXd& covariance, const SmoothedFrf& lines);

/// How far a direct receptance is missed where no force along its axis was measured.
struct HeldOut {
  double error = 0.0;      ///< Σ |ΔH_aa| / Σ |H_aa| over all postures, NaN where it is not known
  double predicted = 0.0;  ///< what the parameters' covariance makes of it
};
/// Calibrates without the forces along one measured axis and compares what follows with what was measured of it.
[[nodiscard]] HeldOut hold_out(const FlexibleArm& arm, const CalibrationData& data, double highest_hz, bool varying,
                               const Beginning& beginning, int axis, Progress& progress);

/// What the measurements have beyond the model: a receptance G(s) that moves with the flange, symmetric, the same in
/// all postures. A spindle that deflects along its axis makes one. In posture p, with R_p the flange's axes in B,
///     H_measured - H_model = R_p G R_pᵀ + noise,
/// line by line a linear problem of six unknowns, with a prior deviation of each of the size of the receptance, so that
/// what no posture shows stays as unknown as that.
class Unmodelled {
 public:
  /// @param systems  the calibrated arm in the measured postures
  Unmodelled(const std::vector<FlexibleArm::System>& systems, const CalibrationData& data);
  /// Σ sqrt(E|r_aᵀ G r_a|²) over Σ |H_aa| over the lines, of xx, yy and zz: the estimate of G and its variance.
  [[nodiscard]] Eigen::Vector3d deviation(const FlexibleArm::System& system) const;

 private:
  struct Line {
    std::complex<double> s;
    Eigen::Matrix<std::complex<double>, 6, 1> mean;
    Eigen::Matrix<double, 6, 6> covariance;  ///< of the unknowns, complex Gaussian
  };
  std::vector<Line> lines_;
};

}  // namespace robomill::modal::detail
