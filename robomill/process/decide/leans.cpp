#include "robomill/process/decide/leans.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

namespace robomill::process {
namespace {

double angle(const Lean& lean) {
  return std::hypot(lean.lead_rad, lean.tilt_rad);
}

Eigen::Matrix3d frame_of(const Eigen::Vector3d& feed, const Eigen::Vector3d& axis) {
  Eigen::Vector3d x = feed - feed.dot(axis) * axis;
  if (x.norm() < 1e-6) x = axis.unitOrthogonal();  // it plunges all the way
  x.normalize();
  Eigen::Matrix3d out;
  out << x, axis.cross(x), axis;
  return out;
}

}  // namespace

std::vector<Lean> leans_within(const DecideOptions& options) {
  constexpr double rounding = 1.0 + 1e-9;
  const int most = static_cast<int>(std::floor(options.cone_rad / options.cone_step_rad * rounding));
  const int leads = options.is_free(Free::lead) ? most : 0;
  const int tilts = options.is_free(Free::tilt) ? most : 0;
  std::vector<Lean> out;
  for (int i = -leads; i <= leads; ++i) {
    for (int k = -tilts; k <= tilts; ++k) {
      const Lean lean = {.lead_rad = i * options.cone_step_rad, .tilt_rad = k * options.cone_step_rad};
      if ((i != 0 || k != 0) && angle(lean) <= options.cone_rad * rounding) out.push_back(lean);
    }
  }
  std::ranges::stable_sort(out, {}, [](const Lean& lean) { return std::round(angle(lean) * 1e9); });
  return out;
}

std::vector<Eigen::Matrix3d> stretch_frames(const ForcesResult& forces, const ProgramUnits& units) {
  const program::Program& program = forces.program->program;
  std::vector<Eigen::Matrix3d> out;
  out.reserve(units.stretches.size());
  for (const decision::ProgramStretch& stretch : units.stretches) {
    Eigen::Matrix3d ways = Eigen::Matrix3d::Zero();
    Eigen::Vector3d axis = Eigen::Vector3d::Zero();
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    for (std::size_t c = stretch.begin; c < stretch.end; ++c) {
      for (const std::size_t i : units.lines[c].cutting) {
        const Eigen::Vector3d way_m = program.blocks[i].end.tip_m - program.begin_of(i).tip_m;
        axis += program.blocks[i].end.axis;
        if (!(way_m.norm() > 0.0)) continue;
        ways += way_m * way_m.transpose() / way_m.norm();
        if (first.isZero(0.0) && !units.lines[c].plunges) first = way_m;
      }
    }
    axis.normalize();
    Eigen::Vector3d feed = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(ways).eigenvectors().col(2);
    const Eigen::Vector3d along =
        out.empty() || std::abs(feed.dot(out.back().col(0))) < 0.5 ? first : out.back().col(0);
    if (feed.dot(along) < 0.0) feed = -feed;
    out.push_back(frame_of(feed, axis));
  }
  return out;
}

program::Program leant(const ForcesResult& forces, const ProgramUnits& units,
                       const std::vector<Eigen::Matrix3d>& frames, const std::vector<Lean>& leans) {
  program::Program out = forces.program->program;
  const double ball_radius_m = 0.5 * forces.cut.cutter.mill.diameter_m;
  for (std::size_t k = 0; k < units.stretches.size(); ++k) {
    const double turn_rad = angle(leans[k]);
    if (turn_rad == 0.0) continue;
    const Eigen::Vector3d about = frames[k] * Eigen::Vector3d(leans[k].tilt_rad, leans[k].lead_rad, 0.0) / turn_rad;
    const Eigen::AngleAxisd turn(turn_rad, about);
    const auto lean = [&](program::Pose& pose) {
      const Eigen::Vector3d axis = (turn * pose.axis).normalized();
      pose.tip_m += ball_radius_m * (pose.axis - axis);
      pose.axis = axis;
    };
    if (units.lean_from[k] == 0) lean(out.start);
    const std::size_t end = k + 1 < units.stretches.size() ? units.lean_from[k + 1] : out.blocks.size();
    for (std::size_t i = units.lean_from[k]; i < end; ++i) lean(out.blocks[i].end);
  }
  return out;
}

}  // namespace robomill::process
