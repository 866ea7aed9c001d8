#include "robomill/stability/collocation/mesh/given_engagement.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/stability/gauss.hpp"

namespace robomill::stability::detail {
namespace {

using cutting::Arc;
using cutting::EdgeSlice;
using cutting::Engagement;

constexpr double degree = 0.017453292519943295;
constexpr double alike_arc_rad = 1.0 * degree;       // by which ends of merged arcs may differ
constexpr double alike_position_rad = 1.0 * degree;  // by which κ may grow in a merged ring
constexpr double alike_lag_rad = 2.0 * degree;       // by which the edge may lag along a merged ring

double half_height_m(const EdgeSlice& ring) {
  return 0.5 * ring.width_m * std::sin(ring.position_rad);
}

void push(const EdgeSlice& ring, std::span<const Arc> arcs, Engagement& out) {
  out.slices.push_back(ring);
  out.arcs.insert(out.arcs.end(), arcs.begin(), arcs.end());
  out.first_arc.push_back(out.arcs.size());
}

double covered_rad(std::span<const Arc> arcs) {
  double sum = 0.0;
  for (const Arc& arc : arcs) sum += arc.exit_rad - arc.entry_rad;
  return sum;
}

/// Rings taken together: means weighted by the width.
class Group {
 public:
  Group(const EdgeSlice& ring, std::span<const Arc> arcs) : first_(ring), sum_(ring), arcs_(arcs.begin(), arcs.end()) {
    start_ = arcs_;
  }

  [[nodiscard]] bool takes(const EdgeSlice& ring, std::span<const Arc> arcs, double lag_rad_per_m) const {
    const double touching = half_height_m(last_or_first()) + half_height_m(ring) + 1e-12;
    if (arcs.size() != arcs_.size() || ring.height_m - last_or_first().height_m > 1.5 * touching) return false;
    const double higher = ring.height_m - first_.height_m;
    if (std::abs(lag_rad_per_m) * higher > alike_lag_rad) return false;
    if (std::abs(ring.position_rad - first_.position_rad) > alike_position_rad) return false;
    for (std::size_t i = 0; i < arcs.size(); ++i) {
      if (std::abs(arcs[i].entry_rad - start_[i].entry_rad) > alike_arc_rad) return false;
      if (std::abs(arcs[i].exit_rad - start_[i].exit_rad) > alike_arc_rad) return false;
    }
    return true;
  }

  void add(const EdgeSlice& ring, std::span<const Arc> arcs) {
    const double width = sum_.width_m + ring.width_m;
    const double share = ring.width_m / width;
    const auto mix = [share](double& mean, double value) { mean += share * (value - mean); };
    mix(sum_.radius_m, ring.radius_m);
    mix(sum_.height_m, ring.height_m);
    mix(sum_.position_rad, ring.position_rad);
    mix(sum_.edge_length_per_width, ring.edge_length_per_width);
    sum_.width_m = width;
    for (std::size_t i = 0; i < arcs.size(); ++i) {
      mix(arcs_[i].entry_rad, arcs[i].entry_rad);
      mix(arcs_[i].exit_rad, arcs[i].exit_rad);
    }
    last_ = ring;
  }

  void close(Engagement& out) const { push(sum_, arcs_, out); }

 private:
  [[nodiscard]] const EdgeSlice& last_or_first() const { return last_ ? *last_ : first_; }

