#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/assumption.hpp"

// Method: robomill/io/README.md, "Sample values"

namespace robomill::io {

class TomlFile;

/// What an assumption says that is a sample value.
inline constexpr const char* sample_left = "Sample value left as it was";

/// The comment that marks a value as one of an example: "sample 3" of 3, "sample 620 0.03 0.6" of
/// [{ frequency_hz = 620, damping_ratio = 0.03, modal_mass_kg = 0.6 }]. The numbers and texts of the value in their
/// order.
/// @param value  as TOML writes it, in one line
[[nodiscard]] std::string sample_mark(std::string_view value);

/// The values that were read and are still what their marks say: nobody has given them. Keys that the source sets are
/// given.
[[nodiscard]] std::vector<Assumption> sample_values(const TomlFile& document);

/// A document whose key bears no mark any more: somebody has given its value.
[[nodiscard]] std::string without_sample_mark(std::string document, std::string_view key);

}  // namespace robomill::io
