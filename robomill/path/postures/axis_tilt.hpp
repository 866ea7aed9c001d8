#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/path/postures/posture_walk.hpp"
#include "robomill/path/smooth.hpp"
#include "robomill/program/program.hpp"

namespace robomill::path {

/// A part of a block: its share of the block ends there, at this pose.
struct TiltedPart {
  double share = 1.0;  ///< in (0, 1]
  program::Pose end = {};
};

/// A block in parts where tilts change within it, else as one part; poses are tilted as their places say.
/// @param block  from 0
/// @param from   its begin as programmed
[[nodiscard]] std::vector<TiltedPart> tilted_parts(std::span<const AxisTilt> tilts, std::size_t block,
                                                   const program::Pose& from, const program::Pose& to);
/// The largest tilt within a block [rad]; 0 where there is none.
[[nodiscard]] double tilt_within(std::span<const AxisTilt> tilts, std::size_t block);

/// A way with constant gamma that passes beside singularities of the wrist through which the program leads: the axis
/// is tilted there across its motion relative to axis 4 by options.beside's angle, which joint 4 needs to turn in.
/// @param farthest  walks that ended in a singularity, the best first
/// @return empty gamma_rad where none goes through
struct TiltedWay {
  Posture posture = {};
  Walk walk = {};  ///< of the tilted way; its margin's block is the program's
};
[[nodiscard]] TiltedWay tilted_way(const Head& head, std::span<const TiltedWay> farthest,
                                   const PostureOptions& options);

}  // namespace robomill::path
