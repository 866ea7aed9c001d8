#include "robomill/stability/eigen/hessenberg.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace robomill::stability::detail {
namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// I - w v^T with v = (1, v1, v2), which turns (x, y, z) into (-length, 0, 0).
struct Reflector {
  double length, v1, v2, w0, w1, w2;

  Reflector(double x, double y, double z, double square) : length(std::copysign(std::sqrt(square), x)) {
    const double by_first = 1.0 / (x + length);
    const double by_length = 1.0 / length;
    v1 = y * by_first;
    v2 = z * by_first;
    w0 = (x + length) * by_length;
    w1 = y * by_length;
    w2 = z * by_length;
  }
  /// From the left on three rows, or on two where row2 is null.
  void on_rows(double* __restrict row0, double* __restrict row1, double* __restrict row2, std::size_t count) const {
    for (std::size_t c = 0; row2 != nullptr && c < count; ++c) {
      const double t = row0[c] + v1 * row1[c] + v2 * row2[c];
      row0[c] -= w0 * t;
      row1[c] -= w1 * t;
      row2[c] -= w2 * t;
    }
    for (std::size_t c = 0; row2 == nullptr && c < count; ++c) {
      const double t = row0[c] + v1 * row1[c];
      row0[c] -= w0 * t;
      row1[c] -= w1 * t;
    }
  }
  /// From the right on three neighbouring columns, or on two.
  void on_columns(double* entry, std::size_t stride, std::size_t count, bool three) const {
    for (std::size_t r = 0; r < count; ++r, entry += stride) {
      const double t = w0 * entry[0] + w1 * entry[1] + (three ? w2 * entry[2] : 0.0);
      entry[0] -= t;
      entry[1] -= t * v1;
      if (three) entry[2] -= t * v2;
    }
  }
};

}  // namespace

void Hessenberg::resize(std::size_t size) {
  size_ = size;
  matrix_.assign(size * size, 0.0);
}

double Hessenberg::norm() const {
  double square = 0.0;
  for (const double entry : matrix_) square += entry * entry;
  return std::sqrt(square);
}

/// Start of the unreduced window that ends at high: zeroes the subdiagonal entry above it.
bool Hessenberg::deflate(std::size_t high, std::size_t& low) {
  const std::size_t n = size_;
  for (low = high; low > 0; --low) {
    const double below = std::abs(work_[low * n + low - 1]);
    const double around = std::abs(work_[low * n + low]) + std::abs(work_[(low - 1) * n + low - 1]);
    if (below <= epsilon * around || below < std::numeric_limits<double>::min()) {
      work_[low * n + low - 1] = 0.0;
      break;
    }
  }
  return low + 1 >= high;
}

/// One double-shift step on rows and columns low … high.
void Hessenberg::sweep(std::size_t low, std::size_t high, int iteration) {
  const std::size_t n = size_;
  double* h = work_.data();
  const auto at = [&](std::size_t r, std::size_t c) -> double& { return h[r * n + c]; };
  double sum = at(high - 1, high - 1) + at(high, high);
  double product = at(high - 1, high - 1) * at(high, high) - at(high - 1, high) * at(high, high - 1);
  if (iteration % 10 == 0) {  // an exceptional shift breaks cycles
    const double size = std::abs(at(high, high - 1)) + std::abs(at(high - 1, high - 2));
    sum = 1.5 * size;
    product = size * size;
  }
  double x = at(low, low) * at(low, low) + at(low, low + 1) * at(low + 1, low) - sum * at(low, low) + product;
  double y = at(low + 1, low) * (at(low, low) + at(low + 1, low + 1) - sum);
  double z = at(low + 1, low) * at(low + 2, low + 1);
  for (std::size_t k = low; k < high; ++k) {
    const bool three = k + 1 < high;
    // The matrix is scaled to about 1: what would underflow here is nothing beside it.
    const double square = x * x + y * y + z * z;
    if (square > 1e-280) {
      const Reflector reflector(x, y, z, square);
      if (k > low) {
        at(k, k - 1) = -reflector.length;
        at(k + 1, k - 1) = 0.0;
        if (three) at(k + 2, k - 1) = 0.0;
      }
      double* diagonal = h + k * n + k;
      reflector.on_rows(diagonal, diagonal + n, three ? diagonal + 2 * n : nullptr, high + 1 - k);
      reflector.on_columns(h + low * n + k, n, std::min(k + 3, high) + 1 - low, three);
    }
    if (k + 1 < high) {
      x = at(k + 1, k);
      y = at(k + 2, k);
      z = k + 2 < high ? at(k + 3, k) : 0.0;
    }
  }
}

