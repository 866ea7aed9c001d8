#include "robomill/jobs/stiffness.hpp"

#include "robomill/base/units.hpp"
#include "robomill/jobs/pages.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {

Exit run(const StiffnessCommand& command, const Common& common, Progress&) {
  require_output(common, jobs::Document::stiffness);
  jobs::StiffnessJob job = {.loads = command.loads, .cell = command.cell};
  if (!common.to_stdout()) job.output = common.output;
  if (!command.point_mm.empty()) {
    job.point_m = units::mm * Eigen::Vector3d(command.point_mm[0], command.point_mm[1], command.point_mm[2]);
  }
  const jobs::StiffnessResult result = jobs::run_stiffness(job);
  write_result(common, result);
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  return exit_of(jobs::shortfall(result));
}

}  // namespace robomill::app
