#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/path/record/outline.hpp"
#include "robomill/path/sample.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/signal/bands.hpp"

// Method: robomill/path/README.md, "What is recorded for a page"

namespace robomill::path {

/// What one joint does; rad or m.
struct JointMotion {
  bool prismatic = false;  ///< m; else rad
  signal::Band velocity = {}, acceleration = {}, jerk = {};
  signal::Band tracking_error = {};  ///< of its drive; empty where none was modelled
};

/// A trajectory over time: every band has n runs of run_s each, from 0 on.
struct Motion {
  double run_s = 0.0;
  signal::Band tip_speed_m_per_s = {}, axis_speed_rad_per_s = {};
  std::vector<JointMotion> joints = {};
  Eigen::Matrix3Xd tip_m = {};                        ///< 3 x m, some of its points in their order
  Eigen::VectorXd tip_speed_at_m_per_s = {};          ///< length m
  std::vector<Eigen::Matrix2Xd> corner_paths_m = {};  ///< the way round each corner, 2 x any, in the corner's plane
};

/// How far each drive is behind: called for every sample in order; {} where none is modelled.
using Tracking = std::function<robot::Position6(const Sample& sample)>;

/// Takes a trajectory's samples and keeps what a page shows, in memory that does not grow with them: speeds and the
/// joints' differences by time, the path, and the way round some corners.
class ROBOMILL_API MotionRecorder {
 public:
  /// @param prismatic  of each joint
  /// @param corners    of the outline; outlive the recorder
  /// @throws InvalidInput if there are not 1 to 6 joints or the period is not > 0
  MotionRecorder(int joints, const std::array<bool, 6>& prismatic, double sample_period_s,
                 const std::vector<ProgramCorner>& corners);
  /// Begins anew. @param tracking  of the drives from here on
  void restart(Tracking tracking);
  void add(std::span<const Sample> samples);
  [[nodiscard]] Motion motion() const;

 private:
  struct Point {
    Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();
    double speed_m_per_s = 0.0;
  };
  void add(const Sample& sample);
  void pass_corners(const Sample& sample);

  int joints_;
  std::array<bool, 6> prismatic_;
  double period_s_;
  const std::vector<ProgramCorner>& corners_;
  Tracking tracking_ = {};
  signal::Bands bands_;
  std::vector<double> values_;
  Decimated<Point> path_;
  std::array<Sample, 3> before_ = {};  ///< the last samples, latest first
  bool any_ = false;
  std::vector<std::vector<Eigen::Vector2d>> passes_;
};

}  // namespace robomill::path
