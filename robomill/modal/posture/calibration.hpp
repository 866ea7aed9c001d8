#pragma once
#include <Eigen/Core>
#include <complex>
#include <limits>
#include <optional>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/modal/posture/flexible_arm.hpp"
#include "robomill/modal/posture/smoothed_frf.hpp"

namespace robomill::modal {
struct PostureCalibration;
}

namespace robomill::modal::detail {

/// What postures that are left out, each predicted from the others, show of a calibration.
struct LeftOutPostures {
  double error = std::numeric_limits<double>::quiet_NaN();  ///< mean |ΔH| / |H|; NaN below three postures
  Eigen::Vector3d direct = Eigen::Vector3d::Zero();         ///< Σ |ΔH| / Σ |H| of xx, yy, zz; 0: not measured
  Eigen::Vector3d predicted = Eigen::Vector3d::Zero();      ///< what the covariance makes of it
  /// Factors on the predicted deviations of ln f, ζ and residues.
  double frequency_scale = 1.0, damping_scale = 1.0, residue_scale = 1.0;
};

/// θ, u and their joint deviations: a Gaussian about the least cost.
struct Calibration {
  Eigen::VectorXd common;               ///< θ, length P
  Eigen::MatrixXd differing;            ///< u, a column a posture; rows as `deviating`
  std::vector<Eigen::Index> deviating;  ///< parameters that u moves
  Eigen::MatrixXd covariance;           ///< of (θ, u posture by posture)
  double error = 0.0;                   ///< mean |ΔH| / |H|
  double noise = 0.0;                   ///< variance of a residual, of 5 % of the receptance each
  LeftOutPostures left_out = {};
};

/// The parameters of a posture as the calibration predicts them.
struct PostureParameters {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

/// Distance between postures over all joints but the first, on which nothing depends.
[[nodiscard]] double posture_distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b);

/// Receptances of all postures at every stage of the search: with much added damping first, with hardly any last.
class CalibrationData {
 public:
  enum class Stages { all, last };
  explicit CalibrationData(const std::vector<PostureData>& postures, Stages wanted = Stages::all);
  [[nodiscard]] std::size_t size() const { return joints_.size(); }
  [[nodiscard]] const std::vector<Eigen::VectorXd>& joints() const { return joints_; }
  [[nodiscard]] const std::vector<SmoothedFrf>& stage(std::size_t i) const { return stages_[i]; }
  [[nodiscard]] const std::vector<SmoothedFrf>& last_stage() const { return stages_.back(); }
  /// The same as if no force along that axis, 0 to 2, had been measured.
  [[nodiscard]] CalibrationData without_force(int axis) const;

 private:
  std::vector<Eigen::VectorXd> joints_;
  std::vector<std::vector<SmoothedFrf>> stages_;
};

/// Where a calibration begins.
struct Beginning {
  Eigen::VectorXd parameters;
  double noise = 0.0;  ///< variance of a residual, of 5 % of the receptance each: the less, the better the fit
};

/// The common parameters from much added damping down to little: from the cell's rough numbers into the right valley.
[[nodiscard]] Beginning begin_calibration(const FlexibleArm& arm, const CalibrationData& data, Progress& progress);

struct CalibrationChoice {
  bool varying = false;  ///< joints may differ from posture to posture
  bool judged = true;    ///< left-out postures scale the deviations, where there are three or more
};
[[nodiscard]] Calibration calibrate(const FlexibleArm& arm, const CalibrationData& data, double highest_hz,
                                    const CalibrationChoice& choice, const Beginning& beginning, Progress& progress);

/// The same as calibrate() came to before, without its search. Nothing where `kept` is not of that arm and that data:
/// sizes differ, or the error.
[[nodiscard]] std::optional<Calibration> again(const FlexibleArm& arm, const CalibrationData& data, bool varying,
                                               const PostureCalibration& kept);

/// @param joints  of the measured postures
[[nodiscard]] PostureParameters predict(const FlexibleArm& arm, const Calibration& calibration,
                                        const std::vector<Eigen::VectorXd>& postures, const Eigen::VectorXd& joints);

}  // namespace robomill::modal::detail
