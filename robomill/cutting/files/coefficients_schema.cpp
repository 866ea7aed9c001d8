#include "robomill/cutting/files/coefficients_schema.hpp"

#include <utility>

#include "robomill/cutting/files/cutter_schema.hpp"

namespace robomill::cutting {
namespace {

using io::key;
using io::of;
using io::Row;
using io::Schema;

/// Without it the kind of cutter decides.
constexpr Name<EdgeMeasure> edge_measures[] = {{"width", EdgeMeasure::width},
                                               {"edge-length", EdgeMeasure::edge_length}};

std::vector<Row<CoefficientKeys>> rows() {
  std::vector<Row<CoefficientKeys>> out;
  for (const ForceCoefficient& one : force_coefficients) {
    Row<MillingCoefficients> row = key(one.key, one.values, one.meaning);
    row.key.or_one = true;
    if (!one.edge && one.values != &MillingCoefficients::axial_n_per_m2) row.slider(10.0, 5000.0, 10.0);
    out.push_back(of(&CoefficientKeys::own, std::move(row)));
  }
  io::add_rows(
      out,
      {of(&CoefficientKeys::own, key("edge_per", &MillingCoefficients::edge_measure, edge_measures,
                                     "measure of edge forces; default: width on a flat end, edge length on others")),
       key("file", &CoefficientKeys::file, "a file with such a table, in place of it"),
       key("material", &CoefficientKeys::material, "or a material by its name; edge coefficients replace its own"),
       key("set", &CoefficientKeys::set,
           "of the material's published sets, from 1; without it the one that suits the cutter best")
           .at_least(1.0),
       key("radial_ratio", &CoefficientKeys::radial_ratio,
           "radial over tangential: required where the source of the set states the latter alone; 0.16 to 0.6 where "
           "sources state both")
           .at_least(0.0)
           .at_most(2.0),
       key("chip_thickness_mm", &CoefficientKeys::chip_thickness_m,
           "chip at which a power F = k b h (h / 1 mm)^-m has its tangent taken, or orthogonal tests; without it the "
           "mean chip of the cut, which needs an upright flat end with its feed, depth and direction")
           .above(0.0),
       key("rake_deg", &CoefficientKeys::rake_rad,
           "of the edge: by the material's orthogonal tests in place of a published set"),
       key(helix_key, &CoefficientKeys::helix_rad, "the same; without it the tool's"),
       key("scale", &CoefficientKeys::scale, "factor of all coefficients of a material or a file, edge ones too")
           .above(0.0)
           .at_most(10.0)
           .slider(0.1, 3.0, 0.01)});
  return out;
}

}  // namespace

const Schema<CoefficientKeys>& coefficients_table() {
  static const Schema<CoefficientKeys> table("coefficients", "the cutting force", rows());
  return table;
}

}  // namespace robomill::cutting
