#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "robomill/cutting/dexels/workpiece_sweep.hpp"

namespace robomill::cutting {

/// Parallel rays along one axis and the material on them: the first interval of a ray stands in place, further ones in
/// a pool of its row, so that rows can be cut by different threads.
class Rays {
 public:
  /// Cell centres of the box between two corners.
  Rays(int axis, const Eigen::Vector3d& lowest, const Eigen::Vector3d& spacing,
       const Eigen::Array<std::ptrdiff_t, 3, 1>& cells);

  [[nodiscard]] int axis() const { return axis_; }
  [[nodiscard]] int column_axis() const { return axis_ == 0 ? 1 : 0; }
  [[nodiscard]] int row_axis() const { return axis_ == 2 ? 1 : 2; }
  [[nodiscard]] std::ptrdiff_t columns() const { return columns_; }
  [[nodiscard]] std::ptrdiff_t rows() const { return rows_; }
  /// A point on a ray, its coordinate along the ray zero.
  [[nodiscard]] Eigen::Vector3d point(std::ptrdiff_t row, std::ptrdiff_t column) const;
  /// Columns (rows) whose centres lie in a range; first > last where there is none.
  struct Range {
    std::ptrdiff_t first = 0, last = -1;
  };
  [[nodiscard]] Range columns_in(const Span& span) const { return cells_in(span, column_axis(), columns_); }
  [[nodiscard]] Range rows_in(const Span& span) const { return cells_in(span, row_axis(), rows_); }
  [[nodiscard]] double column_spacing() const { return spacing_[column_axis()]; }
  [[nodiscard]] double cell_area() const { return spacing_[column_axis()] * spacing_[row_axis()]; }

  void add(std::ptrdiff_t row, std::ptrdiff_t column, const Span& span);  ///< behind what stands there
  [[nodiscard]] bool touches(std::ptrdiff_t row, std::ptrdiff_t column, const Span& span) const;
  /// Takes a span away. @param cut  gets the parts that were material @return their length
  double cut(std::ptrdiff_t row, std::ptrdiff_t column, const Span& span, std::vector<Span>& cut);
  /// Distance to the nearest end of material along the ray, > 0 within, cut off at ±limit.
  [[nodiscard]] double depth(std::ptrdiff_t row, std::ptrdiff_t column, double at, double limit) const;
  /// The same between the four rays about a point; `spread` is how much they differ.
  [[nodiscard]] double depth(const Eigen::Vector3d& point, double limit, double& spread) const;
  /// What that lacks where the surface is curved: straight lines between rays cut off its bends.
  [[nodiscard]] double bend(const Eigen::Vector3d& point, double limit) const;
  [[nodiscard]] double volume() const;
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  static constexpr std::uint32_t nil = 0xffffffffU;
  struct Ray {
    double from = 0.0, to = 0.0;  ///< empty: from >= to
    std::uint32_t next = nil;
  };
  struct Pool {
    std::vector<Ray> nodes;
    std::uint32_t free = nil;
  };
  [[nodiscard]] Range cells_in(const Span& span, int axis, std::ptrdiff_t count) const;
  [[nodiscard]] std::size_t index(std::ptrdiff_t row, std::ptrdiff_t column) const {
    return static_cast<std::size_t>(row * columns_ + column);
  }
  static std::uint32_t take(Pool& pool, const Ray& node);
  /// A point among the rays: the ray below it and the shares of the way to the next ones.
  struct Place {
    std::ptrdiff_t column = 0, row = 0;
    double across_columns = 0.0, across_rows = 0.0;
  };
  [[nodiscard]] Place place_of(const Eigen::Vector3d& point) const;

  int axis_;
  Eigen::Vector3d lowest_, spacing_;
  std::ptrdiff_t columns_, rows_;
  std::vector<Ray> rays_;
  std::vector<Pool> pools_;  ///< by row
};

}  // namespace robomill::cutting
