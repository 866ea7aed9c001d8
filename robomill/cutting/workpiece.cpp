#include "robomill/cutting/workpiece.hpp"

#include <algorithm>
#include <cmath>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/cutting/dexels/workpiece_rays.hpp"
#include "robomill/cutting/dexels/workpiece_sweep.hpp"

namespace robomill::cutting {
namespace {

using Eigen::Vector3d;
using Cells = Eigen::Array<std::ptrdiff_t, 3, 1>;

constexpr double bytes_of_ray = 36.0;  ///< with some that have two intervals
constexpr double finest_dexel_m = 1e-6;
constexpr double rounding_m = 1e-9;
constexpr std::size_t row_grain = 16;
constexpr double worth_sharing = 6e4;   ///< rays; fewer are cut before another thread has woken
constexpr double shank_patience = 4.0;  ///< how much farther than the edges the shank may swing in a step

/// Radius of a turned outline at a height.
double radius_at(const std::vector<Eigen::Vector2d>& outline, double z) {
  for (std::size_t i = 1; i < outline.size(); ++i) {
    const Eigen::Vector2d& low = outline[i - 1];
    const Eigen::Vector2d& high = outline[i];
    if (z > high.y() || high.y() == low.y()) continue;
    return low.x() + (high.x() - low.x()) * (z - low.y()) / (high.y() - low.y());
  }
  return 0.0;
}

/// Where a vertical ray at a radius lies within a turned outline.
template <class Add>
void turned_column(const std::vector<Eigen::Vector2d>& outline, double radius, const Add& add) {
  Span span;
  for (std::size_t i = 1; i < outline.size(); ++i) {
    const Eigen::Vector2d& low = outline[i - 1];
    const Eigen::Vector2d& high = outline[i];
    if (high.y() == low.y()) continue;
    const bool in_low = low.x() >= radius;
    const bool in_high = high.x() >= radius;
    const double at =
        in_low == in_high ? 0.0 : low.y() + (high.y() - low.y()) * (radius - low.x()) / (high.x() - low.x());
    const Span part = {.from = in_low ? low.y() : at, .to = in_high ? high.y() : at};
    if (!in_low && !in_high) continue;
    if (!span.empty() && part.from > span.to) {
      add(span);
      span = part;
    } else {
      span = {.from = std::min(span.from, part.from), .to = std::max(span.to, part.to)};
    }
  }
  add(span);
}

/// Each ray is filled, too.
void require_affordable_rays(double rays, double dexel_m, const Stock& stock) {
  constexpr double usual_dexel_m = 2.5e-4, usual_size_m = 0.3, operations_of_ray = 30.0;
  const double size_m = (stock.highest_m() - stock.lowest_m()).maxCoeff();
  const bool box = stock.shape == Stock::Shape::box;
  // The corner that lies farther from the origin.
  const bool low = stock.min_m.cwiseAbs().maxCoeff() > stock.max_m.cwiseAbs().maxCoeff();
  const Vector3d& corner = low ? stock.min_m : stock.max_m;
  Eigen::Index axis = 0;
  corner.cwiseAbs().maxCoeff(&axis);
  require_affordable(
      {.operations = operations_of_ray * rays,
       .bytes = bytes_of_ray * rays,
       .dominant = dominant_of(
           {{.field = "dexel_m", .value = dexel_m, .unit = "m", .times_usual = std::pow(usual_dexel_m / dexel_m, 2)},
            {.field = !box  ? "radius_m"
                      : low ? "min_m"
                            : "max_m",
             .value = box ? corner(axis) : 0.5 * size_m,
             .unit = "m",
             .times_usual = std::pow(size_m / usual_size_m, 2)}})});
}

void fill(Rays& rays, const Stock& stock) {
  const int axis = rays.axis();
  for (std::ptrdiff_t row = 0; row < rays.rows(); ++row) {
    for (std::ptrdiff_t column = 0; column < rays.columns(); ++column) {
      const Vector3d p = rays.point(row, column);
      const auto add = [&](const Span& span) { rays.add(row, column, span); };
      if (stock.shape == Stock::Shape::box) {
        add({.from = stock.min_m[axis], .to = stock.max_m[axis]});
        continue;
      }
      const Eigen::Vector2d off = p.head<2>() - stock.center_m;
      const bool turned = stock.shape == Stock::Shape::turned;
      if (axis == 2) {
        if (turned) {
          turned_column(stock.outline_m, off.norm(), add);
        } else if (off.norm() <= stock.radius_m) {
          add({.from = stock.bottom_m, .to = stock.top_m});
        }
        continue;
      }
      const double radius = turned ? radius_at(stock.outline_m, p.z()) : stock.radius_m;
      const double away = off[1 - axis];
      const double squared = radius * radius - away * away;
      if (squared <= 0.0) continue;
      const double half = std::sqrt(squared);
      add({.from = stock.center_m[axis] - half, .to = stock.center_m[axis] + half});
    }
  }
}

/// What one row of rays gave up.
struct RowResult {
  double edges = 0.0, shank = 0.0, shank_depth = 0.0;
  double cut_rays = 0.0;
};

struct AimedCutter {
  SweptCutter cutter;
  Rays::Range rows;
};

/// Eight columns at a time.
void cut_row(Rays& rays, std::ptrdiff_t row, const SweptSolid& solid, bool shank, std::vector<Span>& cut,
             RowResult& result) {
  const Vector3d on_row = rays.point(row, 0);
  const double at_row = on_row[rays.row_axis()];
  const Rays::Range columns = rays.columns_in(solid.columns(at_row));
  const Span reach = solid.extent(rays.axis());
  Lanes at = {};
  std::array<Span, lane_count> spans = {};
  for (std::ptrdiff_t first = columns.first; first <= columns.last; first += lane_count) {
    const auto count =
        static_cast<std::size_t>(std::min<std::ptrdiff_t>(columns.last - first + 1, std::ptrdiff_t{lane_count}));
    bool any = false;
    for (std::size_t i = 0; i < lane_count; ++i) {
      const std::ptrdiff_t column = first + static_cast<std::ptrdiff_t>(std::min(i, count - 1));
      at.v[i] = on_row[rays.column_axis()] + static_cast<double>(column) * rays.column_spacing();
      any = any || rays.touches(row, column, reach);
    }
    if (!any) continue;
    solid.about(at_row, at, spans);
    for (std::size_t i = 0; i < count; ++i) {
      const std::ptrdiff_t column = first + static_cast<std::ptrdiff_t>(i);
      Span span = spans[i];
      if (span.empty() || !rays.touches(row, column, span)) continue;
      if (!solid.exact_about()) span = solid.refine(at_row, at.v[i], span);
      if (span.empty()) continue;
      const double length = rays.cut(row, column, span, cut);
      (shank ? result.shank : result.edges) += length;
      result.cut_rays += length > 0.0 ? 1.0 : 0.0;
      if (!shank) continue;
      for (const Span& part : cut) {
        Vector3d middle = rays.point(row, column);
        middle[rays.axis()] = 0.5 * (part.from + part.to);
        result.shank_depth = std::max(result.shank_depth, solid.depth_in_side(middle));
      }
    }
  }
}

}  // namespace

namespace {}  // namespace

double Removal::volume_m3() const {
  const double weight = silhouette_m2.squaredNorm();
  return weight > 0.0 ? silhouette_m2.cwiseAbs2().dot(edges_m3 + shank_m3) / weight : 0.0;
}

struct Workpiece::Grid {
  Vector3d lowest, highest, spacing;
  double dexel = 0.0;
  std::vector<Rays> rays = {};       ///< along x, y, z
  std::vector<RowResult> rows = {};  ///< of the sweep under way
  std::array<AimedCutter, 3> aimed = {};

