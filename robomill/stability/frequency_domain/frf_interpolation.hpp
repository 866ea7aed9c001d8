#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

namespace robomill::stability::detail {

/// Four receptances between and beside the lines on which they were measured.
///
/// Between two lines: (H d) is the polynomial of degree 5 through the six lines around, d a polynomial of degree 0, 1
/// or 2 that all four share. d is chosen so that (H d) misses the next line on either side least, as [McKelvey2012]
/// does for noise; it takes a pole only where that lowers the miss to less than a third and the pole is that of a
/// structure (decaying, and not narrower than the lines can show), so that noise is interpolated by a polynomial. A
/// peak whose half width is that of a line comes out right. Below the lowest line: its real part, and its imaginary
/// part in proportion to the frequency (a structure at rest). Above the highest: -mass / ω², where the last tenth of
/// the lines follows that within half of its size, otherwise 0.
class FrfInterpolation {
 public:
  using Lines = Eigen::Matrix<std::complex<double>, Eigen::Dynamic, 4, Eigen::RowMajor>;
  static constexpr Eigen::Index least_lines = 8;
  /// @param frequency_rad_per_s  length n >= 8, increasing, >= 0
  /// @param lines                n x 4: xx, yx, xy, yy [m/N]
  FrfInterpolation(Eigen::VectorXd frequency_rad_per_s, Lines lines);

  /// H(iω) for ω of either sign, 2 x 2; H(-iω) = conj H(iω).
  [[nodiscard]] Eigen::Matrix2cd at(double frequency_rad_per_s) const;
  [[nodiscard]] double low() const { return frequency_(0); }
  [[nodiscard]] double high() const { return frequency_(frequency_.size() - 1); }
  /// C_1 of what continues above the highest line [m/(N s)].
  [[nodiscard]] Eigen::Matrix2d first_moment() const;
  [[nodiscard]] const Eigen::VectorXd& frequency() const { return frequency_; }
  [[nodiscard]] const Lines& lines() const { return lines_; }

 private:
  static constexpr Eigen::Index window = 8, through = 6;
  struct Piece {
    Eigen::Index first = 0;                                             ///< of the lines that it goes through
    double middle = 0.0, scale = 1.0;                                   ///< x = (ω - middle) / scale
    std::array<double, static_cast<std::size_t>(through)> weight = {};  ///< barycentric
    std::array<std::complex<double>, 2> denominator = {};               ///< d = 1 + d₁ x + d₂ x²
  };
  [[nodiscard]] Piece piece(Eigen::Index line) const;
  void find_continuation();

  Eigen::VectorXd frequency_;
  Lines lines_;
  std::vector<Piece> pieces_;
  Eigen::Matrix4d above_ = Eigen::Matrix4d::Zero();  ///< C_k times high^-k: a row a power, a column an entry
};

}  // namespace robomill::stability::detail
