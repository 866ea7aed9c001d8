#pragma once
#include <string>

namespace robomill::io {

/// Whether two texts may state one unit; true where one of them is not known.
[[nodiscard]] bool units_agree(const std::string& a, const std::string& b);

}  // namespace robomill::io
