#include "robomill/stability/chart/chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <span>

#include "robomill/base/parallel.hpp"

namespace robomill::stability::detail {
namespace {

/// A node of the grid: speed and depth.
struct Node {
  std::size_t speed = 0, depth = 0;
  auto operator<=>(const Node&) const = default;
};

Eigen::Index row(std::size_t i) {
  return static_cast<Eigen::Index>(i);
}

/// Evaluates nodes that are in order, speed by speed; to the tolerance where one is given.
void evaluate_nodes(const Scheme& scheme, const Axes& axes, const std::vector<Node>& nodes,
                    std::optional<double> tolerance, GridRadii& grid, Count& count, Progress& progress) {
  std::vector<std::size_t> starts;  // of each speed's nodes
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (i == 0 || nodes[i].speed != nodes[i - 1].speed) starts.push_back(i);
  }
  starts.push_back(nodes.size());
  std::vector<Count> counts(starts.size());
  std::vector<long long> uncertain(starts.size(), 0);
  parallel_for(starts.size() - 1, 4, [&](std::size_t begin, std::size_t end) {
    const std::unique_ptr<PointEvaluator> evaluator = scheme.evaluator();
    for (std::size_t c = begin; c < end; ++c) {
      for (std::size_t first = starts[c]; first < starts[c + 1]; first += lane_count) {
        progress.check();
        const std::size_t size = std::min(lane_count, starts[c + 1] - first);
        std::array<OperatingPoint, lane_count> points;
        std::array<Outcome, lane_count> outcomes;
        for (std::size_t i = 0; i < size; ++i) points[i] = axes.at(nodes[first + i].speed, nodes[first + i].depth);
        evaluator->evaluate(std::span(points).first(size), {.estimate = tolerance.has_value()},
                            std::span(outcomes).first(size));
        for (std::size_t i = 0; i < size; ++i) {
          const Node& node = nodes[first + i];
          grid.radius(row(node.depth), row(node.speed)) = outcomes[i].spectral_radius;
          grid.unstable(row(node.depth), row(node.speed)) = outcomes[i].spectral_radius >= 1.0;
          const double allowed = tolerance.value_or(0.0) * std::max(1.0, outcomes[i].spectral_radius);
          if (tolerance && !(outcomes[i].error_estimate <= allowed)) ++uncertain[begin];
        }
      }
      progress.advance();
    }
    counts[begin].add(*evaluator);
  });
  for (const Count& c : counts) count.add(c);
  for (const long long number : uncertain) grid.uncertain += number;
}

GridRadii empty_grid(const Axes& axes) {
  GridRadii grid;
  const Eigen::Index rows = row(axes.axial_depth_m.size());
  const Eigen::Index columns = row(axes.spindle_speed_rad_per_s.size());
  grid.radius = Eigen::MatrixXd::Constant(rows, columns, std::numeric_limits<double>::quiet_NaN());
  grid.unstable = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>::Constant(rows, columns, false);
  return grid;
}

/// A rectangle of the grid, from node to node.
struct Cell {
  std::size_t speed_low = 0, speed_high = 0, depth_low = 0, depth_high = 0;
  [[nodiscard]] bool whole() const { return speed_high - speed_low <= 1 && depth_high - depth_low <= 1; }
  [[nodiscard]] std::array<Node, 4> corners() const {
    return {Node{speed_low, depth_low}, Node{speed_low, depth_high}, Node{speed_high, depth_low},
            Node{speed_high, depth_high}};
  }
};

/// Cuts a cell in four, or in two where it is one node wide.
void cut(const Cell& cell, std::vector<Cell>& out) {
  const std::size_t speed = (cell.speed_low + cell.speed_high) / 2;
  const std::size_t depth = (cell.depth_low + cell.depth_high) / 2;
  std::vector<std::array<std::size_t, 2>> speeds = {{cell.speed_low, cell.speed_high}};
  std::vector<std::array<std::size_t, 2>> depths = {{cell.depth_low, cell.depth_high}};
  if (cell.speed_high - cell.speed_low > 1) speeds = {{cell.speed_low, speed}, {speed, cell.speed_high}};
  if (cell.depth_high - cell.depth_low > 1) depths = {{cell.depth_low, depth}, {depth, cell.depth_high}};
  for (const auto& s : speeds) {
    for (const auto& d : depths) out.push_back({s[0], s[1], d[0], d[1]});
  }
}

class BoundarySearch {
 public:
  BoundarySearch(const Scheme& scheme, const Axes& axes, Count& count, Progress& progress)
      : scheme_(scheme), axes_(axes), count_(count), progress_(progress), grid_(empty_grid(axes)) {}

