#include "robomill/jobs/outputs.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>

#include "robomill/cell/check.hpp"
#include "robomill/cell/dynamics.hpp"
#include "robomill/cell/files/check_json.hpp"
#include "robomill/coupling/files/joint_json.hpp"
#include "robomill/io/json.hpp"
#include "robomill/jobs/coefficients.hpp"
#include "robomill/jobs/explain.hpp"
#include "robomill/jobs/files/assumed.hpp"
#include "robomill/jobs/files/plan_json.hpp"
#include "robomill/jobs/files/postures_json.hpp"
#include "robomill/jobs/frf.hpp"
#include "robomill/jobs/joint.hpp"
#include "robomill/jobs/lobes.hpp"
#include "robomill/jobs/modes.hpp"
#include "robomill/jobs/predict.hpp"
#include "robomill/jobs/simulate.hpp"
#include "robomill/jobs/smooth.hpp"
#include "robomill/jobs/stiffness.hpp"
#include "robomill/jobs/tools.hpp"
#include "robomill/modal/files/frf_files.hpp"
#include "robomill/modal/files/modes_files.hpp"
#include "robomill/path/files/motion_json.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/robot/files/stiffness_files.hpp"
#include "robomill/simulation/files/simulation_files.hpp"
#include "robomill/simulation/files/vibration_json.hpp"
#include "robomill/stability/files/peak_classification_json.hpp"
#include "robomill/version.hpp"

namespace robomill::jobs {
namespace {

page::Report titled(const char* title, std::string lines) {
  page::Report page;
  page.title = title;
  page.created = created_now();
  page.summary = std::move(lines);
  return page;
}

void add_texts(std::vector<std::string>& to, const std::vector<std::string>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

}  // namespace

std::string created_now() {
  return fmt::format("{:%Y-%m-%d %H:%M} UTC, robomill " ROBOMILL_VERSION, fmt::gmtime(std::time(nullptr)));
}

page::Report page_of(const FrfJobResult& result) {
  page::Report page = titled("Frequency response functions", summary(result));
  page.frf = modal::frf_json(result.frfs);
  add_texts(page.notes, result.file.notes);
  add_texts(page.notes, result.frfs.notes);
  page.assumed = result.file.assumed;
  return page;
}

page::Report page_of(const ModesResult& result) {
  page::Report page = titled("Modes", summary(result));
  page.frf = modal::frf_json(result.measured.set);
  if (!result.fit.model.modes.empty()) {
    page.fitted = modal::frf_json(fitted_frfs(result.fit.model, result.measured.set));
  }
  page.modes = modal::modes_json(result.fit);
  page.warnings = result.fit.warnings;
  page.notes = result.measured.notes;
  page.assumed = result.measured.assumed;
  return page;
}

page::Report page_of(const cell::ModesOfPosture& result) {
  page::Report page = titled("Modes of a posture", summary(result));
  page.modes = cell::posture_modes_json(result);
  page.warnings = cell::posture_warnings(result);
  page.notes = result.notes;
  page.assumed = result.assumed;
  return page;
}

page::Report page_of(const TipPrediction& result) {
  page::Report page = titled("Tool in its holder", summary(result));
  page.frf = modal::frf_json(result.tip.frfs);
  page.assembly = io::dump(assembly_table().write(result));
  if (result.measured) page.measured = modal::frf_json(*result.measured);
  page.assumed = result.file.assumed;
  return page;
}

page::Report page_of(const ToolsResult& result) {
  page::Report page = titled("Tools in one holder", summary(result));
  const coupling::AssemblyFile& assembly = result.assembly;
  page.tools = decision::tools_json(result.tools, assembly.holder);
  page.notes = assembly.notes;
  if (assembly.holder) add_texts(page.notes, assembly.holder->notes);
  page.assumed = assembly.assumed;
  if (result.cut) add_assumed(page.assumed, assumed_of(*result.cut, CutUse::stability));
  return page;
}

page::Report page_of(const JointResult& result) {
  page::Report page = titled("Joint between tool and holder", summary(result));
  page.joint = coupling::joint_json(result.fit);
  page.frf = modal::frf_json(result.measured);
  page.fitted = modal::frf_json(result.fit.model);
  page.notes = result.notes;
  page.assumed = result.assumed;
  return page;
}

page::Report page_of(const LobesJobResult& result) {
  page::Report page = titled("Stability lobes", summary(result));
  const bool surface = result.surface.axial_depth_m.size() > 0;
  std::string& document = result.sweep ? page.sweep : result.comparison ? page.comparison : page.lobes;
  document = lobes_document(result);
  page.notes = result.cut.notes;
  page.assumed = assumed_of(result.cut, surface ? CutUse::motion : CutUse::stability);
  return page;
}

page::Report page_of(const PosturesResult& result) {
  page::Report page = titled("Postures side by side", summary(result));
  page.postures = io::dump(postures_table().write(result));
  page.notes = result.cut.notes;
  page.assumed = assumed_of(result.cut, CutUse::stability);
  return page;
}

page::Report page_of(const ExplainResult& result) {
  page::Report page = titled("Peaks of a cut", summary(result));
  page.explanation = stability::peak_classification_json(result.peaks, result.mechanism ? &*result.mechanism : nullptr);
  page.notes = result.notes;
  if (!result.cut) return page;
  add_texts(page.notes, result.cut->notes);
  page.assumed = assumed_of(*result.cut, CutUse::stability);
  return page;
}

page::Report page_of(const SimulateResult& result) {
  page::Report page = titled("A cut in time", summary(result));
  page.simulation =
      simulation::simulation_json(result.simulation, result.point.spindle_speed_rad_per_s, result.point.axial_depth_m);
  page.vibration = simulation::vibration_json(result.simulation);
  page.notes = result.cut.notes;
  page.assumed = assumed_of(result.cut, CutUse::motion);
  return page;
}

page::Report page_of(const process::ForcesResult& result) {
  page::Report page = titled("Cutting forces", summary(result));
  page.forces = process::forces_json(result);
  page.assumed = result.assumed;
  return page;
}

page::Report page_of(const CoefficientsResult& result) {
  page::Report page = titled("Cutting force coefficients", summary(result));
  page.coefficients = cutting::slot_fit_json(result.fit, result.file, result.assumed);
  page.notes = result.file.notes;
  page.assumed = result.assumed;
  return page;
}

page::Report page_of(const SignalCoefficientsResult& result) {
  page::Report page = titled("Cutting force coefficients of a force record", summary(result));
  page.notes = result.fit.notes;
  if (result.forces.revolution) {
    page.forces = process::forces_json(result.forces);
  } else {
    add_texts(page.notes, result.forces.warnings);
    add_texts(page.notes, result.forces.notes);
  }
  page.assumed = result.assumed;
  return page;
}

page::Report page_of(const StiffnessResult& result) {
  page::Report page = titled("Joint stiffness", summary(result));
  page.stiffness = robot::stiffness_json(result.found, result.cell.robot.arm, result.loads);
  page.notes = result.cell.notes;
  page.assumed = result.assumed;
  return page;
}

page::Report page_of(const cell::CellCheck& result) {
  page::Report page = titled("Robot cell", summary(result));
  page.cell = cell::cell_check_json(result);
  return page;
}

page::Report page_of(const process::SmoothResult& result) {
  page::Report page = titled("Smoothed program", summary(result));
  page.smooth = path::smooth_json(result.smoothed);
  if (!result.motions.empty()) page.motion = path::motion_json(result.outline, result.motions);
  page.assumed = result.smoothed.assumed;
  return page;
}

}  // namespace robomill::jobs
