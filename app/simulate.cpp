#include <fmt/format.h>

#include <cmath>

#include "point.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/files/lobes_toml.hpp"
#include "robomill/modal/fit.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/simulation/drilling.hpp"
#include "robomill/simulation/files/simulation_files.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

using simulation::Simulation;
using simulation::SmallVibration;
using simulation::Verdict;

/// @throws InvalidInput if the ending is none that a simulation has
void check_output(const Common& common) {
  if (common.output.empty() || common.to_stdout()) return;
  switch (io::format_of(common.output)) {
    case io::Format::csv:
    case io::Format::mat:
    case io::Format::wav:
    case io::Format::json:
      return;
    default:
      throw InvalidInput(common.output, "a simulation is written as .csv, .mat, .wav or .json");
  }
}

/// A simulation steps modes: where FRFs are given, those of the hybrid fit over all their lines.
void fit_where_measured(const std::filesystem::path& path, modal::FrfSet& measured, modal::ModalModel& model,
                        bool reported, Progress& progress) {
  if (measured.frfs.empty()) return;
  const modal::FitResult fit = modal::fit_modes(measured, {}, progress);
  if (!fit.usable()) {
    throw InvalidInput(
        path.string(), fmt::format("the modes fitted to it differ from it by {:.3g} %", 100.0 * fit.relative_error),
        "Fit the band in which it can be trusted with robomill modes, and name the result as dynamics.modes");
  }
  model = fit.model;
  measured = {};
  if (reported) {
    fmt::print("{}: {} modes fitted, {:.2g} % of the FRFs left over.\n", printable(path.filename().string()),
               model.modes.size(), 100.0 * fit.relative_error);
  }
}

jobs::LobesFile read_cut(const std::filesystem::path& path, bool reported, Progress& progress) {
  jobs::LobesFile file = jobs::read_lobes(path);
  jobs::load_dynamics(file);
  stability::LobesProblem& problem = file.problem;
  if (reported) print_notes(file.notes, "Note: ");
  fit_where_measured(file.frf, problem.measured, problem.dynamics, reported, progress);
  fit_where_measured(file.workpiece_frf, problem.workpiece_measured, problem.workpiece_dynamics, reported, progress);
  file.validate();
  if (!file.drilling && !(file.problem.milling.feed_per_tooth_m > 0.0)) {
    throw InvalidInput(InvalidInput::Parts{.where = path.string(),
                                           .field = "cut.feed_per_tooth_mm",
                                           .rule = "must be given and > 0",
                                           .hint = "Without feed nothing is cut"});
  }
  return file;
}

modal::TipModes structure_of(const stability::LobesProblem& problem) {
  modal::TipModes tool = modal::tip_modes(problem.dynamics, problem.keep_modes, problem.feed_direction_rad);
  if (problem.workpiece_dynamics.modes.empty()) return tool;
  return modal::joined(
      tool, modal::tip_modes(problem.workpiece_dynamics, {}, problem.feed_direction_rad, modal::ModeOwner::workpiece));
}

void print_small(const SmallVibration& small) {
  switch (small.status) {
    case SmallVibration::Status::found:
      fmt::print("Small vibration {} by |μ| = {:.5f} ± {:.0e} in each period of {:.4g} ms.\n",
                 small.spectral_radius < 1.0 ? "dies out" : "grows", small.spectral_radius, small.error_estimate,
                 small.period_s / units::ms);
      return;
    case SmallVibration::Status::not_converged:
      fmt::print("The multiplier of small vibration did not converge.\n");
      return;
    case SmallVibration::Status::not_periodic:
      fmt::print("The swing of the speed repeats in no 50 revolutions: no multiplier.\n");
      return;
    case SmallVibration::Status::rigid:
      fmt::print("Nothing can vibrate.\n");
  }
}

