#include "robomill/jobs/simulate.hpp"

#include "point.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/pages.hpp"
#include "robomill/simulation/files/simulation_files.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {

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
  const simulation::Simulation& simulated = result.simulation;
  if (common.output.empty() || common.to_stdout() || io::format_of(common.output) == io::Format::json) {
    write_output(common, [&](io::Format) {
      return simulation::simulation_json(simulated, job.point.spindle_speed_rad_per_s, job.point.axial_depth_m);
    });
  } else {
    simulation::write_simulation(common.output, simulated);
  }
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  return simulated.resolved && simulated.verdict != simulation::Verdict::undecided ? done : not_reached;
}

}  // namespace robomill::app
