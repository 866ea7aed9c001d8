#include "robomill/jobs/forces.hpp"

#include <fmt/format.h>

#include "robomill/jobs/summary.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

page::Report page_of(const jobs::ForcesResult& result) {
  page::Report page;
  page.title = "Cutting forces";
  page.summary = jobs::summary(result);
  page.forces = jobs::forces_json(result);
  return page;
}

bool reached(const jobs::ForcesResult& result) {
  if (!result.revolution) return true;
  const jobs::RevolutionForces& revolution = *result.revolution;
  if (revolution.deflected.status != cutting::StaticDeflection::Status::found) return false;
  return !revolution.vibration || revolution.vibration->verdict != simulation::Verdict::undecided;
}

}  // namespace

Exit run(const ForcesCommand& command, const Common& common, Progress& progress) {
  require_output(common, {io::Format::csv, io::Format::json}, "forces are written as .csv or .json");
  require_report_place(command.report);
  const jobs::ForcesResult result = jobs::run_forces(command.input, command.program, command.cell, progress);
  write_output(common, [&](io::Format format) {
    return format == io::Format::csv ? jobs::forces_csv(result) : jobs::forces_json(result);
  });
  if (!command.report.empty()) write_report(command.report, page_of(result));
  if (common.wants_summary()) fmt::print("{}", jobs::summary(result));
  return reached(result) ? done : not_reached;
}

}  // namespace robomill::app
