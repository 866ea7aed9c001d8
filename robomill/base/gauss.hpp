#pragma once
#include <vector>

namespace robomill {

/// Points and weights on [0, 1].
struct GaussRule {
  std::vector<double> node, weight;
};

/// Gauss-Legendre, exact for polynomials of degree 2 points - 1; points >= 1.
GaussRule make_gauss_rule(int points);

inline constexpr int most_gauss_points = 32;
/// The same, kept; 1 <= points <= most_gauss_points.
const GaussRule& gauss_rule(int points);

}  // namespace robomill
