#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <span>

#include "robomill/robot/inverse.hpp"

// Method: robomill/path/README.md, "Outputs"

namespace robomill::path {

/// One moment of a trajectory.
struct Sample {
  double time_s = 0.0;
  robot::Position6 joints = robot::Position6::Zero();  ///< rad or m; rows beyond the machine's joints are 0
  Eigen::Vector3d tip_m = Eigen::Vector3d::Zero();     ///< in W
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();     ///< in W, unit, from the tip to the spindle
  std::size_t block = 0;                               ///< of the program, from 0
  double path_m = 0.0;                                 ///< how far along the planner's path; 0 where it has none
};

/// Takes samples as they come, in order of time; a call holds one or more.
using SampleSink = std::function<void(std::span<const Sample>)>;

}  // namespace robomill::path
