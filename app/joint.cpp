#include "robomill/jobs/joint.hpp"

#include <fmt/format.h>

#include "robomill/coupling/files/joint_json.hpp"
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
  require_output(common, {io::Format::csv, io::Format::json}, "joints are written as .csv or .json");
  const jobs::JointResult result = jobs::run_joint(job_of(command, common), progress);
  write_output(common, [&](io::Format format) {
    return format == io::Format::csv ? coupling::joint_csv(result.fit) : coupling::joint_json(result.fit);
  });
  show(common, jobs::summary(result), [&] { return jobs::page_of(result); });
  if (result.fit.status == coupling::JointFitResult::Status::converged) return done;
  fmt::print(stderr, "robomill: the joint was not found to convergence\n");
  return not_reached;
}

}  // namespace robomill::app
