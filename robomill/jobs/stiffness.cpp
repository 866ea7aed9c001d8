#include "robomill/jobs/stiffness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <string>

#include "robomill/base/units.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/robot/pose.hpp"
#include "robomill/robot/usual_arm.hpp"

namespace robomill::jobs {

namespace {

/// What is unusual about the loads, and about the stiffness that they give.
void warn_of_loads(StiffnessResult& result) {
  const auto warn = [&](const std::string& text) {
    result.cell.notes.push_back(fmt::format("{}{}: {}", io::warning_label, result.loads.path.string(), text));
  };
  for (const std::string& text : robot::unusual_displacements(result.loads.loads)) warn(text);
  for (std::size_t k = 0; k < result.found.joints.size(); ++k) {
    const robot::IdentifiedJoint& joint = result.found.joints[k];
    if (!joint.identifiable || result.cell.robot.arm.joints[k].prismatic) continue;
    const auto unusual = io::unusual_value("joint_stiffness_n_m_per_rad", std::span(&joint.stiffness, 1));
    if (unusual)
      warn(fmt::format("joint {} comes out as {:.4g} N m/rad, which {}.", k + 1, joint.stiffness, unusual->rule));
  }
}

}  // namespace

StiffnessResult run_stiffness(const StiffnessJob& job) {
  StiffnessResult out;
  out.output = job.output;
  out.cell = cell::read_cell(job.cell);
  const robot::Cell& cell = out.cell.robot;
  out.loads = robot::read_loads(job.loads, cell.arm);
  out.cell.notes.insert(out.cell.notes.end(), out.loads.notes.begin(), out.loads.notes.end());
  const Eigen::Isometry3d mount = out.cell.mount();
  const Eigen::Vector3d point_m = job.point_m.value_or(mount * robot::tip_point(cell));
  out.found = robot::identify_joint_stiffness(cell.arm, mount.inverse() * point_m, out.loads);
  warn_of_loads(out);
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
