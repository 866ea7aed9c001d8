#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "robomill/base/parallel.hpp"
#include "robomill/stability/chart/chart.hpp"

namespace robomill::stability::detail {
namespace {

/// An edge of the grid: from this node to the next speed, or to the next depth.
struct EdgeKey {
  Eigen::Index speed = 0, depth = 0;
  bool along_depth = false;
  auto operator<=>(const EdgeKey&) const = default;
};

/// Edges of the grid whose ends differ in stability, in a fixed order.
std::vector<EdgeKey> crossed_edges(const GridRadii& grid) {
  std::vector<EdgeKey> keys;
  for (Eigen::Index s = 0; s < grid.unstable.cols(); ++s) {
    for (Eigen::Index d = 0; d < grid.unstable.rows(); ++d) {
      const bool here = grid.unstable(d, s);
      if (d + 1 < grid.unstable.rows() && grid.unstable(d + 1, s) != here) keys.push_back({s, d, true});
      if (s + 1 < grid.unstable.cols() && grid.unstable(d, s + 1) != here) keys.push_back({s, d, false});
    }
  }
  return keys;
}

Edge edge_of(const Axes& axes, const GridRadii& grid, const EdgeKey& key) {
  const Eigen::Index speed = key.speed + (key.along_depth ? 0 : 1);
  const Eigen::Index depth = key.depth + (key.along_depth ? 1 : 0);
  const auto at = [&](Eigen::Index s, Eigen::Index d) {
    return axes.at(static_cast<std::size_t>(s), static_cast<std::size_t>(d));
  };
  return {at(key.speed, key.depth), at(speed, depth), grid.radius(key.depth, key.speed), grid.radius(depth, speed)};
}

std::vector<BoundaryPoint> refine_all(const Scheme& scheme, const std::vector<Edge>& edges, double tolerance,
                                      Count& count, Progress& progress) {
  std::vector<BoundaryPoint> points(edges.size());
  std::vector<Count> counts(edges.size());
  progress.start("stability boundary", edges.size());
  parallel_for(edges.size(), 4 * lane_count, [&](std::size_t begin, std::size_t end) {
    const std::unique_ptr<PointEvaluator> evaluator = scheme.evaluator();
    const auto at = [](auto& list, std::size_t i) { return list.begin() + static_cast<std::ptrdiff_t>(i); };
    const std::vector<Edge> mine(at(edges, begin), at(edges, end));
    std::ranges::copy(refine(*evaluator, mine, tolerance, progress), at(points, begin));
    counts[begin].add(*evaluator);
    progress.advance(end - begin);
  });
  for (const Count& c : counts) count.add(c);
  return points;
}

/// Which points are joined by a stretch of boundary inside a cell.
class Links {
 public:
  explicit Links(std::size_t points) : neighbours_(points) {}
  void join(std::size_t a, std::size_t b) {
    neighbours_[a].push_back(b);
    neighbours_[b].push_back(a);
  }
  /// Numbers the curves: open ones first from an end, then closed ones; each from its first point on.
  [[nodiscard]] std::vector<std::vector<std::size_t>> curves() const {
    std::vector<std::vector<std::size_t>> all;
    std::vector<bool> used(neighbours_.size(), false);
    for (const bool closed : {false, true}) {
      for (std::size_t i = 0; i < neighbours_.size(); ++i) {
        if (!used[i] && (closed || neighbours_[i].size() < 2)) all.push_back(walk(i, used));
      }
    }
    return all;
  }

 private:
  [[nodiscard]] std::vector<std::size_t> walk(std::size_t from, std::vector<bool>& used) const {
    std::vector<std::size_t> curve = {from};
    used[from] = true;
    for (;;) {
      const auto& next = neighbours_[curve.back()];
      const auto free = std::ranges::find_if(next, [&](std::size_t j) { return !used[j]; });
      if (free == next.end()) return curve;
      curve.push_back(*free);
      used[*free] = true;
    }
  }
  std::vector<std::vector<std::size_t>> neighbours_;
};

/// Joins what crosses the sides of every cell. Where all four sides are crossed, the middle of the cell decides.
void join_cells(const Scheme& scheme, const Axes& axes, const GridRadii& grid,
                const std::map<EdgeKey, std::size_t>& index, Count& count, Links& links) {
  const std::unique_ptr<PointEvaluator> evaluator = scheme.evaluator();
  for (Eigen::Index s = 0; s + 1 < grid.unstable.cols(); ++s) {
    for (Eigen::Index d = 0; d + 1 < grid.unstable.rows(); ++d) {
      // left, top, right, bottom
      const std::array<EdgeKey, 4> sides = {EdgeKey{s, d, true}, EdgeKey{s, d + 1, false}, EdgeKey{s + 1, d, true},
                                            EdgeKey{s, d, false}};
      std::vector<std::size_t> crossed;
      for (const EdgeKey& side : sides) {
        const auto known = index.find(side);
        if (known != index.end()) crossed.push_back(known->second);
      }
      if (crossed.size() == 2) links.join(crossed[0], crossed[1]);
      if (crossed.size() != 4) continue;
      const OperatingPoint low = axes.at(static_cast<std::size_t>(s), static_cast<std::size_t>(d));
      const OperatingPoint high = axes.at(static_cast<std::size_t>(s + 1), static_cast<std::size_t>(d + 1));
      const OperatingPoint middle = {0.5 * (low.spindle_speed_rad_per_s + high.spindle_speed_rad_per_s),
                                     0.5 * (low.axial_depth_m + high.axial_depth_m)};
      Outcome outcome;
      evaluator->evaluate({&middle, 1}, {}, {&outcome, 1});
      const bool like_first = (outcome.spectral_radius >= 1.0) == grid.unstable(d, s);
      links.join(crossed[0], crossed[like_first ? 1 : 3]);
      links.join(crossed[2], crossed[like_first ? 3 : 1]);
    }
  }
  count.add(*evaluator);
}

}  // namespace

std::vector<BoundaryPoint> string_boundary(const Scheme& scheme, const Axes& axes, const GridRadii& grid,
                                           double tolerance, Count& count, Progress& progress) {
  const std::vector<EdgeKey> keys = crossed_edges(grid);
  std::vector<Edge> edges;
  std::map<EdgeKey, std::size_t> index;
  for (const EdgeKey& key : keys) {
    index.emplace(key, edges.size());
    edges.push_back(edge_of(axes, grid, key));
  }
  const std::vector<BoundaryPoint> points = refine_all(scheme, edges, tolerance, count, progress);
  Links links(points.size());
  join_cells(scheme, axes, grid, index, count, links);
  std::vector<BoundaryPoint> strung;
  int number = 0;
  for (const std::vector<std::size_t>& curve : links.curves()) {
    ++number;
    for (const std::size_t i : curve) {
      strung.push_back(points[i]);
      strung.back().curve = number;
    }
  }
  return strung;
}

}  // namespace robomill::stability::detail
