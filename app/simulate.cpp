#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "point.hpp"
#include "robomill/base/printable.hpp"
#include "robomill/base/units.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/simulate.hpp"
#include "robomill/simulation/files/simulation_files.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

using simulation::Simulation;
using simulation::SmallVibration;
using simulation::Verdict;

void print_fit(const std::filesystem::path& frf, const std::optional<modal::FitResult>& fit) {
  if (!fit) return;
  fmt::print("{}: {} modes fitted, {:.2g} % of the FRFs left over.\n", printable(frf.filename().string()),
             fit->model.modes.size(), 100.0 * fit->relative_error);
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

}  // namespace

Exit run(const SimulateCommand& command, const Common& common, Progress& progress) {
  require_output(common, {io::Format::csv, io::Format::mat, io::Format::wav, io::Format::json},
                 "a simulation is written as .csv, .mat, .wav or .json");
  const jobs::SimulateJob job = {.lobes = command.input,
                                 .point = parse_point(command.at),
                                 .options = {.seconds = command.seconds,
                                             .sample_rate_hz = command.sample_rate_hz,
                                             .loss_of_contact = !command.linear,
                                             .seed = common.seed}};
  const jobs::SimulateResult result = jobs::run_simulate(job, progress);
  const Simulation& simulated = result.simulation;
  if (common.output.empty() || common.to_stdout() || io::format_of(common.output) == io::Format::json) {
    write_output(common, [&](io::Format) {
      return simulation::simulation_json(simulated, job.point.spindle_speed_rad_per_s, job.point.axial_depth_m);
    });
  } else {
    simulation::write_simulation(common.output, simulated);
  }
  if (common.wants_summary()) {
    print_notes(result.cut.notes, "Note: ");
    print_fit(result.cut.frf, result.fit);
    print_fit(result.cut.workpiece_frf, result.workpiece_fit);
    print_summary(simulated, job.point);
  }
  return simulated.resolved && simulated.verdict != Verdict::undecided ? done : not_reached;
}

}  // namespace robomill::app
