#pragma once
#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"

/// The force record of a dynamometer beside a predicted revolution.
// Method: robomill/cutting/README.md, "Measured forces (`measured_force.hpp`)"
namespace robomill::cutting {

/// Forces as recorded, in the axes and with the sign of the prediction.
struct ForceRecord {
  double sample_rate_hz = 0.0;  ///< [Hz], > 0; required
  Eigen::Matrix3Xd force_n;     ///< 3 x n; a row of NaN: that component was not measured
};

/// One revolution of a prediction.
struct PredictedRevolution {
  Eigen::VectorXd rotation_rad;  ///< length m >= 8: even steps of one revolution, of tooth 0
  Eigen::Matrix3Xd force_n;      ///< 3 x m, means over the steps
  int teeth = 0;                 ///< N, >= 1; required
  bool teeth_alike = true;       ///< it repeats with every tooth
};

struct ROBOMILL_API MeasuredForceOptions {
  double spindle_speed_rad_per_s = 0.0;  ///< Ω as given [rad/s], > 0; required
  double speed_tolerance = 0.01;         ///< relative; the record's own speed is sought within it, in [0, 0.1] and
                                         ///< at most 0.4 / N: beyond it N teeth look like N ± 1 at another speed
  double from_s = 0.0;                   ///< of the record: the stretch in the cut
  double to_s = std::numeric_limits<double>::infinity();  ///< its end; the stretch is found where neither is given
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Signed axes of a record: entry i is what the prediction's axis i is, +1, +2, +3 for the record's x, y, z, negative
/// for its opposite.
using SignedAxes = std::array<int, 3>;

/// Amplitudes at a multiple of the rotation.
struct ForceHarmonic {
  int multiple = 0;           ///< of the spindle speed, from 1
  double frequency_hz = 0.0;  ///< at the record's speed
  Eigen::Vector3d measured_n, predicted_n;
};

/// The mean of the record's revolutions at the steps of the prediction, and the two compared. Components that were not
/// measured are NaN.
struct MeasuredForce {
  double sample_rate_hz = 0.0;
  double from_s = 0.0, to_s = 0.0;  ///< the revolutions that count
  int revolutions = 0;              ///< of them
  int revolutions_in_record = 0;    ///< whole ones at the speed as given

  double spindle_speed_rad_per_s = 0.0;            ///< that of the record
  double spindle_speed_deviation_rad_per_s = 0.0;  ///< standard deviation
  double wander_rad = 0.0;                         ///< standard deviation of the angle of a single revolution
  double offset_deviation_rad = 0.0;  ///< … and of the mean one: at from_s tooth 0 stood at the prediction's first step

  int air_revolutions = 0;                           ///< whose mean was taken off; 0: forces are as recorded
  Eigen::Vector3d zero_n = Eigen::Vector3d::Zero();  ///< that mean, of air before and after the cut at its middle
  Eigen::Vector3d drift_n;  ///< of a revolution's mean from from_s to to_s; taken out about its middle

  Eigen::VectorXd rotation_rad;  ///< length m, those of the prediction
  Eigen::Matrix3Xd force_n;      ///< 3 x m: mean revolution
  Eigen::Matrix3Xd deviation_n;  ///< 3 x m: standard deviation of single revolutions about it

  Eigen::Vector3d mean_n, peak_n, rms_n;               ///< of the mean revolution, as in ForceSummary
  Eigen::Vector3d mean_deviation_n, peak_deviation_n;  ///< of single revolutions
  Eigen::Vector3d scatter_n;                           ///< root mean square of deviation_n
  Eigen::Vector3d between_teeth_n;  ///< root mean square of what differs from tooth to tooth in the mean revolution
  Eigen::Vector3d predicted_mean_n, predicted_peak_n, predicted_rms_n;  ///< of what it was compared with

  /// Root mean square of predicted less measured. The noise of the mean revolution, scatter_n / √revolutions, is in it;
  /// the offset, a free parameter, makes it smaller.
  Eigen::Vector3d error_n;
  Eigen::Vector3d error_ratio;        ///< over rms_n
  Eigen::Vector3d shape_error_n;      ///< the same without the means
  Eigen::Vector3d shape_error_ratio;  ///< over the measured root mean square without its mean

  std::vector<ForceHarmonic> harmonics;  ///< the first ones; a resonance of the dynamometer stands out in them

  /// Axes with which the error of all components is below 0.75 of that with the given ones; only where all three were
  /// measured and the given error is above 0.3 of the measured force.
  std::optional<SignedAxes> better_axes;
  double better_axes_error_ratio = 0.0, error_ratio_of_all = 0.0;  ///< of all components together, means included
  std::vector<std::string> notes;                                  ///< sentences for the user
};

/// Cuts the record into revolutions, averages them and lays the prediction over them.
///
/// The strongest is the variation that five revolutions in succession reach. The stretch in the cut is the longest run
/// of revolutions whose force varies by more than half of it and less than twice, 200 revolutions at most and 4e6 steps
/// together, those in its middle. Five revolutions or more before or after it that vary by less than a tenth of it are
/// air, whose mean is taken off: of air on both sides the straight line between, at the stretch's middle. The speed
/// maximises Σ_k |X(kΩ)|² over the harmonics of rotation, X the transform of the stretch, and is then the slope of the
/// revolutions' angles, which gives its deviation, residuals taken as independent. The offset maximises the correlation
/// with the prediction.
/// @throws InvalidInput naming the member, or "record": fewer than five revolutions, fewer than four samples a tooth,
///     values that are not finite, nothing that repeats with the rotation (air), a force below 2 % of the predicted
///     one, a prediction without force
[[nodiscard]] ROBOMILL_API MeasuredForce compare_forces(const ForceRecord& record, const PredictedRevolution& predicted,
                                                        const MeasuredForceOptions& options);

}  // namespace robomill::cutting
