#pragma once
#include <filesystem>
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/cutting/force.hpp"

// Method: robomill/cutting/README.md, "Files"

namespace robomill::io {
class TomlFile;
}

namespace robomill::cutting {

/// The table [coefficients] of a TOML file: each a number or a polynomial in κ [rad], highest power first; or
/// coefficients.file, a file with such a table; or coefficients.material with rake_deg, chip_thickness_mm and the
/// helix, which is coefficients.helix_deg or the tool's. edge_per says what edge forces are per: "width" or
/// "edge-length".
/// @throws InvalidInput with file, line, key and value
[[nodiscard]] ROBOMILL_API MillingCoefficients read_coefficient_table(io::TomlFile& file);

/// coefficients.toml. @throws InvalidInput with file, line, key and value
[[nodiscard]] ROBOMILL_API MillingCoefficients read_coefficients(const std::filesystem::path& path);

/// The table as text, for coefficients.toml.
[[nodiscard]] ROBOMILL_API std::string coefficients_toml(const MillingCoefficients& coefficients);

}  // namespace robomill::cutting
