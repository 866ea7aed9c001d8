#pragma once
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/jobs/summary.hpp"
#include "robomill/page/report.hpp"

// Method: robomill/jobs/README.md, "Pages (`pages.hpp`)"

namespace robomill::cell {
struct CellCheck;
}  // namespace robomill::cell

namespace robomill::jobs {

/// "2026-07-31 12:05 UTC, robomill 0.1.0".
[[nodiscard]] ROBOMILL_API std::string created_now();

/// The page of what one verb found: the result's documents, what was assumed, what no document says, and the summary.
/// That of a plan: make_report.
[[nodiscard]] ROBOMILL_API page::Report page_of(const FrfJobResult& result);
[[nodiscard]] ROBOMILL_API page::Report page_of(const ModesResult& result);
[[nodiscard]] ROBOMILL_API page::Report page_of(const cell::ModesOfPosture& result);
[[nodiscard]] ROBOMILL_API page::Report page_of(const TipPrediction& result);
/// @param cut  that the tools were tried in, if any
[[nodiscard]] ROBOMILL_API page::Report page_of(const std::vector<ToolResult>& results,
                                                const coupling::AssemblyFile& assembly,
                                                const std::optional<LobesFile>& cut);
[[nodiscard]] ROBOMILL_API page::Report page_of(const ToolsResult& result);
[[nodiscard]] ROBOMILL_API page::Report page_of(const JointResult& result);
[[nodiscard]] ROBOMILL_API page::Report page_of(const LobesJobResult& result);
[[nodiscard]] ROBOMILL_API page::Report page_of(const ExplainResult& result);
[[nodiscard]] ROBOMILL_API page::Report page_of(const SimulateResult& result);
[[nodiscard]] ROBOMILL_API page::Report page_of(const process::ForcesResult& result);
[[nodiscard]] ROBOMILL_API page::Report page_of(const CoefficientsResult& result);
[[nodiscard]] ROBOMILL_API page::Report page_of(const StiffnessResult& result);
[[nodiscard]] ROBOMILL_API page::Report page_of(const cell::CellCheck& result);
/// With curves where the job recorded them.
[[nodiscard]] ROBOMILL_API page::Report page_of(const process::SmoothResult& result);

}  // namespace robomill::jobs
