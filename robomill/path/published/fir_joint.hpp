#pragma once
// What a block's time constants must be for the joints.
#include <vector>

#include "robomill/path/options.hpp"
#include "robomill/program/program.hpp"
#include "robomill/robot/kinematics.hpp"

namespace robomill::path {

/// Time constants of one block [s]; t3_s is not used with one filter.
struct FirConstants {
  double t1_s = 0.0, t2_s = 0.0, t3_s = 0.0;
};

/// One block as a way from 0 to 1.
struct FirWay {
  program::Pose begin, end;
  double gamma_begin_rad = 0.0, gamma_end_rad = 0.0;
};

/// Joints and their derivatives by the share at evenly spaced points of a block, its ends among them.
/// @param near  the position to follow from; the one at the block's end on return
/// @param out   the points until the first that the machine cannot take
robot::Reach joints_along(const robot::Kinematics& kinematics, const FirWay& way, robot::Position6& near,
                          std::vector<robot::JointJet>& out);

/// Stretches constants until the joints are within their limits, as far as the method looks (plan_fir()).
void stretch_for_joints(const std::vector<robot::JointJet>& joints, const robot::JointLimits& limits, int count,
                        const SmoothingOptions& options, FirConstants& constants);

}  // namespace robomill::path
