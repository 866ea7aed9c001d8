#pragma once
#include <string>

#include "robomill/stability/lobes.hpp"

namespace robomill::app {

/// --at RPM,MM. @throws InvalidInput
stability::OperatingPoint parse_point(const std::string& text);

/// An option's spindle speed in rad/s. @throws InvalidInput in rpm
double spindle_speed(const char* option, double rpm);

}  // namespace robomill::app
