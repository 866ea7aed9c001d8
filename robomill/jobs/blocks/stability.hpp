#pragma once
#include <Eigen/Core>

#include "robomill/jobs/blocks.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::jobs {

/// One cut of a program before the structure that vibrates.
struct BlockCut {
  const ForcesFile& file;  ///< cutter and coefficients
  const cutting::PoseEngagement& cut;
  Eigen::Matrix3d base_from_work = Eigen::Matrix3d::Identity();
  double spindle_speed_rad_per_s = 0.0;
  double tolerance = 1e-4;
};

/// The cut and what vibrates, in F.
/// @param modes  in B
/// @throws InvalidInput if the modes know neither x nor y at a tip
[[nodiscard]] stability::LobesProblem block_problem(const BlockCut& at, const modal::ModalModel& modes);

/// @param modes  in B
/// @throws InvalidInput where modes or cut are out of range
[[nodiscard]] CutStability cut_stability(const BlockCut& cut, const modal::ModalModel& modes);

/// The limit depth alone; NaN: none.
[[nodiscard]] double limit_depth_m(const BlockCut& cut, const modal::ModalModel& modes);

/// Height of the engaged part along the tool's axis, 1 µm at least: what limits are compared with.
[[nodiscard]] double engaged_depth_m(const cutting::PoseEngagement& cut);

}  // namespace robomill::jobs
