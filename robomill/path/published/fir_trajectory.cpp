#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "robomill/path/published/fir.hpp"

namespace robomill::path {

using Eigen::Vector3d;
using Eigen::Vector4d;
using AxisJet = Eigen::Matrix<double, 3, 4>;

namespace {

// A vector that moves, turned by an angle that moves about a fixed axis: d/dt (R x) = R (x' + φ' n × x), thrice.
AxisJet turned(const AxisJet& x, const Vector3d& normal, const Vector4d& angle) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle[0], normal).toRotationMatrix();
  const auto across = [&normal](const Vector3d& v) { return Vector3d(normal.cross(v)); };
  const Vector3d x0 = x.col(0), x1 = x.col(1), x2 = x.col(2), x3 = x.col(3);
  const Vector3d n0 = across(x0), n1 = across(x1), n2 = across(x2);
  const double f1 = angle[1], f2 = angle[2], f3 = angle[3];
  const Vector3d z1 = x1 + f1 * n0;
  const Vector3d z1_dot = x2 + f2 * n0 + f1 * n1;
  const Vector3d z1_ddot = x3 + f3 * n0 + 2.0 * f2 * n1 + f1 * n2;
  const Vector3d z2 = z1_dot + f1 * across(z1);
  const Vector3d z2_dot = z1_ddot + f2 * across(z1) + f1 * across(z1_dot);
  const Vector3d z3 = z2_dot + f1 * across(z2);
  AxisJet out;
  out << turn * x0, turn * z1, turn * z2, turn * z3;
  return out;
}

}  // namespace

FirTrajectory::FirTrajectory(const program::Program& program, std::vector<FirBlock> blocks,
                             const std::vector<double>& gamma_rad)
    : blocks_(std::move(blocks)) {
  const std::size_t count = blocks_.size();
  const auto gamma = [&gamma_rad](std::size_t i) {
    return gamma_rad.empty() ? 0.0 : gamma_rad[gamma_rad.size() == 1 ? 0 : i];
  };
  moves_.resize(count);
  first_active_.resize(count);
  name_from_s_.resize(count);
  program::Pose end = program.start;
  double gamma_end = gamma(0);
  std::size_t active = 0;
  double share_before_s = 0.0;  // what the block before shares with the one at hand
  for (std::size_t i = 0; i < count; ++i) {
    const FirBlock& block = blocks_[i];
    Move& move = moves_[i];
    const program::Pose begin = end;
    const double gamma_begin = gamma_end;
    if (block.tip.count > 0) {
      end = program.blocks[i].end;
      gamma_end = gamma(i + 1);
    }
    move = {.tip_begin_m = begin.tip_m,
            .tip_way_m = end.tip_m - begin.tip_m,
            .axis_begin = begin.axis,
            .normal = begin.axis.cross(end.axis),
            .angle_rad = program::angle_between(begin.axis, end.axis),
            .gamma_begin_rad = gamma_begin,
            .gamma_way_rad = gamma_end - gamma_begin};
    const double size = move.normal.norm();
    move.normal = size > 0.0 ? Vector3d(move.normal / size) : Vector3d(begin.axis.unitOrthogonal());
    duration_s_ = std::max(duration_s_, block.end_s);
    while (active < i && blocks_[active].end_s <= block.start_s) ++active;
    first_active_[i] = active;
    name_from_s_[i] = block.start_s + 0.5 * share_before_s;
    if (block.end_s > block.start_s) share_before_s = block.overlap_s;
  }
  for (std::size_t i = count; i-- > 1;) {
    // What takes no time is never named, and nothing is named before what comes before it.
    const bool empty = !(blocks_[i - 1].end_s > blocks_[i - 1].start_s);
    name_from_s_[i - 1] = empty ? name_from_s_[i] : std::min(name_from_s_[i - 1], name_from_s_[i]);
  }
  end_.tip_m.col(0) = end.tip_m;
  end_.axis.col(0) = end.axis;
  end_.gamma_rad[0] = gamma_end;
}

robot::ToolJet FirTrajectory::at(double time_s) const {
  if (blocks_.empty() || time_s >= duration_s_) return end_;
  const double t = std::max(0.0, time_s);
  const auto after = std::upper_bound(blocks_.begin(), blocks_.end(), t,
                                      [](double value, const FirBlock& block) { return value < block.start_s; });
  const std::size_t last = static_cast<std::size_t>(std::distance(blocks_.begin(), after)) - 1;
  const std::size_t first = first_active_[last];
  robot::ToolJet jet;
  jet.tip_m.col(0) = moves_[first].tip_begin_m;
  jet.axis.col(0) = moves_[first].axis_begin;
  jet.gamma_rad[0] = moves_[first].gamma_begin_rad;
  for (std::size_t i = first; i <= last; ++i) {
    const FirBlock& block = blocks_[i];
    if (block.tip.count == 0) continue;
    const Move& move = moves_[i];
    const Vector4d tip = share_at(block.tip, t - block.start_s);
    jet.tip_m += move.tip_way_m * tip.transpose();
    jet.gamma_rad += move.gamma_way_rad * tip.transpose();
    if (move.angle_rad > 0.0) {
      jet.axis = turned(jet.axis, move.normal, move.angle_rad * share_at(block.axis, t - block.start_s));
    }
  }
  return jet;
}

std::size_t FirTrajectory::block_at(double time_s) const {
  const auto after = std::upper_bound(name_from_s_.begin(), name_from_s_.end(), time_s);
  const auto index = std::distance(name_from_s_.begin(), after);
  return index == 0 ? 0 : static_cast<std::size_t>(index) - 1;
}

}  // namespace robomill::path
