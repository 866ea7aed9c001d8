#pragma once
#include <Eigen/Core>
#include <array>
#include <complex>
#include <vector>

#include "robomill/coupling/assembly.hpp"
#include "robomill/coupling/beam_element.hpp"

namespace robomill::coupling::detail {

/// Receptance of the shank where it leaves the holder's mouth, the shank standing in the holder on joint.points points.
/// Shank and holder are beams side by side over the insertion; a holder that was measured moves there as a rigid body.
/// @param base  of the holder's mouth without the shank, one a frequency
template <int N>
[[nodiscard]] std::vector<Square<N>> distributed(const Joint& joint, const Holder& holder,
                                                 const std::vector<Square<N>>& base,
                                                 const Eigen::VectorXd& frequency_hz);

extern template std::vector<Square<2>> distributed<2>(const Joint&, const Holder&, const std::vector<Square<2>>&,
                                                      const Eigen::VectorXd&);
extern template std::vector<Square<4>> distributed<4>(const Joint&, const Holder&, const std::vector<Square<4>>&,
                                                      const Eigen::VectorXd&);

/// One gap between neighbouring points, from the mouth inwards; one element a frequency.
struct JointGap {
  std::vector<BeamElement> shank, holder;
};

/// A receptance that depends on the joint, and its derivative.
template <int N>
struct Along {
  Square<N> value;
  std::array<Square<N>, 2> slope;  ///< along the two stiffnesses of the joint, k_u + iωc_u and k_θ + iωc_θ
};

/// The tip in one plane over a shank on several points, as a function of the joint's whole stiffness Kc: all else is
/// worked out once.
class DistributedTip {
 public:
  /// @param tool, base  by line; base of the holder's mouth without the shank
  DistributedTip(std::vector<BeamElement> tool, const Joint& joint, const Holder& holder,
                 const std::vector<Eigen::Matrix2cd>& base, const Eigen::VectorXd& frequency_hz);

  struct Response {
    std::complex<double> receptance;
    std::array<std::complex<double>, 2> slope;  ///< ∂H/∂(k_u + iωc_u), ∂H/∂(k_θ + iωc_θ); 0 unless asked for
  };
  [[nodiscard]] Response at(std::size_t line, const Eigen::Matrix2cd& stiffness, bool derivatives) const;

 private:
  std::vector<BeamElement> tool_;
  std::vector<JointGap> gaps_;
  std::vector<Eigen::Matrix2cd> deep_;
  bool holder_moves_ = true;  ///< else the shank stands on springs to the ground
};

}  // namespace robomill::coupling::detail
