#pragma once
#include <kdl/chain.hpp>

#include "robomill/robot/arm.hpp"

namespace robomill::robot {

/// The arm for Orocos KDL, of two segments a joint: what lies before it, and the joint with the link that it moves. It
/// begins in B and ends in the frame after the last joint; the rotors are not in it.
[[nodiscard]] KDL::Chain kdl_chain(const Arm& arm);

}  // namespace robomill::robot
