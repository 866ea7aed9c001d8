#include "robomill/cutting/program/local.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "robomill/base/error.hpp"

namespace robomill::cutting {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

bool cuts(const program::Block& block) {
  return block.kind == program::Block::Kind::feed;
}

/// A pass where it crosses the plane across the feed.
struct Crossing {
  double y = 0.0, z = 0.0;
};

std::optional<Crossing> crossing(const Vector3d& from, const Vector3d& to, const Vector3d& middle,
                                 const Matrix3d& frame) {
  constexpr double least_cosine = 0.5;
  const Vector3d way = to - from;
  const double along = way.dot(frame.col(0));
  if (!(std::abs(along) > least_cosine * way.norm())) return std::nullopt;
  const double share = (middle - from).dot(frame.col(0)) / along;
  if (!(share >= -1e-9 && share <= 1.0 + 1e-9)) return std::nullopt;
  const Vector3d offset = from + share * way - middle;
  return Crossing{.y = offset.dot(frame.col(1)), .z = offset.dot(frame.col(2))};
}

/// Parabola z = a y + b y² through the origin and what is known beside it.
void bend(const std::optional<Crossing>& left, const std::optional<Crossing>& right, LocalCut& out) {
  double a = 0.0;
  double b = 0.0;
  if (left && right) {
    b = (left->z / left->y - right->z / right->y) / (left->y - right->y);
    a = left->z / left->y - b * left->y;
  } else if (left || right) {
    const Crossing& only = left ? *left : *right;
    a = only.z / only.y;
  }
  out.slope_rad = std::atan(a);
  out.curvature_per_m = -2.0 * b / std::pow(1.0 + a * a, 1.5);
}

/// How long feed moves are on average; 0: there are none.
double mean_way_m(const program::Program& program) {
  double way_m = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    if (!cuts(program.blocks[i])) continue;
    way_m += (program.blocks[i].end.tip_m - program.begin_of(i).tip_m).norm();
    count += 1.0;
  }
  return count > 0.0 ? way_m / count : 0.0;
}

constexpr double off_sample = 0.25;  ///< of a cell: a place of a block lies no farther from one that is kept
constexpr double off_middle = 0.87;  ///< of a cell: its corners lie no farther from its middle

}  // namespace

LocalCuts::LocalCuts(const program::Program& program, double reach_m) : program_(program), reach_m_(reach_m) {
  require_positive("reach_m", reach_m, "m");
  cell_m_ = std::clamp(mean_way_m(program), 0.125 * reach_m, reach_m);
  lowest_m_ = program.start.tip_m;
  for (const program::Block& block : program.blocks) lowest_m_ = lowest_m_.cwiseMin(block.end.tip_m);
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    if (!cuts(program.blocks[i])) continue;
    const Vector3d from = program.begin_of(i).tip_m;
    const Vector3d way = program.blocks[i].end.tip_m - from;
    const double steps = std::max(std::ceil(0.5 * way.norm() / (off_sample * cell_m_)), 1.0);
    for (double k = 0.0; k <= steps; k += 1.0) {
      std::vector<std::size_t>& here = blocks_[key(steps_to(from + k / steps * way))];
      if (here.empty() || here.back() != i) here.push_back(i);
    }
  }
}

LocalCuts::Steps LocalCuts::steps_to(const Vector3d& place) const {
  return ((place - lowest_m_).array() / cell_m_).floor().cast<std::int64_t>();
}

LocalCuts::Cell LocalCuts::key(const Steps& cell) {
  constexpr std::int64_t bias = 16;  // neighbours of the lowest cells are cells too
  constexpr Cell most = (Cell{1} << 21) - 1;
  Cell key = 0;
  for (int i = 0; i < 3; ++i) key = (key << 21) | (static_cast<Cell>(cell[i] + bias) & most);
  return key;
}

/// The nearest passes beside a block, to the left, to the right and of those before it.
class LocalCuts::Nearest {
 public:
  struct Pass {
    Crossing at = {};
    double distance_m = std::numeric_limits<double>::infinity();
    std::size_t block = 0;
    [[nodiscard]] std::optional<Crossing> found() const {
      return std::isfinite(distance_m) ? std::optional(at) : std::nullopt;
    }
  };
  Pass left, right, before;

