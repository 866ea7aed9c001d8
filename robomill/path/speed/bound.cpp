#include "robomill/path/speed/bound.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace robomill::path {
namespace {

/// A bound on a = d²u/dt² as a line over b.
struct Line {
  double at_zero, slope;
  [[nodiscard]] double at(double b) const { return at_zero + slope * b; }
};
struct Range {
  Line low, high;
};

/// The strictest lines at b: the channels', and 0 <= b + 2 Δ a <= next.
Range range_at(const BoundPoint& point, const ChannelLimits& limits, double b, double apart_m, double next_b) {
  Range out{.low = {0.0, -0.5 / apart_m}, .high = {0.5 * next_b / apart_m, -0.5 / apart_m}};
  for (std::size_t k = 0; k < channel_count; ++k) {
    const double c1 = std::abs(point.c1[k]);
    if (c1 < 1e-9) continue;
    const double c2 = point.c1[k] < 0.0 ? -point.c2[k] : point.c2[k];
    const Line high{limits.acceleration[k] / c1, -c2 / c1}, low{-limits.acceleration[k] / c1, -c2 / c1};
    if (high.at(b) < out.high.at(b)) out.high = high;
    if (low.at(b) > out.low.at(b)) out.low = low;
  }
  return out;
}

/// The largest b from which the next point can be met with b <= next.
double largest_b(const BoundPoint& point, const ChannelLimits& limits, double apart_m, double next_b) {
  double b = point.max_b;
  for (std::size_t k = 0; k < channel_count; ++k) {
    if (std::abs(point.c1[k]) < 1e-9) b = std::min(b, limits.acceleration[k] / std::max(std::abs(point.c2[k]), 1e-30));
  }
  // The range closes where two lines cross; each crossing lies nearer to the answer.
  for (int i = 0; i < 100; ++i) {
    const auto [low, high] = range_at(point, limits, b, apart_m, next_b);
    if (low.at(b) <= high.at(b) + 1e-12 * (std::abs(low.at(b)) + std::abs(high.at(b)))) return b;
    const double crossing = (high.at_zero - low.at_zero) / (low.slope - high.slope);
    if (!(crossing < b)) return b;  // rounding: at b = 0 the range is never empty
    b = std::max(crossing, 0.0);
  }
  return b;
}

}  // namespace

double least_time_s(const std::vector<BoundPoint>& points, const ChannelLimits& limits) {
  std::vector<double> most(points.size(), 0.0);
  for (std::size_t i = points.size(); i-- > 0;) {
    if (points[i].rests || i + 1 == points.size()) continue;
    most[i] = largest_b(points[i], limits, points[i + 1].u_m - points[i].u_m, most[i + 1]);
  }
  double sum_s = 0.0, b = 0.0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    if (points[i].rests) b = 0.0;
    const double apart_m = points[i + 1].u_m - points[i].u_m;
    if (!(apart_m > 0.0)) continue;
    const double a = range_at(points[i], limits, b, apart_m, most[i + 1]).high.at(b);
    const double next = std::clamp(b + 2.0 * apart_m * a, 0.0, most[i + 1]);
    const double sum = std::sqrt(b) + std::sqrt(next);
    if (sum > 0.0) sum_s += 2.0 * apart_m / sum;
    b = next;
  }
  return sum_s;
}

}  // namespace robomill::path
