#pragma once
#include <compare>
#include <string>
#include <string_view>

#include "robomill/base/export.hpp"

// Method: robomill/modal/README.md, "Outputs"

namespace robomill::modal {

/// The structure that a mode belongs to.
enum class ModeOwner {
  tool,      ///< what carries the cutting edges: cutter, holder, spindle, machine or robot
  workpiece  ///< the part and its fixture
};

/// Which mode of which structure.
struct ModeId {
  int number = 0;  ///< in that structure's model, from 1; modes that keep_modes leaves out are counted; 0: unknown
  ModeOwner of = ModeOwner::tool;
  [[nodiscard]] bool known() const { return number > 0; }
  friend auto operator<=>(const ModeId&, const ModeId&) = default;
};

/// "tool", "workpiece": as the files write them.
[[nodiscard]] ROBOMILL_API std::string_view to_string(ModeOwner owner);
/// "mode 3", "mode 3 of the workpiece", "unknown mode".
[[nodiscard]] ROBOMILL_API std::string to_string(const ModeId& mode);

}  // namespace robomill::modal
