#include "robomill/cutting/program/local.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "robomill/base/error.hpp"

namespace robomill::cutting {
namespace {

using Eigen::Array3d;
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

}  // namespace

LocalCuts::LocalCuts(const program::Program& program, double reach_m) : program_(program), reach_m_(reach_m) {
  require_positive("reach_m", reach_m, "m");
  lowest_m_ = program.start.tip_m.array();
  for (const program::Block& block : program.blocks) lowest_m_ = lowest_m_.min(block.end.tip_m.array());
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    if (!cuts(program.blocks[i])) continue;
    const Vector3d from = program.begin_of(i).tip_m;
    const Vector3d way = program.blocks[i].end.tip_m - from;
    const double steps = std::max(std::ceil(2.0 * way.norm() / reach_m), 1.0);
    for (double k = 0.0; k <= steps; k += 1.0) {
      std::vector<std::size_t>& here = blocks_[cell((from + k / steps * way).array())];
      if (here.empty() || here.back() != i) here.push_back(i);
    }
  }
}

LocalCuts::Cell LocalCuts::cell(const Array3d& place) const {
  constexpr double bias = 4.0;  // neighbours of the lowest cells are cells too
  const Array3d at = ((place - lowest_m_) / reach_m_ + bias).floor();
  constexpr Cell most = (Cell{1} << 21) - 1;
  Cell key = 0;
  for (int i = 0; i < 3; ++i) key = (key << 21) | (static_cast<Cell>(at[i]) & most);
  return key;
}

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

  std::optional<Crossing> left;
  std::optional<Crossing> right;
  std::optional<Crossing> before;
  const auto keep_nearest = [](const Crossing& found, std::optional<Crossing>& nearest) {
    if (!nearest || std::hypot(found.y, found.z) < std::hypot(nearest->y, nearest->z)) nearest = found;
  };
  // A pass within reach has a point of its in one of the cells within one and a half reaches.
  for (int i = 0; i < 125; ++i) {
    const Eigen::Array3i cells(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2);
    const Array3d step = cells.cast<double>();
    const auto here = blocks_.find(cell(middle.tip_m.array() + step * reach_m_));
    if (here == blocks_.end()) continue;
    for (const std::size_t other : here->second) {
      if (other == block) continue;
      const std::optional<Crossing> found =
          crossing(program_.begin_of(other).tip_m, program_.blocks[other].end.tip_m, middle.tip_m, out.work_from_feed);
      // Steep ones are other walls, near ones the same pass again.
      if (!found || std::abs(found->z) > std::abs(found->y) || std::abs(found->y) < 1e-3 * reach_m_) continue;
      if (std::hypot(found->y, found->z) > reach_m_) continue;
      keep_nearest(*found, found->y > 0.0 ? left : right);
      if (other < block) keep_nearest(*found, before);
    }
  }
  bend(left, right, out);
  if (before) {
    out.neighbour = before->y > 0.0 ? LocalCut::Neighbour::left : LocalCut::Neighbour::right;
    out.stepover_m = std::hypot(before->y, before->z);
  }
  return out;
}

}  // namespace robomill::cutting
