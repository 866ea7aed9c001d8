#include "robomill/base/gauss.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace robomill {
/// Newton's method on the three-term recurrence of the Legendre polynomials.
GaussRule make_gauss_rule(int points) {
  GaussRule rule;
  for (int i = 0; i < points; ++i) {
    double x = -std::cos(std::numbers::pi * (i + 0.75) / (points + 0.5));
    double slope = 1.0;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double before = 1.0;
      double here = x;
      for (int k = 2; k <= points; ++k) {
        const double next = ((2 * k - 1) * x * here - (k - 1) * before) / k;
        before = here;
        here = next;
      }
      slope = points * (x * here - before) / (x * x - 1.0);
      const double change = here / slope;
      x -= change;
      if (std::abs(change) < 1e-16) break;
    }
    rule.node.push_back(0.5 * (x + 1.0));
    rule.weight.push_back(1.0 / ((1.0 - x * x) * slope * slope));
  }
  return rule;
}

const GaussRule& gauss_rule(int points) {
  static const std::array<GaussRule, most_gauss_points + 1> rules = [] {
    std::array<GaussRule, most_gauss_points + 1> all;
    for (int i = 1; i <= most_gauss_points; ++i) all[static_cast<std::size_t>(i)] = make_gauss_rule(i);
    return all;
  }();
  return rules[static_cast<std::size_t>(points)];
}

}  // namespace robomill
