#include "robomill/process/blocks/dynamics.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/arm_modes.hpp"
#include "robomill/cell/dynamics.hpp"
#include "robomill/process/blocks.hpp"
#include "robomill/process/decide/units.hpp"

namespace robomill::process {

namespace {

/// Postures of a program: each of its runs asks for the same ones. A server that keeps a program asks for others as
/// long as its flange is turned: beyond their most all are found again.
class KnownPostures {
 public:
  static constexpr std::size_t most = 4096;  ///< kept at a time

  template <class Find>
  PostureDynamics find(const Eigen::VectorXd& joints, const Find& find) {
    const std::vector<double> key(joints.begin(), joints.end());
    {
      const std::scoped_lock lock(mutex_);
      if (const auto at = known_.find(key); at != known_.end()) return at->second;
    }
    PostureDynamics found = find();
    const std::scoped_lock lock(mutex_);
    if (known_.size() >= most) known_.clear();
    return known_.emplace(key, std::move(found)).first->second;
  }

 private:
  std::mutex mutex_;
  std::map<std::vector<double>, PostureDynamics> known_;
};

}  // namespace

std::array<bool, 3> pushed_axes(const ForcesResult& forces) {
  std::array<bool, 3> out = {true, true, true};
  if (forces.cut.cutter.kind != cutting::CutterKind::flat_end) return out;
  const program::Program& program = forces.program->program;
  const Eigen::Matrix3d base_from_work = forces.cell->robot.workpiece.linear();
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

DynamicsAt dynamics_of_cell(const cell::Cell& cell, const std::array<bool, 3>& pushed,
                            std::vector<std::string>& warnings, std::vector<std::string>& notes,
                            std::vector<Assumption>& assumed, Progress& progress) {
  if (cell.postures.empty() && !cell::vibrates(cell.robot.arm)) {
    throw InvalidInput(cell.path.string(), "does not say what vibrates",
                       "Give modes or FRFs in the job, [[postures]] in the cell, or its links' masses and "
                       "joint_damping_n_m_s_per_rad");
  }
  const cell::CellDynamics dynamics = cell::cell_dynamics(cell, progress);
  warnings.insert(warnings.end(), dynamics.warnings.begin(), dynamics.warnings.end());
  const std::string unmeasured =
      cell::unmeasured_axes_text(dynamics.model->report(), dynamics.direct_deviation, pushed);
  if (!unmeasured.empty()) warnings.push_back(unmeasured);
  notes.insert(notes.end(), dynamics.notes.begin(), dynamics.notes.end());
  add_assumed(assumed, dynamics.assumed);
  const bool measured = dynamics.model->report().postures > 0;
  return [dynamics, measured, known = std::make_shared<KnownPostures>()](const Eigen::VectorXd& joints) {
    return known->find(joints, [&] {
      modal::PosturePrediction there = dynamics.at(joints);
      PostureDynamics out = {.modes = {}, .joint_distance_rad = there.distance_rad};
      out.unmatched = dynamics.unmatched(there);
      if (measured) out.measured_nearby = there.measured_nearby;
      out.modes = std::move(there.modes);
      return out;
    });
  };
}

DynamicsAt constant_dynamics(modal::ModalModel modes) {
  return [model = std::move(modes)](const Eigen::VectorXd&) { return PostureDynamics{.modes = model}; };
}

}  // namespace robomill::process