  EdgeSlice first_, sum_;
  std::optional<EdgeSlice> last_ = {};
  std::vector<Arc> start_, arcs_;
};

/// Where the profile reaches a height, by its length within a piece.
double length_at_m(const cutting::Profile& profile, const cutting::Profile::Piece& piece, double height_m) {
  double low = piece.start_m;
  double high = piece.start_m + piece.length_m;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (profile.at(middle).height_m < height_m ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

Engagement merged_rings(const cutting::Cutter& cutter, const Engagement& engagement) {
  Engagement out;
  out.feed_from_tool = engagement.feed_from_tool;
  out.first_arc = {0};
  double lag_rad_per_m = 0.0;
  for (int j = 0; j < cutter.mill.teeth; ++j) {
    if (std::abs(cutter.mill.lag_rad_per_m(j)) > std::abs(lag_rad_per_m)) lag_rad_per_m = cutter.mill.lag_rad_per_m(j);
  }
  std::optional<Group> group;
  for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
    const EdgeSlice& ring = engagement.slices[i];
    if (engagement.of(i).empty() || !(ring.width_m > 0.0)) continue;
    if (group && group->takes(ring, engagement.of(i), lag_rad_per_m)) {
      group->add(ring, engagement.of(i));
      continue;
    }
    if (group) group->close(out);
    group.emplace(ring, engagement.of(i));
  }
  if (group) group->close(out);
  return out;
}

GivenEngagement::GivenEngagement(const cutting::Cutter& cutter, const Engagement& engagement)
    : profile_(cutter), mill_(cutter.mill), engagement_(merged_rings(cutter, engagement)) {
  if (engagement_.empty()) return;
  low_m_ = 1e300;
  high_m_ = -1e300;
  for (const EdgeSlice& ring : engagement_.slices) {
    low_m_ = std::min(low_m_, ring.height_m - half_height_m(ring));
    high_m_ = std::max(high_m_, ring.height_m + half_height_m(ring));
  }
  const double upper_m = high_m_ - 0.25 * (high_m_ - low_m_);
  double widest_rad = -1.0;
  for (std::size_t i = 0; i < engagement_.slices.size(); ++i) {
    const EdgeSlice& ring = engagement_.slices[i];
    if (ring.height_m + half_height_m(ring) < upper_m) continue;
    if (covered_rad(engagement_.of(i)) < widest_rad) continue;
    widest_rad = covered_rad(engagement_.of(i));
    upper_ = i;
  }
}

Engagement GivenEngagement::at(double depth_m, int rings) const {
  Engagement out;
  out.feed_from_tool = engagement_.feed_from_tool;
  out.first_arc = {0};
  constexpr double least_depth_m = 1e-9;  // below it nothing is cut
  if (engagement_.empty() || depth_m < least_depth_m) return out;
  const double top_m = low_m_ + depth_m;
  for (std::size_t i = 0; i < engagement_.slices.size(); ++i) {
    EdgeSlice ring = engagement_.slices[i];
    const double half = half_height_m(ring);
    const double bottom_m = ring.height_m - half;
    const double share = half > 0.0 ? std::clamp((top_m - bottom_m) / (2.0 * half), 0.0, 1.0) : 1.0;
    if (ring.height_m - half >= top_m && half > 0.0) continue;
    ring.width_m *= share;
    ring.height_m = bottom_m + share * half;
    if (ring.width_m > 0.0) push(ring, engagement_.of(i), out);
  }
  if (top_m > high_m_ + 1e-12) extend(top_m, rings, out);
  return out;
}

void GivenEngagement::extend(double to_m, int rings, Engagement& out) const {
  const GaussRule& rule = gauss_rule(std::clamp(rings, 4, most_gauss_points));
  for (const cutting::Profile::Piece& piece : profile_.pieces()) {
    const double low = std::max(piece.first.height_m, high_m_);
    const double high = std::min(piece.last.height_m, to_m);
    if (!(high - low > 1e-12)) continue;
    const double from = length_at_m(profile_, piece, low);
    const double to = length_at_m(profile_, piece, high);
    for (std::size_t q = 0; q < rule.node.size(); ++q) {
      const cutting::Profile::Point at = profile_.at(from + (to - from) * rule.node[q]);
      push({.radius_m = at.radius_m,
            .height_m = at.height_m,
            .position_rad = at.position_rad,
            .width_m = (to - from) * rule.weight[q],
            .edge_length_per_width = cutting::edge_length_per_width(mill_, 0, at)},
           engagement_.of(upper_), out);
    }
  }
}

}  // namespace robomill::stability::detail
