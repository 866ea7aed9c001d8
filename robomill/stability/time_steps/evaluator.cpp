#include "robomill/stability/time_steps/evaluator.hpp"

#include <cmath>

namespace robomill::stability::detail {
namespace {

bool finer(const Resolution& a, const Resolution& b) {
  return a.halvings != b.halvings ? a.halvings > b.halvings : a.nodes > b.nodes;
}

}  // namespace

Outcome outcome_of(const Dominant& found, const Motion& motion) {
  const double radius = spectral_radius(found);
  return {.multiplier = std::isfinite(std::abs(found.multiplier)) ? found.multiplier : radius,
          .spectral_radius = radius,
          .kind = kind_of(found.multiplier),
          .chatter_frequency_hz = motion.frequency_hz,
          .mode = motion.mode};
}

void Evaluator::evaluate(std::span<const Point> points, std::span<Dominant> out) {
  Resolution finest = {.nodes = 0};
  const auto step_s = [&](std::size_t lane) { return model_.cut.step_rad() / points[lane].spindle_speed_rad_per_s; };
  for (std::size_t lane = 0; lane < points.size(); ++lane) {
    points_[lane].depth = points[lane].plan;
    if (points_[lane].depth == nullptr) {
      model_.cut.at_depth(points[lane].axial_depth_m, depths_[lane]);
      points_[lane].depth = &depths_[lane];
    }
    const Resolution needed = resolution(model_.tip, step_s(lane), points_[lane].depth->largest_n_per_m);
    if (finer(needed, finest)) finest = needed;
  }
  for (std::size_t lane = 0; lane < points.size(); ++lane) {
    if (lane > 0 && points[lane].spindle_speed_rad_per_s == points[lane - 1].spindle_speed_rad_per_s) {
      points_[lane].speed = points_[lane - 1].speed;
      continue;
    }
    SpeedPlan& plan = speeds_[lane];
    const bool known = plan.step_s == step_s(lane) && plan.resolution.nodes == finest.nodes &&
                       plan.resolution.halvings == finest.halvings;
    if (!known) plan_speed(model_.tip, step_s(lane), finest, plan);
    points_[lane].speed = &plan;
  }
  monodromy_.prepare(std::span(points_).first(points.size()));
  arnoldi_.find(monodromy_, out);
}

void Evaluator::describe(std::span<const Dominant> dominant, std::span<Motion> out) {
  std::array<double, lane_count> step_s = {};
  for (std::size_t lane = 0; lane < dominant.size(); ++lane) step_s[lane] = points_[lane].speed->step_s;
  motion_.find(model_.tip, model_.cut.steps(), step_s, monodromy_, arnoldi_, dominant, out);
}

}  // namespace robomill::stability::detail
