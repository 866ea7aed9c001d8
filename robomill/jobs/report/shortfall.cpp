#include <fmt/format.h>

#include <algorithm>

#include "robomill/cell/check.hpp"
#include "robomill/cell/dynamics.hpp"
#include "robomill/io/file.hpp"
#include "robomill/jobs/coefficients.hpp"
#include "robomill/jobs/explain.hpp"
#include "robomill/jobs/frf.hpp"
#include "robomill/jobs/joint.hpp"
#include "robomill/jobs/lobes.hpp"
#include "robomill/jobs/modes.hpp"
#include "robomill/jobs/outputs.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/jobs/simulate.hpp"
#include "robomill/jobs/smooth.hpp"
#include "robomill/jobs/stiffness.hpp"
#include "robomill/jobs/tools.hpp"
#include "robomill/process/forces.hpp"

namespace robomill::jobs {

std::string shortfall(const FrfJobResult&) {
  return {};
}

std::string shortfall(const ModesResult& result) {
  if (result.fit.status != modal::FitResult::Status::converged) return "the fit did not converge";
  return result.fit.usable() ? "" : "the modes do not describe the FRFs";
}

std::string shortfall(const cell::ModesOfPosture&) {
  return {};
}

std::string shortfall(const TipPrediction&) {
  return {};
}

std::string shortfall(const ToolsResult& result) {
  const auto is_done = [](const ToolResult& tool) { return tool.failure.empty() && tool.no_cut.empty(); };
  return std::ranges::all_of(result.tools, is_done) ? "" : "not every tool has a result; its row says why";
}

std::string shortfall(const JointResult& result) {
  return result.fit.status == coupling::JointFitResult::Status::converged ? ""
                                                                          : "the joint was not found to convergence";
}

std::string shortfall(const LobesJobResult&) {
  return {};
}

std::string shortfall(const ExplainResult&) {
  return {};
}

std::string shortfall(const SimulateResult& result) {
  if (!result.simulation.resolved) return "the simulation's steps do not resolve the vibration";
  return result.simulation.verdict == simulation::Verdict::undecided
             ? "the cut is too short to decide between stable and chatter"
             : "";
}

std::string shortfall(const process::ForcesResult& result) {
  if (!result.revolution) return {};
  const process::RevolutionForces& revolution = *result.revolution;
  if (revolution.deflected.status != cutting::StaticDeflection::Status::found) {
    return "there is no static deflection of the robot";
  }
  const bool undecided = revolution.vibration && revolution.vibration->verdict == simulation::Verdict::undecided;
  return undecided ? "the vibration is neither stable nor chatter as far as it was simulated" : "";
}

std::string shortfall(const CoefficientsResult& result) {
  if (!(result.fit.tangential.cutting_n_per_m2 > 0.0)) {
    return "the tangential coefficient is not above 0: are these the forces on the tool?";
  }
  return result.fit.status == cutting::SlotFit::Status::identified ? "" : "one feed does not determine the edge force";
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

std::string shortfall(const process::SmoothResult& result) {
  if (result.holds()) return {};
  std::string what = "the trajectory breaks limits";
  if (!result.clear()) {
    what = path::clearance_text(*result.smoothed.clearance);
  } else if (result.trajectory_holds() && !result.smoothed.robot_program->one_speed()) {
    what = "the robot program carries out one spindle speed of several, see the notes";
  } else if (result.trajectory_holds()) {
    what = result.smoothed.robot_program->too_long() ? "the robot program is too long for its controller, see the notes"
                                                     : "the robot program leaves its tolerances, see the notes";
  }
  if (!result.output.empty() && !result.smoothed.written) {
    what += "; it was not written";
    if (result.stale) what += fmt::format(", and the {} of an earlier run was removed", result.output.string());
  }
  return what;
}

}  // namespace robomill::jobs
