#pragma once
#include <cstddef>
#include <cstdint>
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
  std::uint64_t most_points = 1'000'000;  ///< that are evaluated or interpolated; at least those of the coarse grid
  bool interpolate = true;                ///< where that gives the sign, see trace_boundary; false: all is evaluated

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

/// Numbers of points near each other differ by strides.
struct GridPointHash {
  std::size_t operator()(std::uint64_t point) const noexcept {
    point *= 0x9E3779B97F4A7C15U;
    return static_cast<std::size_t>(point ^ (point >> 32U));
  }
};

}  // namespace robomill::jobs
