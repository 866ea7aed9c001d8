#pragma once
#include <Eigen/Core>
#include <Eigen/LU>
#include <complex>
#include <vector>

#include "robomill/coupling/assembly.hpp"

/// Receptances of one plane: displacement u and slope θ = ∂u/∂z answer force f and moment m; all matrices are 2 x 2 in
/// the order (u, θ) and (f, m), in SI.
namespace robomill::coupling::detail {

/// What segments do between their free end 1 and their end 2, which something holds:
///   x_1 = clamped f_1 + carry x_2,   f_2 = stiffness x_2 - carryᵀ f_1.
/// On a base of receptance B, x_2 = -B f_2 with f_2 the force on the segments, the free end's receptance is
///   G = clamped + carry (1 + B stiffness)⁻¹ B carryᵀ.
struct BeamElement {
  Eigen::Matrix2cd clamped;    ///< receptance of end 1 with end 2 held
  Eigen::Matrix2cd carry;      ///< motion of end 1 for an imposed motion of end 2
  Eigen::Matrix2cd stiffness;  ///< dynamic stiffness of end 2 with end 1 free
};

/// The beam elements of segments joined rigidly, one a frequency; end 1 is that of the first segment.
/// Any @throws as Segment::validate; the frequencies are > 0.
[[nodiscard]] std::vector<BeamElement> beam_elements(const std::vector<Segment>& segments,
                                                     const Eigen::VectorXd& frequency_hz);

/// The tool's, end 1 with the accelerometer on it: M = m [1, -e; -e, e²] of its mass m at e beyond the tip, where u - e
/// θ is its motion, between end 1 and the tool. With E = (1 - ω² g M)⁻¹: g becomes E g, t becomes E t, and k becomes k
/// - ω² tᵀ M E t.
[[nodiscard]] std::vector<BeamElement> tool_elements(const Assembly& assembly, const Eigen::VectorXd& frequency_hz);

/// Kc⁻¹ of a whole joint.
[[nodiscard]] Eigen::Matrix2cd flexibility(const Joint& joint, double frequency_hz);

template <int N>
using Square = Eigen::Matrix<std::complex<double>, N, N>;

/// The same in each plane and none between: N is twice the number of planes.
template <int N>
[[nodiscard]] Square<N> planes(const Eigen::Matrix2cd& plane) {
  Square<N> out = Square<N>::Zero();
  for (int i = 0; i < N; i += 2) out.template block<2, 2>(i, i) = plane;
  return out;
}

/// clamped + carry (1 + base stiffness)⁻¹ base carryᵀ
template <class Matrix>
[[nodiscard]] inline Matrix on_base(const Matrix& clamped, const Matrix& carry, const Matrix& stiffness,
                                    const Matrix& base) {
  const Matrix moved = Matrix::Identity() + base * stiffness;
  const auto held = [&]() -> Matrix {
    if constexpr (Matrix::RowsAtCompileTime == 2) return moved.inverse() * base;
    return moved.partialPivLu().solve(base);  // the closed form of a 4 x 4 inverse takes no pivots
  };
  return clamped + carry * held() * carry.transpose();
}

/// G of a beam element, the same in each plane, on a base.
template <int N>
[[nodiscard]] Square<N> on_base(const BeamElement& element, const Square<N>& base) {
  return on_base<Square<N>>(planes<N>(element.clamped), planes<N>(element.carry), planes<N>(element.stiffness), base);
}

}  // namespace robomill::coupling::detail
