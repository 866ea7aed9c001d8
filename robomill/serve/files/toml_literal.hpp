#pragma once
#include <string>

#include "robomill/io/json.hpp"

namespace robomill::serve {

/// A number, a text, true or false, or a list of them as TOML writes it: "3", "\"up\"", "[1, 2]".
/// @throws InvalidInput naming the member if it is another value
[[nodiscard]] std::string toml_literal(const io::JsonNode& value);

}  // namespace robomill::serve
