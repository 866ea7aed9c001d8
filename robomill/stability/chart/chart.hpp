#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/stability/chart/edges.hpp"
#include "robomill/stability/point_evaluator.hpp"

namespace robomill::stability::detail {

struct Count {
  long long evaluations = 0, unsettled = 0;
  void add(const PointEvaluator& evaluator) {
    evaluations += evaluator.evaluations();
    unsettled += evaluator.unsettled();
  }
  void add(const Count& other) {
    evaluations += other.evaluations;
    unsettled += other.unsettled;
  }
};

/// Where a chart is looked at.
struct Axes {
  std::vector<double> spindle_speed_rad_per_s, axial_depth_m;
  std::size_t fine = 1;  ///< columns: every n-th depth is evaluated, the others show where a limit lies between
  [[nodiscard]] OperatingPoint at(std::size_t speed, std::size_t depth) const {
    return {spindle_speed_rad_per_s[speed], axial_depth_m[depth]};
  }
};

/// The options' grid.
Axes even_axes(const LobesOptions& options);
Eigen::VectorXd to_eigen(const std::vector<double>& values);
std::vector<double> even(const std::array<double, 2>& range, int count);

/// Spectral radius on the grid, a row a depth. A node that nobody had to look at has the stability of its surroundings
/// and the value NaN in `radius`.
struct GridRadii {
  Eigen::MatrixXd radius;
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> unstable;
  long long uncertain = 0;  ///< nodes whose error estimate stays above the tolerance
  [[nodiscard]] bool known(Eigen::Index depth, Eigen::Index speed) const {
    return radius(depth, speed) == radius(depth, speed);
  }
};

/// Every node; to the tolerance where one is given.
GridRadii evaluate_grid(const Scheme& scheme, const Axes& axes, std::optional<double> tolerance, Count& count,
                        Progress& progress);

/// The nodes that the boundary needs. Cells of several nodes' width are looked at by their corners, and cut in four
/// where a boundary passes, where it passes on a neighbour's side, and where the radius comes so near to 1, by its own
/// slope there, that an island could hide inside.
GridRadii find_boundary_nodes(const Scheme& scheme, const Axes& axes, Count& count, Progress& progress);

/// The boundary as curves: where it cuts the edges of the grid, refined to the tolerance, strung together cell by cell.
std::vector<BoundaryPoint> string_boundary(const Scheme& scheme, const Axes& axes, const GridRadii& grid,
                                           double tolerance, Count& count, Progress& progress);

/// The lowest unstable depth at each speed of a grid; taken from its boundary where that is known.
std::vector<Limit> grid_limits(const Scheme& scheme, const Axes& axes, const GridRadii& grid,
                               const std::vector<BoundaryPoint>& boundary, double tolerance, Count& count,
                               Progress& progress);

Limit limit_at(const BoundaryPoint& point);
/// Already unstable at the least depth.
Limit limit_at_start(PointEvaluator& evaluator, const OperatingPoint& point);

/// The options' depths at these speeds, for columns.
Axes column_axes(const LobesOptions& options, std::vector<double> spindle_speed_rad_per_s);
/// The same without a grid, of the speeds first to last - 1: depths are looked at from the lowest up to the first that
/// is unstable, those between two that are alike and far from unstable left out. Where axes are fine a limit is known
/// when it lies between two neighbouring depths: on a straight line of ln |μ| between these, without an estimate.
std::vector<Limit> limits_between(PointEvaluator& evaluator, const Axes& axes, std::size_t first, std::size_t last,
                                  double tolerance, const Progress& progress);
/// Of all speeds, on all threads:
std::vector<Limit> column_limits(const Scheme& scheme, const Axes& axes, double tolerance, Count& count,
                                 Progress& progress);

}  // namespace robomill::stability::detail
