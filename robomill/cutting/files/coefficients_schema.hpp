#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "robomill/cutting/force.hpp"
#include "robomill/io/schema.hpp"

namespace robomill::cutting {

/// [coefficients]: numbers of its own, a file with such a table, or a material.
struct CoefficientKeys {
  MillingCoefficients own = {};
  std::filesystem::path file = {};
  std::string material = {};
  std::optional<int> set = {};  ///< of the material, from 1
  std::optional<double> radial_ratio = {};
  std::optional<double> chip_thickness_m = {};
  std::optional<double> rake_rad = {};   ///< of orthogonal tests
  std::optional<double> helix_rad = {};  ///< the same
  double scale = 1.0;                    ///< of a material or a file
};
[[nodiscard]] const io::Schema<CoefficientKeys>& coefficients_table();

/// A coefficient of the force, in the order of the table.
struct ForceCoefficient {
  const char* key = nullptr;
  const char* meaning = nullptr;
  std::vector<double> MillingCoefficients::*values = nullptr;
  bool edge = false;
};
inline constexpr std::array<ForceCoefficient, 6> force_coefficients = {{
    {"tangential_n_per_mm2", "a number, or a polynomial in the axial position angle (rad), highest power first",
     &MillingCoefficients::tangential_n_per_m2},
    {"radial_n_per_mm2", "the same; of drilling the thrust normal to the lip", &MillingCoefficients::radial_n_per_m2},
    {"axial_n_per_mm2", "the same, > 0 pushes the tool towards the spindle", &MillingCoefficients::axial_n_per_m2},
    {"tangential_edge_n_per_mm", "force of the edges, of forces, simulations and the surface error",
     &MillingCoefficients::tangential_edge_n_per_m, true},
    {"radial_edge_n_per_mm", "the same", &MillingCoefficients::radial_edge_n_per_m, true},
    {"axial_edge_n_per_mm", "the same", &MillingCoefficients::axial_edge_n_per_m, true},
}};

}  // namespace robomill::cutting
