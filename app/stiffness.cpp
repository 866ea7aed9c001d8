#include "robomill/jobs/stiffness.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "robomill/base/units.hpp"
#include "robomill/jobs/pages.hpp"
#include "robomill/robot/files/stiffness_files.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

std::string document(const jobs::StiffnessResult& result, io::Format format) {
  const robot::Arm& arm = result.cell.cell.arm;
  if (format == io::Format::csv) return robot::stiffness_csv(result.found, arm);
  if (format == io::Format::toml) return robot::stiffness_toml(result.found, arm);
  return robot::stiffness_json(result.found, arm, result.loads);
}

}  // namespace

Exit run(const StiffnessCommand& command, const Common& common, Progress&) {
  require_output(common, {io::Format::csv, io::Format::json, io::Format::toml},
                 "joint stiffness is written as .csv, .json or as .toml, a line for cell.toml");
  jobs::StiffnessJob job = {.loads = command.loads, .cell = command.cell};
  if (!command.point_mm.empty()) {
    job.point_m = units::mm * Eigen::Vector3d(command.point_mm[0], command.point_mm[1], command.point_mm[2]);
  }
  const jobs::StiffnessResult result = jobs::run_stiffness(job);
  const robot::IdentifiedStiffness& found = result.found;
  const bool converged = found.status == robot::IdentifiedStiffness::Status::converged;
  if (converged || io::format_of(common.output) != io::Format::toml) {
    write_output(common, [&](io::Format format) { return document(result, format); });
  }
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
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
