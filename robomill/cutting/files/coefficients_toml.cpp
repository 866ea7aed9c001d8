#include "robomill/cutting/files/coefficients_toml.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/material.hpp"
#include "robomill/io/toml_file.hpp"

namespace robomill::cutting {
namespace {

struct Field {
  const char* key = nullptr;
  const char* member = nullptr;
  double factor = 0.0;
  std::vector<double> MillingCoefficients::*values = nullptr;
  bool edge = false;
};

constexpr std::array<Field, 6> fields = {{
    {"tangential_n_per_mm2", "tangential_n_per_m2", units::n_per_mm2, &MillingCoefficients::tangential_n_per_m2},
    {"radial_n_per_mm2", "radial_n_per_m2", units::n_per_mm2, &MillingCoefficients::radial_n_per_m2},
    {"axial_n_per_mm2", "axial_n_per_m2", units::n_per_mm2, &MillingCoefficients::axial_n_per_m2},
    {"tangential_edge_n_per_mm", "tangential_edge_n_per_m", units::n_per_mm,
     &MillingCoefficients::tangential_edge_n_per_m, true},
    {"radial_edge_n_per_mm", "radial_edge_n_per_m", units::n_per_mm, &MillingCoefficients::radial_edge_n_per_m, true},
    {"axial_edge_n_per_mm", "axial_edge_n_per_m", units::n_per_mm, &MillingCoefficients::axial_edge_n_per_m, true},
}};

bool read_edge_measure(io::TomlFile& file, MillingCoefficients& out) {
  return file.choice<EdgeMeasure>("coefficients.edge_per",
                                  {{"width", EdgeMeasure::width}, {"edge-length", EdgeMeasure::edge_length}},
                                  out.edge_measure);
}

/// The helix that inclines the edge: coefficients.helix_deg, else the tool's; a tool without one has straight edges.
double read_helix(io::TomlFile& file) {
  double helix_rad = 0.0;
  const char* const key = file.has("coefficients.helix_deg") ? "coefficients.helix_deg" : "tool.helix_deg";
  if (file.has(key) && !file.is_number(key)) {
    throw file.reject(key, "must be one angle where a material is named", "Give coefficients.helix_deg");
  }
  if (!file.number(key, "helix_rad", units::deg, helix_rad) && !file.has("tool")) {
    file.require("coefficients.helix_deg", "The cutter's, which inclines its edges");
  }
  return helix_rad;
}

MillingCoefficients read_material(io::TomlFile& file, const std::string& name) {
  double rake_rad = 0.0, chip_thickness_m = 0.0;
  file.require("coefficients.rake_deg", "Of the cutter's edges");
  file.require("coefficients.chip_thickness_mm", "The mean of the cut; in a slot 0.64 of the feed per tooth");
  file.number("coefficients.rake_deg", "rake_rad", units::deg, rake_rad);
  file.number("coefficients.chip_thickness_mm", "chip_thickness_m", units::mm, chip_thickness_m);
  const double helix_rad = read_helix(file);
  try {
    return milling_coefficients(material(name), rake_rad, helix_rad, chip_thickness_m);
  } catch (const InvalidInput& error) {
    const InvalidInput reported = file.located(error);
    if (!reported.parts().where.empty()) throw reported;
    throw file.reject("coefficients.material", error.parts().rule, error.parts().hint);
  }
}

/// A material's coefficients with those of the edge that the table gives in place of its own.
MillingCoefficients with_own_edge(MillingCoefficients material, const MillingCoefficients& own) {
  for (const Field& field : fields) {
    if (!(own.*field.values).empty()) material.*field.values = own.*field.values;
  }
  if (own.edge_measure != EdgeMeasure::by_kind) material.edge_measure = own.edge_measure;
  return material;
}

}  // namespace

MillingCoefficients read_coefficient_table(io::TomlFile& file) {
  MillingCoefficients out;
  std::filesystem::path other;
  std::string material;
  const char* cutting = nullptr;  // a coefficient that the table itself gives
  const char* edge = nullptr;
  for (const Field& field : fields) {
    if (!file.numbers(std::string("coefficients.") + field.key, field.member, field.factor, out.*field.values))
      continue;
    (field.edge ? edge : cutting) = field.key;
  }
  const bool measured = read_edge_measure(file, out);
  if (file.text("coefficients.material", material)) {
    if (cutting != nullptr) {
      throw file.reject("coefficients.material", fmt::format("must not stand beside {}", cutting),
                        "Edge coefficients may; they replace the material's");
    }
    if (file.has("coefficients.file")) throw file.reject("coefficients.material", "must not stand beside a file");
    return with_own_edge(read_material(file, material), out);
  }
  if (!file.path("coefficients.file", other)) {
    file.require("coefficients.tangential_n_per_mm2",
                 "A number, or a polynomial in the axial position angle (rad); or name a file or a material");
    return out;
  }
  if (cutting != nullptr || edge != nullptr || measured) {
    throw file.reject("coefficients.file", "must not stand beside coefficients of its own");
  }
  return read_coefficients(other);
}

MillingCoefficients read_coefficients(const std::filesystem::path& path) {
  io::TomlFile file(path);
  if (file.has("coefficients.file")) throw file.reject("coefficients.file", "must not name a further file");
  MillingCoefficients out = read_coefficient_table(file);
  for (const char* reported : {"identification", "source"}) file.skip(reported);
  file.done();
  return out;
}

std::string coefficients_toml(const MillingCoefficients& coefficients) {
  std::string text = "[coefficients]\n";
  for (const Field& field : fields) {
    std::vector<double> values = coefficients.*field.values;
    if (values.empty()) continue;
    for (double& value : values) value /= field.factor;
    text += values.size() == 1 ? fmt::format("{} = {:.10g}\n", field.key, values.front())
                               : fmt::format("{} = [{:.10g}]\n", field.key, fmt::join(values, ", "));
  }
  if (coefficients.edge_measure == EdgeMeasure::width) text += "edge_per = \"width\"\n";
  if (coefficients.edge_measure == EdgeMeasure::edge_length) text += "edge_per = \"edge-length\"\n";
  return text;
}

}  // namespace robomill::cutting
