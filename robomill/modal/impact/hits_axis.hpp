#pragma once
#include <Eigen/Core>

namespace robomill::modal {

/// Moves an FRF by `decay_per_s` in the complex plane: from H(iω + σ), as the exponential window shows it, to H(iω).
///
/// Around each line a cubic and rational functions of degrees 2/1, 2/2 and 3/3 are fitted to the 13 nearest lines; the
/// one with the smallest residual, those with more unknowns handicapped, is evaluated at -σ beside the axis. σ comes to
/// half a line's spacing or so: this is a short step. Of a real signal's transform the lines below zero are the
/// conjugates of those above.
/// @param lines  H(i k Δω + σ), k = 0 … n-1 (n > 13); the line at zero is not used and comes back as it is
/// Source: the local rational method of [McKelvey2012], here used to continue and not to smooth
[[nodiscard]] Eigen::VectorXcd without_decay(const Eigen::VectorXcd& lines, double spacing_rad_per_s,
                                             double decay_per_s);

}  // namespace robomill::modal
