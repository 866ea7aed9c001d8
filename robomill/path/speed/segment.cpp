#include "robomill/path/speed/segment.hpp"

#include <algorithm>
#include <cmath>

namespace robomill::path {
namespace {

/// b = begin + slope x + curve x²; its motion obeys x'' = slope / 2 + curve x.
struct Quadratic {
  double slope, curve;
};
Quadratic quadratic(const Segment& segment) {
  return {2.0 * (segment.middle_b - segment.begin_b) / segment.length_m,
          (segment.begin_b - 2.0 * segment.middle_b + segment.end_b) / (segment.length_m * segment.length_m)};
}

}  // namespace

double duration_s(const Segment& segment) noexcept {
  switch (segment.kind) {
    case Segment::Kind::dwell:
      return segment.dwell_s;
    case Segment::Kind::from_rest:
      return 3.0 * segment.length_m / std::sqrt(segment.end_b);
    case Segment::Kind::to_rest:
      return 3.0 * segment.length_m / std::sqrt(segment.begin_b);
    case Segment::Kind::cruise:
      break;
  }
  // tanh(k T / 2) = k d / (v0 + v1), from x'' = a + k² x; k imaginary gives the tangent.
  const double z = segment.length_m / (std::sqrt(segment.begin_b) + std::sqrt(segment.end_b));
  const double w = quadratic(segment).curve * z * z;
  if (std::abs(w) < 1e-4) return 2.0 * z * (1.0 + w * (1.0 / 3.0 + w * (1.0 / 5.0 + w * (1.0 / 7.0 + w / 9.0))));
  const double k = std::sqrt(std::abs(w));
  return 2.0 * z * (w > 0.0 ? std::atanh(k) : std::atan(k)) / k;
}

double way_m(const Segment& segment, double t_s, double total_s) noexcept {
  switch (segment.kind) {
    case Segment::Kind::dwell:
      return 0.0;
    case Segment::Kind::from_rest: {
      const double share = t_s / total_s;
      return segment.length_m * share * share * share;
    }
    case Segment::Kind::to_rest: {
      const double share = 1.0 - t_s / total_s;
      return segment.length_m * (1.0 - share * share * share);
    }
    case Segment::Kind::cruise:
      break;
  }
  const auto [slope, curve] = quadratic(segment);
  const double w = curve * t_s * t_s;
  double s = 1.0, c = 0.5;  // sinh(k t)/(k t) and (cosh(k t) − 1)/(k t)²
  if (std::abs(w) < 1e-2) {
    s = 1.0 + w / 6.0 * (1.0 + w / 20.0 * (1.0 + w / 42.0 * (1.0 + w / 72.0)));
    c = 0.5 * (1.0 + w / 12.0 * (1.0 + w / 30.0 * (1.0 + w / 56.0 * (1.0 + w / 90.0))));
  } else if (w > 0.0) {
    const double k = std::sqrt(w);
    s = std::sinh(k) / k;
    c = (std::cosh(k) - 1.0) / w;
  } else {
    const double k = std::sqrt(-w);
    s = std::sin(k) / k;
    c = (1.0 - std::cos(k)) / -w;
  }
  const double x = t_s * (std::sqrt(segment.begin_b) * s + 0.5 * slope * t_s * c);
  return std::min(std::max(x, 0.0), segment.length_m);
}

}  // namespace robomill::path
