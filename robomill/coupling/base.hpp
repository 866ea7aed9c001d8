#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/coupling/assembly.hpp"

namespace robomill::coupling::detail {

/// Receptances of the holder's mouth in one plane, (u, θ) for (f, m), one a frequency: of its segments on the wall, of
/// its measured FRFs, or zero for the wall itself.
/// @param axis  x or y: the plane; θ of y is -(rotation about x), so that θ = ∂u/∂z in both
/// @throws InvalidInput as tip_frfs
[[nodiscard]] std::vector<Eigen::Matrix2cd> base_receptances(const Holder& holder, modal::Axis axis,
                                                             const Eigen::VectorXd& frequency_hz);

}  // namespace robomill::coupling::detail