bool Hessenberg::dominant(std::complex<double>& value) {
  value = 0.0;
  const double size = norm();
  if (!std::isfinite(size)) return false;
  if (size == 0.0) return true;
  const double unit = std::ldexp(1.0, std::ilogb(size));  // a power of two, so that scaling changes no digit
  work_ = matrix_;
  for (double& entry : work_) entry /= unit;
  double largest = -1.0;
  const auto consider = [&](double real, double imaginary) {
    const double square = real * real + imaginary * imaginary;
    if (square > largest) {
      largest = square;
      value = {real, imaginary};
    }
  };
  const std::size_t n = size_;
  int iteration = 0;
  for (std::size_t end = n; end > 0;) {
    const std::size_t high = end - 1;
    std::size_t low = 0;
    if (!deflate(high, low)) {
      if (++iteration > 60) return false;
      sweep(low, high, iteration);
      continue;
    }
    iteration = 0;
    if (low == high) {
      consider(work_[high * n + high], 0.0);
      end -= 1;
      continue;
    }
    const double a = work_[low * n + low], b = work_[low * n + high];
    const double c = work_[high * n + low], d = work_[high * n + high];
    const double half = 0.5 * (a - d);
    const double square = half * half + b * c;
    const double root = std::sqrt(std::abs(square));
    if (square < 0.0) {
      consider(d + half, root);
    } else {  // the larger of the two without cancellation, the other from the product
      const double away = half + std::copysign(root, half);
      consider(d + away, 0.0);
      consider(away != 0.0 ? d - b * c / away : d, 0.0);
    }
    end -= 2;
  }
  value *= unit;
  return true;
}

/// (matrix - value) x = x by elimination with a swap of neighbours, which is all that a Hessenberg matrix needs.
void Hessenberg::solve_shifted(std::complex<double> value, double smallest) {
  const std::size_t n = size_;
  real_ = matrix_;
  imaginary_.assign(n * n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    real_[k * n + k] -= value.real();
    imaginary_[k * n + k] -= value.imag();
  }
  const auto floor_pivot = [&](std::size_t k) {
    if (std::abs(real_[k * n + k]) + std::abs(imaginary_[k * n + k]) < smallest) real_[k * n + k] = smallest;
  };
  for (std::size_t k = 0; k + 1 < n; ++k) {
    double* re = real_.data() + k * n;
    double* im = imaginary_.data() + k * n;
    double* next_re = re + n;
    double* next_im = im + n;
    if (std::abs(next_re[k]) + std::abs(next_im[k]) > std::abs(re[k]) + std::abs(im[k])) {
      std::swap_ranges(re + k, re + n, next_re + k);
      std::swap_ranges(im + k, im + n, next_im + k);
      std::swap(real_side_[k], real_side_[k + 1]);
      std::swap(imaginary_side_[k], imaginary_side_[k + 1]);
    }
    floor_pivot(k);
    const double size = re[k] * re[k] + im[k] * im[k];
    const double f = (next_re[k] * re[k] + next_im[k] * im[k]) / size;
    const double g = (next_im[k] * re[k] - next_re[k] * im[k]) / size;
    for (std::size_t c = k + 1; c < n; ++c) {
      next_re[c] -= f * re[c] - g * im[c];
      next_im[c] -= f * im[c] + g * re[c];
    }
    real_side_[k + 1] -= f * real_side_[k] - g * imaginary_side_[k];
    imaginary_side_[k + 1] -= f * imaginary_side_[k] + g * real_side_[k];
  }
  floor_pivot(n - 1);
  for (std::size_t k = n; k-- > 0;) {
    const double* re = real_.data() + k * n;
    const double* im = imaginary_.data() + k * n;
    double x = real_side_[k];
    double y = imaginary_side_[k];
    for (std::size_t c = k + 1; c < n; ++c) {
      x -= re[c] * real_side_[c] - im[c] * imaginary_side_[c];
      y -= re[c] * imaginary_side_[c] + im[c] * real_side_[c];
    }
    const double size = re[k] * re[k] + im[k] * im[k];
    real_side_[k] = (x * re[k] + y * im[k]) / size;
    imaginary_side_[k] = (y * re[k] - x * im[k]) / size;
  }
}

const std::vector<std::complex<double>>& Hessenberg::vector(std::complex<double> value) {
  const double smallest = epsilon * std::max(norm(), 1e-300);
  real_side_.assign(size_, 1.0 / std::sqrt(static_cast<double>(size_)));
  imaginary_side_.assign(size_, 0.0);
  vector_.resize(size_);
  for (int pass = 0; pass < 3; ++pass) {
    solve_shifted(value, smallest);
    double square = 0.0;
    for (std::size_t k = 0; k < size_; ++k) {
      square += real_side_[k] * real_side_[k] + imaginary_side_[k] * imaginary_side_[k];
    }
    const double growth = std::sqrt(square);
    for (std::size_t k = 0; k < size_; ++k) {
      real_side_[k] /= growth;
      imaginary_side_[k] /= growth;
      vector_[k] = {real_side_[k], imaginary_side_[k]};
    }
    // The residual of the unit vector is 1 / growth.
    if (growth * smallest * 1e3 >= 1.0) break;
  }
  return vector_;
}

}  // namespace robomill::stability::detail
