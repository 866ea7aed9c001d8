#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "robomill/stability/point_evaluator.hpp"
#include "robomill/stability/time_steps/discretizations.hpp"
#include "robomill/stability/time_steps/evaluator.hpp"

namespace robomill::stability::detail {
namespace {

/// Semi-discretization's evaluator as the chart wants it. Of the order 2, so that four thirds of what a run at twice
/// the intervals differs by is the error.
class SteppedEvaluator final : public PointEvaluator {
 public:
  SteppedEvaluator(const LobesProblem& problem, int intervals, const Model& model, const KnownDepths& depths)
      : problem_(problem), intervals_(intervals), depths_(depths), evaluator_(model) {}

  void evaluate(std::span<const OperatingPoint> points, Ask ask, std::span<Outcome> out) override {
    std::array<Evaluator::Point, lane_count> at;
    std::array<Dominant, lane_count> found;
    std::array<Motion, lane_count> motion;
    const std::size_t size = points.size();
    for (std::size_t i = 0; i < size; ++i) {
      at[i] = {points[i].spindle_speed_rad_per_s, points[i].axial_depth_m, depths_.find(points[i].axial_depth_m)};
    }
    evaluator_.evaluate(std::span(at).first(size), std::span(found).first(size));
    if (ask.motion) evaluator_.describe(std::span(found).first(size), std::span(motion).first(size));
    for (std::size_t i = 0; i < size; ++i) {
      out[i] = outcome_of(found[i], motion[i]);
      if (found[i].by == Dominant::By::unsettled) ++unsettled_;
    }
    evaluations_ += static_cast<long long>(size);
    if (ask.estimate) estimate(std::span(at).first(size), out);
  }

 private:
  void estimate(std::span<Evaluator::Point> points, std::span<Outcome> out) {
    if (!fine_) {
      fine_model_.emplace(problem_, 2 * intervals_);
      fine_.emplace(*fine_model_);
    }
    std::array<Dominant, lane_count> finer;
    for (Evaluator::Point& point : points) point.plan = nullptr;
    fine_->evaluate(points, std::span(finer).first(points.size()));
    evaluations_ += static_cast<long long>(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      out[i].error_estimate = 4.0 / 3.0 * std::abs(spectral_radius(finer[i]) - out[i].spectral_radius);
    }
  }

  const LobesProblem& problem_;
  int intervals_;
  const KnownDepths& depths_;
  Evaluator evaluator_;
  std::optional<Model> fine_model_;
  std::optional<Evaluator> fine_;
};

class SemiDiscretization final : public Scheme {
 public:
  SemiDiscretization(const LobesProblem& problem, int intervals)
      : problem_(problem), intervals_(intervals), model_(problem, intervals) {}

  [[nodiscard]] std::unique_ptr<PointEvaluator> evaluator() const override {
    return std::make_unique<SteppedEvaluator>(problem_, intervals_, model_, depths_);
  }
  [[nodiscard]] Period period() const override { return model_.cut.period(); }
  void expect(std::span<const double> depths_m, bool) override { depths_.expect(model_.cut, depths_m); }

 private:
  LobesProblem problem_;
  int intervals_;
  Model model_;
  KnownDepths depths_;
};

}  // namespace

std::unique_ptr<Scheme> semi_discretization(const LobesProblem& problem, int intervals) {
  reject_changing_delays(problem.milling, "semi-discretization");
  return std::make_unique<SemiDiscretization>(problem, intervals);
}

}  // namespace robomill::stability::detail
