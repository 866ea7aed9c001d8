#include "robomill/cutting/files/materials_schema.hpp"

#include <string>
#include <vector>

#include "robomill/base/error.hpp"

namespace robomill::cutting {
namespace {

using io::declared;
using io::Holds;
using io::key;
using io::of;
using io::Row;
using io::Schema;

constexpr Name<CutterKind> stated_kinds[] = {{"flat-end", CutterKind::flat_end},
                                             {"ball-end", CutterKind::ball_end},
                                             {"bull-nose", CutterKind::bull_nose},
                                             {"general", CutterKind::general}};

/// A text that is there.
template <class T>
Row<T> text_key(const std::string& name, std::string T::*member, const std::string& meaning) {
  return key(name, member, meaning).required().read_by([member](io::TomlFile& file, const std::string& path, T& out) {
    file.text(path, out.*member);
    if ((out.*member).empty()) throw file.reject(path, "must not be empty");
  });
}

template <class T>
Row<T> range_key(const std::string& name, std::optional<FromTo> T::*member, const std::string& meaning) {
  Row<T> row = key(name, member, meaning);
  const double factor = row.factor;
  return row.entries(2).at_least(0.0).read_by([=](io::TomlFile& file, const std::string& path, T& out) {
    std::vector<double> values;
    if (!file.numbers(path, {}, factor, values)) return;
    if (values.size() != 2 || !(0.0 <= values[0] && values[0] <= values[1])) {
      throw file.reject(path, "must be [from, to], from 0 on");
    }
    out.*member = FromTo{values[0], values[1]};
  });
}

Row<PublishedCoefficients> kind_key() {
  Row<PublishedCoefficients> row =
      declared<PublishedCoefficients>("kind", Holds::word, "of the cutter, where the source states it");
  for (const auto& [word, kind] : stated_kinds) row.key.words.emplace_back(word);
  return row.read_by([](io::TomlFile& file, const std::string& path, PublishedCoefficients& out) {
    if (CutterKind kind = {}; file.choice(path, stated_kinds, kind)) out.kind = kind;
  });
}

Row<PublishedCoefficients> line_key(const std::string& name, std::vector<double> MillingCoefficients::*values) {
  return of(&PublishedCoefficients::line, key(name, values, "of a straight line over the chip").entries(1).or_one());
}

const Schema<PublishedCoefficients>& set_table() {
  using Set = PublishedCoefficients;
  static const Schema<Set> table(
      "coefficient_set", "force coefficients as a source states them",
      {text_key("cutter", &Set::cutter, "in words"), text_key("source", &Set::source, "a key of docs/bibliography.md"),
       kind_key(), line_key("tangential_n_per_mm2", &MillingCoefficients::tangential_n_per_m2),
       line_key("radial_n_per_mm2", &MillingCoefficients::radial_n_per_m2),
       line_key("axial_n_per_mm2", &MillingCoefficients::axial_n_per_m2),
       line_key("tangential_edge_n_per_mm", &MillingCoefficients::tangential_edge_n_per_m),
       line_key("radial_edge_n_per_mm", &MillingCoefficients::radial_edge_n_per_m),
       line_key("axial_edge_n_per_mm", &MillingCoefficients::axial_edge_n_per_m),
       key("specific_force_n_per_mm2", &Set::specific_force_n_per_m2, "of a power of the chip, at 1 mm").above(0.0),
       key("thickness_power", &Set::thickness_power, "of that power").at_least(0.0),
       key("tangential_std_n_per_mm2", &Set::tangential_std_n_per_m2, "over the tests; 0: not stated").at_least(0.0),
       range_key("tangential_range_n_per_mm2", &Set::tangential_range_n_per_m2, "over the tests, from, to"),
       range_key("cutting_speed_m_per_min", &Set::tested_speed_m_per_s, "of the tests, from, to"),
       range_key("feed_per_tooth_mm", &Set::tested_feed_per_tooth_m, "of the tests, from, to"),
       range_key("chip_thickness_mm", &Set::tested_chip_m, "of the tests, from, to")});
  return table;
}

const Schema<CuttingConditions>& conditions_table() {
  static const Schema<CuttingConditions> table(
      "cutting_conditions", "what a handbook or a maker recommends",
      {text_key("cutter", &CuttingConditions::cutter, "in words"),
       text_key("source", &CuttingConditions::source, "a key of docs/bibliography.md"),
       range_key("cutting_speed_m_per_min", &CuttingConditions::cutting_speed_m_per_s, "from, to"),
       key("diameter_mm", &CuttingConditions::diameter_m, "of cutters").or_one(),
       key("feed_per_tooth_mm", &CuttingConditions::feed_per_tooth_m, "a feed for each diameter").or_one()});
  return table;
}

const Schema<OrthogonalTests>& orthogonal_table() {
  using Tests = OrthogonalTests;
  static const Schema<Tests> table(
      "orthogonal_tests", "what orthogonal tests have measured",
      {text_key("source", &Tests::source, "a key of docs/bibliography.md"),
       key("shear_stress_n_per_mm2", &Tests::shear_stress_n_per_m2, "on the shear plane"),
       key("friction_angle_deg", &Tests::friction_angle_rad, "at rake 0"),
       key("friction_angle_per_rake", &Tests::friction_angle_per_rake, "its slope"),
       key("chip_ratio", &Tests::chip_ratio, "c0 of r = (c0 + c0' α) (h / 1 mm)^(c1 + c1' α)"),
       key("chip_ratio_per_deg", &Tests::chip_ratio_per_rad, "c0'"),
       key("chip_ratio_power", &Tests::chip_ratio_power, "c1"),
       key("chip_ratio_power_per_deg", &Tests::chip_ratio_power_per_rad, "c1'"),
       key("tangential_edge_n_per_mm", &Tests::tangential_edge_n_per_m, "along the edge"),
       key("radial_edge_n_per_mm", &Tests::radial_edge_n_per_m, "along the edge")});
  return table;
}

}  // namespace

const Schema<Material>& material_table() {
  static const Schema<Material> table(
      "material", "a material and what sources state of it",
      {text_key("description", &Material::description, "in words"),
       key("other_names", &Material::other_names, "by which it is found too").or_one(),
       key("coefficients", &Material::coefficients, set_table(), "of forces"),
       key("conditions", &Material::conditions, conditions_table(), "speeds and feeds"),
       key("orthogonal", &Material::orthogonal, orthogonal_table(), "for the oblique transformation")});
  return table;
}

}  // namespace robomill::cutting