  void sweep(const Profile& cutter, const program::Pose& pose, const Vector3d& way, double top, Removal& total);
  /// Height above the tip at which a cylinder about the axis has left the stock's box, whichever of two places the tip
  /// stands at or between; not above 0 where none of the cutter reaches it.
  [[nodiscard]] double reach(const Vector3d& tip, const Vector3d& other_tip, const Vector3d& axis, double radius) const;
};

Workpiece::Workpiece(const Stock& stock, double dexel_m) : grid_(std::make_unique<Grid>()) {
  stock.validate();
  require_positive("dexel_m", dexel_m, "m");
  if (dexel_m < finest_dexel_m) {
    throw InvalidInput("dexel_m", dexel_m, "m", "must be at least 1 µm", "0.25 mm is usual; are the units mixed up?");
  }
  Grid& grid = *grid_;
  grid.lowest = stock.lowest_m();
  grid.highest = stock.highest_m();
  const Vector3d size = grid.highest - grid.lowest;
  const Eigen::Array3d counts = (size.array() / dexel_m - 1e-9).ceil().max(1.0);
  const double needed = counts[0] * counts[1] + counts[1] * counts[2] + counts[2] * counts[0];
  require_affordable_rays(needed, dexel_m, stock);
  grid.spacing = (size.array() / counts).matrix();
  grid.dexel = grid.spacing.maxCoeff();
  const Cells cells = counts.cast<std::ptrdiff_t>();
  grid.rays.reserve(3);
  for (int axis = 0; axis < 3; ++axis) grid.rays.emplace_back(axis, grid.lowest, grid.spacing, cells);
  for (Rays& rays : grid.rays) fill(rays, stock);
}

Workpiece::~Workpiece() = default;
Workpiece::Workpiece(Workpiece&&) noexcept = default;
Workpiece& Workpiece::operator=(Workpiece&&) noexcept = default;

double Workpiece::Grid::reach(const Vector3d& tip, const Vector3d& other_tip, const Vector3d& axis,
                              double radius) const {
  double least = 1e300;
  for (int i = 0; i < 3; ++i) {
    const double side = axis[i] > 0.0 ? highest[i] + radius : lowest[i] - radius;
    const double way = axis[i] > 0.0 ? side - std::min(tip[i], other_tip[i]) : std::max(tip[i], other_tip[i]) - side;
    if (way <= 0.0) return 0.0;
    const double slope = std::abs(axis[i]);
    if (slope > 1e-9) least = std::min(least, way / slope);
  }
  return least;
}

void Workpiece::Grid::sweep(const Profile& cutter, const program::Pose& pose, const Vector3d& way, double top,
                            Removal& total) {
  std::array<std::size_t, 4> first = {};
  double expected_rays = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    AimedCutter& aim = aimed[i];
    aim.cutter = swept_cutter(cutter, pose, way, top);
    Span across;
    for (std::vector<SweptSolid>* part : {&aim.cutter.edges, &aim.cutter.shank}) {
      for (SweptSolid& solid : *part) {
        solid.aim(static_cast<int>(i));
        expected_rays += solid.silhouette_m2() / rays[i].cell_area();
        const Span span = solid.extent(rays[i].row_axis());
        across = {.from = std::min(across.from, span.from), .to = std::max(across.to, span.to)};
      }
    }
    aim.rows = rays[i].rows_in(across);
    first[i + 1] = first[i] + static_cast<std::size_t>(std::max<std::ptrdiff_t>(aim.rows.last - aim.rows.first + 1, 0));
  }
  rows.assign(first[3], {});
  const std::size_t grain = expected_rays > worth_sharing ? row_grain : first[3];
  parallel_for(first[3], grain, [&](std::size_t begin, std::size_t end) {
    std::vector<Span> cut;
    for (std::size_t task = begin; task < end; ++task) {
      const std::size_t i = task < first[1] ? 0 : task < first[2] ? 1 : 2;
      const std::ptrdiff_t row = aimed[i].rows.first + static_cast<std::ptrdiff_t>(task - first[i]);
      for (const SweptSolid& solid : aimed[i].cutter.edges) cut_row(rays[i], row, solid, false, cut, rows[task]);
      for (const SweptSolid& solid : aimed[i].cutter.shank) cut_row(rays[i], row, solid, true, cut, rows[task]);
    }
  });
  for (std::size_t i = 0; i < 3; ++i) {
    const double area = rays[i].cell_area();
    const auto axis = static_cast<Eigen::Index>(i);
    for (std::size_t task = first[i]; task < first[i + 1]; ++task) {
      total.edges_m3[axis] += area * rows[task].edges;
      total.shank_m3[axis] += area * rows[task].shank;
      total.silhouette_m2[axis] += area * rows[task].cut_rays;
      total.shank_depth_m = std::max(total.shank_depth_m, rows[task].shank_depth);
    }
  }
}