  Nearest(const LocalCuts& cuts, std::size_t block, const Vector3d& middle, const Matrix3d& frame)
      : cuts_(cuts), block_(block), middle_(middle), frame_(frame) {
    const Steps home = cuts.steps_to(middle);
    const double cell_m = cuts.cell_m_;
    // What is not seen within `ring` cells lies farther off than `seen_m`.
    double seen_m = 0.0;
    for (std::int64_t ring = 0; seen_m <= cuts.reach_m_; ++ring) {
      look_around(home, ring);
      seen_m = (static_cast<double>(ring) - off_sample) * cell_m;
      if (std::max({left.distance_m, right.distance_m, before.distance_m}) < seen_m) return;
    }
  }

 private:
  void look_around(const Steps& home, std::int64_t ring) {
    for (std::int64_t x = -ring; x <= ring; ++x) {
      for (std::int64_t y = -ring; y <= ring; ++y) {
        const bool side = std::abs(x) == ring || std::abs(y) == ring;
        const std::int64_t step = side || ring == 0 ? 1 : 2 * ring;
        for (std::int64_t z = -ring; z <= ring; z += step) look_in(home + Steps(x, y, z));
      }
    }
  }

  void look_in(const Steps& cell) {
    const double cell_m = cuts_.cell_m_;
    const Vector3d to = cuts_.lowest_m_ + cell_m * (cell.cast<double>() + 0.5).matrix() - middle_;
    const double around_m = (off_sample + off_middle) * cell_m;
    if (std::abs(to.dot(frame_.col(0))) > around_m || to.norm() > cuts_.reach_m_ + around_m) return;
    const auto here = cuts_.blocks_.find(key(cell));
    if (here == cuts_.blocks_.end()) return;
    for (const std::size_t other : here->second) look_at(other);
  }

  void look_at(std::size_t other) {
    if (other == block_) return;
    const program::Program& program = cuts_.program_;
    const std::optional<Crossing> found =
        crossing(program.begin_of(other).tip_m, program.blocks[other].end.tip_m, middle_, frame_);
    // Steep ones are other walls, near ones the same pass again.
    if (!found || std::abs(found->z) > std::abs(found->y) || std::abs(found->y) < 1e-3 * cuts_.reach_m_) return;
    const Pass pass = {.at = *found, .distance_m = std::hypot(found->y, found->z), .block = other};
    if (pass.distance_m > cuts_.reach_m_) return;
    keep_nearer(pass, found->y > 0.0 ? left : right);
    if (other < block_) keep_nearer(pass, before);
  }

  static void keep_nearer(const Pass& pass, Pass& nearest) {
    const bool equal = pass.distance_m == nearest.distance_m;
    if (pass.distance_m < nearest.distance_m || (equal && pass.block < nearest.block)) nearest = pass;
  }

  const LocalCuts& cuts_;
  std::size_t block_;
  const Vector3d& middle_;
  const Matrix3d& frame_;
};

LocalCut LocalCuts::at(std::size_t block) const {
  LocalCut out;
  const program::Pose& from = program_.begin_of(block);
  const program::Pose& to = program_.blocks[block].end;
  const Vector3d way = to.tip_m - from.tip_m;
  if (!cuts(program_.blocks[block]) || !(way.norm() > 0.0)) return out;
  const program::Pose middle = program::between(from, to, 0.5);
  const Vector3d x = way.normalized();
  Vector3d z = middle.axis - middle.axis.dot(x) * x;
  if (z.norm() < 1e-6) return out;  // a plunge
  z.normalize();
  out.work_from_feed << x, z.cross(x), z;
  const Nearest nearest(*this, block, middle.tip_m, out.work_from_feed);
  bend(nearest.left.found(), nearest.right.found(), out);
  if (const std::optional<Crossing> before = nearest.before.found()) {
    out.neighbour = before->y > 0.0 ? LocalCut::Neighbour::left : LocalCut::Neighbour::right;
    out.stepover_m = std::hypot(before->y, before->z);
  }
  return out;
}

}  // namespace robomill::cutting
