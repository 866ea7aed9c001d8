#pragma once
#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/modal/posture/posture_calibration.hpp"
#include "robomill/modal/posture_model.hpp"

namespace robomill::modal::detail {

/// What a PostureModel takes its modes from.
class PostureSource {
 public:
  virtual ~PostureSource() = default;
  [[nodiscard]] virtual ModalModel at(const Eigen::VectorXd& joints) const = 0;
  [[nodiscard]] virtual Eigen::Vector3d direct_deviation(const Eigen::VectorXd& joints) const = 0;
  /// What its search found; nothing where it has none.
  [[nodiscard]] virtual std::optional<PostureCalibration> calibration() const = 0;
  robot::Cell cell;
  PostureReport report;
  std::vector<Eigen::VectorXd> postures;
  std::vector<std::string> names;
};

/// A model of the arm, calibrated or as the cell says.
/// @param kept      of an earlier search for the same inputs, or null; where it is not of them the search is done
/// @param searched  set to whether there was a search
[[nodiscard]] std::unique_ptr<PostureSource> calibrated_arm(
    const robot::Cell& cell, const std::optional<robot::Link>& payload, const std::vector<MeasuredPosture>& measured,
    const PostureModelOptions& options, const PostureCalibration* kept, bool& searched, Progress& progress);

}  // namespace robomill::modal::detail
