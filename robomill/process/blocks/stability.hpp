#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/process/blocks.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/surface_error.hpp"

namespace robomill::process {

/// One cut of a program before the structure that vibrates.
struct BlockCut {
  const Cut& setup;  ///< cutter and coefficients
  const cutting::PoseEngagement& cut;
  Eigen::Matrix3d base_from_work = Eigen::Matrix3d::Identity();
  double spindle_speed_rad_per_s = 0.0;
  double tolerance = 1e-4;
};

/// The cut and what vibrates, in F.
/// @param modes  in B
/// @throws InvalidInput if the modes know neither x nor y at a tip
[[nodiscard]] stability::LobesProblem block_problem(const BlockCut& at, const modal::ModalModel& modes);

/// A cut's stability, and what it leaves place by place.
struct JudgedCut {
  stability::BlockStability stability = {};  ///< as of BlockRow
  SteadyMotion steady = {};
  /// stability::surface_profile; empty where the cut is not fed or chatters, so that it has no steady motion.
  std::vector<stability::SurfacePlace> surface = {};
};

/// @param modes  in B
/// @throws InvalidInput where modes or cut are out of range
[[nodiscard]] JudgedCut judged_cut(const BlockCut& cut, const modal::ModalModel& modes);

/// The limit depth alone; infinity: none.
[[nodiscard]] double limit_depth_m(const BlockCut& cut, const modal::ModalModel& modes);

/// Height of the engaged part along the tool's axis, 1 µm at least: what limits are compared with.
[[nodiscard]] double engaged_depth_m(const cutting::PoseEngagement& cut);

}  // namespace robomill::process
