#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "robomill/jobs/sweep/boundary_grid.hpp"

// Method: robomill/jobs/README.md, "A boundary (`sweep/boundary.hpp`)"

namespace robomill::jobs {

/// The values of a function at new points of the finest grid, which rise; one each, NaN where it has none. It may
/// compute them in any order, on any number of threads.
using BoundaryValues = std::function<std::vector<double>(std::span<const std::uint64_t> points)>;

struct Boundary {
  /// Where f = 0, a row a point, a column an axis: on each edge of the cubes whose ends have different signs, between
  /// their values linearly; in the middle where an end is infinite.
  Eigen::MatrixXd points = {};
  std::vector<std::uint64_t> cubes = {};  ///< that the boundary crosses: their lowest corners, which rise
  std::uint64_t step = 1;                 ///< edge of these cubes, in steps of the finest grid
  std::uint64_t evaluations = 0;
  std::uint64_t interpolated = 0;   ///< further points, whose signs were taken from the values around them
  std::uint64_t compared = 0;       ///< evaluations at points that had an interpolated value, too
  std::uint64_t beyond_error = 0;   ///< of them, further from it than its estimated error
  double grid_points = 0.0;         ///< that a grid with these steps has
  std::uint64_t unknown = 0;        ///< points whose value is NaN
  std::uint64_t lost_cubes = 0;     ///< crossed before a halving, and in no part after it: NaN hides the crossing
  std::uint64_t middle_points = 0;  ///< of `points`, those in the middle of an edge
  /// All halvings are done; otherwise most_points was reached.
  bool complete = true;
};

/// Traces the set f = 0 of a function of several parameters by bisection of cubes [Bachrathy2012].
///
/// All points of the coarse grid are evaluated. A cube of the grid is kept where two of its corners have different
/// signs: f >= 0 and f < 0; a corner of NaN has none. To halve the steps, values are found at the middles of the kept
/// cubes' edges that change sign; of the smaller cubes those at the halves that change sign are kept, and, from them
/// on, the neighbours across each face whose corners change sign: so a branch is followed where the coarse grid missed
/// it. Of a cube that has no part then, since a value there is NaN, the values of all parts are found. Each point is
/// evaluated at most once. Results depend on the values alone.
///
/// A value is found by evaluation or, from the second halving on, by interpolation (GridValues::interpolated): where
/// that is further from 0 than its estimated error, only its sign being wanted. Points between those of the coarser
/// grid along fewer axes come first. Where an evaluated value differs by more than the estimate, or is NaN, the
/// interpolated corners of the cubes around it whose sign so great an error could change are evaluated, too.
///
/// A sign that interpolation has wrong and no evaluation next to it shows adds or hides cubes there, also in the
/// halvings after it. A region of NaN that is narrower than the steps of a halving may be interpolated across.
///
/// Not seen: what changes no sign at a corner of the coarse grid and is not connected to what does, as a closed surface
/// within one coarse cube; a set where f touches 0 without a change of sign.
///
/// Where the next points would be more than most_points, nothing more is evaluated, and the boundary is that of the
/// last halving that was done to its end.
/// @throws InvalidInput as BoundaryOptions::validate; if the function gives another number of values
[[nodiscard]] Boundary trace_boundary(const BoundaryOptions& options, const BoundaryValues& values);

}  // namespace robomill::jobs
