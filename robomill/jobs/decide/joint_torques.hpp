#pragma once
#include <vector>

#include "robomill/jobs/blocks.hpp"
#include "robomill/jobs/forces.hpp"
#include "robomill/robot/joint_load.hpp"

namespace robomill::jobs {

/// What the joints bear in every block: weight and the force of the cut over a revolution, at the block's end and its
/// programmed feed. Of links whose masses are not known nothing is known.
[[nodiscard]] std::vector<robot::LoadedBlock> joint_torques(const ForcesResult& forces, const ProgramBlocks& blocks);

/// The greatest share of its torque that a drive gives in a block; 0 where no joint has a limit or a known load.
[[nodiscard]] double greatest_torque_share(const robot::Arm& arm, const robot::LoadedBlock& block);

}  // namespace robomill::jobs
