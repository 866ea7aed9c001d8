#include "robomill/jobs/forces.hpp"

#include <fmt/format.h>

#include "robomill/base/error.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/summary.hpp"
#include "robomill/page/report.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

void write_report(const std::filesystem::path& path, const jobs::ForcesResult& result) {
  page::Report page;
  page.title = "Cutting forces";
  page.summary = jobs::summary(result);
  page.forces = jobs::forces_json(result);
  const bool html = path.extension() == ".html";
  io::write_file(path, html ? page::report_html(page) : page::report_json(page));
}

bool reached(const jobs::ForcesResult& result) {
  if (!result.revolution) return true;
  const jobs::RevolutionForces& revolution = *result.revolution;
  if (revolution.deflected.status != cutting::StaticDeflection::Status::found) return false;
  return !revolution.vibration || revolution.vibration->verdict != simulation::Verdict::undecided;
}

}  // namespace

Exit run(const ForcesCommand& command, const Common& common, Progress& progress) {
  if (!common.output.empty() && !common.to_stdout()) {
    const io::Format format = io::format_of(common.output);
    if (format != io::Format::csv && format != io::Format::json) {
      throw InvalidInput(common.output, "forces are written as .csv or .json");
    }
  }
  if (!command.report.empty() && command.report.extension() != ".html" && command.report.extension() != ".json") {
    throw InvalidInput(command.report.string(), "a report is written as .html or .json");
  }
  const jobs::ForcesResult result = jobs::run_forces(command.input, command.program, command.cell, progress);
  if (common.to_stdout()) {
    fmt::print("{}", jobs::forces_json(result));
  } else if (!common.output.empty()) {
    const bool csv = io::format_of(common.output) == io::Format::csv;
    io::write_file(common.output, csv ? jobs::forces_csv(result) : jobs::forces_json(result));
  }
  if (!command.report.empty()) write_report(command.report, result);
  if (common.wants_summary()) fmt::print("{}", jobs::summary(result));
  return reached(result) ? done : not_reached;
}

}  // namespace robomill::app
