#pragma once
#include "robomill/io/json.hpp"
#include "robomill/modal/mode_id.hpp"

namespace robomill::formats {

/// Sets "mode", its number, and "mode_of", "tool" or "workpiece"; both null where it is unknown.
inline void set_mode(Json& object, const modal::ModeId& mode) {
  object["mode"] = mode.known() ? Json(mode.number) : Json(nullptr);
  object["mode_of"] = mode.known() ? Json(modal::to_string(mode.of)) : Json(nullptr);
}

}  // namespace robomill::formats
