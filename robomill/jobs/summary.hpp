#pragma once
#include <optional>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/coupling/files/assembly_toml.hpp"

// Method: robomill/jobs/README.md, "Outputs"

namespace robomill::cell {
struct ModesOfPosture;
}  // namespace robomill::cell

namespace robomill::process {
struct ForcesResult;
struct SmoothResult;
}  // namespace robomill::process

namespace robomill::jobs {

struct CoefficientsResult;
struct ExplainResult;
struct FrfJobResult;
struct JointResult;
struct LobesFile;
struct LobesJobResult;
struct ModesResult;
struct PlanResult;
struct SimulateResult;
struct StiffnessResult;
struct TipPrediction;
struct ToolResult;
struct ToolsResult;

/// A result in the lines that the command line prints, and that a report shows where no script runs. Texts out of files
/// are printable.
[[nodiscard]] ROBOMILL_API std::string summary(const PlanResult& result);
[[nodiscard]] ROBOMILL_API std::string summary(const FrfJobResult& result);
[[nodiscard]] ROBOMILL_API std::string summary(const ModesResult& result);
[[nodiscard]] ROBOMILL_API std::string summary(const cell::ModesOfPosture& result);
[[nodiscard]] ROBOMILL_API std::string summary(const TipPrediction& result);
/// @param cut  that the tools were tried in, if any
[[nodiscard]] ROBOMILL_API std::string summary(const std::vector<ToolResult>& results,
                                               const coupling::AssemblyFile& assembly,
                                               const std::optional<LobesFile>& cut);
[[nodiscard]] ROBOMILL_API std::string summary(const ToolsResult& result);
[[nodiscard]] ROBOMILL_API std::string summary(const JointResult& result);
[[nodiscard]] ROBOMILL_API std::string summary(const LobesJobResult& result);
[[nodiscard]] ROBOMILL_API std::string summary(const ExplainResult& result);
[[nodiscard]] ROBOMILL_API std::string summary(const SimulateResult& result);
[[nodiscard]] ROBOMILL_API std::string summary(const process::ForcesResult& result);
[[nodiscard]] ROBOMILL_API std::string summary(const CoefficientsResult& result);
[[nodiscard]] ROBOMILL_API std::string summary(const StiffnessResult& result);
[[nodiscard]] ROBOMILL_API std::string summary(const process::SmoothResult& result);

}  // namespace robomill::jobs
