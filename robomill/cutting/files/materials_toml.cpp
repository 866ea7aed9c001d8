#include "robomill/cutting/files/materials_toml.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cutting/files/embedded_materials.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/toml/file.hpp"

namespace robomill::cutting {
namespace {

constexpr double m_per_min = 1.0 / units::minute;

constexpr io::Field<OrthogonalTests> orthogonal_fields[] = {
    {"shear_stress_n_per_mm2", "shear_stress_n_per_m2", units::n_per_mm2, &OrthogonalTests::shear_stress_n_per_m2},
    {"friction_angle_deg", "friction_angle_rad", units::deg, &OrthogonalTests::friction_angle_rad},
    {"friction_angle_per_rake", "friction_angle_per_rake", 1.0, &OrthogonalTests::friction_angle_per_rake},
    {"chip_ratio", "chip_ratio", 1.0, &OrthogonalTests::chip_ratio},
    {"chip_ratio_per_deg", "chip_ratio_per_rad", 1.0 / units::deg, &OrthogonalTests::chip_ratio_per_rad},
    {"chip_ratio_power", "chip_ratio_power", 1.0, &OrthogonalTests::chip_ratio_power},
    {"chip_ratio_power_per_deg", "chip_ratio_power_per_rad", 1.0 / units::deg,
     &OrthogonalTests::chip_ratio_power_per_rad},
    {"tangential_edge_n_per_mm", "tangential_edge_n_per_m", units::n_per_mm, &OrthogonalTests::tangential_edge_n_per_m},
    {"radial_edge_n_per_mm", "radial_edge_n_per_m", units::n_per_mm, &OrthogonalTests::radial_edge_n_per_m},
};

void read_text(io::TomlFile& file, const std::string& key, std::string& out) {
  file.require(key);
  file.text(key, out);
  if (out.empty()) throw file.reject(key, "must not be empty");
}

std::optional<FromTo> read_range(io::TomlFile& file, const std::string& key, double factor) {
  std::vector<double> values;
  if (!file.numbers(key, {}, factor, values)) return std::nullopt;
  if (values.size() != 2 || !(0.0 <= values[0] && values[0] <= values[1])) {
    throw file.reject(key, "must be [from, to], from 0 on");
  }
  return FromTo{values[0], values[1]};
}

void read_line(io::TomlFile& file, const std::string& row, MillingCoefficients& line) {
  const auto read = [&](const char* key, double factor, std::vector<double>& values) {
    double value = 0.0;
    if (file.number(row + key, {}, factor, value)) values = {value};
  };
  read("tangential_n_per_mm2", units::n_per_mm2, line.tangential_n_per_m2);
  read("radial_n_per_mm2", units::n_per_mm2, line.radial_n_per_m2);
  read("axial_n_per_mm2", units::n_per_mm2, line.axial_n_per_m2);
  read("tangential_edge_n_per_mm", units::n_per_mm, line.tangential_edge_n_per_m);
  read("radial_edge_n_per_mm", units::n_per_mm, line.radial_edge_n_per_m);
  read("axial_edge_n_per_mm", units::n_per_mm, line.axial_edge_n_per_m);
}

PublishedCoefficients read_set(io::TomlFile& file, const std::string& row) {
  PublishedCoefficients set;
  read_text(file, row + "cutter", set.cutter);
  read_text(file, row + "source", set.source);
  CutterKind kind = CutterKind::flat_end;
  if (file.choice<CutterKind>(row + "kind",
                              {{"flat-end", CutterKind::flat_end},
                               {"ball-end", CutterKind::ball_end},
                               {"bull-nose", CutterKind::bull_nose},
                               {"general", CutterKind::general}},
                              kind)) {
    set.kind = kind;
  }
  read_line(file, row, set.line);
  const bool power = file.number(row + "specific_force_n_per_mm2", {}, units::n_per_mm2, set.specific_force_n_per_m2);
  file.number(row + "thickness_power", {}, 1.0, set.thickness_power);
  if (power == !set.line.tangential_n_per_m2.empty()) {
    throw file.reject(row + "cutter", "must have either tangential_n_per_mm2 or specific_force_n_per_mm2");
  }
  if (power && !(set.specific_force_n_per_m2 > 0.0 && set.thickness_power >= 0.0 && set.thickness_power < 1.0)) {
    throw file.reject(row + "specific_force_n_per_mm2", "must be > 0, and thickness_power from 0 to below 1");
  }
  file.number(row + "tangential_std_n_per_mm2", {}, units::n_per_mm2, set.tangential_std_n_per_m2);
  set.tangential_range_n_per_m2 = read_range(file, row + "tangential_range_n_per_mm2", units::n_per_mm2);
  set.tested_speed_m_per_s = read_range(file, row + "cutting_speed_m_per_min", m_per_min);
  set.tested_feed_per_tooth_m = read_range(file, row + "feed_per_tooth_mm", units::mm);
  set.tested_chip_m = read_range(file, row + "chip_thickness_mm", units::mm);
  return set;
}

CuttingConditions read_conditions(io::TomlFile& file, const std::string& row) {
  CuttingConditions out;
  read_text(file, row + "cutter", out.cutter);
  read_text(file, row + "source", out.source);
  out.cutting_speed_m_per_s = read_range(file, row + "cutting_speed_m_per_min", m_per_min);
  file.numbers(row + "diameter_mm", {}, units::mm, out.diameter_m);
  file.numbers(row + "feed_per_tooth_mm", {}, units::mm, out.feed_per_tooth_m);
  if (out.diameter_m.size() != out.feed_per_tooth_m.size()) {
    throw file.reject(row + "feed_per_tooth_mm", "must have a feed for each diameter_mm");
  }
  return out;
}

Material read_material(io::TomlFile& file, const std::string& name) {
  const std::string table = "materials." + name + ".";
  Material out;
  out.name = name;
  read_text(file, table + "description", out.description);
  file.texts(table + "other_names", out.other_names);
  for (std::size_t i = 0; i < file.tables(table + "coefficients"); ++i) {
    out.coefficients.push_back(read_set(file, fmt::format("{}coefficients[{}].", table, i)));
  }
  for (std::size_t i = 0; i < file.tables(table + "conditions"); ++i) {
    out.conditions.push_back(read_conditions(file, fmt::format("{}conditions[{}].", table, i)));
  }
  if (file.has(table + "orthogonal")) {
    OrthogonalTests tests;
    read_text(file, table + "orthogonal.source", tests.source);
    file.fields(table + "orthogonal.", orthogonal_fields, tests);
    out.orthogonal = std::move(tests);
  }
  return out;
}

/// Without what people write differently: "Ti 6Al-4V" and "ti6al4v" are one.
std::string bare(std::string_view name) {
  std::string out;
  for (const char letter : name) {
    if (letter == '-' || letter == '_' || letter == ' ') continue;
    out += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  return out;
}

}  // namespace

std::vector<Material> read_materials(const io::TomlSource& source, std::vector<std::string>& notes) {
  io::TomlFile file(source);
  std::vector<Material> out;
  for (const std::string& name : file.keys("materials")) out.push_back(read_material(file, name));
  std::ranges::move(file.done(), std::back_inserter(notes));
  return out;
}

const std::vector<Material>& materials() {
  static const std::vector<Material> known = [] {
    std::vector<std::string> notes;  // none: a test compares what the library carries with it
    return read_materials(io::TomlSource("materials.toml", std::string(embedded_materials())), notes);
  }();
  return known;
}

const Material& material(std::string_view name) {
  std::vector<std::string> names, all;
  for (const Material& known : materials()) {
    const auto same = [&](const std::string& other) { return bare(other) == bare(name); };
    if (same(known.name) || std::ranges::any_of(known.other_names, same)) return known;
    names.push_back(known.name);
    all.push_back(known.name);
    all.insert(all.end(), known.other_names.begin(), known.other_names.end());
  }
  std::string near = io::nearest_word(name, all);
  if (near.empty()) {
    const auto longer = [&](const std::string& other) {
      return !bare(name).empty() && bare(other).starts_with(bare(name));
    };
    const auto found = std::ranges::find_if(all, longer);
    if (found != all.end()) near = *found;
  }
  throw InvalidInput(
      "material", fmt::format("must be one of {}", fmt::join(names, ", ")),
      near.empty() ? "Give the coefficients of another as numbers" : fmt::format("Did you mean {}?", near));
}

}  // namespace robomill::cutting