Removal Workpiece::remove(const Profile& cutter, const program::Pose& from, const program::Pose& to) {
  Removal total;
  Grid& grid = *grid_;
  const double radius = cutter.max_radius_m();
  double steps = 1.0;
  if (const double turned = program::angle_between(from.axis, to.axis); turned > 0.0) {
    double reach = 0.0;
    for (const double share : {0.0, 0.5, 1.0}) {
      const Vector3d axis = program::between(from, to, share).axis;
      reach = std::max(reach, grid.reach(from.tip_m, to.tip_m, axis, radius));
    }
    const double edges = std::hypot(std::min(reach, cutter.height_m()), radius);
    const double shank = std::hypot(reach, radius);
    steps = std::max(std::ceil(turned * std::max(edges, shank / shank_patience) / grid.dexel), 1.0);
  }
  for (double step = 0.0; step < steps; step += 1.0) {
    const program::Pose begin = program::between(from, to, step / steps);
    const program::Pose end = program::between(from, to, (step + 1.0) / steps);
    const program::Pose held = {.tip_m = begin.tip_m, .axis = program::between(begin, end, 0.5).axis};
    const double top = grid.reach(begin.tip_m, end.tip_m, held.axis, radius);
    if (top > 0.0) grid.sweep(cutter, held, end.tip_m - begin.tip_m, top, total);
  }
  return total;
}

