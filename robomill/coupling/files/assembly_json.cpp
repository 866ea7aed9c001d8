#include "robomill/coupling/files/assembly_json.hpp"

#include <utility>
#include <vector>

#include "robomill/coupling/files/segment_fields.hpp"

namespace robomill::coupling {

using io::key;
using io::Row;
using io::Schema;

const Schema<Segment>& segment_table() {
  const auto fluted = [](const Segment& segment) { return segment.flutes > 0; };
  static const Schema<Segment> table(
      "segment", "a segment of tool or holder",
      {key("length_mm", &Segment::length_m, "along the axis"), key("diameter_mm", &Segment::diameter_m, "outside"),
       key("inner_diameter_mm", &Segment::inner_diameter_m, "of its bore; 0: none"),
       key("youngs_modulus_gpa", &Segment::youngs_modulus_pa, "of its material"),
       where([](const Segment& segment) { return segment.mass_kg > 0.0; },
             key("mass_kg", &Segment::mass_kg, "where it was weighed")),
       where([](const Segment& segment) { return segment.density_kg_per_m3 > 0.0; },
             key("density_kg_per_m3", &Segment::density_kg_per_m3, "of its material")),
       key("poissons_ratio", &Segment::poissons_ratio, "of its material"),
       key("loss_factor", &Segment::loss_factor, "of its material"),
       where(fluted, key("flutes", &Segment::flutes, "of a fluted part")),
       where(fluted, key("flute_diameter_ratio", &Segment::flute_diameter_ratio,
                         "share of the diameter that counts as a solid round")),
       key("beam", &Segment::beam, beam_names, "theory")},
      io::Use::written);
  return table;
}

const Schema<Joint>& assembly_joint_table() {
  static const Schema<Joint> table(
      "assembly_joint", "the joint between tool and holder",
      [] {
        std::vector<Row<Joint>> rows;
        for (const io::Field<Joint>& field : joint_fields) rows.push_back(key(field.key, field.value, "in SI"));
        const auto distributed = [](const Joint& joint) { return joint.points > 1; };
        add_rows(rows, {key("cross_stiffness_n_per_rad", &Joint::cross_stiffness_n_per_rad, "in SI"),
                        key("points", &Joint::points, "along the shank"),
                        where(distributed, key("insertion_length_mm", &Joint::insertion_length_m, "of the shank")),
                        where(distributed, key("shank", &Joint::shank, segment_table(), "in the holder"))});
        return rows;
      }(),
      io::Use::written);
  return table;
}

}  // namespace robomill::coupling
