#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "robomill/path/sample.hpp"
#include "robomill/report/smooth.hpp"
#include "robomill/report/smooth_outline.hpp"
#include "robomill/robot/kinematics.hpp"
#include "robomill/signal/bands.hpp"

namespace robomill::report {

/// How far each drive is behind: called for every sample in order; {} where none is modelled.
using Tracking = std::function<robot::Position6(const path::Sample& sample)>;

/// Takes a trajectory's samples and keeps what a report shows, in memory that does not grow with them: speeds and the
/// joints' differences by time, the path, and the way round some corners.
class MotionRecorder {
 public:
  /// @param corners  outlive the recorder
  MotionRecorder(const robot::Kinematics& kinematics, const std::array<bool, 6>& prismatic, double sample_period_s,
                 const std::vector<ProgramCorner>& corners);
  /// Begins anew. @param tracking  of the drives from here on
  void restart(Tracking tracking);
  void add(std::span<const path::Sample> samples);
  [[nodiscard]] Motion motion() const;
  /// The way round each corner, 2 x any, in its plane.
  [[nodiscard]] std::vector<Eigen::Matrix2Xd> corner_paths() const;

 private:
  struct Point {
    Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();
    double speed_m_per_s = 0.0;
  };
  void add(const path::Sample& sample);
  void pass_corners(const path::Sample& sample);

  int joints_;
  std::array<bool, 6> prismatic_;
  robot::JointLimits limits_;
  double period_s_;
  const std::vector<ProgramCorner>& corners_;
  Tracking tracking_ = {};
  signal::Bands bands_;
  std::vector<double> values_;
  Decimated<Point> path_;
  std::array<path::Sample, 3> before_ = {};  ///< the last samples, latest first
  bool any_ = false;
  std::vector<std::vector<Eigen::Vector2d>> passes_;
};

}  // namespace robomill::report
