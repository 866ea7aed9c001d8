#pragma once
#include "robomill/io/json.hpp"
#include "robomill/modal/mode_id.hpp"

namespace robomill::modal {

/// Sets "mode", its number, and "mode_of", "tool" or "workpiece"; both null where it is unknown.
inline void set_mode(io::Json& object, const ModeId& mode) {
  object["mode"] = mode.known() ? io::Json(mode.number) : io::Json(nullptr);
  object["mode_of"] = mode.known() ? io::Json(to_string(mode.of)) : io::Json(nullptr);
}

}  // namespace robomill::modal