bool Workpiece::is_far_off(const Vector3d& low_m, const Vector3d& high_m) const {
  const double off_m = -farthest_m() + rounding_m;
  return (low_m.array() > grid_->highest.array() + off_m).any() ||
         (high_m.array() < grid_->lowest.array() - off_m).any();
}

double Workpiece::farthest_m() const {
  return -3.0 * grid_->dexel;
}

double Workpiece::depth_m(const Vector3d& point_m) const {
  const Grid& grid = *grid_;
  const double limit = -farthest_m();
  const double within =
      std::min((point_m - grid.lowest).minCoeff(), (grid.highest - point_m).minCoeff());  // of the stock's box
  if (within < -limit) return -limit;
  double best = 1e300;
  constexpr double bend_matters = 0.1;  // of a dexel; further off it changes no sign
  double depth = -limit;
  const Rays* clearest = nullptr;
  for (const Rays& rays : grid.rays) {
    double spread = 0.0;
    const double along = rays.depth(point_m, limit, spread);
    if (spread + std::abs(along) >= best) continue;
    best = spread + std::abs(along);
    depth = along;
    clearest = &rays;
  }
  if (clearest != nullptr && std::abs(depth) < bend_matters * grid.dexel) depth += clearest->bend(point_m, limit);
  return std::min(depth, within);
}

Vector3d Workpiece::volumes_m3() const {
  return {grid_->rays[0].volume(), grid_->rays[1].volume(), grid_->rays[2].volume()};
}

double Workpiece::dexel_m() const {
  return grid_->dexel;
}

std::size_t Workpiece::memory_bytes() const {
  std::size_t bytes = sizeof(Grid);
  for (const Rays& rays : grid_->rays) bytes += rays.memory_bytes();
  return bytes;
}

}  // namespace robomill::cutting
