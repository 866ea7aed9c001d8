#include <fmt/format.h>

#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/jobs/cell_check.hpp"
#include "robomill/jobs/files/cell_check_json.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

/// Runs the job; what it rejects of the command line is reported by the option's name.
jobs::CellCheck check_cell(const CellCheckCommand& command, Progress& progress) {
  jobs::CellFile cell = jobs::read_cell(command.cell, jobs::Robots::any);
  jobs::CellCheckJob job{.cell = command.cell, .joints = command.joints, .program = command.program};
  for (double& value : job.joints) value *= cell.hybrid ? units::mm : units::deg;  // all of its joints slide
  try {
    return jobs::run_cell_check(job, std::move(cell), progress);
  } catch (const InvalidInput& error) {
    if (error.parts().field != "joints") throw;
    throw InvalidInput("--joints", error.parts().rule);
  }
}

}  // namespace

Exit run(const CellCheckCommand& command, const Common& common, Progress& progress) {
  require_output(common, {io::Format::json}, "a cell's check is written as .json");
  const jobs::CellCheck check = check_cell(command, progress);
  const std::string json = jobs::cell_check_json(check);
  write_output(common, [&](io::Format) { return json; });
  if (!common.report.empty()) {
    page::Report page;
    page.title = "Robot cell";
    page.summary = jobs::summary(check);
    page.cell = json;
    write_report(common.report, page, json);
  }
  if (common.wants_summary()) fmt::print("{}", jobs::summary(check));
  if (check.placement.works()) return done;
  fmt::print(stderr, "robomill: the tool does not come to the workpiece where it stands\n");
  return not_reached;
}

}  // namespace robomill::app
