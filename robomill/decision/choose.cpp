#include "robomill/decision/choose.hpp"

#include <algorithm>

#include "robomill/base/parallel.hpp"
#include "robomill/cutting/milling.hpp"
#include "robomill/stability/forced_vibration.hpp"
#include "robomill/stability/surface_error.hpp"

namespace robomill::decision {
namespace {

/// What limits the depth at one speed beside chatter and the spindle.
DepthLimit with_finish(const stability::Limit& chatter, const stability::LobesProblem& problem,
                       const stability::ForcedResponse& response, const RecommendOptions& options,
                       const FinishLimits& finish) {
  const bool found = chatter.status == stability::Limit::Status::found;
  double deepest_m = (found ? chatter.axial_depth_m : options.searched_depth_m) * (1.0 - options.machine.depth_margin);
  if (options.machine.max_axial_depth_m > 0.0) deepest_m = std::min(deepest_m, options.machine.max_axial_depth_m);
  const double speed = chatter.spindle_speed_rad_per_s;
  const FinishDepth surface = finish_depth(problem, speed, deepest_m, finish);
  const FinishDepth vibration = vibration_depth(response, speed, deepest_m, options.feed_per_tooth_m);
  return {.chatter = chatter, .finish = vibration.axial_depth_m < surface.axial_depth_m ? vibration : surface};
}

void add_surface(Operation& op, const stability::LobesProblem& problem, const stability::ForcedResponse& response) {
  if (!(op.axial_depth_m > 0.0)) return;
  op.vibration = response.at({op.spindle_speed_rad_per_s, op.axial_depth_m});
  if (problem.has_measured()) return;  // without modes
  const stability::SurfacePoint surface =
      stability::surface_point(problem, {op.spindle_speed_rad_per_s, op.axial_depth_m});
  op.surface_error_m = surface.surface_location_error_m;
  op.peak_deflection_m = surface.peak_deflection_m;
}

}  // namespace

std::function<double(double)> mean_torque_of(const cutting::Milling& milling) {
  return [milling](double depth_m) { return cutting::mean_torque_n_m(milling, depth_m, milling.feed_per_tooth_m); };
}

Recommendation choose(const stability::LobesProblem& problem, const stability::LobesOptions& lobes,
                      const std::vector<stability::Limit>& limits, RecommendOptions options, const FinishLimits& finish,
                      Progress& progress) {
  require_finishable(problem, finish);
  const cutting::Milling& milling = problem.milling;
  options.teeth = milling.tool.teeth;
  options.diameter_m = milling.tool.diameter_m;
  options.feed_per_tooth_m = milling.feed_per_tooth_m;
  options.searched_depth_m = lobes.axial_depth_m[1];
  options.mean_torque_n_m = mean_torque_of(milling);
  const stability::ForcedResponse response(problem);
  std::vector<DepthLimit> depths(limits.size());
  progress.start("forced vibration", limits.size());
  parallel_for(limits.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      progress.check();
      depths[i] = with_finish(limits[i], problem, response, options, finish);
      progress.advance();
    }
  });
  Recommendation result = recommend(depths, options, [&](double speed) {
    progress.check();
    return with_finish(stability::limit_depths(problem, lobes, {speed}).front(), problem, response, options, finish);
  });
  if (result.recommended) add_surface(*result.recommended, problem, response);
  for (Operation& op : result.alternatives) add_surface(op, problem, response);
  return result;
}

}  // namespace robomill::decision
