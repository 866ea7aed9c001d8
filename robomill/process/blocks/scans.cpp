#include "robomill/process/blocks/scans.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "robomill/base/parallel.hpp"
#include "robomill/process/blocks/stability.hpp"
#include "robomill/process/blocks/stand_at.hpp"
#include "robomill/process/program_forces.hpp"
#include "robomill/robot/pose.hpp"

namespace robomill::process {
namespace {

constexpr double scan_reach_m = 0.2, scan_reach_rad = 0.5 * std::numbers::pi;
constexpr std::array<const char*, 4> scan_parameters = {"x_mm", "y_mm", "z_mm", "gamma_deg"};

}  // namespace

std::vector<LimitScan> limit_scans(const ForcesResult& forces, std::size_t block, const DynamicsAt& dynamics,
                                   const BlocksOptions& options) {
  const robot::Cell& cell = forces.cell->robot;
  const BlockResult& row = forces.program->blocks[block];
  const std::optional<robot::SphericalWristInverse> inverse = spherical_wrist(cell.arm);
  const BlockCut cut = {.setup = forces.cut,
                        .cut = forces.program->cuts[block],
                        .base_from_work = cell.workpiece.linear(),
                        .spindle_speed_rad_per_s = row.force.spindle_speed_rad_per_s,
                        .tolerance = options.tolerance};
  const robot::ToolPose middle = robot::tool_pose(cell, robot::forward(cell.arm, row.joints));
  const auto points = static_cast<std::size_t>(options.scan_points);
  std::vector<LimitScan> scans(scan_parameters.size());
  for (std::size_t k = 0; k < scans.size(); ++k) {
    scans[k].parameter = scan_parameters.at(k);
    scans[k].value.resize(points);
    scans[k].limit_m.assign(points, unknown);
  }
  parallel_for(scan_parameters.size() * points, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t k = i / points;
      const std::size_t n = i % points;
      const double share = points > 1 ? 2.0 * static_cast<double>(n) / static_cast<double>(points - 1) - 1.0 : 0.0;
      robot::ToolPose pose = middle;
      double& value = k < 3 ? pose.tip_m(static_cast<Eigen::Index>(k)) : pose.gamma_rad;
      value += share * (k < 3 ? scan_reach_m : scan_reach_rad);
      scans[k].value[n] = value;
      const std::optional<Eigen::VectorXd> joints = stand_at(cell, inverse, pose, row.joints);
      if (joints) scans[k].limit_m[n] = limit_depth_m(cut, dynamics(*joints).modes);
    }
  });
  return scans;
}

}  // namespace robomill::process
