#include "robomill/stability/block.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/stability/chart/cost.hpp"
#include "robomill/stability/chart/edges.hpp"
#include "robomill/stability/chart/gain_search.hpp"
#include "robomill/stability/chart/lowest_crossing.hpp"
#include "robomill/stability/collocation/collocation.hpp"
#include "robomill/stability/collocation/mode_sensitivity.hpp"
#include "robomill/stability/collocation/regime_of.hpp"
#include "robomill/stability/sensitivity.hpp"

namespace robomill::stability {
namespace {

using namespace detail;
constexpr double none = std::numeric_limits<double>::infinity();

class BlockSearch {
 public:
  BlockSearch(const LobesProblem& problem, const OperatingPoint& point, const BlockOptions& options)
      : problem_(problem),
        options_(options),
        point_(point),
        model_(collocation_model(problem)),
        evaluator_(*model_, options.tolerance,
                   {.tolerance = 1e-3 * options.tolerance, .between = 8, .most_cold_modes = 40}) {
    crossing_.tolerance = options.tolerance;
    crossing_.at_a_time = lane_count;
    crossing_.level = model_->first_level(point, options.tolerance);
    crossing_.coarse_level = std::max(1, crossing_.level - 1);
  }

  BlockStability run() {
    BlockStability out;
    if (options_.margin) look_at_gains(out);
    if (options_.point) out.at = point_result(evaluator_, point_);
    if (options_.margin) out.at.gain_margin = gain_of(out.gain);
    look_at_depths(out);
    out.evaluations = evaluator_.evaluations();
    return out;
  }

 private:
  /// The margin: one engagement.
  void look_at_gains(BlockStability& out) {
    const LookAlong look = [&](std::span<const double> gains, const Ask& ask, std::span<Outcome> outcomes) {
      std::array<OperatingPoint, lane_count> points;
      for (std::size_t i = 0; i < gains.size(); ++i) {
        points[i] = point_;
        points[i].gain = gains[i];
      }
      evaluator_.evaluate(std::span(points).first(gains.size()), ask, outcomes);
    };
    crossing_.cheap_lanes = true;
    crossing_.estimate = false;
    const Crossing crossing =
        lowest_crossing(look, marks(1.0, 1.0 / options_.most_gain, options_.most_gain, 0.0), crossing_);
    out.gain.gain = crossing.at;
    out.gain.status = crossing.status == Crossing::Status::none    ? GainMargin::Status::unconditionally_stable
                      : crossing.status == Crossing::Status::found ? GainMargin::Status::found
                                                                   : GainMargin::Status::below_range;
  }

  void look_at_depths(BlockStability& out) {
    const LookAlong look = [&](std::span<const double> depths, const Ask& ask, std::span<Outcome> outcomes) {
      std::array<OperatingPoint, lane_count> points;
      for (std::size_t i = 0; i < depths.size(); ++i) {
        points[i] = point_;
        points[i].axial_depth_m = depths[i];
      }
      evaluator_.evaluate(std::span(points).first(depths.size()), ask, outcomes);
    };
    std::array<double, 2> range = options_.axial_depth_m;
    if (range[1] == 0.0) {
      const double deepest_m = std::clamp(8.0 * point_.axial_depth_m, point_.axial_depth_m, most_depth_m());
      range = {point_.axial_depth_m / 16.0, deepest_m};
    }
    const bool guessed = out.gain.status == GainMargin::Status::found;
    crossing_.cheap_lanes = false;
    crossing_.estimate = true;
    const double guess = guessed ? out.gain.gain * point_.axial_depth_m : 0.0;
    const Crossing crossing = lowest_crossing(look, marks(point_.axial_depth_m, range[0], range[1], guess), crossing_);
    out.limit.spindle_speed_rad_per_s = point_.spindle_speed_rad_per_s;
    out.searched_depth_m = range;
    out.at.limit_depth_m = out.limit_5_percent_m = out.limit_95_percent_m = none;
    if (crossing.status == Crossing::Status::none) return;
    out.limit.status = Limit::Status::found;
    out.limit.axial_depth_m = crossing.at;
    out.limit.chatter_frequency_hz = crossing.outcome.chatter_frequency_hz;
    out.limit.kind = crossing.outcome.kind;
    out.limit.mode = crossing.outcome.mode;
    out.limit.error_estimate = crossing.outcome.error_estimate;
    out.at.limit_depth_m = out.limit_5_percent_m = out.limit_95_percent_m = crossing.at;
    explain(crossing, out);
  }

