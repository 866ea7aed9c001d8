#pragma once
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/io/toml_source.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/modal/modes.hpp"

// Method: robomill/modal/README.md, "Files"

namespace robomill::modal {

/// Reads modes.json, or the same as TOML: [[modes]] with frequency_hz, damping_ratio, left = { x = [re, im], … },
/// right.
///
/// A mode needs no more than these four; .json may have residuals and standard deviations, and all else in it is left
/// alone. A direction that one mode names and another does not is 0 in the other.
/// @param notes  gains sentences for the user
/// @throws InvalidInput if .json says of its fit that it is not usable, and
///     with the file and "modes[2].damping_ratio" (counted from 1) or the line if a value is missing,
///     no finite number or outside its range, or the ending is neither .json nor .toml
[[nodiscard]] ROBOMILL_API ModalModel read_modes(const io::TomlSource& source, std::vector<std::string>& notes);

/// modes.json as text: modes, standard deviations, residuals. @throws InvalidInput if the model is not valid
[[nodiscard]] ROBOMILL_API std::string modes_json(const ModalModel& model);
/// With how well they fit, the convergence, the band and the warnings.
[[nodiscard]] ROBOMILL_API std::string modes_json(const FitResult& fit);
/// A row a mode: what modes.json has of it, entries of left and right a column each; cells that are not known are
/// empty.
/// @throws InvalidInput if the model is not valid
[[nodiscard]] ROBOMILL_API std::string modes_csv(const ModalModel& model);

}  // namespace robomill::modal
