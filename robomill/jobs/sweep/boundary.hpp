#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

// Method: robomill/jobs/README.md, "A boundary (`sweep/boundary.hpp`)"

namespace robomill::jobs {

/// A parameter and the coarse grid along it.
struct BoundaryAxis {
  double low = 0.0, high = 1.0;  ///< in any unit; low < high
  int count = 2;                 ///< points of the coarse grid, both ends among them, >= 2
};

struct BoundaryOptions {
  std::vector<BoundaryAxis> axes = {};    ///< 1 to 8
  int halvings = 4;                       ///< of the coarse grid's steps, 0 to 20
  std::uint64_t most_points = 1'000'000;  ///< that are evaluated; at least those of the coarse grid

  /// @throws InvalidInput naming the member
  void validate() const;
};

/// The finest grid. A point is one number: its places along the axes, the last of which counts fastest.
class BoundaryGrid {
 public:
  /// @throws InvalidInput as BoundaryOptions::validate
  explicit BoundaryGrid(const BoundaryOptions& options);

  [[nodiscard]] std::size_t axes() const { return axes_.size(); }
  [[nodiscard]] std::uint64_t stride(std::size_t axis) const { return strides_[axis]; }
  /// Points along an axis.
  [[nodiscard]] std::uint64_t count(std::size_t axis) const { return counts_[axis]; }
  [[nodiscard]] std::uint64_t place(std::uint64_t point, std::size_t axis) const {
    return point / strides_[axis] % counts_[axis];
  }
  /// At a place along an axis: at those of the coarse grid the bits do not depend on the halvings.
  [[nodiscard]] double at(std::size_t axis, double place) const;
  [[nodiscard]] double coordinate(std::uint64_t point, std::size_t axis) const {
    return at(axis, static_cast<double>(place(point, axis)));
  }
  /// Of a grid whose steps are so many of the finest.
  [[nodiscard]] double points_of(std::uint64_t step) const;

 private:
  std::vector<BoundaryAxis> axes_;
  std::vector<std::uint64_t> counts_, strides_;
};

/// The values of a function at new points of the finest grid, which rise; one each, NaN where it has none. It may
/// compute them in any order, on any number of threads.
using BoundaryValues = std::function<std::vector<double>(std::span<const std::uint64_t> points)>;

struct Boundary {
  /// Where f = 0, a row a point, a column an axis: on each edge of the cubes whose ends have different signs, between
  /// them linearly; in the middle where an end is infinite.
  Eigen::MatrixXd points = {};
  std::vector<std::uint64_t> cubes = {};  ///< that the boundary crosses: their lowest corners, which rise
  std::uint64_t step = 1;                 ///< edge of these cubes, in steps of the finest grid
  std::uint64_t evaluations = 0;
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
/// signs: f >= 0 and f < 0; a corner of NaN has none. To halve the steps, the middles of the kept cubes' edges that
/// change sign are evaluated; of the smaller cubes those at the halves that change sign are kept, and, from them on,
/// the neighbours across each face whose corners change sign: so a branch is followed where the coarse grid missed it.
/// Of a cube that has no part then, since a value there is NaN, all parts are evaluated. Each point is evaluated once.
/// Results depend on the values alone.
///
/// Not seen: what changes no sign at a corner of the coarse grid and is not connected to what does, as a closed surface
/// within one coarse cube; a set where f touches 0 without a change of sign.
///
/// Where the next points would be more than most_points, nothing more is evaluated, and the boundary is that of the
/// last halving that was done to its end.
/// @throws InvalidInput as BoundaryOptions::validate; if the function gives another number of values
[[nodiscard]] Boundary trace_boundary(const BoundaryOptions& options, const BoundaryValues& values);

}  // namespace robomill::jobs