  /// An analytic cut must not reach the shank; what a given engagement lacks above the edges is left out by itself.
  [[nodiscard]] double most_depth_m() const {
    if (!problem_.spatial || problem_.spatial->engagement) return none;
    const cutting::Cut& cut = problem_.spatial->cut;
    const double upright = std::cos(cut.lead_rad) * std::cos(cut.tilt_rad);
    return std::max(point_.axial_depth_m, 0.5 * cutting::Profile(problem_.spatial->cutter).height_m() * upright);
  }

  /// At the limit, whose case is the evaluator's last one.
  void explain(const Crossing& crossing, BlockStability& out) {
    OperatingPoint there = point_;
    there.axial_depth_m = crossing.at;
    const CollocationCase& at = evaluator_.last_case();
    const double factor = model_->factor(there);
    if (options_.regime) {
      const RegimeResult regime =
          regime_of(problem_, at, factor, there.spindle_speed_rad_per_s, crossing.outcome.chatter_frequency_hz);
      out.regime = regime.regime;
      out.lower_bound = regime.lower_bound;
    }
    if (!options_.quantiles || crossing.status != Crossing::Status::found || !knows_deviations()) return;
    LimitSensitivity sensitivity;
    sensitivity.depth = crossing.slope;
    sensitivity.modes = knows_sensitivities(problem_, at)
                            ? mode_sensitivities(problem_, at, eigen_motion(at, factor, crossing.outcome.multiplier))
                            : mode_differences(problem_, there, crossing_.level, options_.tolerance);
    const LimitQuantiles quantiles = limit_quantiles(problem_, sensitivity, crossing.at);
    out.limit_5_percent_m = quantiles.limit_5_percent_m;
    out.limit_95_percent_m = quantiles.limit_95_percent_m;
  }

  [[nodiscard]] bool knows_deviations() const {
    const auto knows = [](const modal::Mode& mode) {
      return std::isfinite(mode.frequency_std_hz) || std::isfinite(mode.damping_ratio_std) ||
             std::isfinite(mode.residue_std_ratio);
    };
    return std::ranges::any_of(problem_.dynamics.modes, knows) ||
           std::ranges::any_of(problem_.workpiece_dynamics.modes, knows);
  }

  /// From low to high: factors of four below half of `here`, square roots of two above; closer about a guess.
  static std::vector<double> marks(double here, double low, double high, double guess) {
    constexpr double beside = 1.04;
    std::vector<double> out = {low, high};
    const auto offer = [&](double at) {
      const bool inside = at > low * 1.01 && at < high / 1.01;
      const bool beside_guess = guess > 0.0 && at > guess / 1.1 && at < guess * 1.1;
      if (inside && !beside_guess) out.push_back(at);
    };
    for (double at = 0.25 * here; at > low; at *= 0.25) offer(at);
    for (double at = 0.5 * here; at < high; at *= std::sqrt(2.0)) offer(at);
    for (const double at : {guess / beside, guess * beside}) {
      if (at > low * 1.01 && at < high / 1.01) out.push_back(at);
    }
    std::ranges::sort(out);
    return out;
  }

  const LobesProblem& problem_;
  const BlockOptions& options_;
  OperatingPoint point_;
  std::unique_ptr<CollocationModel> model_;
  CollocationEvaluator evaluator_;
  CrossingOptions crossing_;
};

}  // namespace

void BlockOptions::validate() const {
  if (!(tolerance >= 1e-10 && tolerance <= 0.1)) {
    throw InvalidInput("tolerance", tolerance, "", "must lie between 1e-10 and 0.1");
  }
  if (!(most_gain >= 2.0 && most_gain <= 1000.0)) {
    throw InvalidInput("most_gain", most_gain, "", "must lie between 2 and 1,000");
  }
  if (axial_depth_m[0] == 0.0 && axial_depth_m[1] == 0.0) return;
  for (const double end : axial_depth_m) require_positive("axial_depth_m", end, "m");
  if (!(axial_depth_m[1] > axial_depth_m[0])) {
    throw InvalidInput("axial_depth_m", axial_depth_m[1], "m", "must end above its start", "Give the lower end first");
  }
}

BlockStability block_stability(const LobesProblem& problem, double spindle_speed_rad_per_s, double axial_depth_m,
                               const BlockOptions& options) {
  problem.validate();
  options.validate();
  require_known(problem, Method::collocation);
  cutting::require_spindle_speed("spindle_speed_rad_per_s", spindle_speed_rad_per_s);
  require_positive("axial_depth_m", axial_depth_m, "m");
  require_affordable(cost_of_looks(problem, {}, std::array{spindle_speed_rad_per_s}, {.a_speed = 2.0 * looks_a_limit}));
  return BlockSearch(problem, {spindle_speed_rad_per_s, axial_depth_m}, options).run();
}

}  // namespace robomill::stability
