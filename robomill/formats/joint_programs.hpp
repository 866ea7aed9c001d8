#pragma once
#include <filesystem>
#include <memory>

#include "robomill/formats/trajectory.hpp"

namespace robomill::formats {

/// What a robot's controller reads: KUKA KRL (.src), ABB RAPID (.mod), Universal Robots URScript (.script), or the
/// joints alone, a row a cycle (.servoj).
enum class JointLanguage { krl, rapid, urscript, servoj };

/// A trajectory as a program of joint points, one every TrajectoryInfo::program_period_s; degrees for KUKA and ABB, rad
/// for Universal Robots. Its header tells how far a straight line in the joints between two points leaves the
/// trajectory; what the controller makes of the points is its own.
/// @throws InvalidInput unless the machine has six joints that all turn, the period is a multiple of the sample's and
///     at most 10 s, and the program's name, the file's with letters, digits and underscores alone, is short enough: 24
///     characters in KRL, 32 in RAPID
[[nodiscard]] std::unique_ptr<SampleFile> open_joint_program(const std::filesystem::path& path,
                                                             const TrajectoryInfo& info, JointLanguage language);

}  // namespace robomill::formats
