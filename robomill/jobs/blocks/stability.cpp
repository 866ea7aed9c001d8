#include "robomill/jobs/blocks/stability.hpp"

#include <algorithm>
#include <numbers>

#include "robomill/jobs/blocks/dynamics.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/sweep.hpp"

namespace robomill::jobs {
namespace {

/// Limits are searched up to this multiple of the depth, and no higher than the edges reach.
constexpr double depths_searched = 4.0;

stability::LobesProblem block_problem(const BlockCut& at, const modal::ModalModel& modes) {
  const cutting::FlatEndMill& mill = at.file.cutter.mill;
  const double teeth_per_s = at.spindle_speed_rad_per_s * mill.teeth / (2.0 * std::numbers::pi);
  stability::LobesProblem problem;
  stability::SpatialMilling& cut = problem.spatial.emplace();
  cut.cutter = at.file.cutter;
  cut.engagement = at.cut.engagement;
  cut.coefficients = at.file.coefficients;
  cut.feed_per_tooth_m = at.cut.feed_speed_m_per_s / teeth_per_s;
  const Eigen::Matrix3d base_from_feed = at.base_from_work * at.cut.work_from_feed;
  problem.dynamics = in_axes(modes, base_from_feed.transpose());
  return problem;
}

stability::LobesOptions block_options(const BlockCut& at, double depth_m) {
  stability::LobesOptions options;
  options.axial_depth_m = {0.0, depths_searched * depth_m};
  options.spindle_speed_rad_per_s = {at.spindle_speed_rad_per_s, 2.0 * at.spindle_speed_rad_per_s};
  options.grid = {2, 17};
  options.tolerance = at.tolerance;
  return options;
}

}  // namespace

double engaged_depth_m(const cutting::PoseEngagement& cut) {
  return stability::engaged_height_m(cut.engagement);
}

CutStability cut_stability(const BlockCut& at, const modal::ModalModel& modes) {
  const double depth_m = engaged_depth_m(at.cut);
  const stability::LobesProblem problem = block_problem(at, modes);
  const stability::LobesOptions options = block_options(at, depth_m);
  const stability::OperatingPoint point = {.spindle_speed_rad_per_s = at.spindle_speed_rad_per_s,
                                           .axial_depth_m = depth_m};
  const stability::PointResult here = stability::evaluate_point(problem, options, point);
  const stability::Limit limit = stability::limit_depths(problem, options, {at.spindle_speed_rad_per_s}).front();
  const stability::GainMargin gain = stability::gain_margin(problem, point, at.tolerance);
  CutStability out;
  out.spectral_radius = here.spectral_radius;
  out.searched_depth_m = options.axial_depth_m[1];
  out.chatter_frequency_hz = here.chatter_frequency_hz;
  out.mode = here.mode;
  if (limit.status == stability::Limit::Status::found) {
    out.limit_depth_m = limit.axial_depth_m;
    out.chatter_frequency_hz = limit.chatter_frequency_hz;
    out.mode = limit.mode;
    out.regime = "regenerative";
  }
  out.gain_margin = gain.status == stability::GainMargin::Status::unconditionally_stable
                        ? std::numeric_limits<double>::infinity()
                        : gain.gain;
  return out;
}

double limit_depth_m(const BlockCut& at, const modal::ModalModel& modes) {
  const stability::Limit limit =
      stability::limit_depths(block_problem(at, modes), block_options(at, engaged_depth_m(at.cut)),
                              {at.spindle_speed_rad_per_s})
          .front();
  return limit.status == stability::Limit::Status::found ? limit.axial_depth_m : CutStability::none;
}

}  // namespace robomill::jobs
