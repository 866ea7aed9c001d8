#include "robomill/jobs/explain.hpp"

#include "point.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/jobs/pages.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

InvalidInput reject(const char* option, double value, const char* unit, const char* rule, const char* hint = "") {
  return {option, value, unit, rule, hint};
}

/// In the user's words and units.
void check(const ExplainCommand& command) {
  for (const double f : command.peaks_hz) {
    if (!(f > 0.0 && f <= 1e6)) throw reject("--peaks", f, "Hz", "must lie between 0 and 1 MHz");
  }
  static_cast<void>(spindle_speed("--rpm", command.rpm));
  if (!(command.tolerance_hz > 0.0 && command.tolerance_hz < 0.25 * command.rpm / 60.0)) {
    throw reject("--tolerance-hz", command.tolerance_hz, "Hz",
                 "must be > 0 and below a quarter of the rotation frequency",
                 "Otherwise every peak is a multiple of it");
  }
  if (!(command.speed_tolerance_percent >= 0.0 && command.speed_tolerance_percent <= 5.0)) {
    throw reject("--speed-tolerance-percent", command.speed_tolerance_percent, "%", "must lie between 0 and 5");
  }
  if (command.lobes.empty() != command.at.empty()) {
    throw InvalidInput(command.at.empty() ? "--at" : "--lobes", "--lobes and --at go together",
                       "The cut says whether its chatter needs the delay: --lobes lobes.toml --at 6500,0.8");
  }
  if (!command.at.empty() && !(command.at[0] > 0.0 && command.at[1] >= 0.0)) {
    throw InvalidInput("--at", "must read RPM,MM, RPM > 0, MM >= 0");
  }
  if (!command.at.empty()) static_cast<void>(spindle_speed("--at", command.at[0]));
}

}  // namespace

Exit run(const ExplainCommand& command, const Common& common, Progress&) {
  require_output(common, jobs::Document::explanation);
  check(command);
  jobs::ExplainJob job = {.peaks = {command.peaks_hz, command.rpm * units::rpm, command.teeth},
                          .options = {command.tolerance_hz, command.speed_tolerance_percent / 100.0},
                          .modes = command.modes,
                          .lobes = command.lobes};
  if (!command.at.empty()) job.point = {command.at[0] * units::rpm, command.at[1] * units::mm};
  const jobs::ExplainResult result = jobs::run_explain(job);
  write_result(common, result);
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  return exit_of(jobs::shortfall(result));
}

}  // namespace robomill::app
