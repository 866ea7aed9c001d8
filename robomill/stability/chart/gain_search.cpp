#include "robomill/stability/chart/gain_search.hpp"

#include <array>
#include <limits>

#include "robomill/stability/chart/chart.hpp"

namespace robomill::stability::detail {
namespace {

constexpr double least_gain = 1e-3;
constexpr double most_gain = 1e3;
constexpr double step = 1.1;

/// A point's gains in the place of a chart's depths.
class GainColumn final : public PointEvaluator {
 public:
  GainColumn(PointEvaluator& evaluator, const OperatingPoint& point) : evaluator_(evaluator), point_(point) {}
  void evaluate(std::span<const OperatingPoint> points, Ask ask, std::span<Outcome> out) override {
    std::array<OperatingPoint, lane_count> scaled;
    for (std::size_t i = 0; i < points.size(); ++i) {
      scaled[i] = point_;
      scaled[i].gain = points[i].axial_depth_m;
    }
    evaluator_.evaluate(std::span(scaled).first(points.size()), ask, out);
  }

 private:
  PointEvaluator& evaluator_;
  OperatingPoint point_;
};

}  // namespace

PointResult point_result(PointEvaluator& evaluator, const OperatingPoint& point) {
  Outcome outcome;
  evaluator.evaluate({&point, 1}, {.estimate = true, .motion = true}, {&outcome, 1});
  PointResult result;
  result.spindle_speed_rad_per_s = point.spindle_speed_rad_per_s;
  result.axial_depth_m = point.axial_depth_m;
  result.spectral_radius = outcome.spectral_radius;
  result.multiplier = outcome.multiplier;
  result.stable = result.spectral_radius < 1.0;
  result.error_estimate = outcome.error_estimate;
  result.chatter_frequency_hz = outcome.chatter_frequency_hz;
  result.kind = outcome.kind;
  result.mode = outcome.mode;
  return result;
}

GainMargin search_gain(PointEvaluator& evaluator, const OperatingPoint& point, double tolerance,
                       const Progress& progress) {
  GainColumn column(evaluator, point);
  Axes axes = {{point.spindle_speed_rad_per_s}, {}};
  for (double gain = least_gain; gain < most_gain; gain *= step) axes.axial_depth_m.push_back(gain);
  axes.axial_depth_m.push_back(most_gain);
  const Limit limit = limits_between(column, axes, 0, 1, tolerance, progress).front();
  if (limit.status == Limit::Status::stable_in_range) return {};
  const bool below = limit.axial_depth_m <= least_gain;
  return {.status = below ? GainMargin::Status::below_range : GainMargin::Status::found, .gain = limit.axial_depth_m};
}

double gain_of(const GainMargin& margin) {
  return margin.status == GainMargin::Status::unconditionally_stable ? std::numeric_limits<double>::infinity()
                                                                     : margin.gain;
}

}  // namespace robomill::stability::detail
