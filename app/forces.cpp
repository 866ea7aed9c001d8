#include "robomill/jobs/forces.hpp"

#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/jobs/files/forces_toml.hpp"
#include "robomill/jobs/pages.hpp"
#include "robomill/jobs/posture_choice.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {

namespace {

jobs::ForcesResult run_job(const ForcesCommand& command, Progress& progress) {
  if (command.posture_deg.empty()) return jobs::run_forces(command.input, command.program, command.cell, progress);
  jobs::ForcesFile file = jobs::read_forces(command.input, jobs::ForcesJob::program);
  if (!command.cell.empty()) file.cell = command.cell;
  if (file.cell.empty()) throw InvalidInput("--posture", "goes with a robot", "Give --cell");
  jobs::CellFile cell = jobs::read_cell(file.cell);
  jobs::ask_for_posture(cell, command.posture_deg);
  return jobs::run_forces(std::move(file), command.program, std::move(cell), progress);
}

}  // namespace

Exit run(const ForcesCommand& command, const Common& common, Progress& progress) {
  require_output(common, jobs::Document::forces);
  const jobs::ForcesResult result = run_job(command, progress);
  write_result(common, result);
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  return exit_of(jobs::shortfall(result));
}

}  // namespace robomill::app
