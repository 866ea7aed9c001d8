#include "robomill/jobs/stiffness.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "robomill/base/units.hpp"
#include "robomill/robot/pose.hpp"

namespace robomill::jobs {

StiffnessResult run_stiffness(const StiffnessJob& job) {
  StiffnessResult out;
  out.output = job.output;
  out.cell = read_cell(job.cell);
  const robot::Cell& cell = out.cell.cell;
  out.loads = robot::read_loads(job.loads, cell.arm);
  const Eigen::Isometry3d mount = out.cell.mount();
  const Eigen::Vector3d point_m = job.point_m.value_or(mount * robot::tip_point(cell));
  out.found = robot::identify_joint_stiffness(cell.arm, mount.inverse() * point_m, out.loads);
  if (!job.point_m) {
    const Eigen::Vector3d mm = point_m / units::mm;
    out.assumed.push_back({.what = "Point that the loads attack and that moved",
                           .taken = fmt::format("the tool's tip, ({:.6g}, {:.6g}, {:.6g}) mm in the flange frame",
                                                mm.x(), mm.y(), mm.z()),
                           .key = "--point-mm"});
  }
  if (std::ranges::all_of(out.loads.loads, [](const robot::Load& load) { return load.deviation_m == 0.0; })) {
    out.assumed.push_back({.what = "Deviations of the displacements",
                           .taken = "all alike",
                           .key = "deviation_mm",
                           .file = job.loads.filename().string()});
  }
  return out;
}

}  // namespace robomill::jobs
