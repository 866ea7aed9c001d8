#pragma once
#include <string>

#include "robomill/base/export.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::formats {

/// lobes.json as text; with the map where it has one.
[[nodiscard]] ROBOMILL_API std::string lobes_json(const stability::LobesResult& result);

}  // namespace robomill::formats
