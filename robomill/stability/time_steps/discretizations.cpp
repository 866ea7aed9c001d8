#include "robomill/stability/time_steps/discretizations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/stability/time_steps/evaluator.hpp"
#include "robomill/stability/time_steps/node_steps.hpp"
#include "robomill/stability/time_steps/step_motion.hpp"

namespace robomill::stability::detail {
namespace {

using MakeSteps = std::unique_ptr<NodeSteps> (*)(const TipDynamics&, int);

/// Everything about a problem that no point of the chart changes. Shared by threads.
struct NodeModel {
  NodeModel(const LobesProblem& problem, int intervals, MakeSteps make)
      : tip(tip_dynamics(problem)), halves(problem.milling, 2 * intervals), steps(intervals), make_steps(make) {}
  TipDynamics tip;
  CutSteps halves;  ///< two to a step
  int steps;
  MakeSteps make_steps;
};

/// Multipliers of eight points at a time.
class NodeEvaluator {
 public:
  NodeEvaluator(const NodeModel& model, const KnownDepths& depths)
      : model_(model), depths_(depths), map_(model.make_steps(model.tip, model.steps)) {}

  void find(std::span<const OperatingPoint> points, std::span<Dominant> out) {
    for (std::size_t lane = 0; lane < points.size(); ++lane) {
      points_[lane].step_s = 2.0 * model_.halves.step_rad() / points[lane].spindle_speed_rad_per_s;
      points_[lane].halves = depths_.find(points[lane].axial_depth_m);
      if (points_[lane].halves != nullptr) continue;
      if (lane > 0 && points[lane].axial_depth_m == points[lane - 1].axial_depth_m) {
        points_[lane].halves = points_[lane - 1].halves;
        continue;
      }
      model_.halves.at_depth(points[lane].axial_depth_m, plans_[lane]);
      points_[lane].halves = &plans_[lane];
    }
    map_->prepare(std::span(points_).first(points.size()));
    arnoldi_.find(*map_, out);
  }

  /// Of the points of the last find.
  void describe(std::span<const Dominant> dominant, std::span<Motion> out) {
    std::array<double, lane_count> step_s = {};
    for (std::size_t lane = 0; lane < dominant.size(); ++lane) step_s[lane] = points_[lane].step_s;
    motion_.find(model_.tip, model_.steps, step_s, *map_, arnoldi_, dominant, out);
  }

 private:
  const NodeModel& model_;
  const KnownDepths& depths_;
  std::unique_ptr<NodeSteps> map_;
  Arnoldi arnoldi_;
  StepMotion motion_;
  std::array<DepthPlan, lane_count> plans_;
  std::array<NodePoint, lane_count> points_;
};

/// As the chart wants it. Of the order 2, so that four thirds of what a run at twice the intervals differs by is the
/// error.
class NodePointEvaluator final : public PointEvaluator {
 public:
  NodePointEvaluator(const LobesProblem& problem, const NodeModel& model, const KnownDepths& depths)
      : problem_(problem), model_(model), evaluator_(model, depths) {}

  void evaluate(std::span<const OperatingPoint> points, Ask ask, std::span<Outcome> out) override {
    const std::size_t size = points.size();
    std::array<Dominant, lane_count> found;
    std::array<Motion, lane_count> motion;
    evaluator_.find(points, std::span(found).first(size));
    if (ask.motion) evaluator_.describe(std::span(found).first(size), std::span(motion).first(size));
    for (std::size_t i = 0; i < size; ++i) {
      out[i] = outcome_of(found[i], motion[i]);
      if (found[i].by == Dominant::By::unsettled) ++unsettled_;
    }
    evaluations_ += static_cast<long long>(size);
    if (ask.estimate) estimate(points, out);
  }

 private:
  void estimate(std::span<const OperatingPoint> points, std::span<Outcome> out) {
    if (!fine_) {
      fine_model_.emplace(problem_, 2 * model_.steps, model_.make_steps);
      fine_.emplace(*fine_model_, no_depths_);
    }
    std::array<Dominant, lane_count> finer;
    fine_->find(points, std::span(finer).first(points.size()));
    evaluations_ += static_cast<long long>(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      out[i].error_estimate = 4.0 / 3.0 * std::abs(spectral_radius(finer[i]) - out[i].spectral_radius);
    }
  }

  const LobesProblem& problem_;
  const NodeModel& model_;
  NodeEvaluator evaluator_;
  KnownDepths no_depths_;
  std::optional<NodeModel> fine_model_;
  std::optional<NodeEvaluator> fine_;
};

class NodeScheme final : public Scheme {
 public:
  NodeScheme(const LobesProblem& problem, int intervals, MakeSteps make)
      : problem_(problem), model_(problem, intervals, make) {}

  [[nodiscard]] std::unique_ptr<PointEvaluator> evaluator() const override {
    return std::make_unique<NodePointEvaluator>(problem_, model_, depths_);
  }
  [[nodiscard]] Period period() const override { return Period::tooth; }
  void expect(std::span<const double> depths_m, bool) override { depths_.expect(model_.halves, depths_m); }

 private:
  LobesProblem problem_;
  NodeModel model_;
  KnownDepths depths_;
};

void reject(bool asked, const char* field, std::string_view method, const char* what) {
  if (!asked) return;
  throw InvalidInput(field, "does not go with " + std::string(method) + ": " + what, "Take method = \"collocation\"");
}

std::unique_ptr<Scheme> make(const LobesProblem& problem, int intervals, std::string_view method, MakeSteps make) {
  reject_changing_delays(problem.milling, method);
  reject(!problem.milling.tool.has_equal_pitch(), "pitch_rad", method, "it has a single delay");
  return std::make_unique<NodeScheme>(problem, intervals, make);
}

}  // namespace

void reject_changing_delays(const cutting::Milling& milling, std::string_view method) {
  reject(!milling.tool.has_equal_helix(), "tooth_helix_rad", method, "its delays do not change with height");
  reject(milling.tool.runout_m > 0.0, "runout_m", method, "it has no missed cuts");
  reject(milling.process_damping.active(), "indentation_n_per_m3", method, "it has no process damping");
  reject(milling.speed_variation.active(), "amplitude_ratio", method, "its speed is constant");
}

std::unique_ptr<Scheme> first_order_semi_discretization(const LobesProblem& problem, int intervals) {
  return make(problem, intervals, "semi-discretization", first_order_steps);
}

std::unique_ptr<Scheme> full_discretization(const LobesProblem& problem, int intervals) {
  return make(problem, intervals, "full-discretization", full_steps);
}

}  // namespace robomill::stability::detail
