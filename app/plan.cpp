#include "robomill/jobs/plan.hpp"

#include <fmt/format.h>

#include <string>

#include "robomill/jobs/summary.hpp"
#include "verbs.hpp"

namespace robomill::app {

Exit run(const PlanCommand& command, const Common& common, Progress& progress) {
  const std::filesystem::path folder = common.to_stdout() ? std::string() : common.output;
  const jobs::PlanResult result = jobs::run_job(command.job, common.seed, progress, folder, command.accept_fit);
  if (common.to_stdout()) {
    fmt::print("{}", jobs::plan_json(result));
  } else if (!common.output.empty()) {
    jobs::write_plan(common.output, result);
  }
  if (common.wants_summary()) fmt::print("{}", jobs::summary(result));
  if (result.decision && result.decision->status == jobs::DecideResult::Status::infeasible) return not_reached;
  if (result.path && !result.path->holds()) return not_reached;
  if (result.blocks && !result.recommends()) return done;  // an unstable block is an answer
  return result.recommendation.status == decision::Recommendation::Status::found ? done : not_reached;
}

}  // namespace robomill::app
