#pragma once
#include <string>

#include "robomill/io/json.hpp"
#include "robomill/jobs/plan.hpp"

namespace robomill::jobs {

[[nodiscard]] io::Json operation_json(const decision::Operation& op);
/// What the job itself came to: plan.json without the documents of its stages.
[[nodiscard]] io::Json decision_json(const PlanResult& result);
/// Spectra of the recorded test cuts, thinned as for a page.
[[nodiscard]] io::Json recordings_json(const PlanResult& result);
/// modes.json, lobes.json of a job.
[[nodiscard]] std::string modes_json(const PlanResult& result);
[[nodiscard]] std::string lobes_json(const PlanResult& result);

}  // namespace robomill::jobs
