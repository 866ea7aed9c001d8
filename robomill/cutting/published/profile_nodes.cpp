#include "robomill/cutting/published/profile_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>

#include "robomill/base/gauss.hpp"

namespace robomill::cutting::detail {
namespace {

constexpr int samples = 48;

struct Interval {
  double from = 0.0, to = 0.0;
  bool straight = false;
  double area_m2 = 0.0;  ///< of the patch, roughly
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

/// Of a ball, whose border says where arcs change.
void add_ball_intervals(const Patch& patch, const BallPatch& ball, std::vector<Interval>& intervals) {
  const double radius = patch.profile().pieces().front().arc_radius_m;
  const std::vector<double>& borders = ball.borders();
  for (std::size_t i = 1; i < borders.size(); ++i) {
    const double middle = 0.5 * (borders[i - 1] + borders[i]);
    Interval interval = {.from = radius * borders[i - 1], .to = radius * borders[i]};
    interval.area_m2 = interval.length() * radius * std::sin(middle) * ball.arcs(middle).length();
    if (interval.area_m2 > 0.0) intervals.push_back(interval);
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

void add_gauss_nodes(const Interval& interval, const GaussRule& rule, std::vector<Node>& nodes) {
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const double x = rule.node[i];  // 3 x² - 2 x³ on [0, 1]
    const double weight = rule.node.size() > 1 ? 6.0 * x * (1.0 - x) * rule.weight[i] : 1.0;
    nodes.push_back({.length_m = interval.from + interval.length() * x * x * (3.0 - 2.0 * x),
                     .width_m = interval.length() * weight});
  }
}

void add_nodes(const Patch& patch, const Interval& interval, int count, std::vector<Node>& nodes) {
  if (!is_even(patch, interval)) {
    add_gauss_nodes(interval, make_gauss_rule(count), nodes);
    return;
  }
  const double width = interval.length() / count;
  for (int i = 0; i < count; ++i) nodes.push_back({.length_m = interval.from + width * (i + 0.5), .width_m = width});
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
  double left = 0.0;
  for (const Interval& interval : intervals) left += std::sqrt(interval.area_m2);
  std::vector<Node> nodes;
  nodes.reserve(static_cast<std::size_t>(count) + 8 * intervals.size());
  const int least = std::clamp(count / std::max(2 * static_cast<int>(intervals.size()), 1), 1, 6);
  int spare = std::max(count - least * static_cast<int>(intervals.size()), 0);
  for (const Interval& interval : intervals) {
    const double weight = std::sqrt(interval.area_m2);
    const int more = static_cast<int>(std::lround(spare * std::min(weight / left, 1.0)));
    add_nodes(patch, interval, least + more, nodes);
    spare -= more;
    left -= weight;
  }
  return nodes;
}

}  // namespace robomill::cutting::detail
