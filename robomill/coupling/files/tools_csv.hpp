#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/coupling/assembly.hpp"

// Method: robomill/coupling/README.md, "Files"

namespace robomill::coupling {

/// A tool of a shop's list.
struct ListedTool {
  std::string name;
  std::vector<Segment> segments;  ///< from the tip to the joint
  int teeth = 0;                  ///< of the column teeth, else the flutes of the first segment; 0: not said
};

/// Reads tools.csv: a row a segment; rows of one name that follow each other are one tool from the tip to the joint.
/// Columns tool, length_mm, diameter_mm, and optionally inner_diameter_mm, flutes, flute_diameter_ratio, mass_kg,
/// youngs_modulus_gpa, density_kg_per_m3, poissons_ratio, loss_factor, beam, teeth.
/// @param like  what says the material, beam and flute ratio where their column is missing or empty; bore, flutes and
///     mass belong to one segment alone and are then 0
/// @param notes  gains sentences for the user
/// @throws InvalidInput with file, line, column and value
[[nodiscard]] ROBOMILL_API std::vector<ListedTool> read_tools(const std::filesystem::path& path, const Segment& like,
                                                              std::vector<std::string>& notes);

}  // namespace robomill::coupling
