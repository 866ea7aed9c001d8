#pragma once
#include <cstdint>
#include <span>
#include <string_view>

namespace robomill::program {

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
  cycle = 1024,
  retract = 2048,
  other = 4096  ///< no group
};

/// The group of a G code, in tenths, that moves neither the tool nor its frame and is left out; null for others.
[[nodiscard]] const GcodeGroup* still_gcode(int code);

/// Why a G code that is not read may move the tool; empty where there is nothing to say.
[[nodiscard]] const char* gcode_hint(int code);

/// What is made of an M code.
enum class McodeAct {
  nothing,   ///< moves neither the tool nor its frame: left out
  rejected,  ///< would change what the program's positions or moves mean, or their order
  end,
  stop,           ///< the machine waits for its operator
  optional_stop,  ///< … where its switch says so
  spindle_clockwise,
  spindle_counterclockwise,
  spindle_off,
  mist,
  flood,
  coolant_off,
  through_tool,
  through_tool_off,
  tool_change,
  tcp_on,  ///< positions are those of the tip
  tcp_off  ///< … of the machine's axes
};

/// An M code and what it does on each control; empty where a control does not know it or leaves it to the builder.
struct Mcode {
  int code;
  McodeAct act;
  std::string_view linuxcnc, fanuc_haas, heidenhain;
};

/// The row of an M code; null for those that are not known here.
[[nodiscard]] const Mcode* find_mcode(int code);

}  // namespace robomill::program
