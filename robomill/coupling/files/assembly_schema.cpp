#include "robomill/coupling/files/assembly_schema.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <string_view>

#include "robomill/base/error.hpp"
#include "robomill/coupling/files/segment_fields.hpp"

namespace robomill::coupling {
namespace {

using io::key;
using io::of;
using io::Row;
using io::Schema;

/// One of the four that robomill joint looks for, which need not keep its rule there: Joint::validate checks it.
Row<Joint> joint_key(const io::Field<Joint>& field) {
  Row<Joint> row = key(field.key, field.value, "of the joint");
  row.read_by([&field](io::TomlFile& file, const std::string& path, Joint& out) {
    file.number(path, std::string("joint.") + field.member, field.factor, out.*field.value);
  });
  return std::string_view(field.key).find("stiffness") != std::string_view::npos ? row.above(0.0) : row.at_least(0.0);
}

/// A range of [search] of one unknown.
Row<JointFitOptions> range_key(std::size_t unknown) {
  const bool stiffness = unknown % 2 == 0;
  const char* const name = joint_fields[unknown].key;
  return io::declared<JointFitOptions>(name, io::Holds::number,
                                       stiffness
                                           ? "range of the search, from, to. Without it ga as published [1e5, 1e8]; "
                                             "hybrid [1e3, 1e12]"
                                           : "range of the search, from, to. Without it ga as published [0, 100]; "
                                             "hybrid [0, 1e6]",
                                       1)
      .entries(2)
      .at_least(0.0)
      .read_by([=](io::TomlFile& file, const std::string& path, JointFitOptions& out) {
        std::vector<double> range;
        if (!file.numbers(path, name, 1.0, range)) return;
        if (range.size() != 2 || !(range[0] <= range[1]) || !(stiffness ? range[0] > 0.0 : range[0] >= 0.0)) {
          throw file.reject(path,
                            fmt::format("must be [from, to] with {} <= to", stiffness ? "0 < from" : "0 <= from"));
        }
        // (0, 0) stands for a range that is left open.
        if (range[1] == 0.0) {
          throw file.reject(path, "must not end at 0", "For no damping write a small upper bound: 1e-9");
        }
        out.lower[unknown] = range[0];
        out.upper[unknown] = range[1];
      });
}

}  // namespace

const std::vector<SegmentNumber>& segment_numbers() {
  static const std::vector<SegmentNumber> numbers = [] {
    std::vector<SegmentNumber> out;
    const auto add = [&out](const char* name, double Segment::*value, const char* meaning) -> Row<Segment>& {
      return out.emplace_back(SegmentNumber{.row = key(name, value, meaning), .value = value}).row;
    };
    add("length_mm", &Segment::length_m, "along the axis").required().above(0.0);
    add("diameter_mm", &Segment::diameter_m, "outer; of a fluted part the cutter's").required().above(0.0);
    add("inner_diameter_mm", &Segment::inner_diameter_m, "of a bore; 0: none").at_least(0.0);
    constexpr const char* usual_modulus = "Steel is near 200 GPa, cemented carbide near 600 GPa";
    add("youngs_modulus_gpa", &Segment::youngs_modulus_pa, "of the material")
        .required(usual_modulus)
        .above(0.0, usual_modulus);
    add("density_kg_per_m3", &Segment::density_kg_per_m3, "of the material; not needed beside mass_kg").at_least(0.0);
    add("mass_kg", &Segment::mass_kg,
        "of the segment, if it was weighed; takes precedence over the density; 0: it was not")
        .at_least(0.0);
    add("poissons_ratio", &Segment::poissons_ratio, "of the material").above(-1.0).at_most(0.5, "Steel is near 0.3");
    add("loss_factor", &Segment::loss_factor, "of the material")
        .at_least(0.0)
        .at_most(1.0, "It is twice the damping ratio, not a percentage");
    add("flute_diameter_ratio", &Segment::flute_diameter_ratio,
        "a fluted part counts as a solid round of that share of its diameter")
        .above(0.0)
        .at_most(1.0);
    return out;
  }();
  return numbers;
}

const Schema<Segment>& segment_options_table() {
  static const Schema<Segment> table("segment", "a round part, with or without a bore", [] {
    std::vector<Row<Segment>> rows;
    for (const SegmentNumber& number : segment_numbers()) rows.push_back(number.row);
    rows.push_back(key("flutes", &Segment::flutes, "0: a plain shank").at_least(0.0));
    rows.push_back(key("beam", &Segment::beam, beam_names, "theory of the beam"));
    return rows;
  }());
  return table;
}

const Schema<FrequencyTable>& frequency_table() {
  static const Schema<FrequencyTable> table("frequency",
                                            "lines to give; with a measured holder its own lines within the range, "
                                            "where there is no step; robomill joint fits "
                                            "within the range",
                                            {key("range_hz", &FrequencyTable::range_hz, "from, to")
                                                 .required("[from, to]")
                                                 .entries(2, "[from, to]")
                                                 .at_least(0.0),
                                             key("step_hz", &FrequencyTable::step_hz, "between lines").above(0.0)});
  return table;
}

const Schema<Joint>& joint_options_table() {
  static const Schema<Joint> table(
      "joint", "between tool and holder; without it rigid. robomill joint needs none of its stiffness and damping", [] {
        std::vector<Row<Joint>> rows;
        for (const io::Field<Joint>& field : joint_fields) rows.push_back(joint_key(field));
        io::add_rows<Joint>(
            rows,
            {key("cross_stiffness_n_per_rad", &Joint::cross_stiffness_n_per_rad, "force for a rotation"),
             key("points", &Joint::points,
                 "of a joint spread over the shank in the holder; 1: at the mouth; robomill joint finds the whole of a "
                 "joint that is spread so")
                 .at_least(1.0)
                 .at_most(100.0),
             key("insertion_length_mm", &Joint::insertion_length_m, "over which several points are").at_least(0.0),
             key("shank", &Joint::shank, segment_options_table(),
                 "the shank in the holder. With more than one point the holder's segments over the insertion need "
                 "its bore (inner_diameter_mm)")
                 .as("shank")});
        return rows;
      }());
  return table;
}

const Schema<HolderTable>& holder_table() {
  static const Schema<HolderTable> table(
      "holder", "what holds the tool; without it a rigid wall",
      {key("segments", &HolderTable::segments, segment_options_table(), "from the joint to the wall; []: a rigid wall")
           .as("holder.segments"),
       key("free", &HolderTable::free,
           "nothing holds the tool: it hangs free, without [joint] and the other keys. For couple alone: such a tool "
           "neither cuts nor has a joint"),
       key("receptances", &HolderTable::receptances, "a measured holder, any FRF file; in place of segments"),
       key("points_mm", &HolderTable::position_m,
           "the file holds translations at two or three points (1x:1x, 2x:1x, …), at these distances from the mouth: "
           "rotations are completed by finite differences")
           .as("position_m")
           .or_one(),
       key("artefact", &HolderTable::artefact, segment_options_table(),
           "a known rod was in the holder when it was measured: its effect is removed. points_mm count from its free "
           "end. "
           "One point is enough where its rotations were measured too (1x:1x, 1ry:1x, 1ry:1my)")
           .as("holder.artefact"),
       of(&HolderTable::options, key("regularisation", &HolderOptions::regularisation,
                                     "for finite differences and the artefact, a share of the largest singular value")
                                     .at_least(0.0)),
       of(&HolderTable::options,
          key("max_amplification", &HolderOptions::max_amplification, "of errors: lines above it are unreliable")
              .above(0.0))});
  return table;
}

const Schema<Accelerometer>& accelerometer_table() {
  static const Schema<Accelerometer> table(
      "accelerometer",
      "glued to the tip when it was measured: a mass that the FRFs have, not the tool that cuts. plan and tools take "
      "it "
      "off, and plan compares with it on. FRFs of hits with acquisition.accelerometer_mass_kg do not hold it: leave "
      "the "
      "table out for them",
      {key("mass_kg", &Accelerometer::mass_kg, "of it, with what of cable and glue moves with it; 0: none")
           .at_least(0.0)
           .at_most(1.0, "Accelerometers have 0.0005 to 0.05 kg"),
       key("offset_mm", &Accelerometer::offset_m, "of its centre of mass, beyond the tip").at_least(0.0)});
  return table;
}

const Schema<JointFitOptions>& search_table() {
  static const Schema<JointFitOptions> table("search", "of robomill joint", [] {
    std::vector<Row<JointFitOptions>> rows;
    for (std::size_t i = 0; i < joint_unknowns; ++i) rows.push_back(range_key(i));
    io::add_rows<JointFitOptions>(
        rows,
        {key("population", &JointFitOptions::population, "of ga, as published").at_least(4.0),
         key("generations", &JointFitOptions::generations, "of ga, as published").at_least(1.0),
         key("crossover", &JointFitOptions::crossover, "of ga, as published: share of children by arithmetic crossover")
             .at_least(0.0)
             .at_most(1.0),
         key("mutation_rate", &JointFitOptions::mutation_rate, "of ga, as published: a gene's chance")
             .at_least(0.0)
             .at_most(1.0),
         key("mutation", &JointFitOptions::mutation, mutation_names, "of ga; --mutation takes precedence")});
    return rows;
  }());
  return table;
}

}  // namespace robomill::coupling
