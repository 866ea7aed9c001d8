#pragma once
#include <iterator>

#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/joint_fit.hpp"
#include "robomill/io/toml/file.hpp"

namespace robomill::coupling {

/// The unknowns of a joint in the order of JointUnknown; SI in the files too.
inline constexpr io::Field<Joint> joint_fields[] = {
    {"translational_stiffness_n_per_m", "translational_stiffness_n_per_m", 1.0,
     &Joint::translational_stiffness_n_per_m},
    {"translational_damping_n_s_per_m", "translational_damping_n_s_per_m", 1.0,
     &Joint::translational_damping_n_s_per_m},
    {"rotational_stiffness_n_m_per_rad", "rotational_stiffness_n_m_per_rad", 1.0,
     &Joint::rotational_stiffness_n_m_per_rad},
    {"rotational_damping_n_m_s_per_rad", "rotational_damping_n_m_s_per_rad", 1.0,
     &Joint::rotational_damping_n_m_s_per_rad},
};
static_assert(std::size(joint_fields) == joint_unknowns);

}  // namespace robomill::coupling
