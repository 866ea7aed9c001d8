#pragma once
#include <Eigen/Core>

namespace robomill::modal {

/// Moves an FRF by `decay_per_s` in the complex plane: from H(iω + σ), as the exponential window shows it, to H(iω).
///
/// Around each line a rational function of degree 2/2, or a cubic where that describes the lines as well, is fitted to
/// the 13 nearest ones and evaluated at -σ beside the axis. σ comes to about one line's spacing, so this is a short
/// step. Of a real signal's transform the lines below zero are the conjugates of those above.
/// @param lines  H(i k Δω + σ), k = 0 … n-1 (n > 13); the line at zero is not used and comes back as it is
/// Source: the local rational method of [McKelvey2012], here used to continue and not to smooth
[[nodiscard]] Eigen::VectorXcd without_decay(const Eigen::VectorXcd& lines, double spacing_rad_per_s,
                                             double decay_per_s);

}  // namespace robomill::modal
