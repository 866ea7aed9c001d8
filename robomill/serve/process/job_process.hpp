#pragma once
#include <atomic>
#include <cstddef>
#include <string>

#include "robomill/base/progress.hpp"
#include "robomill/serve/jobs/runner.hpp"
#include "robomill/serve/jobs/verbs.hpp"
#include "robomill/serve/process/worker_process.hpp"

// Method: robomill/serve/README.md, "Processes"

namespace robomill::serve {

/// Runs a request that was checked in a process of its own, which lives on where the job judged a program, to answer
/// with another γ.
/// @throws Interrupted, AnsweredElsewhere with the error of the job, WorkerEnded
[[nodiscard]] JobRun run_in_process(const WorkerOptions& options, const JobRequest& request,
                                    const Progress::Report& report, const std::atomic<bool>& stop);

/// The request out of what run_in_process() sends.
[[nodiscard]] JobRequest request_of(const std::string& text);
/// What run_in_process() reads of a job that is done.
/// @param blocks  of its program that were judged
[[nodiscard]] std::string text_of(const JobOutcome& outcome, std::size_t blocks);

}  // namespace robomill::serve
