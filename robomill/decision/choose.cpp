#include "robomill/decision/choose.hpp"

#include <algorithm>

#include "robomill/base/parallel.hpp"
#include "robomill/cutting/milling.hpp"
#include "robomill/stability/surface_error.hpp"

namespace robomill::decision {
namespace {

DepthLimit with_finish(const stability::Limit& chatter, const stability::LobesProblem& problem,
                       const RecommendOptions& options, const FinishLimits& finish) {
  if (!finish.any()) return {.chatter = chatter};
  const bool found = chatter.status == stability::Limit::Status::found;
  double deepest_m = (found ? chatter.axial_depth_m : options.searched_depth_m) * (1.0 - options.depth_margin);
  if (options.max_axial_depth_m > 0.0) deepest_m = std::min(deepest_m, options.max_axial_depth_m);
  return {.chatter = chatter, .finish = finish_depth(problem, chatter.spindle_speed_rad_per_s, deepest_m, finish)};
}

void add_surface(Operation& op, const stability::LobesProblem& problem) {
  if (problem.has_measured()) return;  // without modes
  const stability::SurfacePoint surface =
      stability::surface_point(problem, {op.spindle_speed_rad_per_s, op.axial_depth_m});
  op.surface_error_m = surface.surface_location_error_m;
  op.peak_deflection_m = surface.peak_deflection_m;
}

}  // namespace

Recommendation choose(const stability::LobesProblem& problem, const stability::LobesOptions& lobes,
                      const std::vector<stability::Limit>& limits, RecommendOptions options, const FinishLimits& finish,
                      Progress& progress) {
  require_finishable(problem, finish);
  const cutting::Milling& milling = problem.milling;
  options.teeth = milling.tool.teeth;
  options.diameter_m = milling.tool.diameter_m;
  options.feed_per_tooth_m = milling.feed_per_tooth_m;
  options.searched_depth_m = lobes.axial_depth_m[1];
  // The mean torque is proportional to depth, so one metre of depth gives the factor.
  options.torque_per_depth_n = cutting::mean_load(milling, 1.0, milling.feed_per_tooth_m, 1.0).torque_n_m;
  std::vector<DepthLimit> depths(limits.size());
  if (finish.any()) progress.start("finishing depths", limits.size());
  parallel_for(limits.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      progress.check();
      depths[i] = with_finish(limits[i], problem, options, finish);
      if (finish.any()) progress.advance();
    }
  });
  Recommendation result = recommend(depths, options, [&](double speed) {
    progress.check();
    return with_finish(stability::limit_depths(problem, lobes, {speed}).front(), problem, options, finish);
  });
  if (result.recommended) add_surface(*result.recommended, problem);
  for (Operation& op : result.alternatives) add_surface(op, problem);
  return result;
}

}  // namespace robomill::decision
