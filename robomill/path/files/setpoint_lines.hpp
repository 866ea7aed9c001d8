#pragma once
#include <filesystem>
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/path/setpoint_stream.hpp"

// Method: robomill/path/README.md, "Set-points by the clock"

namespace robomill::path {

/// How the set-points of a stream are written: a line each.
enum class SetpointFormat {
  json,  ///< {"time_s":…,"joints":[…],"tip_mm":[…],"axis":[…],"block":…,"override":…,"state":"running"}
  csv    ///< a header, then time_s,q1…qn,x_mm,y_mm,z_mm,i,j,k,block,override,state
};

/// .csv, .jsonl or .json; another one: JSON.
[[nodiscard]] ROBOMILL_API SetpointFormat setpoint_format_of(const std::filesystem::path& path);

/// What stands before the first line.
/// @param joints  1 to 6
[[nodiscard]] ROBOMILL_API std::string setpoint_header(SetpointFormat format, int joints);

/// Appends a line. Numbers have the shortest digits that read back as the same number; blocks count from 1.
ROBOMILL_API void append_setpoint(std::string& to, const Setpoint& setpoint, SetpointFormat format, int joints);

}  // namespace robomill::path
