#pragma once
#include "robomill/io/json.hpp"
#include "robomill/process/blocks.hpp"

namespace robomill::process {

/// Of blocks.json how many blocks there are, how many chatter, and the worst.
[[nodiscard]] io::Json blocks_summary(const ForcesResult& forces, const ProgramBlocks& blocks);
/// blocks.json.
[[nodiscard]] io::Json blocks_object(const ForcesResult& forces, const ProgramBlocks& blocks);

}  // namespace robomill::process
