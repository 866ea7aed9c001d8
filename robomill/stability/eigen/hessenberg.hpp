#pragma once
#include <complex>
#include <cstddef>
#include <vector>

namespace robomill::stability::detail {

/// The eigenvalue of greatest modulus of a small upper Hessenberg matrix and its vector. Many such matrices are solved
/// one after the other, so that storage is kept and nothing but what is asked for is found.
class Hessenberg {
 public:
  /// Makes room for a size x size matrix, all zero.
  void resize(std::size_t size);
  [[nodiscard]] std::size_t size() const { return size_; }
  double& operator()(std::size_t row, std::size_t column) { return matrix_[row * size_ + column]; }
  /// Frobenius norm.
  [[nodiscard]] double norm() const;
  /// Of a pair, the one with imaginary part > 0. False where the iteration did not end. Francis' double-shift QR on the
  /// active window alone, after a balancing by powers of two has nothing to do: a Krylov basis is orthonormal.
  /// Source: [GolubVanLoan2013] section 7.5.
  bool dominant(std::complex<double>& value);
  /// Unit vector y with (matrix - value) y = 0, by inverse iteration.
  const std::vector<std::complex<double>>& vector(std::complex<double> value);

 private:
  bool deflate(std::size_t high, std::size_t& low);
  void sweep(std::size_t low, std::size_t high, int iteration);
  void solve_shifted(std::complex<double> value, double smallest);

  std::size_t size_ = 0;
  std::vector<double> matrix_, work_;
  std::vector<double> real_, imaginary_, real_side_, imaginary_side_;
  std::vector<std::complex<double>> vector_;
};

}  // namespace robomill::stability::detail
