#include "robomill/coupling/files/assembly_json.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "robomill/base/units.hpp"
#include "robomill/coupling/files/segment_fields.hpp"

namespace robomill::coupling {

using io::Json;
using io::number;

Json segments_json(const std::vector<Segment>& segments) {
  Json list = Json::array();
  for (const Segment& s : segments) {
    Json row = {{"length_mm", number(s.length_m / units::mm)},
                {"diameter_mm", number(s.diameter_m / units::mm)},
                {"inner_diameter_mm", number(s.inner_diameter_m / units::mm)},
                {"youngs_modulus_gpa", number(s.youngs_modulus_pa / units::gpa)}};
    if (s.mass_kg > 0.0) row["mass_kg"] = number(s.mass_kg);
    if (s.density_kg_per_m3 > 0.0) row["density_kg_per_m3"] = number(s.density_kg_per_m3);
    row["poissons_ratio"] = number(s.poissons_ratio);
    row["loss_factor"] = number(s.loss_factor);
    if (s.flutes > 0) {
      row["flutes"] = s.flutes;
      row["flute_diameter_ratio"] = number(s.flute_diameter_ratio);
    }
    row["beam"] = name_in(beam_names, s.beam);
    list.push_back(std::move(row));
  }
  return list;
}

Json joint_json(const Joint& joint) {
  Json out;
  for (const io::Field<Joint>& field : joint_fields) out[field.key] = number(joint.*field.value);
  out["cross_stiffness_n_per_rad"] = number(joint.cross_stiffness_n_per_rad);
  out["points"] = joint.points;
  if (joint.points > 1) {
    out["insertion_length_mm"] = number(joint.insertion_length_m / units::mm);
    out["shank"] = segments_json(joint.shank);
  }
  return out;
}

}  // namespace robomill::coupling
