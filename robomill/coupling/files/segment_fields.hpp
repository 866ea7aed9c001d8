#pragma once
#include <iterator>

#include "robomill/base/units.hpp"
#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/joint_fit.hpp"
#include "robomill/io/toml/file.hpp"

namespace robomill::coupling {

/// The numbers of a segment as files have them.
inline constexpr io::Field<Segment> segment_fields[] = {
    {"length_mm", "length_m", units::mm, &Segment::length_m},
    {"diameter_mm", "diameter_m", units::mm, &Segment::diameter_m},
    {"inner_diameter_mm", "inner_diameter_m", units::mm, &Segment::inner_diameter_m},
    {"youngs_modulus_gpa", "youngs_modulus_pa", units::gpa, &Segment::youngs_modulus_pa},
    {"density_kg_per_m3", "density_kg_per_m3", 1.0, &Segment::density_kg_per_m3},
    {"mass_kg", "mass_kg", 1.0, &Segment::mass_kg},
    {"poissons_ratio", "poissons_ratio", 1.0, &Segment::poissons_ratio},
    {"loss_factor", "loss_factor", 1.0, &Segment::loss_factor},
    {"flute_diameter_ratio", "flute_diameter_ratio", 1.0, &Segment::flute_diameter_ratio},
};

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
