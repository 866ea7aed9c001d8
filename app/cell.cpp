#include <fmt/format.h>

#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/check.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/cell/posture_choice.hpp"
#include "robomill/jobs/pages.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

/// Runs the job; what it rejects of the command line is reported by the option's name.
cell::CellCheck check_cell(const CellCheckCommand& command, Progress& progress) {
  cell::CellFile cell = cell::read_cell(command.cell, cell::Robots::any);
  if (!command.posture_deg.empty()) cell::ask_for_posture(cell, command.posture_deg);
  cell::CellCheckJob job{.cell = command.cell, .joints = command.joints, .program = command.program};
  for (double& value : job.joints) value *= cell.hybrid ? units::mm : units::deg;  // all of its joints slide
  try {
    return cell::run_cell_check(job, std::move(cell), progress);
  } catch (const InvalidInput& error) {
    if (error.parts().field != "joints") throw;
    throw InvalidInput("--joints", error.parts().rule);
  }
}

}  // namespace

Exit run(const CellCheckCommand& command, const Common& common, Progress& progress) {
  require_output(common, jobs::Document::cell_check);
  const cell::CellCheck check = check_cell(command, progress);
  write_result(common, check);
  if (!common.report.empty()) {
    const page::Report page = jobs::page_of(check);
    write_report(common.report, page, page.cell);
  }
  if (common.wants_summary()) fmt::print("{}", cell::summary(check));
  return exit_of(jobs::shortfall(check));
}

}  // namespace robomill::app
