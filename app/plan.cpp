#include "robomill/jobs/plan.hpp"

#include <fmt/format.h>

#include <string>

#include "robomill/jobs/pages.hpp"
#include "robomill/jobs/summary.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {

Exit run(const PlanCommand& command, const Common& common, Progress& progress) {
  const std::filesystem::path folder = common.to_stdout() ? std::string() : common.output;
  const jobs::PlanResult result =
      jobs::run_job(command.job, common.seed, progress, folder, command.accept_fit, command.posture_deg);
  if (common.to_stdout()) {
    fmt::print("{}", jobs::plan_json(result));
  } else if (!common.output.empty()) {
    jobs::write_plan(common.output, result);
  }
  show(common, jobs::summary(result), [&] { return jobs::make_report(result, {}); });
  return jobs::reached(result) ? done : not_reached;
}

}  // namespace robomill::app
