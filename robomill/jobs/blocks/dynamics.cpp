#include "robomill/jobs/blocks/dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/jobs/blocks.hpp"
#include "robomill/jobs/decide/units.hpp"
#include "robomill/jobs/posture.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/robot/dynamics.hpp"
#include "robomill/robot/pose.hpp"

namespace robomill::jobs {

std::optional<robot::Link> payload_of(const CellFile& cell) {
  if (!cell.end_effector.mass_kg) return std::nullopt;
  constexpr double radius_of_gyration_m = 0.1;
  const Eigen::Isometry3d flange = cell.cell.arm.flange * cell.mount().inverse();  // after the last joint
  robot::Link link;
  link.mass_kg = *cell.end_effector.mass_kg;
  link.center_m = flange * cell.end_effector.center();
  link.inertia_kg_m2 = link.mass_kg * radius_of_gyration_m * radius_of_gyration_m * Eigen::Matrix3d::Identity();
  return link;
}

bool vibrates(const robot::Arm& arm) {
  return std::ranges::any_of(arm.joints, [](const robot::Joint& j) { return j.link.mass_kg > 0.0; }) &&
         std::ranges::all_of(arm.joints, [](const robot::Joint& j) { return j.damping > 0.0; });
}

std::array<bool, 3> pushed_axes(const ForcesResult& forces) {
  std::array<bool, 3> out = {true, true, true};
  if (forces.file.cutter.kind != cutting::CutterKind::flat_end) return out;
  const program::Program& program = forces.program->program;
  const Eigen::Matrix3d base_from_work = forces.cell->cell.workpiece.linear();
  const double upright = std::cos(5.0 * units::deg);
  out = {false, false, false};
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    if (!forces.program->blocks[i].force.cuts()) continue;
    const Eigen::Vector3d axis = base_from_work * program.blocks[i].end.axis;
    const bool plunges = plunges_in_line(program, i);
    for (std::size_t k = 0; k < out.size(); ++k) {
      out.at(k) = out.at(k) || plunges || std::abs(axis(static_cast<Eigen::Index>(k))) < upright;
    }
  }
  return out;
}

modal::ModalModel arm_modes(const robot::Cell& cell, const Eigen::VectorXd& joints) {
  const robot::ToolModes found = robot::tool_modes(cell.arm, joints, robot::tip_point(cell));
  modal::ModalModel model;
  model.excitations = model.responses = modal::tip_axes();
  model.modes.reserve(found.modes.size());
  for (const robot::ToolMode& swing : found.modes) {
    modal::Mode mode;
    mode.frequency_hz = swing.frequency_hz;
    mode.damping_ratio = swing.damping_ratio;
    mode.right = swing.right.head<3>();
    mode.left = swing.left.head<3>();
    model.modes.push_back(std::move(mode));
  }
  return model;
}

DynamicsAt dynamics_of_cell(const CellFile& cell, const std::array<bool, 3>& pushed, std::vector<std::string>& warnings,
                            std::vector<std::string>& notes, std::vector<Assumption>& assumed, Progress& progress) {
  if (cell.postures.empty() && !vibrates(cell.cell.arm)) {
    throw InvalidInput(cell.path.string(), "does not say what vibrates",
                       "Give modes or FRFs in the job, [[postures]] in the cell, or its links' masses and "
                       "joint_damping_n_m_s_per_rad");
  }
  const CellDynamics dynamics = cell_dynamics(cell, progress);
  warnings.insert(warnings.end(), dynamics.warnings.begin(), dynamics.warnings.end());
  const std::string unmeasured = unmeasured_axes_text(dynamics.model->report(), dynamics.direct_deviation, pushed);
  if (!unmeasured.empty()) warnings.push_back(unmeasured);
  notes.insert(notes.end(), dynamics.notes.begin(), dynamics.notes.end());
  add_assumed(assumed, dynamics.assumed);
  const bool measured = dynamics.model->report().postures > 0;
  return [dynamics, measured](const Eigen::VectorXd& joints) {
    modal::PosturePrediction there = dynamics.at(joints);
    PostureDynamics out = {.modes = {}, .joint_distance_rad = there.distance_rad};
    out.unmatched = dynamics.unmatched(there);
    if (measured) out.measured_nearby = there.measured_nearby;
    out.modes = std::move(there.modes);
    return out;
  };
}

DynamicsAt constant_dynamics(modal::ModalModel modes) {
  return [model = std::move(modes)](const Eigen::VectorXd&) { return PostureDynamics{.modes = model}; };
}

}  // namespace robomill::jobs
