#include "robomill/jobs/sweep/tasks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

namespace robomill::jobs {
namespace {

constexpr std::size_t most_failures = 10;

}  // namespace

SweepTasks tasks_of(const SlurmJobs& jobs, const std::vector<bool>& there, const std::vector<std::string>& running) {
  SweepTasks out{
      .array = jobs.array, .merge = jobs.merge, .merge_state = SlurmFolder::state(jobs.merge), .tasks = jobs.shards};
  const std::size_t tasks = static_cast<std::size_t>(jobs.shards);
  std::vector<bool> done(tasks, true);
  for (std::size_t chunk = 0; chunk < there.size(); ++chunk) done[chunk % tasks] = done[chunk % tasks] && there[chunk];
  const SlurmStates states = SlurmFolder::states(jobs.array);
  for (int task = 1; task <= jobs.shards; ++task) {
    const auto known = states.find(task);
    const bool held = std::ranges::find(running, fmt::format("{}/{}", task, jobs.shards)) != running.end();
    TaskState state = held ? TaskState::running : TaskState::idle;
    if (done[static_cast<std::size_t>(task - 1)]) {
      state = TaskState::done;
    } else if (known != states.end()) {
      state = task_state(known->second);
    }
    (state == TaskState::done      ? out.done
     : state == TaskState::running ? out.running
     : state == TaskState::waiting ? out.waiting
     : state == TaskState::failed  ? out.failed
                                   : out.idle) += 1;
    if (state == TaskState::failed && out.failures.size() < most_failures) {
      out.failures.push_back(fmt::format("{}: {}", task, known->second));
    }
  }
  return out;
}

}  // namespace robomill::jobs
