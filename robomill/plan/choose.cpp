#include "robomill/plan/choose.hpp"

#include "robomill/cutting/milling.hpp"

namespace robomill::plan {
namespace {

DepthLimit to_depth_limit(const stability::Limit& limit) {
  DepthLimit out{.spindle_speed_rad_per_s = limit.spindle_speed_rad_per_s};
  if (limit.status == stability::Limit::Status::found) {
    out.axial_depth_m = limit.axial_depth_m;
    out.chatter_frequency_hz = limit.chatter_frequency_hz;
    out.mode = limit.mode;
  }
  return out;
}

}  // namespace

Recommendation choose(const formats::LobesFile& cut, const std::vector<stability::Limit>& limits,
                      RecommendOptions options) {
  const cutting::Milling& milling = cut.problem.milling;
  options.teeth = milling.tool.teeth;
  options.radial_depth_m = cut.radial_depth_m;
  options.feed_per_tooth_m = milling.feed_per_tooth_m;
  options.searched_depth_m = cut.options.axial_depth_m[1];
  // The mean torque is proportional to depth, so one metre of depth gives the factor.
  options.torque_per_depth_n = cutting::mean_load(milling, 1.0, milling.feed_per_tooth_m, 1.0).torque_n_m;
  std::vector<DepthLimit> depths;
  depths.reserve(limits.size());
  for (const stability::Limit& limit : limits) depths.push_back(to_depth_limit(limit));
  return recommend(depths, options, [&](double speed) {
    return to_depth_limit(stability::limit_depths(cut.problem, cut.options, {speed}).front());
  });
}

}  // namespace robomill::plan
