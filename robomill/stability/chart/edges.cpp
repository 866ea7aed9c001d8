#include "robomill/stability/chart/edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>

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
  bool careful = false;  ///< near enough to ask for an estimate with each value
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
  s.dragging = s.high - s.low > 0.51 * width ? s.dragging + 1 : 0;  // a halving is none, whatever it rounds to
  choose(s);
}

Search start(const std::vector<Edge>& edges, std::size_t edge) {
  Search search;
  search.edge = edge;
  search.value_low = std::log(edges[edge].radius_from);
  search.value_high = std::log(edges[edge].radius_to);
  choose(search);
  return search;
}

/// Whether the search is over with this value.
bool ends(Search& search, double radius, double tolerance) {
  const bool there = std::abs(radius - 1.0) <= tolerance || search.high - search.low <= 1e-14;
  if (!there || search.careful) return there;
  search.careful = true;
  return false;
}

}  // namespace

BoundaryPoint boundary_point(const OperatingPoint& point, const Outcome& outcome) {
  BoundaryPoint b;
  b.spindle_speed_rad_per_s = point.spindle_speed_rad_per_s;
  b.axial_depth_m = point.axial_depth_m;
  b.chatter_frequency_hz = outcome.chatter_frequency_hz;
  b.kind = outcome.kind;
  b.mode = outcome.mode;
  b.error_estimate = outcome.error_estimate;
  return b;
}

std::vector<BoundaryPoint> refine(PointEvaluator& evaluator, const std::vector<Edge>& edges, double tolerance,
                                  const Progress& progress) {
  std::vector<BoundaryPoint> found(edges.size());
  std::vector<Search> active;  // a lane each; one that ends makes room for the next
  std::size_t next = 0;
  while (next < edges.size() && active.size() < lane_count) active.push_back(start(edges, next++));
  while (!active.empty()) {
    progress.check();
    for (const bool careful : {false, true}) {
      std::array<OperatingPoint, lane_count> points;
      std::array<Outcome, lane_count> outcomes;
      std::array<std::size_t, lane_count> which = {};
      std::size_t count = 0;
      for (std::size_t i = 0; i < active.size(); ++i) {
        if (active[i].careful != careful) continue;
        points[count] = along(edges[active[i].edge], active[i].next);
        which[count++] = i;
      }
      if (count == 0) continue;
      const Ask ask = {.estimate = careful, .motion = careful};
      evaluator.evaluate(std::span(points).first(count), ask, std::span(outcomes).first(count));
      for (std::size_t i = 0; i < count; ++i) {
        Search& search = active[which[i]];
        if (ends(search, outcomes[i].spectral_radius, tolerance)) {
          found[search.edge] = boundary_point(points[i], outcomes[i]);
          search.edge = edges.size();  // free
        } else if (careful || !search.careful) {
          narrow(search, std::log(outcomes[i].spectral_radius));
        }
      }
    }
    std::size_t kept = 0;
    for (Search& search : active) {
      if (search.edge == edges.size()) {
        if (next == edges.size()) continue;
        search = start(edges, next++);
      }
      active[kept++] = search;
    }
    active.resize(kept);
  }
  return found;
}

}  // namespace robomill::stability::detail
