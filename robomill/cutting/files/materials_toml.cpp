#include "robomill/cutting/files/materials_toml.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <string>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/cutting/files/embedded_materials.hpp"
#include "robomill/cutting/files/materials_schema.hpp"
#include "robomill/io/text.hpp"
#include "robomill/io/toml/file.hpp"

namespace robomill::cutting {
namespace {

/// Rules over several keys.
void check_material(const io::TomlFile& file, const std::string& table, const Material& material) {
  for (std::size_t i = 0; i < material.coefficients.size(); ++i) {
    const PublishedCoefficients& set = material.coefficients[i];
    const std::string row = fmt::format("{}coefficients[{}].", table, i);
    const bool power = file.has(row + "specific_force_n_per_mm2");
    if (power == !set.line.tangential_n_per_m2.empty()) {
      throw file.reject(row + "cutter", "must have either tangential_n_per_mm2 or specific_force_n_per_mm2");
    }
    if (power && !(set.thickness_power < 1.0)) {
      throw file.reject(row + "thickness_power", "must be below 1 beside specific_force_n_per_mm2");
    }
  }
  for (std::size_t i = 0; i < material.conditions.size(); ++i) {
    if (material.conditions[i].diameter_m.size() == material.conditions[i].feed_per_tooth_m.size()) continue;
    throw file.reject(fmt::format("{}conditions[{}].feed_per_tooth_mm", table, i),
                      "must have a feed for each diameter_mm");
  }
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
  for (const std::string& name : file.keys("materials")) {
    Material& material = out.emplace_back();
    material.name = name;
    material_table().read(file, "materials." + name, material);
    check_material(file, "materials." + name + ".", material);
  }
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
