#pragma once
#include <Eigen/Core>
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

}  // namespace robomill::coupling::detail
