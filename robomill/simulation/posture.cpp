#include "robomill/simulation/posture.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/simulation/job.hpp"
#include "robomill/simulation/posture_model.hpp"

namespace robomill::simulation {
namespace {

using namespace detail;
using std::numbers::pi;

Job job_of(const PostureCut& cut, const SimulationOptions& options) {
  cut.validate();
  options.validate();
  const double speed = cut.motion.spindle_speed_rad_per_s;
  Job job;
  job.model_at = [&cut](const Resolution& resolution) { return posture_model(cut, resolution.steps_per_revolution); };
  job.feed_from_tool = cut.engagement.feed_from_tool;
  job.structure = modal::turned(cut.structure, job.feed_from_tool.transpose());
  job.period = period_of(cut.cutter.mill);
  job.first.steps_per_revolution =
      first_steps(cut.structure, speed, cut.cutter.mill, mean_arc_rad(cut.engagement), options);
  job.spindle_speed_rad_per_s = speed;
  job.feed_per_tooth_m = cut.motion.feed_per_tooth_m;
  job.teeth = cut.cutter.mill.teeth;
  return job;
}

bool valid(const cutting::EdgeSlice& slice) {
  return slice.radius_m >= 0.0 && std::isfinite(slice.radius_m) && std::isfinite(slice.height_m) &&
         slice.position_rad >= 0.0 && slice.position_rad <= pi && slice.width_m >= 0.0 &&
         std::isfinite(slice.width_m) && slice.edge_length_per_width >= 1.0 &&
         std::isfinite(slice.edge_length_per_width);
}

bool valid(const cutting::Arc& arc) {
  const double range = arc.exit_rad - arc.entry_rad;
  return arc.entry_rad >= 0.0 && arc.entry_rad < 2.0 * pi && range > 0.0 && range <= 2.0 * pi * (1.0 + 1e-12);
}

void require_valid(const cutting::Engagement& engagement) {
  const std::vector<std::size_t>& first = engagement.first_arc;
  const bool ordered = engagement.slices.empty()
                           ? engagement.arcs.empty()
                           : first.size() == engagement.slices.size() + 1 && first.front() == 0 &&
                                 first.back() == engagement.arcs.size() && std::ranges::is_sorted(first);
  if (!ordered) throw InvalidInput("engagement.first_arc", "must give each slice its arcs, in order");
  for (const cutting::EdgeSlice& slice : engagement.slices) {
    if (!valid(slice)) {
      throw InvalidInput("engagement.slices",
                         "must have radii and widths >= 0, a position between 0 and 180 degrees "
                         "and an edge no shorter than the width");
    }
  }
  for (const cutting::Arc& arc : engagement.arcs) {
    if (!valid(arc)) {
      throw InvalidInput("engagement.arcs", "must have an entry in [0, 2π) and an exit at most a revolution after it");
    }
  }
  const Eigen::Matrix3d& r = engagement.feed_from_tool;
  if (!((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-9 &&
        r.row(0).cross(r.row(1)).dot(r.row(2)) > 0)) {
    throw InvalidInput("engagement.feed_from_tool", "must be a rotation");
  }
}

}  // namespace

void PostureCut::validate() const {
  cutter.validate();
  require_valid(engagement);
  motion.validate();
  cutting::require_spindle_speed("motion.spindle_speed_rad_per_s", motion.spindle_speed_rad_per_s);
  if (cutter.mill.runout_m > 0.0) {
    require_positive("motion.feed_per_tooth_m", motion.feed_per_tooth_m, "m",
                     "Where there is runout it decides which teeth miss the cut");
  }
  const auto [low, high] = std::ranges::minmax_element(engagement.slices, {}, &cutting::EdgeSlice::position_rad);
  if (low != engagement.slices.end()) coefficients.validate(low->position_rad, high->position_rad);
  require_damped(structure);
}

SmallVibration small_vibration(const PostureCut& cut, const SimulationOptions& options, Progress& progress) {
  return detail::small_vibration(job_of(cut, options), options, progress);
}

Simulation simulate(const PostureCut& cut, const SimulationOptions& options, Progress& progress) {
  require_positive("motion.feed_per_tooth_m", cut.motion.feed_per_tooth_m, "m", "Without feed nothing is cut");
  return detail::simulate(job_of(cut, options), options, progress);
}

}  // namespace robomill::simulation
