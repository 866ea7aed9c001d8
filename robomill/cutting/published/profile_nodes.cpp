#include "robomill/cutting/published/profile_nodes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <optional>

#include "robomill/base/gauss.hpp"

namespace robomill::cutting::detail {
namespace {

constexpr int samples = 48;
/// Of an interval of a ball, to look how fast more of them converge.
constexpr int few_rings = 5;

struct Interval {
  double from = 0.0, to = 0.0;
  bool straight = false;
  double area_m2 = 0.0;  ///< of the patch, roughly
  /// Of a ball: Gauss's rule with few rings is off by error_m2, which falls by `ratio` with each further one.
  double error_m2 = 0.0, ratio = 0.5;
  [[nodiscard]] double length() const { return to - from; }
};

/// Where the rings of a piece come below the surface: around the sample that is nearest to `touching`.
std::vector<double> sample_piece(const Patch& patch, const Profile::Piece& piece, const std::vector<double>& places) {
  const double end = piece.start_m + piece.length_m;
  const auto below = [&](double s) { return !patch.below_surface(patch.profile().at(s)).empty(); };
  const double start = std::clamp(patch.touching_length_m(), piece.start_m, end);
  const auto limit = [&](double towards) {
    double in = start;
    double out = towards;
    for (int i = 1; i <= samples; ++i) {
      const double next = start + (towards - start) * i / samples;
      if (!below(next)) {
        out = next;
        break;
      }
      in = next;
    }
    for (int i = 0; i < 40 && in != towards; ++i) (below(0.5 * (in + out)) ? in : out) = 0.5 * (in + out);
    return in;
  };
  const double low = limit(piece.start_m);
  const double high = limit(end);
  std::vector<double> at;
  at.reserve(samples + 3 + places.size());
  at.push_back(piece.start_m);
  for (int i = 0; i <= samples; ++i) at.push_back(low + (high - low) * i / samples);
  at.push_back(end);
  for (const double s : places) {
    if (s > piece.start_m && s < end) at.push_back(s);
  }
  std::ranges::sort(at);
  const auto twin = [&](double a, double b) { return b - a < 1e-9 * piece.length_m; };
  at.erase(std::unique(at.begin(), at.end(), twin), at.end());
  return at;
}

/// Adds places until the engaged angle changes by little from one to the next: where a ring touches the patch's border
/// it opens or tears in a hurry.
void refine(const Patch& patch, double from, double to, double at_from, double at_to, double narrow,
            std::vector<double>& places) {
  constexpr double little = 0.15;
  if (std::abs(at_to - at_from) < little || to - from < narrow) return;
  const double middle = 0.5 * (from + to);
  const double at_middle = patch.arcs(patch.profile().at(middle)).length();
  refine(patch, from, middle, at_from, at_middle, narrow, places);
  places.push_back(middle);
  refine(patch, middle, to, at_middle, at_to, narrow, places);
}

/// Adds to `borders` where the signature changes between two places.
void split(const std::function<std::uint64_t(double)>& signature, double from, double to, std::uint64_t at_from,
           std::uint64_t at_to, double tolerance, std::vector<double>& borders) {
  if (at_from == at_to) return;
  const double middle = 0.5 * (from + to);
  if (to - from < tolerance) {
    borders.push_back(middle);
    return;
  }
  const std::uint64_t at_middle = signature(middle);
  split(signature, from, middle, at_from, at_middle, tolerance, borders);
  split(signature, middle, to, at_middle, at_to, tolerance, borders);
}

/// Places along a piece, close where the engaged angle changes fast.
struct Course {
  std::vector<double> at, angle;
};

Course course_of(const Patch& patch, const Profile::Piece& piece, const std::vector<double>& places) {
  const std::vector<double> rough = sample_piece(patch, piece, places);
  Course course;
  double before = 0.0;
  for (std::size_t i = 0; i < rough.size(); ++i) {
    const double here = patch.arcs(patch.profile().at(rough[i])).length();
    if (i > 0) refine(patch, rough[i - 1], rough[i], before, here, 1e-6 * piece.length_m, course.at);
    course.at.push_back(rough[i]);
    before = here;
  }
  course.angle.reserve(course.at.size());
  for (const double s : course.at) course.angle.push_back(patch.arcs(patch.profile().at(s)).length());
  return course;
}

/// Adds to `borders` where the engaged angle is far steeper than on either side, within an interval: a ring that nearly
/// touches the patch's border. The root at an interval's own end is none.
void add_steep(const Course& course, const Interval& interval, std::vector<double>& borders) {
  const auto& at = course.at;
  const auto first = static_cast<std::size_t>(std::ranges::upper_bound(at, interval.from) - at.begin());
  const auto last = static_cast<std::size_t>(std::ranges::lower_bound(at, interval.to) - at.begin());
  if (last < first + 4) return;
  std::vector<double> slope;
  slope.reserve(last - first);
  for (std::size_t i = first; i + 1 < last; ++i) {
    slope.push_back(std::abs(course.angle[i + 1] - course.angle[i]) / (at[i + 1] - at[i]));
  }
  double steepest = 0.0;
  std::size_t where = 0;
  for (std::size_t i = 1; i + 1 < slope.size(); ++i) {
    const double before = *std::min_element(slope.begin(), slope.begin() + static_cast<std::ptrdiff_t>(i));
    const double after = *std::min_element(slope.begin() + static_cast<std::ptrdiff_t>(i) + 1, slope.end());
    const double excess = slope[i] / (std::max(before, after) + 1e-300);
    if (slope[i] < slope[i - 1] || slope[i] < slope[i + 1] || excess <= steepest) continue;
    steepest = excess;
    where = i;
  }
  constexpr double steep = 4.0;
  if (steepest > steep) borders.push_back(0.5 * (at[first + where] + at[first + where + 1]));
}

/// The engaged parts of a piece, cut where the bounds of the arcs change and where the engaged angle is steep.
void add_intervals(const Patch& patch, const Profile::Piece& piece, const std::vector<double>& places,
                   std::vector<Interval>& intervals) {
  const auto signature = [&](double s) { return patch.arcs(patch.profile().at(s)).signature(); };
  const Course course = course_of(patch, piece, places);
  const std::vector<double>& at = course.at;
  const double end = piece.start_m + piece.length_m;
  const double tolerance = 1e-13 * piece.length_m;
  std::vector<double> borders = {piece.start_m};
  std::uint64_t before = signature(at.front() + tolerance);
  for (std::size_t i = 1; i < at.size(); ++i) {
    const std::uint64_t here = signature(std::min(at[i], end - tolerance));
    split(signature, at[i - 1], at[i], before, here, tolerance, borders);
    before = here;
  }
  borders.push_back(end);
  for (std::size_t i = 1, count = borders.size(); i < count; ++i) {
    add_steep(course, {.from = borders[i - 1], .to = borders[i]}, borders);
  }
  std::ranges::sort(borders);
  for (std::size_t i = 1; i < borders.size(); ++i) {
    Interval interval = {.from = borders[i - 1], .to = borders[i], .straight = piece.arc_radius_m == 0.0};
    if (interval.length() < 1e-9 * piece.length_m) continue;
    const Profile::Point middle = patch.profile().at(0.5 * (interval.from + interval.to));
    interval.area_m2 = interval.length() * middle.radius_m * patch.arcs(middle).length();
    if (interval.area_m2 > 0.0) intervals.push_back(interval);
  }
}

/// Where within an interval of a ball the engaged angle is far steeper than beside it, in the variable that Gauss's
/// rule is laid in: a ring nearly touches the patch's border there. Empty: nowhere.
std::optional<double> steep_place(const BallPatch& ball, double radius, double from, double to) {
  constexpr int cells = 10;
  constexpr double steep = 1.5;  // times as steep as the cells beside it
  const auto place = [&](double x) { return from + (to - from) * x * x * (3.0 - 2.0 * x); };
  const auto angle = [&](double x) { return ball.arcs(place(x) / radius).length(); };
  std::array<double, cells + 1> at = {};
  for (int i = 0; i <= cells; ++i) at.at(static_cast<std::size_t>(i)) = angle((i + 0.01) / (cells + 0.02));
  const auto change = [&](std::size_t i) { return std::abs(at.at(i + 1) - at.at(i)); };
  std::size_t steepest = 0;
  for (std::size_t i = 1; i + 1 < cells; ++i) {
    const double beside = std::max(change(i - 1), change(i + 1));
    const bool more = change(i) > steep * beside && (steepest == 0 || change(i) > change(steepest));
    if (more) steepest = i;
  }
  if (steepest == 0) return std::nullopt;
  double low = (static_cast<double>(steepest) + 0.01) / (cells + 0.02);
  double high = low + 1.0 / (cells + 0.02);
  for (int i = 0; i < 12; ++i) {
    const double middle = 0.5 * (low + high);
    const double here = angle(middle);
    (std::abs(here - angle(low)) > std::abs(angle(high) - here) ? high : low) = middle;
  }
  return place(0.5 * (low + high));
}

void add_gauss_nodes(const Interval& interval, const GaussRule& rule, std::vector<Node>& nodes) {
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const double x = rule.node[i];  // 3 x² - 2 x³ on [0, 1]
    const double weight = rule.node.size() > 1 ? 6.0 * x * (1.0 - x) * rule.weight[i] : 1.0;
    nodes.push_back({.length_m = interval.from + interval.length() * x * x * (3.0 - 2.0 * x),
                     .width_m = interval.length() * weight});
  }
}

/// An interval of a ball with how fast Gauss's rule converges over it.
Interval ball_interval(const BallPatch& ball, double radius, double from, double to) {
  static const std::array<GaussRule, 3> rules = {make_gauss_rule(few_rings - 2), make_gauss_rule(few_rings),
                                                 make_gauss_rule(few_rings + 5)};
  Interval out = {.from = from, .to = to};
  std::array<double, 3> area = {};
  for (std::size_t k = 0; k < rules.size(); ++k) {
    std::vector<Node> nodes;
    add_gauss_nodes(out, rules.at(k), nodes);
    for (const Node& node : nodes) {
      const double kappa = node.length_m / radius;
      area.at(k) += node.width_m * radius * std::sin(kappa) * ball.arcs(kappa).length();
    }
  }
  out.area_m2 = area[2];
  const double coarse = std::abs(area[0] - area[2]);
  out.error_m2 = std::max(std::abs(area[1] - area[2]), 1e-12 * area[2]);
  out.ratio = std::clamp(coarse > 0.0 ? std::sqrt(out.error_m2 / coarse) : 0.0, 0.3, 0.9);
  return out;
}

/// Of a ball, whose border says where arcs change.
void add_ball_intervals(const Patch& patch, const BallPatch& ball, std::vector<Interval>& intervals) {
  const double radius = patch.profile().pieces().front().arc_radius_m;
  const auto add = [&](const Interval& interval) {
    if (interval.area_m2 > 0.0) intervals.push_back(interval);
  };
  const std::vector<double>& borders = ball.borders();
  for (std::size_t i = 1; i < borders.size(); ++i) {
    const double from = radius * borders[i - 1];
    const double to = radius * borders[i];
    if (const std::optional<double> steep = steep_place(ball, radius, from, to)) {
      add(ball_interval(ball, radius, from, *steep));
      add(ball_interval(ball, radius, *steep, to));
    } else {
      add(ball_interval(ball, radius, from, to));
    }
  }
}

bool is_even(const Patch& patch, const Interval& interval) {
  if (!interval.straight) return false;
  ArcList first;
  for (int i = 1; i <= 5; ++i) {
    const ArcList arcs = patch.arcs(patch.profile().at(interval.from + interval.length() * i / 6.0));
    if (i == 1) {
      first = arcs;
      continue;
    }
    if (arcs.size() != first.size()) return false;
    for (std::size_t k = 0; k < arcs.size(); ++k) {
      if (std::abs(arcs[k].entry - first[k].entry) > 1e-12 || std::abs(arcs[k].exit - first[k].exit) > 1e-12) {
        return false;
      }
    }
  }
  return true;
}

void add_nodes(const Patch& patch, const Interval& interval, int count, std::vector<Node>& nodes) {
  if (!is_even(patch, interval)) {
    add_gauss_nodes(interval, make_gauss_rule(count), nodes);
    return;
  }
  const double width = interval.length() / count;
  for (int i = 0; i < count; ++i) nodes.push_back({.length_m = interval.from + width * (i + 0.5), .width_m = width});
}

/// The rings of each interval, by the square roots of their areas.
std::vector<int> rings_by_area(const std::vector<Interval>& intervals, int count) {
  double left = 0.0;
  for (const Interval& interval : intervals) left += std::sqrt(interval.area_m2);
  const int least = std::clamp(count / std::max(2 * static_cast<int>(intervals.size()), 1), 1, 6);
  int spare = std::max(count - least * static_cast<int>(intervals.size()), 0);
  std::vector<int> out;
  for (const Interval& interval : intervals) {
    const double weight = std::sqrt(interval.area_m2);
    const int more = static_cast<int>(std::lround(spare * std::min(weight / left, 1.0)));
    out.push_back(least + more);
    spare -= more;
    left -= weight;
  }
  return out;
}

/// The rings of each interval of a ball such that all of them err alike, as far as that can be told from few, and then
/// by area.
std::vector<int> rings_by_error(const std::vector<Interval>& intervals, int count) {
  if (count < 2 * few_rings * static_cast<int>(intervals.size())) return rings_by_area(intervals, count);
  const auto rings_at = [&](double error_m2) {
    std::vector<int> out;
    for (const Interval& interval : intervals) {
      const double more = std::log(error_m2 / interval.error_m2) / std::log(interval.ratio);
      out.push_back(std::max(few_rings, few_rings + static_cast<int>(std::lround(more))));
    }
    return out;
  };
  const auto sum = [](const std::vector<int>& rings) { return std::accumulate(rings.begin(), rings.end(), 0); };
  double area = 0.0;
  for (const Interval& interval : intervals) area += interval.area_m2;
  double low = 1e-10 * area;
  double high = area;
  std::vector<int> rings = rings_at(low);
  if (sum(rings) <= count) {
    const std::vector<int> spare = rings_by_area(intervals, count - sum(rings));
    for (std::size_t i = 0; i < rings.size(); ++i) rings[i] += spare[i];
    return rings;
  }
  for (int i = 0; i < 30; ++i) {
    const double middle = std::sqrt(low * high);
    rings = rings_at(middle);
    (sum(rings) > count ? low : high) = middle;
  }
  return rings_at(high);
}

std::vector<Interval> intervals_of(const Patch& patch) {
  std::vector<Interval> intervals;
  if (patch.ball()) {
    add_ball_intervals(patch, *patch.ball(), intervals);
  } else {
    const std::vector<double> places = patch.places();
    for (const Profile::Piece& piece : patch.profile().pieces()) add_intervals(patch, piece, places, intervals);
  }
  return intervals;
}

}  // namespace

std::vector<Node> profile_nodes_each(const Patch& patch, int count) {
  const GaussRule rule = make_gauss_rule(count);
  std::vector<Node> nodes;
  for (const Interval& interval : intervals_of(patch)) add_gauss_nodes(interval, rule, nodes);
  return nodes;
}

std::vector<Node> profile_nodes(const Patch& patch, int count) {
  const std::vector<Interval> intervals = intervals_of(patch);
  const std::vector<int> rings = patch.ball() ? rings_by_error(intervals, count) : rings_by_area(intervals, count);
  std::vector<Node> nodes;
  nodes.reserve(static_cast<std::size_t>(count) + 8 * intervals.size());
  for (std::size_t i = 0; i < intervals.size(); ++i) add_nodes(patch, intervals[i], rings[i], nodes);
  return nodes;
}

}  // namespace robomill::cutting::detail
