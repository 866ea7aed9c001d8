#include "robomill/jobs/forces.hpp"

#include "robomill/jobs/pages.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

bool reached(const jobs::ForcesResult& result) {
  if (!result.revolution) return true;
  const jobs::RevolutionForces& revolution = *result.revolution;
  if (revolution.deflected.status != cutting::StaticDeflection::Status::found) return false;
  return !revolution.vibration || revolution.vibration->verdict != simulation::Verdict::undecided;
}

}  // namespace

Exit run(const ForcesCommand& command, const Common& common, Progress& progress) {
  require_output(common, {io::Format::csv, io::Format::json}, "forces are written as .csv or .json");
  const jobs::ForcesResult result = jobs::run_forces(command.input, command.program, command.cell, progress);
  write_output(common, [&](io::Format format) {
    return format == io::Format::csv ? jobs::forces_csv(result) : jobs::forces_json(result);
  });
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  return reached(result) ? done : not_reached;
}

}  // namespace robomill::app
