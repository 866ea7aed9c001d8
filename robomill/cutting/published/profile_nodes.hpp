#pragma once
#include <vector>

#include "robomill/cutting/published/patch.hpp"

namespace robomill::cutting::detail {

/// A ring at s that stands for a piece of the profile.
struct Node {
  double length_m = 0.0, width_m = 0.0;
};

/// Rings over exactly the engaged part of the profile, `count` of them or a few more. Between two places where the
/// arcs' bounds change the engaged angle is smooth but for a root at either end, which Gauss's rule meets by the
/// substitution s = m + d (3 τ - τ³) / 2; where the arcs do not change at all the rings are even.
[[nodiscard]] std::vector<Node> profile_nodes(const Patch& patch, int count);
/// The same rule with `count` rings between any two such places, also where arcs do not change.
[[nodiscard]] std::vector<Node> profile_nodes_each(const Patch& patch, int count);

}  // namespace robomill::cutting::detail
