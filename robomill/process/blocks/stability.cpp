#include "robomill/process/blocks/stability.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "robomill/modal/tip.hpp"
#include "robomill/stability/block.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/surface_error.hpp"

namespace robomill::process {
namespace {

/// Limits are searched from the depth over the first to the second multiple of it.
constexpr double depths_below = 16.0, depths_above = 8.0;
/// Of a flat bottom that cuts alone, whose engagement has no height: it is stable at every depth or at none.
constexpr double least_depth_m = 1e-6;

/// The error of greatest magnitude; none where no edge leaves a surface.
double worst_error_m(const std::vector<stability::SurfacePlace>& surface) {
  double out = unknown;
  for (const stability::SurfacePlace& place : surface) {
    if (!(std::abs(place.error_m) <= std::abs(out))) out = place.error_m;
  }
  return out;
}

}  // namespace

stability::LobesProblem block_problem(const BlockCut& at, const modal::ModalModel& modes) {
  const cutting::FlatEndMill& mill = at.setup.cutter.mill;
  const double teeth_per_s = at.spindle_speed_rad_per_s * mill.teeth / (2.0 * std::numbers::pi);
  stability::LobesProblem problem;
  stability::SpatialMilling& cut = problem.spatial.emplace();
  cut.cutter = at.setup.cutter;
  cut.engagement = at.cut.engagement;
  cut.coefficients = at.setup.coefficients;
  cut.feed_per_tooth_m = at.cut.feed_speed_m_per_s / teeth_per_s;
  const Eigen::Matrix3d base_from_feed = at.base_from_work * at.cut.work_from_feed;
  problem.dynamics = modal::turned(modes, base_from_feed.transpose());
  return problem;
}

double engaged_depth_m(const cutting::PoseEngagement& cut) {
  return std::max(stability::engaged_height_m(cut.engagement), least_depth_m);
}

JudgedCut judged_cut(const BlockCut& at, const modal::ModalModel& modes) {
  const double depth_m = engaged_depth_m(at.cut);
  stability::BlockOptions options;
  options.tolerance = at.tolerance;
  options.axial_depth_m = {depth_m / depths_below, depth_m * depths_above};
  const stability::LobesProblem problem = block_problem(at, modes);
  JudgedCut judged;
  stability::BlockStability& block = judged.stability;
  block = stability::block_stability(problem, at.spindle_speed_rad_per_s, depth_m, options);
  if (block.limited()) {
    // The first order knows nothing of depths that were not looked at.
    for (double* depth : {&block.limit_5_percent_m, &block.limit_95_percent_m}) {
      *depth = std::clamp(*depth, options.axial_depth_m[0], options.axial_depth_m[1]);
    }
  }
  if (block.at.stable && problem.spatial->feed_per_tooth_m > 0.0) {
    stability::SteadyCut steady =
        stability::steady_cut(problem, {block.at.spindle_speed_rad_per_s, block.at.axial_depth_m}, at.tolerance);
    judged.surface = std::move(steady.profile);
    judged.steady.vibration = steady.vibration;
    judged.steady.vibration_share = steady.vibration.amplitude_m / problem.spatial->feed_per_tooth_m;
  }
  judged.steady.surface_error_m = worst_error_m(judged.surface);
  return judged;
}

double limit_depth_m(const BlockCut& at, const modal::ModalModel& modes) {
  const double depth_m = engaged_depth_m(at.cut);
  stability::BlockOptions options;
  options.tolerance = at.tolerance;
  options.axial_depth_m = {depth_m / depths_below, depth_m * depths_above};
  options.point = options.margin = options.regime = options.quantiles = false;
  return stability::block_stability(block_problem(at, modes), at.spindle_speed_rad_per_s, depth_m, options)
      .at.limit_depth_m;
}

}  // namespace robomill::process
