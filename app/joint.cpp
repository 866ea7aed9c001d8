#include "robomill/jobs/joint.hpp"

#include "robomill/jobs/pages.hpp"
#include "terminal.hpp"
#include "verbs.hpp"

namespace robomill::app {
namespace {

jobs::JointJob job_of(const JointCommand& command, const Common& common) {
  jobs::JointJob job;
  job.assembly = command.input;
  job.measured = command.measured;
  job.as = command.as;
  job.method = value_in(coupling::joint_method_names, command.method).value();
  if (!command.mutation.empty()) job.mutation = value_in(coupling::mutation_names, command.mutation);
  job.axis = command.axis == "y" ? modal::Axis::y : modal::Axis::x;
  job.seed = common.seed;
  return job;
}

}  // namespace

Exit run(const JointCommand& command, const Common& common, Progress& progress) {
  require_output(common, jobs::Document::joint);
  const jobs::JointResult result = jobs::run_joint(job_of(command, common), progress);
  write_result(common, result);
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  return exit_of(jobs::shortfall(result));
}

}  // namespace robomill::app
