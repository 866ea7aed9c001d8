#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/cutting/cutter.hpp"
#include "robomill/cutting/program_engagement.hpp"
#include "robomill/cutting/workpiece.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/program/program.hpp"
#include "robomill/stability/surface_error.hpp"

// Method: robomill/process/README.md, "Every block of a program (`blocks.hpp`)", "The finished surface"

namespace robomill::process {

/// A place that an edge leaves, in T and F.
struct LeftPlace {
  Eigen::Vector3d in_tool_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_in_feed = Eigen::Vector3d::Zero();  ///< unit, out of the cutter
  double error_m = 0.0;                                      ///< as SurfacePlace::error_m
  double width_m = 0.0;                                      ///< of the surface that it stands for, across the feed
  double tolerance_m = 0.0;  ///< it is on a surface where the depth at it differs from 0 by no more than this
};

/// The places of a cut's surface whose error is known, in their order.
/// @param surface  stability::surface_profile of the cut
/// @param cutter   of the cut
[[nodiscard]] std::vector<LeftPlace> left_places(std::span<const stability::SurfacePlace> surface,
                                                 const cutting::Profile& cutter, const Cut& cut);

/// The tool at up to eight stations along a block, about a radius of the cutter apart.
class BlockStations {
 public:
  /// @param bend_m  by how much the tip stands off the program, in W
  /// @param cut     of the block; how the tool is turned about its axis
  BlockStations(const program::Program& program, std::size_t block, const Eigen::Vector3d& bend_m,
                const cutting::PoseEngagement& cut, const cutting::Profile& cutter);
  /// Share of the stations at which the place stands on the workpiece's surface.
  [[nodiscard]] double share_on(const cutting::Workpiece& workpiece, const LeftPlace& place) const;

 private:
  struct Station {
    Eigen::Vector3d tip_m;
    Eigen::Matrix3d work_from_tool;
  };
  std::vector<Station> stations_;
};

/// What the program leaves of its stock, each block where its mean force bends the robot to. A block that loses its
/// engagement takes nothing away.
/// @param forces  along a program, with a stock
/// @throws Interrupted
[[nodiscard]] cutting::Workpiece finished_workpiece(const ForcesResult& forces, Progress& progress);

/// Errors of the finished surface by block: of the places that stand on the workpiece's surface at the end that of
/// greatest magnitude, NaN where there is none or the forces know no stock.
/// @param forces    along a program, with its cuts
/// @param places    one a block, or none where it leaves no surface that is known: by falling magnitude of the error
[[nodiscard]] std::vector<double> surface_left_m(const ForcesResult& forces,
                                                 const std::vector<const std::vector<LeftPlace>*>& places,
                                                 Progress& progress);

}  // namespace robomill::process