  GridRadii run() {
    std::vector<Cell> cells = coarse_cells();
    progress_.start("stability boundary", axes_.spindle_speed_rad_per_s.size());
    evaluate_corners(cells);
    while (!cells.empty()) {
      std::vector<Cell> finer;
      std::vector<Cell> kept;
      for (const Cell& cell : cells) {
        if (cell.whole()) continue;
        if (changes_along_border(cell) || could_hide(cell)) {
          cut(cell, finer);
        } else {
          kept.push_back(cell);
        }
      }
      if (finer.empty()) {
        fill(kept);
        break;
      }
      evaluate_corners(finer);
      cells = kept;
      cells.insert(cells.end(), finer.begin(), finer.end());
    }
    return grid_;
  }

 private:
  static constexpr std::size_t coarse_width = 8;

  static std::vector<std::size_t> coarse_marks(std::size_t nodes) {
    std::vector<std::size_t> marks;
    for (std::size_t i = 0; i + 1 < nodes; i += coarse_width) marks.push_back(i);
    marks.push_back(nodes - 1);
    return marks;
  }

  [[nodiscard]] std::vector<Cell> coarse_cells() const {
    const std::vector<std::size_t> speeds = coarse_marks(axes_.spindle_speed_rad_per_s.size());
    const std::vector<std::size_t> depths = coarse_marks(axes_.axial_depth_m.size());
    std::vector<Cell> cells;
    for (std::size_t s = 0; s + 1 < speeds.size(); ++s) {
      for (std::size_t d = 0; d + 1 < depths.size(); ++d) {
        cells.push_back({speeds[s], speeds[s + 1], depths[d], depths[d + 1]});
      }
    }
    return cells;
  }

  void evaluate_corners(const std::vector<Cell>& cells) {
    std::vector<Node> nodes;
    for (const Cell& cell : cells) {
      for (const Node& node : cell.corners()) {
        if (!grid_.known(row(node.depth), row(node.speed))) nodes.push_back(node);
      }
    }
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    evaluate_nodes(scheme_, axes_, nodes, {}, grid_, count_, progress_);
  }

  /// Whether known nodes on the cell's border, its corners or those of finer neighbours, differ in stability.
  [[nodiscard]] bool changes_along_border(const Cell& cell) const {
    const bool first = grid_.unstable(row(cell.depth_low), row(cell.speed_low));
    const auto differs = [&](std::size_t speed, std::size_t depth) {
      return grid_.known(row(depth), row(speed)) && grid_.unstable(row(depth), row(speed)) != first;
    };
    for (std::size_t s = cell.speed_low; s <= cell.speed_high; ++s) {
      if (differs(s, cell.depth_low) || differs(s, cell.depth_high)) return true;
    }
    for (std::size_t d = cell.depth_low; d <= cell.depth_high; ++d) {
      if (differs(cell.speed_low, d) || differs(cell.speed_high, d)) return true;
    }
    return false;
  }

  /// Whether ln |μ| falls or rises so steeply across the cell that it could reach 0 and come back inside.
  [[nodiscard]] bool could_hide(const Cell& cell) const {
    double least = std::numeric_limits<double>::infinity();
    double low = least;
    double high = -least;
    for (const Node& node : cell.corners()) {
      const double value = std::log(grid_.radius(row(node.depth), row(node.speed)));
      least = std::min(least, std::abs(value));
      low = std::min(low, value);
      high = std::max(high, value);
    }
    return least < 0.5 * (high - low);
  }

