#pragma once
#include <optional>
#include <string>
#include <vector>

#include "robomill/coupling/files/assembly_toml.hpp"

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
[[nodiscard]] std::string summary(const PlanResult& result);
[[nodiscard]] std::string summary(const FrfJobResult& result);
[[nodiscard]] std::string summary(const ModesResult& result);
[[nodiscard]] std::string summary(const cell::ModesOfPosture& result);
[[nodiscard]] std::string summary(const TipPrediction& result);
/// @param cut  that the tools were tried in, if any
[[nodiscard]] std::string summary(const std::vector<ToolResult>& results, const coupling::AssemblyFile& assembly,
                                  const std::optional<LobesFile>& cut);
[[nodiscard]] std::string summary(const ToolsResult& result);
[[nodiscard]] std::string summary(const JointResult& result);
[[nodiscard]] std::string summary(const LobesJobResult& result);
[[nodiscard]] std::string summary(const ExplainResult& result);
[[nodiscard]] std::string summary(const SimulateResult& result);
[[nodiscard]] std::string summary(const process::ForcesResult& result);
[[nodiscard]] std::string summary(const CoefficientsResult& result);
[[nodiscard]] std::string summary(const StiffnessResult& result);
[[nodiscard]] std::string summary(const process::SmoothResult& result);

}  // namespace robomill::jobs
