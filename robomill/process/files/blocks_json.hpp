#pragma once
#include "robomill/io/schema.hpp"
#include "robomill/process/blocks.hpp"

namespace robomill::process {

/// The blocks of a program with the forces that they were judged by.
struct BlocksView {
  const ForcesResult* forces = nullptr;
  const ProgramBlocks* blocks = nullptr;
};
/// blocks.json
[[nodiscard]] const io::Schema<BlocksView>& blocks_table();
/// Of it how many blocks there are, how many chatter, and the worst: for plan.json.
[[nodiscard]] const io::Schema<BlocksView>& blocks_summary_table();

}  // namespace robomill::process
