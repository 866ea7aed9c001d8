#pragma once
#include <string>
#include <vector>

#include "robomill/io/toml_source.hpp"
#include "robomill/modal/fit.hpp"

namespace robomill::modal {

/// Reads how modes are to be fitted: the table [fit], whose keys are the members of FitOptions; band_hz = [low, high].
/// @param notes  gains sentences for the user
/// @throws InvalidInput with file, line and key
[[nodiscard]] FitOptions read_fit_options(const io::TomlSource& source, std::vector<std::string>& notes);

}  // namespace robomill::modal
