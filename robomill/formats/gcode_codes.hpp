#pragma once
#include <cstdint>

namespace robomill::formats {

/// Modal groups of G codes: of each, a line may name one.
enum class GcodeGroup : std::uint32_t {
  motion = 1,
  distance = 2,
  unit = 4,
  feed = 8,
  plane = 16,
  radius = 32,
  length = 64,
  system = 128,
  path = 256,
  center = 512,
  other = 1024  ///< no group
};

/// The group of a G code, in tenths, that moves neither the tool nor its frame and is left out; null for others.
[[nodiscard]] const GcodeGroup* still_gcode(int code);

/// Why a G code that is not read may move the tool; empty where there is nothing to say.
[[nodiscard]] const char* gcode_hint(int code);

}  // namespace robomill::formats
