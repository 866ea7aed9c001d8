#pragma once
#include <array>
#include <cstddef>
#include <span>

#include "robomill/stability/eigen/arnoldi.hpp"
#include "robomill/stability/lobes.hpp"
#include "robomill/stability/point_evaluator.hpp"
#include "robomill/stability/time_steps/cut_steps.hpp"
#include "robomill/stability/time_steps/monodromy.hpp"
#include "robomill/stability/time_steps/speed_plan.hpp"
#include "robomill/stability/time_steps/step_motion.hpp"
#include "robomill/stability/vibration/motion.hpp"
#include "robomill/stability/vibration/tip_dynamics.hpp"

namespace robomill::stability::detail {

/// What a multiplier and its motion say of a point, without an estimate.
Outcome outcome_of(const Dominant& found, const Motion& motion);

/// Everything about a problem that no point of the chart changes. Shared by threads.
struct Model {
  Model(const LobesProblem& problem, int intervals) : tip(tip_dynamics(problem)), cut(problem.milling, intervals) {}
  TipDynamics tip;
  CutSteps cut;
};

/// One thread's means to find multipliers, eight points at a time; nothing is allocated from the second time on.
class Evaluator {
 public:
  /// model must outlive this.
  explicit Evaluator(const Model& model, const ArnoldiOptions& options = {})
      : model_(model), monodromy_(model.tip, model.cut), arnoldi_(options) {}

  struct Point {
    double spindle_speed_rad_per_s = 0.0;
    double axial_depth_m = 0.0;
    const DepthPlan* plan = nullptr;  ///< of this depth, where there is one already
  };
  /// One to eight points; out has as many.
  void evaluate(std::span<const Point> points, std::span<Dominant> out);
  /// Of the points of the last evaluate.
  void describe(std::span<const Dominant> dominant, std::span<Motion> out);

 private:
  const Model& model_;
  Monodromy monodromy_;
  Arnoldi arnoldi_;
  std::array<SpeedPlan, lane_count> speeds_;
  std::array<DepthPlan, lane_count> depths_;
  std::array<LanePoint, lane_count> points_;
  StepMotion motion_;
};

}  // namespace robomill::stability::detail
