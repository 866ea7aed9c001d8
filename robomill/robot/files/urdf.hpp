#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "robomill/robot/arm.hpp"

namespace robomill::robot {

/// Which chain of a URDF's tree is the arm.
struct UrdfReading {
  std::string tip = {};   ///< link that is the flange; required
  std::string base = {};  ///< link that is the robot's base frame B; empty: the root
};

struct UrdfArm {
  Arm arm = {};
  std::string name = {};                ///< of the robot
  std::vector<std::string> notes = {};  ///< sentences for the user
};

/// Reads the chain of joints from base to tip: origins, axes, limits (position and velocity), damping, and the inertia
/// of the links. Revolute, continuous and prismatic joints become joints; fixed ones are folded in, with the links that
/// hang on them rigidly beside the chain or behind the tip. What moves beside the chain is left out, with a note.
/// Limits of acceleration and jerk, stiffness and rotors are not in a URDF.
/// @param where  names the file in messages
/// @throws InvalidInput naming the link or joint if the text is no URDF, a link is missing or not on the way to the
/// tip,
///     a joint mimics another, is floating or planar, has no limits, or is invalid for robot::Arm
[[nodiscard]] UrdfArm parse_urdf(std::string_view content, const std::string& where, const UrdfReading& reading);
[[nodiscard]] UrdfArm read_urdf(const std::filesystem::path& path, const UrdfReading& reading);

}  // namespace robomill::robot
