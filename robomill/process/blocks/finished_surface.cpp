#include "robomill/process/blocks/finished_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "robomill/base/parallel.hpp"

namespace robomill::process {
namespace {

constexpr int most_stations = 8;

/// By how much the depth at a place may differ from 0 and count as being on the surface: a share of a dexel, and what
/// straight lines between rays miss of an arc.
double depth_tolerance_m(const stability::SurfacePlace& place, const cutting::Profile& cutter, double dexel_m) {
  double out = 0.02 * dexel_m;
  for (const cutting::Profile::Piece& piece : cutter.pieces()) {
    const bool here = place.height_m >= piece.first.height_m && place.height_m <= piece.last.height_m;
    if (here && piece.arc_radius_m > 0.0) out += dexel_m * dexel_m / (8.0 * piece.arc_radius_m);
  }
  return out;
}

/// By how much a block's tip stands off the program in the run that the forces are of.
Eigen::Vector3d bend_of(const ProgramForces& program, std::size_t block) {
  return program.deflected ? program.blocks[block].deflection_m : Eigen::Vector3d(Eigen::Vector3d::Zero());
}

}  // namespace

std::vector<LeftPlace> left_places(std::span<const stability::SurfacePlace> surface, const cutting::Profile& cutter,
                                   const Cut& cut) {
  std::vector<LeftPlace> out;
  out.reserve(surface.size());
  for (const stability::SurfacePlace& place : surface) {
    if (!std::isfinite(place.error_m)) continue;
    const double psi = place.normal_rad;
    out.push_back({.in_tool_m = {place.radius_m * std::sin(place.angle_rad), place.radius_m * std::cos(place.angle_rad),
                                 place.height_m},
                   .normal_in_feed = {0.0, std::sin(psi), -std::cos(psi)},
                   .error_m = place.error_m,
                   .tolerance_m = depth_tolerance_m(place, cutter, cut.dexel_m)});
  }
  // A place stands for half the way to those beside it. Along a stretch of the profile they rise from one to the next;
  // lower or far ones belong to another stretch.
  const double apart_m = 0.25 * cut.cutter.mill.diameter_m;
  for (std::size_t i = 1; i < out.size(); ++i) {
    const Eigen::Vector3d way = out[i].in_tool_m - out[i - 1].in_tool_m;
    const double way_m = way.norm();
    if (way_m > apart_m || way.z() < 0.0) continue;
    out[i - 1].width_m += 0.5 * way_m;
    out[i].width_m += 0.5 * way_m;
  }
  for (LeftPlace& place : out) {
    if (place.width_m == 0.0) place.width_m = 0.01 * apart_m;  // one that stands alone
  }
  return out;
}

BlockStations::BlockStations(const program::Program& program, std::size_t block, const Eigen::Vector3d& bend_m,
                             const cutting::PoseEngagement& cut, const cutting::Profile& cutter) {
  const program::Pose& begin = program.begin_of(block);
  const program::Pose& end = program.blocks[block].end;
  const double way_m = (end.tip_m - begin.tip_m).norm();
  const int count = std::clamp(static_cast<int>(std::ceil(way_m / cutter.max_radius_m())), 1, most_stations);
  const Eigen::Matrix3d work_from_tool = cut.work_from_feed * cut.engagement.feed_from_tool;
  stations_.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    const program::Pose pose = program::between(begin, end, (k + 0.5) / count);
    const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(work_from_tool.col(2), pose.axis);
    stations_.push_back({.tip_m = pose.tip_m + bend_m, .work_from_tool = turn.toRotationMatrix() * work_from_tool});
  }
}

double BlockStations::share_on(const cutting::Workpiece& workpiece, const LeftPlace& place) const {
  const auto there = std::ranges::count_if(stations_, [&](const Station& station) {
    const double depth_m = workpiece.depth_m(station.tip_m + station.work_from_tool * place.in_tool_m);
    return std::abs(depth_m) <= place.tolerance_m;
  });
  return static_cast<double>(there) / static_cast<double>(stations_.size());
}

cutting::Workpiece finished_workpiece(const ForcesResult& forces, Progress& progress) {
  const ProgramForces& run = *forces.program;
  const cutting::Profile cutter(forces.cut.cutter);
  cutting::Workpiece out(run.stock->stock, forces.cut.dexel_m);
  for (std::size_t i = 0; i < run.blocks.size(); ++i) {
    progress.check();
    const program::Block& block = run.program.blocks[i];
    if (block.kind == program::Block::Kind::dwell || run.blocks[i].settled == BlockResult::Settled::lost) continue;
    program::Pose begin = run.program.begin_of(i);
    program::Pose end = block.end;
    begin.tip_m += bend_of(run, i);
    end.tip_m += bend_of(run, i);
    out.remove(cutter, begin, end);
  }
  return out;
}

std::vector<double> surface_left_m(const ForcesResult& forces, const std::vector<const std::vector<LeftPlace>*>& places,
                                   Progress& progress) {
  std::vector<double> out(places.size(), std::numeric_limits<double>::quiet_NaN());
  const auto leaves = [](const std::vector<LeftPlace>* list) { return list != nullptr && !list->empty(); };
  if (!forces.program->stock || std::ranges::none_of(places, leaves)) return out;
  const ProgramForces& run = *forces.program;
  const cutting::Workpiece workpiece = finished_workpiece(forces, progress);
  const cutting::Profile cutter(forces.cut.cutter);
  parallel_for(places.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!leaves(places[i])) continue;
      progress.check();
      const BlockStations stations(run.program, i, bend_of(run, i), run.cuts[i], cutter);
      const auto worst = std::ranges::find_if(
          *places[i], [&](const LeftPlace& place) { return stations.share_on(workpiece, place) > 0.0; });
      if (worst != places[i]->end()) out[i] = worst->error_m;
    }
  });
  return out;
}

}  // namespace robomill::process
