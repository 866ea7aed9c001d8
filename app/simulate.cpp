#include "robomill/jobs/simulate.hpp"

#include "point.hpp"
#include "robomill/jobs/pages.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {

Exit run(const SimulateCommand& command, const Common& common, Progress& progress) {
  require_output(common, jobs::Document::simulation);
  const jobs::SimulateJob job = {.lobes = command.input,
                                 .point = parse_point(command.at),
                                 .options = {.seconds = command.seconds,
                                             .sample_rate_hz = command.sample_rate_hz,
                                             .loss_of_contact = !command.linear,
                                             .seed = common.seed}};
  const jobs::SimulateResult result = jobs::run_simulate(job, progress);
  write_result(common, result);
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  return exit_of(jobs::shortfall(result));
}

}  // namespace robomill::app
