#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/coupling/assembly.hpp"

/// Receptances of one plane: displacement u and slope θ = ∂u/∂z answer force f and moment m; all matrices are 2 x 2 in
/// the order (u, θ) and (f, m), in SI.
namespace robomill::coupling::detail {

/// What segments do between their free end 1 and their end 2, which something holds:
///   x_1 = clamped f_1 + carry x_2,   f_2 = stiffness x_2 - carryᵀ f_1.
/// On a base of receptance B, x_2 = -B f_2 with f_2 the force on the segments, the free end's receptance is
///   G = clamped + carry (1 + B stiffness)⁻¹ B carryᵀ.
struct Span {
  Eigen::Matrix2cd clamped;    ///< receptance of end 1 with end 2 held
  Eigen::Matrix2cd carry;      ///< motion of end 1 for an imposed motion of end 2
  Eigen::Matrix2cd stiffness;  ///< dynamic stiffness of end 2 with end 1 free
};

/// The spans of segments joined rigidly, one a frequency; end 1 is that of the first segment.
/// Any @throws as Segment::validate; the frequencies are > 0.
[[nodiscard]] std::vector<Span> spans(const std::vector<Segment>& segments, const Eigen::VectorXd& frequency_hz);

/// Kc⁻¹ of a whole joint.
[[nodiscard]] Eigen::Matrix2cd flexibility(const Joint& joint, double frequency_hz);

/// G of a span on a base.
[[nodiscard]] inline Eigen::Matrix2cd on_base(const Span& span, const Eigen::Matrix2cd& base) {
  const Eigen::Matrix2cd held = (Eigen::Matrix2cd::Identity() + base * span.stiffness).inverse() * base;
  return span.clamped + span.carry * held * span.carry.transpose();
}

}  // namespace robomill::coupling::detail
