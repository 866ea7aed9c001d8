#include "robomill/jobs/forces.hpp"

#include "robomill/jobs/pages.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {

Exit run(const ForcesCommand& command, const Common& common, Progress& progress) {
  require_output(common, jobs::Document::forces);
  const jobs::ForcesResult result = jobs::run_forces(command.input, command.program, command.cell, progress);
  write_result(common, result);
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  return exit_of(jobs::shortfall(result));
}

}  // namespace robomill::app
