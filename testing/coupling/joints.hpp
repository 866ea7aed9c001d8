#pragma once
// Joints as the model's four numbers, and the tip with them, for tests of the joint's model and of its identification.
#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/base.hpp"
#include "robomill/coupling/beam_element.hpp"
#include "robomill/coupling/joint_model.hpp"
#include "testing/coupling/beams.hpp"

namespace robomill::coupling::testing {

inline constexpr detail::JointValues planted = {2e7, 40.0, 5e4, 0.5};

inline detail::JointModel model_of(const Assembly& assembly, const Eigen::VectorXd& frequency_hz, double cross = 0.0) {
  return detail::JointModel(detail::beam_elements(assembly.tool, frequency_hz),
                            detail::base_receptances(assembly.holder, frequency_hz).x, frequency_hz, cross);
}

inline Joint joint_of(const detail::JointValues& values) {
  return {.translational_stiffness_n_per_m = values[0],
          .translational_damping_n_s_per_m = values[1],
          .rotational_stiffness_n_m_per_rad = values[2],
          .rotational_damping_n_m_s_per_rad = values[3]};
}

inline detail::JointValues values_of(const Joint& joint) {
  return {joint.translational_stiffness_n_per_m, joint.translational_damping_n_s_per_m,
          joint.rotational_stiffness_n_m_per_rad, joint.rotational_damping_n_m_s_per_rad};
}

/// The tip's xx with a joint.
inline modal::FrfSet tip_with(Assembly assembly, const Joint& joint, const Eigen::VectorXd& frequency_hz) {
  assembly.joint = joint;
  modal::FrfSet set = tip_frfs(assembly, frequency_hz).frfs;
  set.frfs.resize(1);
  return set;
}
}  // namespace robomill::coupling::testing
