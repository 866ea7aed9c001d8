#pragma once
#include <string>

#include "robomill/stability/lobes.hpp"

namespace robomill::app {

/// --at RPM,MM. @throws InvalidInput
stability::OperatingPoint parse_point(const std::string& text);

}  // namespace robomill::app
