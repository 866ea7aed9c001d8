#pragma once
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/stability/point_evaluator.hpp"

namespace robomill::stability::detail {

/// A line between two points of the chart, one stable and one not.
struct Edge {
  OperatingPoint from, to;
  double radius_from = 0.0, radius_to = 0.0;
};

BoundaryPoint boundary_point(const OperatingPoint& point, const Outcome& outcome);

/// Finds on each edge a point where |spectral radius - 1| <= tolerance, by the Illinois rule on the radius' logarithm
/// that halves where it drags. Source: [DowellJarratt1971].
std::vector<BoundaryPoint> refine(PointEvaluator& evaluator, const std::vector<Edge>& edges, double tolerance,
                                  const Progress& progress);

}  // namespace robomill::stability::detail
