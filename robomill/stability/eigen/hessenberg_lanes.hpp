#pragma once
#include <array>
#include <complex>
#include <cstddef>
#include <vector>

#include "robomill/base/lanes.hpp"

namespace robomill::stability::detail {

/// Where the QR iteration of eight Hessenberg matrices stands: each lane has a window of its own that it works on.
struct HessenbergArguments {
  std::size_t size = 0;
  std::size_t stride = 0;  ///< from row to row of the matrix
  Lanes* matrix = nullptr;
  Lanes low = {}, high = {};     ///< first and last row of each lane's window; a lane with low = high rests
  Lanes x = {}, y = {}, z = {};  ///< of a sweep: first column of the shifted square
};
/// Finds where the unreduced window that ends at `high` starts, into `low`, and zeroes the subdiagonal entry above it.
void find_windows(HessenbergArguments& a);
/// One double-shift step on rows and columns low … high of each lane.
void sweep_windows(HessenbergArguments& a);

/// The eigenvalue of greatest modulus of eight small upper Hessenberg matrices at once, one a lane: as
/// Hessenberg::dominant finds it, with the same digits. What is found in one lane does not depend on the others.
class HessenbergLanes {
 public:
  /// Makes room for size x size matrices, all zero.
  void resize(std::size_t size);
  Lanes& operator()(std::size_t row, std::size_t column) { return matrix_[row * stride_ + column]; }
  /// Of the lanes that are wanted; of a pair, the one with imaginary part > 0. False where the iteration did not end or
  /// the matrix is not finite. The matrices are used up.
  std::array<bool, lane_count> dominant(const std::array<bool, lane_count>& wanted,
                                        std::array<std::complex<double>, lane_count>& value);

 private:
  struct Lane {
    std::size_t end = 0;  ///< rows that are left
    int iteration = 0;
    double unit = 1.0, largest = -1.0;
    bool works = false;
  };
  double scale(std::size_t lane);
  bool deflate(std::size_t lane, std::complex<double>& value);
  void find_window(std::size_t lane);
  void shift(std::size_t lane);

  std::size_t size_ = 0, stride_ = 0;
  std::vector<Lanes> matrix_;
  std::array<Lane, lane_count> lanes_;
  HessenbergArguments arguments_;
};

}  // namespace robomill::stability::detail
