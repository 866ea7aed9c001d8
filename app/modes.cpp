#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/dynamics.hpp"
#include "robomill/jobs/modes.hpp"
#include "robomill/jobs/pages.hpp"
#include "robomill/modal/files/fit_toml.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

modal::FitOptions options_of(const ModesCommand& command, const Common& common, std::vector<std::string>& notes) {
  modal::FitOptions options;
  if (!command.config.empty()) options = modal::read_fit_options(command.config, notes);
  options.seed = common.seed;
  if (command.method) options.method = value_in(modal::fit_method_names, *command.method).value();
  if (!command.band_hz.empty()) {
    options.band_low_hz = command.band_hz[0];
    options.band_high_hz = command.band_hz[1];
  }
  if (command.modes > 0) options.modes = command.modes;
  return options;
}

/// The posture of --joints, with errors in the option's words.
cell::ModesOfPosture posture_of(const ModesCommand& command, Progress& progress) {
  std::vector<double> joints;
  for (const double angle : command.joints_deg) joints.push_back(angle * units::deg);
  try {
    return cell::posture_modes(command.cell, joints, value_in(cell::posture_axes_names, command.axes).value(),
                               progress);
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    if (!parts.where.empty() || !parts.field.starts_with("joints")) throw;
    parts.field = "--" + parts.field;
    if (parts.number) *parts.number /= units::deg;
    if (parts.number) parts.unit = "deg";
    throw InvalidInput(std::move(parts));
  }
}

/// The modes of a cell's posture.
Exit run_posture(const ModesCommand& command, const Common& common, Progress& progress) {
  const cell::ModesOfPosture posture = posture_of(command, progress);
  write_result(common, posture);
  show(common, jobs::summary(posture), [&] { return jobs::page_of(posture); });
  return exit_of(jobs::shortfall(posture));
}

}  // namespace

Exit run(const ModesCommand& command, const Common& common, Progress& progress) {
  require_output(common, jobs::Document::modes);
  if (!command.cell.empty()) return run_posture(command, common, progress);
  if (command.inputs.empty()) {
    fmt::print(stderr, "robomill: modes needs FRF files, or --cell with --joints\n");
    return wrong_usage;
  }
  jobs::ModesJob job{.frfs = command.inputs, .as = command.as, .accept_fit = command.accept_fit};
  job.options = options_of(command, common, job.notes);
  const jobs::ModesResult result = jobs::run_modes(job, progress);
  write_result(common, result);
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  std::string missing = jobs::shortfall(result);
  if (result.fit.status == modal::FitResult::Status::converged && !result.fit.usable())
    missing += "; --accept-fit takes them all the same";
  return exit_of(missing);
}

}  // namespace robomill::app
