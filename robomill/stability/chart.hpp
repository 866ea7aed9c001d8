#pragma once
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/stability/evaluator.hpp"
#include "robomill/stability/lobes.hpp"

namespace robomill::stability::detail {

/// A line between two points of the chart, one stable and one not.
struct Edge {
  OperatingPoint from, to;
  double radius_from = 0.0, radius_to = 0.0;
};

/// Finds on each edge a point where |spectral radius - 1| <= tolerance, by regula falsi that halves where it drags.
std::vector<BoundaryPoint> refine(Evaluator& evaluator, const std::vector<Edge>& edges, double tolerance,
                                  const Progress& progress);

/// What one spindle speed shows over the depths of the grid.
struct Column {
  std::vector<double> spectral_radius;  ///< Look::limit: up to the first unstable depth and a little beyond
  std::vector<BoundaryPoint> boundary;  ///< by depth; the lowest alone but for Look::boundary
  Limit limit;
};

/// What is wanted of a column: the lowest change of stability alone, that and the spectral radius at every depth, or
/// that and every change of stability.
enum class Look { limit, map, boundary };

/// @param plans  of the depths, or empty
Column column(Evaluator& evaluator, double spindle_speed_rad_per_s, const std::vector<double>& depths_m,
              const std::vector<DepthPlan>& plans, double tolerance, Look look, const Progress& progress);

}  // namespace robomill::stability::detail
