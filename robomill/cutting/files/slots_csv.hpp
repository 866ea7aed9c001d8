#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/assumption.hpp"
#include "robomill/base/export.hpp"
#include "robomill/cutting/coefficients.hpp"

// Method: robomill/cutting/README.md, "Files"

namespace robomill::cutting {

/// slots.csv: mean forces of slots, on the tool.
struct SlotsFile {
  std::vector<SlotForce> slots;
  std::vector<std::size_t> lines;       ///< of each in the file, of one without lines rows; from 1
  std::vector<std::string> notes = {};  ///< sentences for the user
};

/// Columns feed_per_tooth_mm, axial_depth_mm, fx_n, fy_n, fz_n, and spindle_speed_rpm where it is known, of a text or
/// of any other file that io::read_record reads.
/// @throws InvalidInput with file, line, column and value
[[nodiscard]] ROBOMILL_API SlotsFile read_slots(const std::filesystem::path& path);

/// coefficients.toml: the coefficients, and a table [identification] that says how well they are known. What is
/// infinite or not known is left out.
/// @param assumed  what the caller took because nobody said it
[[nodiscard]] ROBOMILL_API std::string slot_fit_toml(const SlotFit& fit, const SlotsFile& file,
                                                     const std::vector<Assumption>& assumed = {});
/// The same as JSON, with null for it.
[[nodiscard]] ROBOMILL_API std::string slot_fit_json(const SlotFit& fit, const SlotsFile& file,
                                                     const std::vector<Assumption>& assumed = {});
/// A row a coefficient; those of each speed below, where there are several.
[[nodiscard]] ROBOMILL_API std::string slot_fit_csv(const SlotFit& fit);

}  // namespace robomill::cutting
