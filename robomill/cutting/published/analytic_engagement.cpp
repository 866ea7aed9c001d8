#include "robomill/cutting/engagement.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/cutting/degrees.hpp"
#include "robomill/cutting/published/patch.hpp"
#include "robomill/cutting/published/profile_nodes.hpp"

namespace robomill::cutting {
namespace {

using std::numbers::pi;

using detail::degrees;

void reject_shank(const Cutter& cutter, const Cut& cut, const char* what) {
  const std::string rule = std::string("puts the cut on ") + what;
  const std::string posture = "lead " + degrees(cut.lead_rad) + " degrees, tilt " + degrees(cut.tilt_rad) + " degrees";
  Cut upright = cut;
  upright.lead_rad = upright.tilt_rad = 0.0;
  const bool too_deep = (cut.lead_rad == 0.0 && cut.tilt_rad == 0.0) ||
                        detail::Patch(cutter, upright).reaches_from(Profile(cutter).height_m());
  if (too_deep) {
    throw InvalidInput("axial_depth_m", cut.axial_depth_m, "m", rule,
                       "The cut is deeper than the edges reach (cutting_height_m)");
  }
  const bool leads = std::abs(cut.lead_rad) >= std::abs(cut.tilt_rad);
  throw InvalidInput(leads ? "lead_rad" : "tilt_rad", leads ? cut.lead_rad : cut.tilt_rad, "rad", rule,
                     "With " + posture);
}

int chosen_slices(const Cutter& cutter, const detail::Patch& patch, const Cut& cut) {
  double steepest = 0.0;
  for (int j = 0; j < cutter.mill.teeth; ++j) steepest = std::max(steepest, std::abs(cutter.mill.lag_rad_per_m(j)));
  const double lag = steepest * std::min(cut.axial_depth_m, patch.profile().height_m());
  return std::clamp(static_cast<int>(std::ceil(lag * 180.0 / pi)), 50, 500);
}

}  // namespace

Engagement engage(const Cutter& cutter, const Cut& cut, const EngagementOptions& options) {
  cut.validate(cutter);
  options.validate();
  const detail::Patch patch(cutter, cut);
  if (patch.reaches_from(patch.profile().height_m())) reject_shank(cutter, cut, "the shank");
  if (cut.curvature_along_feed_per_m != 0.0 && patch.reaches_from(0.5 * cutter.mill.diameter_m)) {
    reject_shank(cutter, cut, "the cylinder above the ball, where the feed must be straight");
  }
  Engagement engagement;
  engagement.feed_from_tool = patch.feed_from_tool();
  engagement.first_arc.push_back(0);
  const int count = options.slices > 0 ? options.slices : chosen_slices(cutter, patch, cut);
  const std::vector<detail::Node> nodes = options.rings_per_stretch > 0
                                              ? detail::profile_nodes_each(patch, options.rings_per_stretch)
                                              : detail::profile_nodes(patch, count);
  for (const detail::Node& node : nodes) {
    const Profile::Point point = patch.profile().at(node.length_m);
    const detail::ArcList arcs = patch.arcs(point);
    if (arcs.empty()) continue;
    engagement.slices.push_back({.radius_m = point.radius_m,
                                 .height_m = point.height_m,
                                 .position_rad = point.position_rad,
                                 .width_m = node.width_m,
                                 .edge_length_per_width = edge_length_per_width(cutter.mill, 0, point)});
    for (const detail::BoundedArc& arc : arcs)
      engagement.arcs.push_back({.entry_rad = arc.entry, .exit_rad = arc.exit});
    engagement.first_arc.push_back(engagement.arcs.size());
  }
  return engagement;
}

}  // namespace robomill::cutting
