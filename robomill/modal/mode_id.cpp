#include "robomill/modal/mode_id.hpp"

namespace robomill::modal {

std::string_view to_string(ModeOwner owner) {
  return owner == ModeOwner::tool ? "tool" : "workpiece";
}

std::string to_string(const ModeId& mode) {
  if (!mode.known()) return "unknown mode";
  const std::string name = "mode " + std::to_string(mode.number);
  return mode.of == ModeOwner::tool ? name : name + " of the workpiece";
}

}  // namespace robomill::modal
