#include "robomill/robot/kinematics/kdl_chain.hpp"

namespace robomill::robot {
namespace {

KDL::Vector kdl_vector(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

KDL::Frame kdl_frame(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d r = pose.linear();
  return {KDL::Rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)),
          kdl_vector(pose.translation())};
}

}  // namespace

KDL::Chain kdl_chain(const Arm& arm) {
  KDL::Chain chain;
  for (const Joint& joint : arm.joints) {
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), kdl_frame(joint.before)));
    const Eigen::Matrix3d& i = joint.link.inertia_kg_m2;
    const KDL::RigidBodyInertia body(joint.link.mass_kg, kdl_vector(joint.link.center_m),
                                     KDL::RotationalInertia(i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2)));
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Vector::Zero(), kdl_vector(joint.axis),
                                             joint.prismatic ? KDL::Joint::TransAxis : KDL::Joint::RotAxis),
                                  KDL::Frame::Identity(), body));
  }
  return chain;
}

}  // namespace robomill::robot
