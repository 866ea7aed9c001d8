#pragma once
#include "robomill/base/progress.hpp"
#include "robomill/stability/point_evaluator.hpp"
#include "robomill/stability/sweep.hpp"

namespace robomill::stability::detail {

/// One point in full, to the tolerance of its evaluator.
PointResult point_result(PointEvaluator& evaluator, const OperatingPoint& point);

/// The smallest gain with the spectral radius 1 at one point.
GainMargin search_gain(PointEvaluator& evaluator, const OperatingPoint& point, double tolerance,
                       const Progress& progress);
/// Infinity where no gain is unstable; the range's start where all are.
double gain_of(const GainMargin& margin);

}  // namespace robomill::stability::detail
