#include <iterator>

#include "robomill/jobs/plan.hpp"
#include "robomill/jobs/verbs/records.hpp"

namespace robomill::jobs {
namespace {

Outcome run_plan_verb(const VerbJob& job, Progress& progress) {
  const auto plan = with_posture(job, [&] {
    return std::make_shared<const PlanResult>(
        run_job(job.source(), job.seed(), progress, job.output, job.flag("accept_fit"), job.numbers("posture_deg")));
  });
  if (!job.output.empty()) write_plan(job.output, *plan);
  return {.shortfall = reached(*plan) ? "" : "no conditions within every limit were found",
          .summary = summary(*plan),
          .json = job.wants_json ? plan_json(*plan) : std::string(),
          .page = [plan] { return make_report(*plan, {}); },
          .plan = plan->judging ? plan : nullptr};
}

Verb plan_verb() {
  return {.name = "plan",
          .button = "Run the job",
          .purpose = "the whole job: hits to safe cutting conditions",
          .more = "A recommendation with its margin, every stage's result, and a report that opens offline.",
          .example = "plan job.toml -o out/",
          .readme = "robomill/jobs/README.md",
          .input = file_option("job", "job.toml", {"job"}, true),
          .output = "out",
          .varies = true,
          .options = {flag_option("accept_fit", "go on with modes whose relative error is 20 % or more"),
                      posture_option(), seed_option()},
          .run = &run_plan_verb};
}

}  // namespace

std::span<const Verb> verbs() {
  static const std::vector<Verb> all = [] {
    std::vector<Verb> out = {plan_verb()};
    const auto add = [&out](std::vector<Verb> more) {
      out.insert(out.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
    };
    add(structure_verbs());
    add(cut_verbs());
    add(robot_verbs());
    out.push_back(calibrate_verb());
    out.push_back(sweep_verb());
    return out;
  }();
  return all;
}

}  // namespace robomill::jobs
