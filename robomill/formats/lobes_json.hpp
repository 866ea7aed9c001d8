#pragma once
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::formats {

/// lobes.json as text; the map's spectral radii are written if with_map.
[[nodiscard]] ROBOMILL_API std::string lobes_json(const stability::LobesResult& result, bool with_map);

}  // namespace robomill::formats
