#include "robomill/jobs/smooth.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/io/text.hpp"
#include "robomill/report/report.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

/// "43 %", or "–" without a limit; "!" behind what breaks it.
std::string share(const path::Usage& usage) {
  if (!(usage.limit > 0.0)) return "–";
  return fmt::format("{:.1f} %{}", 100.0 * usage.max / usage.limit, usage.violations > 0 ? " !" : "");
}

void print_row(const char* name, const std::array<std::string, 4>& cells, const std::string& more = {}) {
  fmt::print("{:<10}{:>12}{:>14}{:>12}{:>12}  {}\n", name, cells[0], cells[1], cells[2], cells[3], more);
}

void print_check(const path::SmoothedBy& by) {
  const path::CheckResult& check = by.summary.check;
  print_row("", {"velocity", "acceleration", "jerk", "tolerance"}, "of the limits");
  print_row("tip",
            {share(check.tip_velocity), share(check.tip_acceleration), share(check.tip_jerk), share(check.tip_error_m)},
            fmt::format("{:.4g} mm from the program; {:.1f} % of the feed", check.tip_error_m.max / units::mm,
                        100.0 * check.feed.max));
  print_row(
      "axis",
      {share(check.axis_velocity), share(check.axis_acceleration), share(check.axis_jerk), share(check.axis_error_rad)},
      fmt::format("{:.4g}° from the program", check.axis_error_rad.max / units::deg));
  for (std::size_t i = 0; i < check.joints.size(); ++i) {
    const path::CheckResult::Joint& joint = check.joints[i];
    std::string more;
    if (joint.position.violations > 0) more = "beyond its range";
    print_row(fmt::format("joint {}", i + 1).c_str(),
              {share(joint.velocity), share(joint.acceleration), share(joint.jerk), ""}, more);
  }
}

void print_methods(const path::SmoothedProgram& smoothed) {
  fmt::print("\n{:<18}{:>12}{:>12}{:>14}{:>14}{:>12}\n", "", "duration", "violations", "joint limits", "tip error",
             "planned in");
  for (const path::SmoothedBy& by : smoothed.methods) {
    fmt::print("{:<18}{:>10.3f} s{:>12}{:>12.1f} %{:>11.4g} mm{:>10.3f} s\n", path::name_of(by.method),
               by.summary.duration_s, by.summary.check.violations(), 100.0 * jobs::joint_share(by.summary.check),
               by.summary.check.tip_error_m.max / units::mm, by.summary.plan_s);
  }
}

/// What a controller makes of the points of a joint program.
void print_run(const path::ProgramRun& run) {
  const double shortest = run.shortest_step_s / units::ms, longest = run.longest_step_s / units::ms;
  fmt::print("\nrobot program  {} points, ", run.points);
  if (shortest == longest) {
    fmt::print("one every {:.4g} ms", longest);
  } else {
    fmt::print("{:.4g} to {:.4g} ms apart", shortest, longest);
  }
  fmt::print(
      "; joints interpolated between them: {:.4g} mm and {:.4g}° from the program, {:.4g} mm and {:.4g}° from the "
      "trajectory\n",
      run.tip_error_m / units::mm, run.axis_error_rad / units::deg, run.tip_deviation_m / units::mm,
      run.axis_deviation_rad / units::deg);
}

void print_summary(const jobs::SmoothResult& result) {
  const path::SmoothedBy& by = result.first();
  const path::Summary& summary = by.summary;
  fmt::print("{}  {:.3f} s", path::name_of(by.method), summary.duration_s);
  if (summary.lower_bound_s > 0.0) fmt::print(" (bound {:.3f} s)", summary.lower_bound_s);
  fmt::print(" for {} blocks; {} samples; planned in {:.3g} s", summary.blocks, summary.samples, summary.plan_s);
  if (summary.rounds > 1) fmt::print(", {} rounds", summary.rounds);
  fmt::print("\n\n");
  print_check(by);
  if (result.smoothed.methods.size() > 1) print_methods(result.smoothed);
  if (result.smoothed.robot_program) print_run(*result.smoothed.robot_program);
  fmt::print("\n{} violations of limits\n", summary.check.violations());
  for (const program::Skipped& item : result.smoothed.skipped)
    fmt::print("skipped    line {}: {}\n", item.line, printable(item.what));
  print_notes(result.smoothed.notes, "note       ");
}

void write_report(const std::filesystem::path& path, const jobs::SmoothResult& result) {
  if (io::lowered(path.extension().string()) == ".json") {
    io::write_file(path, path::smooth_json(result.smoothed));
    return;
  }
  report::Report page;
  page.title = "Smoothed program";
  page.smooth = jobs::smooth_report(result);
  io::write_file(path, report::report_html(page));
}

/// Runs the job; what it refuses of the command line is told in the command line's words.
jobs::SmoothResult run_job(const jobs::SmoothJob& job, Progress& progress) {
  try {
    return jobs::run_smooth(job, progress);
  } catch (const InvalidInput& error) {
    if (error.parts().field != "program_period_s" || !error.parts().number) throw;
    throw InvalidInput("--program-period-ms", *error.parts().number / units::ms, "ms", error.parts().rule);
  }
}

}  // namespace

Exit run(const SmoothCommand& command, const Common& common, Progress& progress) {
  const std::string ending = io::lowered(command.report.extension().string());
  if (!command.report.empty() && ending != ".html" && ending != ".json") {
    throw InvalidInput(command.report.string(), "a report is written as .html or .json");
  }
  jobs::SmoothJob job;
  job.program = command.program;
  job.cell = command.cell;
  if (!common.to_stdout()) job.output = common.output;
  if (command.method) job.method = path::method_of(*command.method);
  job.compare = command.compare;
  job.keep_breaches = command.keep_breaches;
  job.record = ending == ".html";
  if (command.program_period_ms) {
    require_positive("--program-period-ms", *command.program_period_ms, "ms");
    job.program_period_s = *command.program_period_ms * units::ms;
  }
  const jobs::SmoothResult result = run_job(job, progress);
  if (common.to_stdout()) fmt::print("{}", path::smooth_json(result.smoothed));
  if (!command.report.empty()) write_report(command.report, result);
  if (common.wants_summary()) print_summary(result);
  if (result.holds()) return done;
  std::string become;
  if (!job.output.empty() && !result.smoothed.written) {
    become = "; it was not written";
    if (result.stale) become += fmt::format(", and the {} of an earlier run was removed", job.output.string());
  }
  const char* what = "the trajectory breaks limits";
  if (result.trajectory_holds()) {
    what = result.smoothed.robot_program->too_long() ? "the robot program is too long for its controller, see the notes"
                                                     : "the robot program leaves its tolerances, see the notes";
  }
  fmt::print(stderr, "robomill: {}{}\n", what, become);
  return not_reached;
}

}  // namespace robomill::app
