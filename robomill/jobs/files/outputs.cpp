#include "robomill/jobs/outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "robomill/base/error.hpp"
#include "robomill/cell/check.hpp"
#include "robomill/cell/dynamics.hpp"
#include "robomill/cell/files/check_json.hpp"
#include "robomill/coupling/files/joint_json.hpp"
#include "robomill/cutting/files/slots_csv.hpp"
#include "robomill/jobs/calibrate.hpp"
#include "robomill/jobs/coefficients.hpp"
#include "robomill/jobs/explain.hpp"
#include "robomill/jobs/files/postures_json.hpp"
#include "robomill/jobs/files/signal_json.hpp"
#include "robomill/jobs/frf.hpp"
#include "robomill/jobs/joint.hpp"
#include "robomill/jobs/lobes.hpp"
#include "robomill/jobs/modes.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/jobs/simulate.hpp"
#include "robomill/jobs/smooth.hpp"
#include "robomill/jobs/stiffness.hpp"
#include "robomill/jobs/tools.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/monitor/files/calibration_json.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/robot/files/stiffness_files.hpp"
#include "robomill/simulation/files/simulation_files.hpp"
#include "robomill/stability/files/peak_classification_json.hpp"

namespace robomill::jobs {
namespace {

using io::Format;

/// The endings of a document; JSON is always one.
struct Endings {
  Document document;
  std::array<Format, 4> others;  ///< json in place of none
  const char* rule;
};
constexpr Format none = Format::json;
constexpr std::array<Endings, 15> endings = {
    {{Document::frfs,
      {Format::uff, Format::csv, Format::text, Format::mat},
      "FRFs are written as .uff, .csv, .txt, .mat or .json"},
     {Document::tools, {Format::csv, none, none, none}, "a table of tools is written as .csv or .json"},
     {Document::modes, {Format::csv, none, none, none}, "modes are written as .csv or .json"},
     {Document::joint, {Format::csv, none, none, none}, "joints are written as .csv or .json"},
     {Document::lobes, {Format::csv, none, none, none}, "lobes are written as .csv or .json"},
     {Document::postures, {Format::csv, none, none, none}, "limits of postures are written as .csv or .json"},
     {Document::explanation, {Format::csv, none, none, none}, "explanations are written as .csv or .json"},
     {Document::simulation,
      {Format::csv, Format::mat, Format::wav, none},
      "a simulation is written as .csv, .mat, .wav or .json"},
     {Document::forces, {Format::csv, none, none, none}, "forces are written as .csv or .json"},
     {Document::coefficients,
      {Format::toml, Format::csv, none, none},
      "coefficients are written as .toml, .csv or .json"},
     {Document::signal_coefficients,
      {Format::toml, none, none, none},
      "coefficients of a force record are written as .toml or .json"},
     {Document::stiffness,
      {Format::csv, Format::toml, none, none},
      "joint stiffness is written as .csv, .json or as .toml, a line for cell.toml"},
     {Document::cell_check, {none, none, none, none}, "a cell's check is written as .json"},
     {Document::calibration, {Format::toml, none, none, none}, "a calibrated detector is written as .toml or .json"},
     {Document::machine, {none, none, none, none}, "a machine is written as .json"}}};

}  // namespace

void require_output(Document document, const std::filesystem::path& path) {
  const Format format = io::format_of(path);
  const auto* const known = std::ranges::find(endings, document, &Endings::document);
  if (format == Format::json || std::ranges::find(known->others, format) != known->others.end()) return;
  throw InvalidInput(path.string(), known->rule);
}

void require_holder(const TipPrediction& result, const std::string& option) {
  if (!result.holder.frfs.empty()) return;
  throw InvalidInput(option, "needs a measured holder",
                     "A holder of segments, or a rigid wall, has nothing to keep for the next tool");
}

std::string document(const FrfJobResult& result, Format) {
  return modal::frf_json(result.frfs);
}
std::string document(const ModesResult& result, Format format) {
  return format == Format::csv ? modal::modes_csv(result.fit.model) : modal::modes_json(result.fit);
}
std::string document(const cell::ModesOfPosture& result, Format format) {
  return format == Format::csv ? modal::modes_csv(result.prediction.modes) : cell::posture_modes_json(result);
}
std::string document(const TipPrediction& result, Format) {
  return tip_json(result);
}
std::string document(const ToolsResult& result, Format format) {
  return format == Format::csv ? decision::tools_csv(result.tools)
                               : decision::tools_json(result.tools, result.assembly.holder);
}
std::string document(const JointResult& result, Format format) {
  return format == Format::csv ? coupling::joint_csv(result.fit) : coupling::joint_json(result.fit);
}
std::string document(const LobesJobResult& result, Format format) {
  return format == Format::csv ? lobes_table(result) : lobes_document(result);
}
std::string document(const PosturesResult& result, Format format) {
  return format == Format::csv ? postures_csv(result) : io::dump(postures_table().write(result));
}
std::string document(const ExplainResult& result, Format format) {
  if (format == Format::csv) return stability::peaks_csv(result.peaks);
  return stability::peak_classification_json(result.peaks, result.mechanism ? &*result.mechanism : nullptr);
}
std::string document(const SimulateResult& result, Format) {
  return simulation::simulation_json(result.simulation, result.point.spindle_speed_rad_per_s,
                                     result.point.axial_depth_m);
}
std::string document(const process::ForcesResult& result, Format format) {
  return format == Format::csv ? process::forces_csv(result) : process::forces_json(result);
}
std::string document(const CoefficientsResult& result, Format format) {
  if (format == Format::csv) return cutting::slot_fit_csv(result.fit);
  if (format == Format::toml) return cutting::slot_fit_toml(result.fit, result.file, result.assumed);
  return cutting::slot_fit_json(result.fit, result.file, result.assumed);
}
std::string document(const SignalCoefficientsResult& result, Format format) {
  return format == Format::toml ? signal_coefficients_toml(result) : signal_coefficients_json(result);
}
std::string document(const StiffnessResult& result, Format format) {
  const robot::Arm& arm = result.cell.robot.arm;
  if (format == Format::csv) return robot::stiffness_csv(result.found, arm);
  if (format == Format::toml) return robot::stiffness_toml(result.found, arm);
  return robot::stiffness_json(result.found, arm, result.loads);
}
std::string document(const cell::CellCheck& result, Format) {
  return cell::cell_check_json(result);
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  io::write_file(path, text);
}
void write_document(const std::filesystem::path& path, const FrfJobResult& result,
                    const modal::FrfWriteOptions& options) {
  modal::write_frfs(path, result.frfs, options);
}
void write_document(const std::filesystem::path& path, const TipPrediction& result) {
  if (io::format_of(path) == Format::json)
    return write_text(path, document(result, Format::json));  // with what was found out beside the FRFs
  modal::write_frfs(path, result.tip.frfs);
}
void write_document(const std::filesystem::path& path, const SimulateResult& result) {
  if (io::format_of(path) == Format::json) return write_text(path, document(result, Format::json));
  simulation::write_simulation(path, result.simulation);
}
void write_document(const std::filesystem::path& path, const process::ForcesResult& result, Progress& progress) {
  io::LineFile file(path);
  const auto take = [&](std::string_view piece) { static_cast<void>(file.write(piece)); };  // close() says what failed
  if (io::format_of(path) == Format::csv) {
    process::write_forces_csv(result, take, progress);
  } else {
    process::write_forces_json(result, take, progress);
  }
  file.close();
}
void write_document(const std::filesystem::path& path, const StiffnessResult& result) {
  // A line for cell.toml says nothing of its convergence.
  if (result.converged() || io::format_of(path) != Format::toml)
    write_text(path, document(result, io::format_of(path)));
}
void write_document(const std::filesystem::path& path, const CalibrateResult& result) {
  if (io::format_of(path) == Format::json) return io::write_file(path, monitor::calibration_json(result.calibration));
  if (result.found()) io::write_file(path, calibrated_toml(result, path));
}

std::string shortfall(const ModesResult& result) {
  if (result.fit.status != modal::FitResult::Status::converged) return "the fit did not converge";
  return result.fit.usable() ? "" : "the modes do not describe the FRFs";
}

std::string shortfall(const ToolsResult& result) {
  const auto is_done = [](const decision::ToolResult& tool) { return tool.failure.empty() && tool.no_cut.empty(); };
  return std::ranges::all_of(result.tools, is_done) ? "" : "not every tool has a result; its row says why";
}

std::string shortfall(const JointResult& result) {
  using Status = coupling::JointFitResult::Status;
  if (result.fit.status == Status::converged) return "";
  return result.fit.status == Status::stalled ? "the search for the joint stalled at its random start"
                                              : "the joint was not found to convergence";
}

std::string shortfall(const SimulateResult& result) {
  if (!result.simulation.resolved) return "the simulation's steps do not resolve the vibration";
  return result.simulation.verdict == simulation::Verdict::undecided
             ? "the cut is too short to decide between stable and chatter"
             : "";
}

std::string shortfall(const CoefficientsResult& result) {
  if (!(result.fit.tangential.cutting_n_per_m2 > 0.0)) {
    return "the tangential coefficient is not above 0: are these the forces on the tool?";
  }
  return result.fit.status == cutting::SlotFit::Status::identified ? "" : "one feed does not determine the edge force";
}

std::string shortfall(const SignalCoefficientsResult& result) {
  if (!result.rejected.empty()) return result.rejected;
  return result.fit.identifiable ? "" : "the record does not determine every coefficient";
}

std::string shortfall(const StiffnessResult& result) {
  if (!result.converged()) {
    const bool line = io::format_of(result.output) == io::Format::toml;
    return "the joint stiffness was not found to convergence" +
           (line ? fmt::format("; {} was not written", result.output.string()) : std::string());
  }
  const bool seen = std::ranges::any_of(result.found.joints, [](const auto& joint) { return joint.identifiable; });
  return seen ? "" : "these loads determine the stiffness of no joint";
}

std::string shortfall(const cell::CellCheck& result) {
  return result.placement.works() ? "" : "the tool does not come to the workpiece where it stands";
}

}  // namespace robomill::jobs
