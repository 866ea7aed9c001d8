#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/jobs/posture.hpp"
#include "robomill/modal/files/fit_toml.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/modal/fit.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

modal::FitOptions options_of(const ModesCommand& command, const Common& common) {
  modal::FitOptions options;
  if (!command.config.empty()) options = modal::read_fit_options(command.config);
  options.seed = common.seed;
  if (command.method) options.method = value_in(modal::fit_method_names, *command.method).value();
  if (!command.band_hz.empty()) {
    options.band_low_hz = command.band_hz[0];
    options.band_high_hz = command.band_hz[1];
  }
  if (command.modes > 0) options.modes = command.modes;
  return options;
}

template <class Bounds>
void print_modes(const modal::ModalModel& model, Bounds bounds_of) {
  fmt::print("mode  frequency Hz     damping %\n");
  for (std::size_t k = 0; k < model.modes.size(); ++k) {
    const modal::Mode& mode = model.modes[k];
    const auto spread = [](double std) { return std::isfinite(std) ? fmt::format(" ± {:.2g}", std) : std::string(); };
    fmt::print("{:>4}  {:.6g}{}  {:.4g}{}{}\n", k + 1, mode.frequency_hz, spread(mode.frequency_std_hz),
               100.0 * mode.damping_ratio, spread(100.0 * mode.damping_ratio_std), bounds_of(static_cast<int>(k) + 1));
  }
}

void print_summary(const modal::FitResult& fit) {
  print_modes(fit.model, [&](int mode) {
    std::string bounds;
    for (const modal::FitBound bound : fit.bounds_of(mode)) bounds += fmt::format("  at {}", to_string(bound));
    return bounds;
  });
  fmt::print("\n{:.4g} to {:.4g} Hz: relative error {:.4g}, mean relative error {:.4g}\n", fit.band_low_hz,
             fit.band_high_hz, fit.relative_error, fit.mean_relative_error);
  print_notes(fit.warnings, "Warning: ");
}

}  // namespace

namespace {

/// The posture of --joints, with errors in the option's words.
jobs::ModesOfPosture posture_of(const ModesCommand& command, Progress& progress) {
  std::vector<double> joints;
  for (const double angle : command.joints_deg) joints.push_back(angle * units::deg);
  try {
    return jobs::posture_modes(command.cell, joints, value_in(jobs::posture_axes_names, command.axes).value(),
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
  const jobs::ModesOfPosture posture = posture_of(command, progress);
  write_output(common, [&](io::Format) { return jobs::posture_modes_json(posture); });
  if (!common.wants_summary()) return done;
  print_modes(posture.prediction.modes, [](int) { return std::string(); });
  print_notes(jobs::posture_warnings(posture), "Warning: ");
  print_notes(posture.notes, "Note: ");
  return done;
}

}  // namespace

Exit run(const ModesCommand& command, const Common& common, Progress& progress) {
  require_output(common, {io::Format::json}, "modes are written as .json");
  if (!command.cell.empty()) return run_posture(command, common, progress);
  if (command.inputs.empty()) {
    fmt::print(stderr, "robomill: modes needs FRF files, or --cell with --joints\n");
    return wrong_usage;
  }
  const modal::FrfFile file = modal::read_frfs(command.inputs, command.as);
  modal::FitOptions options = options_of(command, common);
  if (file.added_decay_per_s > 0.0) options.exponential_decay_per_s = file.added_decay_per_s;
  modal::FitResult fit = modal::fit_modes(file.set, options, progress);
  fit.accepted = command.accept_fit;
  write_output(common, [&](io::Format) { return modal::modes_json(fit); });
  if (common.wants_summary()) {
    print_notes(file.notes, "Note: ");
    print_summary(fit);
  }
  if (fit.status != modal::FitResult::Status::converged) {
    fmt::print(stderr, "robomill: the fit did not converge\n");
    return not_reached;
  }
  if (fit.usable()) return done;
  fmt::print(stderr, "robomill: the modes do not describe the FRFs; --accept-fit takes them all the same\n");
  return not_reached;
}

}  // namespace robomill::app
