#pragma once
// The same arm in Orocos KDL, as a peer of the tests.
#include <Eigen/Geometry>
#include <kdl/chain.hpp>
#include <kdl/frames.hpp>

#include "robomill/robot/arm.hpp"

namespace robomill::robot::testing {

inline KDL::Frame kdl_frame(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d r = pose.linear();
  const Eigen::Vector3d p = pose.translation();
  return {KDL::Rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)),
          KDL::Vector(p.x(), p.y(), p.z())};
}

inline Eigen::Isometry3d eigen(const KDL::Frame& frame) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    out.translation()(row) = frame.p(row);
    for (int column = 0; column < 3; ++column) out.linear()(row, column) = frame.M(row, column);
  }
  return out;
}

/// Poses alone, no masses.
inline KDL::Chain kdl_chain(const Arm& arm) {
  KDL::Chain chain;
  for (const Joint& joint : arm.joints) {
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), kdl_frame(joint.before)));
    const KDL::Vector axis(joint.axis.x(), joint.axis.y(), joint.axis.z());
    chain.addSegment(KDL::Segment(
        KDL::Joint(KDL::Vector::Zero(), axis, joint.prismatic ? KDL::Joint::TransAxis : KDL::Joint::RotAxis)));
  }
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), kdl_frame(arm.flange)));
  return chain;
}

}  // namespace robomill::robot::testing
