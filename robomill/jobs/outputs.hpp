#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/io/file.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/page/report.hpp"
#include "robomill/process/in_lines.hpp"

// Method: robomill/jobs/README.md, "Outputs"

namespace robomill::cell {
struct CellCheck;
struct ModesOfPosture;
}  // namespace robomill::cell

namespace robomill::jobs {

struct CalibrateResult;
struct CoefficientsResult;
struct ExplainResult;
struct FrfJobResult;
struct JointResult;
struct LobesJobResult;
struct ModesResult;
struct PlanResult;
struct PosturesResult;
struct SimulateResult;
struct SignalCoefficientsResult;
struct StiffnessResult;
struct TipPrediction;
struct ToolsResult;

/// What a verb writes into one file. Of plans see write_plan, of smoothed programs run_smooth.
enum class Document {
  frfs,
  tools,
  modes,
  joint,
  lobes,
  postures,
  explanation,
  simulation,
  forces,
  coefficients,
  signal_coefficients,
  stiffness,
  cell_check,
  calibration,
  machine
};

/// Before the work. @throws InvalidInput naming the file if this document is not written with its ending
ROBOMILL_API void require_output(Document document, const std::filesystem::path& path);

/// A result as text: JSON, or another of the formats that require_output takes. FRFs and simulations as JSON alone.
[[nodiscard]] std::string document(const FrfJobResult& result, io::Format format);
[[nodiscard]] std::string document(const ModesResult& result, io::Format format);
[[nodiscard]] std::string document(const cell::ModesOfPosture& result, io::Format format);
[[nodiscard]] std::string document(const TipPrediction& result, io::Format format);
[[nodiscard]] std::string document(const ToolsResult& result, io::Format format);
[[nodiscard]] std::string document(const JointResult& result, io::Format format);
[[nodiscard]] std::string document(const LobesJobResult& result, io::Format format);
[[nodiscard]] std::string document(const PosturesResult& result, io::Format format);
[[nodiscard]] std::string document(const ExplainResult& result, io::Format format);
[[nodiscard]] std::string document(const SimulateResult& result, io::Format format);
[[nodiscard]] std::string document(const process::ForcesResult& result, io::Format format);
[[nodiscard]] std::string document(const CoefficientsResult& result, io::Format format);
[[nodiscard]] std::string document(const SignalCoefficientsResult& result, io::Format format);
[[nodiscard]] std::string document(const StiffnessResult& result, io::Format format);
[[nodiscard]] std::string document(const cell::CellCheck& result, io::Format format);

/// @throws InvalidInput if the place cannot be written
void write_text(const std::filesystem::path& path, const std::string& text);
/// Writes a result in the format that the file's ending names. @throws InvalidInput if the place cannot be written
template <class Result>
void write_document(const std::filesystem::path& path, const Result& result) {
  write_text(path, document(result, io::format_of(path)));
}
void write_document(const std::filesystem::path& path, const FrfJobResult& result,
                    const modal::FrfWriteOptions& options = {});
void write_document(const std::filesystem::path& path, const TipPrediction& result);
void write_document(const std::filesystem::path& path, const SimulateResult& result);
/// Along a program it is written row by row.
void write_document(const std::filesystem::path& path, const process::ForcesResult& result,
                    Progress& progress = Progress::none());
/// As .toml, a line for cell.toml, only where the stiffness converged.
void write_document(const std::filesystem::path& path, const StiffnessResult& result);
/// As .toml, a detector, only where one was found.
void write_document(const std::filesystem::path& path, const CalibrateResult& result);

/// Before its receptances are kept for other tools. @throws InvalidInput naming the option if the assembly has no
/// measured holder
void require_holder(const TipPrediction& result, const std::string& option);

/// Why a result is not the answer that its verb is for (exit 3): "the fit did not converge". Empty: it is.
[[nodiscard]] std::string shortfall(const ModesResult& result);
[[nodiscard]] std::string shortfall(const ToolsResult& result);
[[nodiscard]] std::string shortfall(const JointResult& result);
[[nodiscard]] std::string shortfall(const SimulateResult& result);
[[nodiscard]] std::string shortfall(const CoefficientsResult& result);
[[nodiscard]] std::string shortfall(const SignalCoefficientsResult& result);
[[nodiscard]] std::string shortfall(const StiffnessResult& result);
[[nodiscard]] std::string shortfall(const cell::CellCheck& result);
// Whatever they find is an answer.
[[nodiscard]] inline std::string shortfall(const FrfJobResult& /*result*/) {
  return {};
}
[[nodiscard]] inline std::string shortfall(const cell::ModesOfPosture& /*result*/) {
  return {};
}
[[nodiscard]] inline std::string shortfall(const TipPrediction& /*result*/) {
  return {};
}
[[nodiscard]] inline std::string shortfall(const LobesJobResult& /*result*/) {
  return {};
}
[[nodiscard]] inline std::string shortfall(const PosturesResult& /*result*/) {
  return {};
}
[[nodiscard]] inline std::string shortfall(const ExplainResult& /*result*/) {
  return {};
}

/// A result in the lines that the command line prints, and that a report shows where no script runs. Texts out of files
/// are printable.
[[nodiscard]] std::string summary(const PlanResult& result);
[[nodiscard]] std::string summary(const FrfJobResult& result);
[[nodiscard]] std::string summary(const ModesResult& result);
[[nodiscard]] std::string summary(const cell::ModesOfPosture& result);
[[nodiscard]] std::string summary(const TipPrediction& result);
[[nodiscard]] std::string summary(const ToolsResult& result);
[[nodiscard]] std::string summary(const JointResult& result);
[[nodiscard]] std::string summary(const LobesJobResult& result);
[[nodiscard]] std::string summary(const PosturesResult& result);
[[nodiscard]] std::string summary(const ExplainResult& result);
[[nodiscard]] std::string summary(const SimulateResult& result);
[[nodiscard]] std::string summary(const CoefficientsResult& result);
[[nodiscard]] std::string summary(const SignalCoefficientsResult& result);
[[nodiscard]] std::string summary(const StiffnessResult& result);

/// "2026-07-31 12:05 UTC, robomill 0.1.0".
[[nodiscard]] std::string created_now();

/// The page of what one verb found: the result's documents, what was assumed, what no document says, and the summary.
[[nodiscard]] page::Report page_of(const FrfJobResult& result);
[[nodiscard]] page::Report page_of(const ModesResult& result);
[[nodiscard]] page::Report page_of(const cell::ModesOfPosture& result);
[[nodiscard]] page::Report page_of(const TipPrediction& result);
[[nodiscard]] page::Report page_of(const ToolsResult& result);
[[nodiscard]] page::Report page_of(const JointResult& result);
[[nodiscard]] page::Report page_of(const LobesJobResult& result);
[[nodiscard]] page::Report page_of(const PosturesResult& result);
[[nodiscard]] page::Report page_of(const ExplainResult& result);
[[nodiscard]] page::Report page_of(const SimulateResult& result);
[[nodiscard]] page::Report page_of(const process::ForcesResult& result);
[[nodiscard]] page::Report page_of(const CoefficientsResult& result);
[[nodiscard]] page::Report page_of(const SignalCoefficientsResult& result);
[[nodiscard]] page::Report page_of(const StiffnessResult& result);
[[nodiscard]] page::Report page_of(const cell::CellCheck& result);
/// With curves where the job recorded them.
[[nodiscard]] page::Report page_of(const process::SmoothResult& result);
/// That of a plan.
/// @param files  that stand beside it
[[nodiscard]] page::Report make_report(const PlanResult& result, const std::vector<page::StageFile>& files);

}  // namespace robomill::jobs
