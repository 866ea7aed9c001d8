#include "robomill/jobs/smooth.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/jobs/pages.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

/// Runs the job; what it rejects of the command line is reported by the option's name.
process::SmoothResult run_job(const jobs::SmoothJob& job, Progress& progress) {
  try {
    return jobs::run_smooth(job, progress);
  } catch (const InvalidInput& error) {
    if (error.parts().field != "program_period_s" || !error.parts().number) throw;
    throw InvalidInput("--program-period-ms", *error.parts().number / units::ms, "ms", error.parts().rule);
  }
}

}  // namespace

Exit run(const SmoothCommand& command, const Common& common, Progress& progress) {
  jobs::SmoothJob job;
  job.program = command.program;
  job.cell = command.cell;
  if (!common.to_stdout()) job.options.output = common.output;
  if (command.method) job.method = value_in(path::method_names, *command.method);
  job.compare = command.compare;
  job.near_deg = command.posture_deg;
  job.options.keep_violations = command.keep_violations;
  job.options.record = is_html(common.report);
  if (command.program_period_ms) {
    require_positive("--program-period-ms", *command.program_period_ms, "ms");
    job.options.program_period_s = *command.program_period_ms * units::ms;
  }
  const process::SmoothResult result = run_job(job, progress);
  if (common.to_stdout()) fmt::print("{}", path::smooth_json(result.smoothed));
  if (!common.report.empty()) {
    const page::Report page = jobs::page_of(result);
    write_report(common.report, page, page.smooth);
  }
  if (common.wants_summary()) fmt::print("{}", jobs::summary(result));
  return exit_of(jobs::shortfall(result));
}

}  // namespace robomill::app
