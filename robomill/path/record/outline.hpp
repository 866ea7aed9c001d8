#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/program/program.hpp"

// Method: robomill/path/README.md, "What is recorded for a page"

namespace robomill::path {

/// A corner of a program that is worth a close look.
struct ProgramCorner {
  std::size_t block = 0;  ///< of the move into it, from 0
  std::size_t line = 0;
  double turn_rad = 0.0;
  double radius_m = 0.0;  ///< how far to look
  Eigen::Vector3d corner_m = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 2, 3> plane = Eigen::Matrix<double, 2, 3>::Zero();  ///< rows: along the way, to the inside
  Eigen::Matrix2Xd vertices_m = {};                                         ///< 2 x n, the moves near it, in the plane
};

/// A program in short: its path and its sharpest corners.
struct ProgramOutline {
  Eigen::Matrix3Xd path_m = {};             ///< 3 x n, every so many of its points
  std::vector<ProgramCorner> corners = {};  ///< in the program's order, no two at one place
  std::size_t blocks = 0;
};

/// Reads a program once, in memory that does not grow with it. Corners are weighed by (1 − cos turn) × the shorter of
/// their moves; of each sixth of the turns the heaviest come first.
/// @param corners  at most so many
[[nodiscard]] ROBOMILL_API ProgramOutline outline(program::Source& source, double tip_tolerance_m,
                                                  std::size_t corners = 6);

/// Some of a long row of things in their order: all of them up to twice `most`, then every second, fourth, … one.
template <class T>
class Decimated {
 public:
  explicit Decimated(std::size_t most) : most_(most) {}
  void add(const T& value) {
    if (count_++ % step_ != 0) return;
    kept_.push_back(value);
    if (kept_.size() < 2 * most_) return;
    for (std::size_t i = 0; i < most_; ++i) kept_[i] = kept_[2 * i];
    kept_.resize(most_);
    step_ *= 2;
  }
  [[nodiscard]] const std::vector<T>& kept() const { return kept_; }

 private:
  std::size_t most_, count_ = 0, step_ = 1;
  std::vector<T> kept_;
};

}  // namespace robomill::path
