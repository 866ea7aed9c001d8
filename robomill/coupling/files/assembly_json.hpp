#pragma once
#include <vector>

#include "robomill/coupling/assembly.hpp"
#include "robomill/io/json.hpp"

namespace robomill::coupling {

/// In the keys of assembly.toml.
[[nodiscard]] io::Json segments_json(const std::vector<Segment>& segments);
[[nodiscard]] io::Json joint_json(const Joint& joint);

}  // namespace robomill::coupling
