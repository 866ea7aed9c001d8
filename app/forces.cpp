#include "robomill/jobs/forces.hpp"

#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/cell/posture_choice.hpp"
#include "robomill/jobs/pages.hpp"
#include "robomill/process/files/forces_toml.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {

namespace {

process::ForcesResult run_job(const ForcesCommand& command, Progress& progress) {
  if (command.posture_deg.empty()) return jobs::run_forces(command.input, command.program, command.cell, progress);
  process::ForcesFile file = process::read_forces(command.input, process::ForcesJob::program);
  if (!command.cell.empty()) file.cell = command.cell;
  if (file.cell.empty()) throw InvalidInput("--posture", "goes with a robot", "Give --cell");
  cell::CellFile cell = cell::read_cell(file.cell);
  cell::ask_for_posture(cell, command.posture_deg);
  return jobs::run_forces(file, command.program, std::move(cell), progress);
}

}  // namespace

Exit run(const ForcesCommand& command, const Common& common, Progress& progress) {
  require_output(common, jobs::Document::forces);
  const process::ForcesResult result = run_job(command, progress);
  write_result(common, result);
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  return exit_of(jobs::shortfall(result));
}

}  // namespace robomill::app
