#pragma once
#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "robomill/modal/posture/calibration.hpp"
#include "robomill/modal/posture/flexible_arm.hpp"
#include "robomill/modal/posture_model.hpp"

namespace robomill::modal {

/// What the search of a calibration found. A PostureModel of the same inputs is made from it again, bit for bit,
/// without the search.
struct PostureCalibration {
  detail::ArmStructure structure = {};
  std::vector<detail::FlexibleArm::Tool> tools = {};  ///< where the search for the chain of spindle and tool started
  Eigen::VectorXd common = {};                        ///< as Calibration::common
  Eigen::MatrixXd differing = {};
  double noise = 0.0, error = 0.0;
  detail::LeftOutPostures left_out = {};
  /// As PostureReport::Direct, of xx, yy and zz.
  Eigen::Vector3d held_out_error = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  double unmeasured_scale = 1.0;  ///< factor on the covariance's deviations along axes that nobody hit along
  double band_scale = 1.0;        ///< the same of modes, with what lies beyond the model
};

/// SHA-256 of all that a calibration depends on: masses, springs and geometry of the arm, the payload, the tool's
/// length, joints and measurements of each posture, the options, and the method's version. Names, limits of joints and
/// the workpiece are not in it.
[[nodiscard]] std::string calibration_fingerprint(const robot::Cell& cell, const std::optional<robot::Link>& payload,
                                                  const std::vector<MeasuredPosture>& measured,
                                                  const PostureModelOptions& options);

}  // namespace robomill::modal
