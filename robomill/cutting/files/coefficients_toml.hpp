#pragma once
#include <optional>
#include <string>
#include <vector>

#include "robomill/cutting/force.hpp"
#include "robomill/cutting/material.hpp"
#include "robomill/io/toml_source.hpp"

namespace robomill::io {
class TomlFile;
}

namespace robomill::cutting {

/// The cut that coefficients are read for; 0: not known.
struct CutAtHand {
  CutterKind kind = CutterKind::flat_end;
  double mean_chip_thickness_m = 0.0;
  double feed_per_tooth_m = 0.0;
  FromTo cutting_speed_m_per_s = {0.0, 0.0};
  double diameter_m = 0.0;
};

/// What [coefficients] says, and where it names a material what that brings along.
struct CoefficientTable {
  MillingCoefficients coefficients = {};
  std::optional<PublishedCoefficients> published = {};  ///< the set that was taken
  /// How far all of them together may be off, as a share: that of the set's tests, else that between the material's
  /// sets; 0: unknown.
  double std_ratio = 0.0;
  const char* std_of = "";                         ///< "the tests of its source", "the sets of its material"
  std::string material = {};                       ///< whose conditions these are
  std::vector<CuttingConditions> conditions = {};  ///< what is recommended of it
  std::vector<std::string> notes = {};  ///< sentences for the user: which set of which source, and its spread
  /// A sentence for each of speed, feed and chip that is known and leaves the range of the set's tests.
  [[nodiscard]] std::vector<std::string> outside(const CutAtHand& cut) const;
  /// A sentence where no speed of the milling cut lies within a recommended range, and where its feed per tooth is
  /// below half or above twice of what is recommended for the cutter's diameter.
  [[nodiscard]] std::vector<std::string> unlike_recommended(const CutAtHand& cut) const;
};

/// `coefficients` of a TOML file, which is the name of a material or a table (coefficients_schema.hpp). A material's
/// orthogonal tests take the tool's helix where the table gives none.
/// @throws InvalidInput with file, line, key and value
[[nodiscard]] CoefficientTable read_coefficient_table(io::TomlFile& file, const CutAtHand& cut = {});

/// Whether `coefficients` is a name, and not a table.
[[nodiscard]] bool names_a_material(const io::TomlFile& file);

/// coefficients.toml. @param notes  gains sentences for the user
/// @throws InvalidInput with file, line, key and value
[[nodiscard]] MillingCoefficients read_coefficients(const io::TomlSource& source, std::vector<std::string>& notes);

/// The table as text, for coefficients.toml.
[[nodiscard]] std::string coefficients_toml(const MillingCoefficients& coefficients);

}  // namespace robomill::cutting
