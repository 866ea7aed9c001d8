#include "robomill/coupling/assembly.hpp"

#include <fmt/format.h>

#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/coupling/section.hpp"

namespace robomill::coupling {

void Segment::validate() const {
  require_positive("length_m", length_m, "m");
  require_positive("diameter_m", diameter_m, "m");
  if (!(inner_diameter_m >= 0.0 && inner_diameter_m < diameter_m)) {
    throw InvalidInput("inner_diameter_m", inner_diameter_m, "m", "must be >= 0 and below the diameter");
  }
  require_positive("youngs_modulus_pa", youngs_modulus_pa, "Pa",
                   "Steel is near 200 GPa, cemented carbide near 600 GPa");
  require_non_negative("mass_kg", mass_kg, "kg");
  if (mass_kg == 0.0) {
    require_positive("density_kg_per_m3", density_kg_per_m3, "kg/m^3",
                     "Steel is near 7800, cemented carbide near 14500");
  }
  if (!(poissons_ratio > -1.0 && poissons_ratio <= 0.5)) {
    throw InvalidInput("poissons_ratio", poissons_ratio, "", "must be above -1 and at most 0.5", "Steel is near 0.3");
  }
  if (!(loss_factor >= 0.0 && loss_factor <= 1.0)) {
    throw InvalidInput("loss_factor", loss_factor, "", "must be in [0, 1]",
                       "It is twice the damping ratio, not a percentage");
  }
  if (flutes < 0) throw InvalidInput("flutes", flutes, "", "must be >= 0");
  if (!(flute_diameter_ratio > 0.0 && flute_diameter_ratio <= 1.0)) {
    throw InvalidInput("flute_diameter_ratio", flute_diameter_ratio, "", "must be above 0 and at most 1");
  }
  if (flutes > 0 && inner_diameter_m >= diameter_m * flute_diameter_ratio) {
    throw InvalidInput("inner_diameter_m", inner_diameter_m, "m", "must be below the fluted part's core",
                       "The core counts as flute_diameter_ratio of the diameter");
  }
}

namespace detail {

void validate_segments(const char* member, const std::vector<Segment>& segments) {
  for (std::size_t i = 0; i < segments.size(); ++i) {
    try {
      segments[i].validate();
    } catch (const InvalidInput& error) {
      throw within(fmt::format("{}[{}].", member, i + 1), error);
    }
  }
}

}  // namespace detail

void Joint::validate() const {
  require_positive("translational_stiffness_n_per_m", translational_stiffness_n_per_m, "N/m");
  require_non_negative("translational_damping_n_s_per_m", translational_damping_n_s_per_m, "N s/m");
  require_positive("rotational_stiffness_n_m_per_rad", rotational_stiffness_n_m_per_rad, "N m/rad");
  require_non_negative("rotational_damping_n_m_s_per_rad", rotational_damping_n_m_s_per_rad, "N m s/rad");
  require_finite("cross_stiffness_n_per_rad", cross_stiffness_n_per_rad, "N/rad");
  if (!(cross_stiffness_n_per_rad * cross_stiffness_n_per_rad <
        translational_stiffness_n_per_m * rotational_stiffness_n_m_per_rad)) {
    throw InvalidInput("cross_stiffness_n_per_rad", cross_stiffness_n_per_rad, "N/rad",
                       "must be below the geometric mean of the two stiffnesses",
                       "Else some load would move the joint against itself");
  }
  if (points < 1 || points > 100) throw InvalidInput("points", points, "", "must be in 1 ... 100");
  if (points == 1) {
    if (!shank.empty()) throw InvalidInput("shank", "must be left out where the joint has one point, at the mouth");
    return;
  }
  require_positive("insertion_length_m", insertion_length_m, "m", "Several points stand over the shank's length");
  if (shank.empty()) throw InvalidInput("shank", "is missing: the part of the tool that stands in the holder");
  detail::validate_segments("shank", shank);
  if (std::abs(detail::total_length(shank) - insertion_length_m) > 1e-9 + 1e-6 * insertion_length_m) {
    throw InvalidInput("insertion_length_m", insertion_length_m, "m", "must be the length of the shank's segments");
  }
}

void Accelerometer::validate() const {
  require_non_negative("mass_kg", mass_kg, "kg");
  if (mass_kg > 1.0) {
    throw InvalidInput("mass_kg", mass_kg, "kg", "must be <= 1", "Accelerometers have 0.0005 to 0.05 kg");
  }
  require_non_negative("offset_m", offset_m, "m");
}

namespace {

void require_free(const Assembly& assembly) {
  const Holder& holder = assembly.holder;
  if (!holder.segments.empty() || !holder.receptances.frfs.empty()) {
    throw InvalidInput("holder.free", "must not be true beside segments or receptances");
  }
  if (assembly.joint) {
    throw InvalidInput("holder.free", "must not be true beside a joint", "A tool that hangs free is joined to nothing");
  }
}

}  // namespace

void Assembly::validate() const {
  if (tool.empty()) throw InvalidInput("tool", "has no segment", "At least one, from the tip to the joint");
  detail::validate_segments("tool", tool);
  detail::validate_segments("holder.segments", holder.segments);
  if (!holder.receptances.frfs.empty()) {
    if (!holder.segments.empty()) throw InvalidInput("holder", "must have segments or receptances, not both");
    holder.receptances.validate();
  }
  if (holder.free) require_free(*this);
  try {
    accelerometer.validate();
  } catch (const InvalidInput& error) {
    throw within("accelerometer.", error);
  }
  if (!joint) return;
  try {
    joint->validate();
  } catch (const InvalidInput& error) {
    throw within("joint.", error);
  }
  if (joint->points > 1 && !holder.segments.empty() &&
      detail::total_length(holder.segments) < joint->insertion_length_m) {
    throw InvalidInput("joint.insertion_length_m", joint->insertion_length_m, "m",
                       "must not be longer than the holder");
  }
}

}  // namespace robomill::coupling
