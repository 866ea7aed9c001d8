#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "robomill/cell/check.hpp"
#include "robomill/path/postures/posture_walk.hpp"

namespace robomill::cell {

/// What the tool must reach.
struct Targets {
  path::Head head = {};               ///< poses, and the line of each block; of the origin alone no block
  program::Source* source = nullptr;  ///< of the same program; null without one
};

/// Whether the tool comes to the targets with the workpiece there.
[[nodiscard]] Placement judge(const Cell& cell, const Eigen::Isometry3d& workpiece, const Targets& targets,
                              Progress& progress);

/// At which poses of a program propose() looks before it judges: up to 20 that failed, then up to 60 all along it.
[[nodiscard]] std::vector<std::size_t> poses_to_look_at(const Placement& failed, std::size_t poses);

/// Other poses of the workpiece, near the one that failed, that judge() finds to work; the smallest change first.
/// @param most  at most so many, each in a direction of its own
[[nodiscard]] std::vector<Proposal> propose(const Cell& cell, const Placement& failed, const Targets& targets,
                                            std::size_t most, Progress& progress);

}  // namespace robomill::cell
