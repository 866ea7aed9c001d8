#pragma once
#include <string>
#include <vector>

#include "robomill/io/json.hpp"
#include "robomill/jobs/plan.hpp"

namespace robomill::jobs {

[[nodiscard]] io::Json operation_json(const decision::Operation& op);
/// What the job itself came to: plan.json without the documents of its stages.
[[nodiscard]] io::Json decision_json(const PlanResult& result);
/// Spectra of the recorded test cuts.
[[nodiscard]] io::Json recordings_json(const PlanResult& result);
/// forces.json, and the member `assembly`.
[[nodiscard]] io::Json forces_object(const ForcesResult& result);
/// Of blocks.json how many blocks there are, how many chatter, and the worst.
[[nodiscard]] io::Json blocks_summary(const ForcesResult& forces, const ProgramBlocks& blocks);
/// blocks.json.
[[nodiscard]] io::Json blocks_object(const ForcesResult& forces, const ProgramBlocks& blocks);
/// The decision of plan.json.
[[nodiscard]] io::Json program_decision_json(const PlanResult& plan);
[[nodiscard]] io::Json prediction_object(const TipPrediction& prediction);

/// plan.json: the decision, and each stage's document as a member.
[[nodiscard]] io::Json plan_object(const PlanResult& result);
/// It as text.
[[nodiscard]] std::string plan_text(const io::Json& plan);
/// As make_report, of what is in plan.json already.
[[nodiscard]] page::Report report_of(const PlanResult& result, const std::vector<page::StageFile>& files,
                                     const io::Json& plan);

}  // namespace robomill::jobs
