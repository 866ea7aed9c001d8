#pragma once
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/stability/fingerprint.hpp"

namespace robomill::stability {

/// What `robomill explain` writes: spindle speed, every peak with what it is and what else it could be, the mode that
/// chatters; the verdict on the delay, or null where no cut was given.
[[nodiscard]] ROBOMILL_API std::string fingerprint_json(const Fingerprint& fingerprint, const DelayVerdict* verdict);

}  // namespace robomill::stability
