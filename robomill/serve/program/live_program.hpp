#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "robomill/base/progress.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/process/turned.hpp"
#include "robomill/serve/client_order.hpp"

// Method: robomill/serve/README.md, "Program"

namespace robomill::serve {

/// What is asked of a job's program while somebody moves the line of its γ.
struct LiveProgramRequest {
  int job = 0;                                 ///< of JobRunner
  std::vector<process::GammaKnot> gamma = {};  ///< increasing in path
  ClientOrder order = {};
};

/// The body of POST /api/program.
/// @throws InvalidInput naming the member
[[nodiscard]] LiveProgramRequest read_live_program_request(std::string_view body);

/// {"sequence", "blocks": blocks.json, "lost": […], "gamma": {…}, "unstable", "least_margin", "worst_block",
/// "notes": […], "milliseconds"}.
/// @param plan  the job's
/// @throws InvalidInput as process::judge_turned; Interrupted
[[nodiscard]] std::string live_program(const LiveProgramRequest& request, const jobs::PlanResult& plan,
                                       Progress& progress = Progress::none());

}  // namespace robomill::serve
