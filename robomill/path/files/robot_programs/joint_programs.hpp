#pragma once
#include <filesystem>
#include <memory>

#include "robomill/path/files/trajectory.hpp"

namespace robomill::path {

/// What a robot's controller reads: KUKA KRL (.src), ABB RAPID (.mod), Universal Robots URScript (.script), or the
/// joints alone, a row a cycle (.servoj).
enum class JointLanguage { krl, rapid, urscript, servoj };

/// A trajectory as a program of joint points, at most TrajectoryInfo::program_period_s apart; degrees for KUKA and ABB,
/// rad for Universal Robots. Its header says what the cell does not give, what of the program is not carried out, and
/// how far the controller's motion is from trajectory and program (SampleFile::verify). Samples are kept beside the
/// file until it is written.
/// @throws InvalidInput unless the machine has six revolute joints, outputs are numbers (KUKA, Universal Robots)
///     or names (ABB), the period is a multiple of the sample's and at most 10 s, and the program's name, the file's
///     with letters, digits and underscores alone, is no word of the language and short enough: 24 characters in KRL,
///     32 in RAPID
[[nodiscard]] std::unique_ptr<SampleFile> open_joint_program(const std::filesystem::path& path,
                                                             const TrajectoryInfo& info, JointLanguage language);

}  // namespace robomill::path
