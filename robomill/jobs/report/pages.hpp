#pragma once
#include <optional>
#include <string>
#include <vector>

#include "robomill/jobs/report/summary.hpp"
#include "robomill/page/report.hpp"

namespace robomill::cell {
struct CellCheck;
}  // namespace robomill::cell

namespace robomill::jobs {

/// "2026-07-31 12:05 UTC, robomill 0.1.0".
[[nodiscard]] std::string created_now();

/// The page of what one verb found: the result's documents, what was assumed, what no document says, and the summary.
[[nodiscard]] page::Report page_of(const FrfJobResult& result);
[[nodiscard]] page::Report page_of(const ModesResult& result);
[[nodiscard]] page::Report page_of(const cell::ModesOfPosture& result);
[[nodiscard]] page::Report page_of(const TipPrediction& result);
/// @param cut  that the tools were tried in, if any
[[nodiscard]] page::Report page_of(const std::vector<ToolResult>& results, const coupling::AssemblyFile& assembly,
                                   const std::optional<LobesFile>& cut);
[[nodiscard]] page::Report page_of(const ToolsResult& result);
[[nodiscard]] page::Report page_of(const JointResult& result);
[[nodiscard]] page::Report page_of(const LobesJobResult& result);
[[nodiscard]] page::Report page_of(const ExplainResult& result);
[[nodiscard]] page::Report page_of(const SimulateResult& result);
[[nodiscard]] page::Report page_of(const process::ForcesResult& result);
[[nodiscard]] page::Report page_of(const CoefficientsResult& result);
[[nodiscard]] page::Report page_of(const StiffnessResult& result);
[[nodiscard]] page::Report page_of(const cell::CellCheck& result);
/// With curves where the job recorded them.
[[nodiscard]] page::Report page_of(const process::SmoothResult& result);
/// That of a plan.
/// @param files  that stand beside it
[[nodiscard]] page::Report make_report(const PlanResult& result, const std::vector<page::StageFile>& files);

}  // namespace robomill::jobs
