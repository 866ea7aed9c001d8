#include "robomill/stability/chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace robomill::stability::detail {
namespace {

/// Where an edge's search stands; the root lies between low and high, as fractions of the edge.
struct Search {
  std::size_t edge = 0;
  double low = 0.0, high = 1.0;
  double value_low = 0.0, value_high = 0.0;  ///< ln of the spectral radius
  int side = 0;                              ///< which end stayed last
  int dragging = 0;                          ///< times that the interval did not halve
  double next = 0.5;
};

OperatingPoint along(const Edge& edge, double t) {
  const auto mix = [t](double a, double b) { return a == b ? a : (1.0 - t) * a + t * b; };
  return {.spindle_speed_rad_per_s = mix(edge.from.spindle_speed_rad_per_s, edge.to.spindle_speed_rad_per_s),
          .axial_depth_m = mix(edge.from.axial_depth_m, edge.to.axial_depth_m)};
}

void choose(Search& s) {
  const double slope = s.value_high - s.value_low;
  const double secant = s.low - s.value_low * (s.high - s.low) / slope;
  const bool inside = secant > s.low && secant < s.high;
  s.next = inside && s.dragging < 3 ? secant : 0.5 * (s.low + s.high);
  if (s.dragging >= 3) s.dragging = 0;
}

/// Illinois: an end that stays twice counts half.
void narrow(Search& s, double value) {
  const double width = s.high - s.low;
  if ((value < 0.0) == (s.value_low < 0.0)) {
    s.low = s.next;
    s.value_low = value;
    if (s.side == 1) s.value_high *= 0.5;
    s.side = 1;
  } else {
    s.high = s.next;
    s.value_high = value;
    if (s.side == -1) s.value_low *= 0.5;
    s.side = -1;
  }
  s.dragging = s.high - s.low > 0.5 * width ? s.dragging + 1 : 0;
  choose(s);
}

BoundaryPoint boundary_point(const OperatingPoint& point, const Dominant& dominant, const Motion& motion) {
  BoundaryPoint b;
  b.spindle_speed_rad_per_s = point.spindle_speed_rad_per_s;
  b.axial_depth_m = point.axial_depth_m;
  b.chatter_frequency_hz = motion.frequency_hz;
  b.kind = kind_of(dominant.multiplier);
  b.mode = motion.mode;
  return b;
}

Limit limit_at(const BoundaryPoint& b) {
  Limit limit;
  limit.spindle_speed_rad_per_s = b.spindle_speed_rad_per_s;
  limit.status = Limit::Status::found;
  limit.axial_depth_m = b.axial_depth_m;
  limit.chatter_frequency_hz = b.chatter_frequency_hz;
  limit.kind = b.kind;
  limit.mode = b.mode;
  return limit;
}

/// Already unstable at the least depth.
Limit limit_at_start(Evaluator& evaluator, const OperatingPoint& point) {
  const Evaluator::Point at{point.spindle_speed_rad_per_s, point.axial_depth_m, nullptr};
  Dominant dominant;
  Motion motion;
  evaluator.evaluate({&at, 1}, {&dominant, 1});
  evaluator.describe({&dominant, 1}, {&motion, 1});
  return limit_at(boundary_point(point, dominant, motion));
}

}  // namespace

std::vector<BoundaryPoint> refine(Evaluator& evaluator, const std::vector<Edge>& edges, double tolerance,
                                  const Progress& progress) {
  std::vector<BoundaryPoint> found(edges.size());
  std::vector<Search> searches(edges.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    searches[e].edge = e;
    searches[e].value_low = std::log(edges[e].radius_from);
    searches[e].value_high = std::log(edges[e].radius_to);
    choose(searches[e]);
  }
  while (!searches.empty()) {
    std::size_t kept = 0;
    for (std::size_t first = 0; first < searches.size(); first += lane_count) {
      progress.check();
      const std::size_t count = std::min(lane_count, searches.size() - first);
      std::array<Evaluator::Point, lane_count> points;
      std::array<Dominant, lane_count> dominant;
      std::array<Motion, lane_count> motion;
      for (std::size_t i = 0; i < count; ++i) {
        const OperatingPoint p = along(edges[searches[first + i].edge], searches[first + i].next);
        points[i] = {p.spindle_speed_rad_per_s, p.axial_depth_m, nullptr};
      }
      evaluator.evaluate(std::span(points).first(count), std::span(dominant).first(count));
      bool described = false;
      for (std::size_t i = 0; i < count; ++i) {
        Search search = searches[first + i];
        const double radius = spectral_radius(dominant[i]);
        if (std::abs(radius - 1.0) > tolerance && search.high - search.low > 1e-14) {
          narrow(search, std::log(radius));
          searches[kept++] = search;
          continue;
        }
        if (!described) {
          evaluator.describe(std::span(dominant).first(count), std::span(motion).first(count));
          described = true;
        }
        const OperatingPoint p{points[i].spindle_speed_rad_per_s, points[i].axial_depth_m};
        found[search.edge] = boundary_point(p, dominant[i], motion[i]);
      }
    }
    searches.resize(kept);
  }
  return found;
}

Column column(Evaluator& evaluator, double spindle_speed_rad_per_s, const std::vector<double>& depths_m,
              const std::vector<DepthPlan>& plans, double tolerance, Look look, const Progress& progress) {
  Column result;
  result.spectral_radius.reserve(depths_m.size());
  bool unstable = false;
  for (std::size_t first = 0; first < depths_m.size() && !(unstable && look == Look::limit); first += lane_count) {
    progress.check();
    const std::size_t count = std::min(lane_count, depths_m.size() - first);
    std::array<Evaluator::Point, lane_count> points;
    std::array<Dominant, lane_count> dominant;
    for (std::size_t i = 0; i < count; ++i) {
      points[i] = {spindle_speed_rad_per_s, depths_m[first + i], plans.empty() ? nullptr : &plans[first + i]};
    }
    evaluator.evaluate(std::span(points).first(count), std::span(dominant).first(count));
    for (std::size_t i = 0; i < count; ++i) {
      result.spectral_radius.push_back(spectral_radius(dominant[i]));
      unstable = unstable || result.spectral_radius.back() >= 1.0;
    }
  }

  std::vector<Edge> edges;
  const auto point = [&](std::size_t j) { return OperatingPoint{spindle_speed_rad_per_s, depths_m[j]}; };
  for (std::size_t j = 0; j + 1 < result.spectral_radius.size(); ++j) {
    const double below = result.spectral_radius[j];
    const double above = result.spectral_radius[j + 1];
    if ((below < 1.0) == (above < 1.0)) continue;
    edges.push_back({point(j), point(j + 1), below, above});
    if (look != Look::boundary) break;
  }
  result.limit.spindle_speed_rad_per_s = spindle_speed_rad_per_s;
  const bool unstable_at_start = result.spectral_radius.front() >= 1.0;
  if (unstable_at_start && look != Look::boundary) edges.clear();
  result.boundary = refine(evaluator, edges, tolerance, progress);
  if (unstable_at_start) {
    result.limit = limit_at_start(evaluator, point(0));
  } else if (!result.boundary.empty()) {
    result.limit = limit_at(result.boundary.front());
  }
  return result;
}

}  // namespace robomill::stability::detail
