#pragma once
#include "robomill/coupling/assembly.hpp"
#include "robomill/io/schema.hpp"

namespace robomill::coupling {

/// In the keys of assembly.toml.
[[nodiscard]] const io::Schema<Segment>& segment_table();
[[nodiscard]] const io::Schema<Joint>& assembly_joint_table();

}  // namespace robomill::coupling
