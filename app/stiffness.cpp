#include <fmt/format.h>

#include <cmath>

#include "robomill/base/units.hpp"
#include "robomill/jobs/files/cell_toml.hpp"
#include "robomill/robot/files/loads_csv.hpp"
#include "robomill/robot/files/stiffness_files.hpp"
#include "robomill/robot/pose.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

void print_summary(const robot::IdentifiedStiffness& found, const jobs::CellFile& cell) {
  for (std::size_t i = 0; i < found.joints.size(); ++i) {
    const robot::IdentifiedJoint& joint = found.joints[i];
    const char* unit = cell.cell.arm.joints[i].prismatic ? "N/m" : "N m/rad";
    if (joint.identifiable) {
      fmt::print("joint {}  {:.6g} ± {:.2g} {}\n", i + 1, joint.stiffness, joint.deviation, unit);
    } else {
      fmt::print("joint {}  not identifiable: {}\n", i + 1, joint.reason);
    }
  }
  fmt::print("\n{} loads, residual {:.3g} mm (root mean square), R² = {:.6f}, {} iterations\n", found.residual_m.cols(),
             found.rms_m / units::mm, found.r_squared, found.iterations);
  print_notes(cell.notes, "Note: ");
}

Eigen::Vector3d point_of(const StiffnessCommand& command, const robot::Cell& cell) {
  if (command.point_mm.empty()) return robot::tip_point(cell);
  return units::mm * Eigen::Vector3d(command.point_mm[0], command.point_mm[1], command.point_mm[2]);
}

}  // namespace

Exit run(const StiffnessCommand& command, const Common& common, Progress&) {
  require_output(common, {io::Format::json, io::Format::toml},
                 "joint stiffness is written as .json or as .toml, a line for cell.toml");
  const jobs::CellFile cell = jobs::read_cell(command.cell);
  const robot::LoadsFile loads = robot::read_loads(command.loads, cell.cell.arm);
  const robot::IdentifiedStiffness found =
      robot::identify_joint_stiffness(cell.cell.arm, point_of(command, cell.cell), loads);
  const bool converged = found.status == robot::IdentifiedStiffness::Status::converged;
  if (converged || io::format_of(common.output) != io::Format::toml) {
    write_output(common, [&](io::Format format) {
      return format == io::Format::toml ? robot::stiffness_toml(found, cell.cell.arm) : robot::stiffness_json(found);
    });
  }
  if (common.wants_summary()) print_summary(found, cell);
  const bool seen = std::ranges::any_of(found.joints, [](const auto& joint) { return joint.identifiable; });
  if (converged && !seen) {
    fmt::print(stderr, "robomill: these loads determine the stiffness of no joint\n");
    return not_reached;
  }
  if (converged) return done;
  fmt::print(stderr, "robomill: the joint stiffness was not found to convergence\n");
  return not_reached;
}

}  // namespace robomill::app
