#pragma once
#include "robomill/process/blocks.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/robot/arm.hpp"
#include "robomill/robot/joint_load.hpp"

namespace robomill::process {

/// What the joints bear in every block: weight and the force of the cut over a revolution, at the block's end and its
/// programmed feed. Of links whose masses are not known nothing is known but what the cut alone puts on a joint.
/// @param out  with its rows; `joint_loads`, and of rows that cut the two numbers of joints, are filled
void add_joint_torques(const ForcesResult& forces, ProgramBlocks& out);

/// The greatest share of its torque that a drive gives in a block; 0 where no joint has a limit or a known load.
[[nodiscard]] double greatest_torque_share(const robot::Arm& arm, const robot::LoadedBlock& block);

}  // namespace robomill::process