void print_summary(const Simulation& s, const stability::OperatingPoint& point) {
  fmt::print("{:.6g} rpm, {:.4g} mm: {}{}", point.spindle_speed_rad_per_s / units::rpm, point.axial_depth_m / units::mm,
             to_string(s.verdict), s.verdict == Verdict::undecided ? ": simulate for longer" : "");
  if (s.chatter_frequency_hz > 0.0) {
    fmt::print(" at {:.1f} Hz, {:.3g} µm", s.chatter_frequency_hz, s.chatter_amplitude_m / units::um);
  }
  fmt::print(".\n");
  print_small(s.small);
  if (s.force_n.rows() > 0) {
    fmt::print(
        "Forces up to {:.4g}, {:.4g}, {:.4g} N in x, y, z; edges between entry and exit touch nothing in {:.1f} % of "
        "the time.\n",
        s.force_n.col(0).cwiseAbs().maxCoeff(), s.force_n.col(1).cwiseAbs().maxCoeff(),
        s.force_n.col(2).cwiseAbs().maxCoeff(), 100.0 * s.missed_share);
  }
  for (const simulation::Wall& wall : s.walls) {
    fmt::print(
        "Wall where teeth {}: {:.3g} µm too {} (from {:.3g} to {:.3g} over the height), Ra {:.3g}, Rz {:.3g} µm.\n",
        wall.angle_rad < 1.0 ? "enter" : "leave", std::abs(wall.location_error_m) / units::um,
        wall.location_error_m > 0.0 ? "shallow" : "deep", wall.least_location_error_m / units::um,
        wall.greatest_location_error_m / units::um, wall.ra_m / units::um, wall.rz_m / units::um);
  }
  if (s.diverged) fmt::print("Without loss of contact the motion grew beyond a metre; the columns end there.\n");
  fmt::print("{} samples, {} steps a revolution, {} slice{}, estimated error {:.1g}{}, in {:.2f} s.\n",
             s.force_n.rows(), s.steps_per_revolution, s.slices, s.slices == 1 ? "" : "s", s.error_estimate,
             s.resolved ? "" : " (above tolerance)", s.seconds);
}

simulation::MillingCut milling_of(const jobs::LobesFile& file, const stability::OperatingPoint& point) {
  return {.milling = file.problem.milling,
          .structure = structure_of(file.problem),
          .spindle_speed_rad_per_s = point.spindle_speed_rad_per_s,
          .axial_depth_m = point.axial_depth_m};
}

/// The point's depth is the lips' radial width: from the pilot hole to the rim.
simulation::DrillingCut drilling_of(const jobs::LobesFile& file, const stability::OperatingPoint& point) {
  simulation::DrillingCut cut;
  cut.lips = file.problem.milling.tool.teeth;
  cut.diameter_m = file.problem.milling.tool.diameter_m;
  if (file.point_angle_rad != 0.0) cut.point_angle_rad = file.point_angle_rad;
  cut.radial_width_m = point.axial_depth_m;
  cut.feed_per_revolution_m = file.feed_per_revolution_m;
  cut.coefficients = file.problem.milling.coefficients;
  cut.structure = structure_of(file.problem);
  cut.spindle_speed_rad_per_s = point.spindle_speed_rad_per_s;
  return cut;
}

}  // namespace

Exit run(const SimulateCommand& command, const Common& common, Progress& progress) {
  check_output(common);
  const stability::OperatingPoint point = parse_point(command.at);
  const jobs::LobesFile file = read_cut(command.input, common.wants_summary(), progress);
  const simulation::SimulationOptions options = {.seconds = command.seconds,
                                                 .sample_rate_hz = command.sample_rate_hz,
                                                 .loss_of_contact = !command.linear,
                                                 .seed = common.seed};
  const Simulation result = file.drilling ? simulation::simulate(drilling_of(file, point), options, progress)
                                          : simulation::simulate(milling_of(file, point), options, progress);
  if (common.to_stdout()) {
    fmt::print("{}", simulation::simulation_json(result, point.spindle_speed_rad_per_s, point.axial_depth_m));
  } else if (!common.output.empty()) {
    if (io::format_of(common.output) == io::Format::json) {
      io::write_file(common.output,
                     simulation::simulation_json(result, point.spindle_speed_rad_per_s, point.axial_depth_m));
    } else {
      simulation::write_simulation(common.output, result);
    }
  }
  if (common.wants_summary()) print_summary(result, point);
  return result.resolved && result.verdict != Verdict::undecided ? done : not_reached;
}

}  // namespace robomill::app
