#pragma once
#include <string>
#include <vector>

#include "robomill/io/schema.hpp"
#include "robomill/jobs/plan.hpp"
#include "robomill/page/report.hpp"

namespace robomill::jobs {

/// What the job itself came to: plan.json without the documents of its stages.
[[nodiscard]] io::Json decision_json(const PlanResult& result);
/// Spectra of the recorded test cuts.
[[nodiscard]] const io::Schema<PlanResult>& recordings_table();
/// The member `assembly`.
[[nodiscard]] const io::Schema<TipPrediction>& assembly_table();

/// plan.json: the decision, and each stage's document as a member.
[[nodiscard]] const io::TableInfo& plan_table();
[[nodiscard]] io::Json plan_object(const PlanResult& result);
/// It as text.
[[nodiscard]] std::string plan_text(const io::Json& plan);
/// As make_report, of what is in plan.json already.
[[nodiscard]] page::Report report_of(const PlanResult& result, const std::vector<page::StageFile>& files,
                                     const io::Json& plan);

}  // namespace robomill::jobs
