#include "robomill/jobs/lobes.hpp"

#include "point.hpp"
#include "robomill/jobs/pages.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {

Exit run(const LobesCommand& command, const Common& common, Progress& progress) {
  require_output(common, jobs::Document::lobes);
  jobs::LobesJob job = {.lobes = command.input, .compare = command.compare, .seed = common.seed};
  for (const std::string& text : command.at) job.points.push_back(parse_point(text));
  const jobs::LobesJobResult result = jobs::run_lobes(job, progress);
  write_result(common, result);
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  return exit_of(jobs::shortfall(result));
}

}  // namespace robomill::app