  /// Inside what was not cut all is as its corners are.
  void fill(const std::vector<Cell>& cells) {
    for (const Cell& cell : cells) {
      const bool unstable = grid_.unstable(row(cell.depth_low), row(cell.speed_low));
      for (std::size_t s = cell.speed_low; s <= cell.speed_high; ++s) {
        for (std::size_t d = cell.depth_low; d <= cell.depth_high; ++d) {
          if (!grid_.known(row(d), row(s))) grid_.unstable(row(d), row(s)) = unstable;
        }
      }
    }
  }

  const Scheme& scheme_;
  const Axes& axes_;
  Count& count_;
  Progress& progress_;
  GridRadii grid_;
};

}  // namespace

Eigen::VectorXd to_eigen(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

std::vector<double> even(const std::array<double, 2>& range, int count) {
  std::vector<double> values(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / (count - 1);
    values[static_cast<std::size_t>(i)] = (1.0 - t) * range[0] + t * range[1];
  }
  return values;
}

Axes even_axes(const LobesOptions& options) {
  return {even(options.spindle_speed_rad_per_s, options.grid[0]), even(options.axial_depth_m, options.grid[1])};
}

GridRadii evaluate_grid(const Scheme& scheme, const Axes& axes, std::optional<double> tolerance, Count& count,
                        Progress& progress) {
  GridRadii grid = empty_grid(axes);
  std::vector<Node> nodes;
  for (std::size_t s = 0; s < axes.spindle_speed_rad_per_s.size(); ++s) {
    for (std::size_t d = 0; d < axes.axial_depth_m.size(); ++d) nodes.push_back({s, d});
  }
  progress.start("stability lobes", axes.spindle_speed_rad_per_s.size());
  evaluate_nodes(scheme, axes, nodes, tolerance, grid, count, progress);
  return grid;
}

GridRadii find_boundary_nodes(const Scheme& scheme, const Axes& axes, Count& count, Progress& progress) {
  return BoundarySearch(scheme, axes, count, progress).run();
}

std::vector<Limit> grid_limits(const Scheme& scheme, const Axes& axes, const GridRadii& grid,
                               const std::vector<BoundaryPoint>& boundary, double tolerance, Count& count,
                               Progress& progress) {
  const std::size_t speeds = axes.spindle_speed_rad_per_s.size();
  std::map<double, BoundaryPoint> lowest;  // by speed
  for (const BoundaryPoint& point : boundary) {
    const auto [at, fresh] = lowest.emplace(point.spindle_speed_rad_per_s, point);
    if (!fresh && point.axial_depth_m < at->second.axial_depth_m) at->second = point;
  }
  std::vector<Limit> limits(speeds);
  std::vector<Count> counts(speeds);
  progress.start("stability limits", speeds);
  parallel_for(speeds, 2 * lane_count, [&](std::size_t begin, std::size_t end) {
    const std::unique_ptr<PointEvaluator> evaluator = scheme.evaluator();
    std::vector<Edge> edges;
    std::vector<std::size_t> owner;
    for (std::size_t s = begin; s < end; ++s) {
      limits[s].spindle_speed_rad_per_s = axes.spindle_speed_rad_per_s[s];
      if (grid.unstable(0, row(s))) {
        limits[s] = limit_at_start(*evaluator, axes.at(s, 0));
        continue;
      }
      std::size_t d = 0;
      while (d < axes.axial_depth_m.size() && !grid.unstable(row(d), row(s))) ++d;
      if (d == axes.axial_depth_m.size()) continue;
      if (const auto known = lowest.find(axes.spindle_speed_rad_per_s[s]); known != lowest.end()) {
        limits[s] = limit_at(known->second);
        continue;
      }
      edges.push_back({axes.at(s, d - 1), axes.at(s, d), grid.radius(row(d - 1), row(s)), grid.radius(row(d), row(s))});
      owner.push_back(s);
    }
    const std::vector<BoundaryPoint> found = refine(*evaluator, edges, tolerance, progress);
    for (std::size_t i = 0; i < found.size(); ++i) limits[owner[i]] = limit_at(found[i]);
    counts[begin].add(*evaluator);
    progress.advance(end - begin);
  });
  for (const Count& c : counts) count.add(c);
  return limits;
}

}  // namespace robomill::stability::detail
