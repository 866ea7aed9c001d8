#include "robomill/process/forces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/arm_modes.hpp"
#include "robomill/io/usual_ranges.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/process/program_forces.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/robot/pose.hpp"
#include "robomill/robot/stiffness.hpp"
#include "robomill/simulation/posture.hpp"

namespace robomill::process {
namespace {

/// An error of what the cut says, reported with its cut.
InvalidInput reject(const Cut& cut, const char* key, std::string rule, std::string hint = {}) {
  return InvalidInput(
      InvalidInput::Parts{.where = cut.path.string(), .field = key, .rule = std::move(rule), .hint = std::move(hint)});
}

/// F in B, from where the arm holds the tool: T's x axis is the feed's direction across the tool's axis.
Eigen::Matrix3d base_from_feed(const Cut& cut, const robot::Cell& cell, const Eigen::Isometry3d& flange) {
  const Eigen::Vector3d axis = -flange.linear().col(2);
  const Eigen::Vector3d feed = cell.workpiece.linear() * cut.feed_direction;
  const Eigen::Vector3d across = feed - axis * axis.dot(feed);
  if (!(across.norm() > 1e-6)) {
    throw reject(cut, "robot.feed_direction", "must not run along the tool's axis in this posture");
  }
  Eigen::Matrix3d base_from_tool;
  base_from_tool.col(0) = across.normalized();
  base_from_tool.col(1) = axis.cross(base_from_tool.col(0));
  base_from_tool.col(2) = axis;
  return base_from_tool * cutting::feed_from_tool(cut.cut.lead_rad, cut.cut.tilt_rad).transpose();
}

Eigen::VectorXd joints_of(const Cut& cut, const robot::Cell& cell) {
  Eigen::VectorXd q =
      Eigen::Map<const Eigen::VectorXd>(cut.joints_rad.data(), static_cast<Eigen::Index>(cut.joints_rad.size()));
  if (q.size() != cell.arm.size()) {
    throw reject(cut, "robot.joints_deg", fmt::format("must have one angle for each of {} joints", cell.arm.size()));
  }
  const robot::LimitCheck limits = robot::within_limits(cell.arm, q);
  if (!limits.inside) {
    throw reject(cut, "robot.joints_deg", fmt::format("must lie within the limits of joint {}", limits.joint + 1),
                 fmt::format("It is {:.4g} degrees beyond", -limits.distance / units::deg));
  }
  return q;
}

/// @param force_n  on the tool, in F
CutPosture posture_of(const Cut& cut, const robot::Cell& cell, const Eigen::VectorXd& joints,
                      const Eigen::Vector3d& force_n) {
  const Eigen::Isometry3d flange = robot::forward(cell.arm, joints);
  const Eigen::Vector3d tip = robot::tip_point(cell);
  const Eigen::Matrix3d frame = base_from_feed(cut, cell, flange);
  const robot::Stiffness stiffness = robot::stiffness(cell.arm, joints, tip, {.force_n = frame * force_n});
  if (stiffness.status == robot::Stiffness::Status::singular) {
    throw reject(cut, "robot.joints_deg",
                 fmt::format("must not be a singular posture (condition number {:.3g})", stiffness.condition_number));
  }
  if (stiffness.status == robot::Stiffness::Status::buckled) {
    throw reject(cut, "robot.joints_deg", "must hold the cutting force: the joints deflect without equilibrium");
  }
  CutPosture out;
  out.compliance_m_per_n = frame.transpose() * stiffness.compliance.topLeftCorner<3, 3>() * frame;
  out.base_from_feed = frame;
  out.condition_number = stiffness.condition_number;
  out.pose = robot::tool_pose(cell, flange);
  return out;
}

/// The robot's own modes as the cut sees them.
modal::TipModes robot_modes(const Cut& cut, const robot::Cell& cell, const Eigen::VectorXd& joints,
                            const Eigen::Matrix3d& base_from_feed) {
  if (!cell::vibrates(cell.arm)) {
    throw reject(cut, "robot.vibration", "needs the masses of the links and the damping of the joints",
                 "The cell says them as links and joint_damping_n_m_s_per_rad");
  }
  return modal::turned(modal::tip_modes(cell::arm_modes(cell, joints, cut.robot_inertia), {}, 0.0),
                       base_from_feed.transpose());
}

/// What vibrates, in F: tool, robot, and the part with its fixture. Each moves against the next, so receptances add.
std::optional<modal::TipModes> structure_of(const Cut& cut, const robot::Cell* cell, const Eigen::VectorXd& joints,
                                            const CutPosture* posture) {
  std::optional<modal::TipModes> all;
  const auto join = [&all](const modal::TipModes& part) { all = all ? modal::joined(*all, part) : part; };
  if (!cut.dynamics.modes.empty()) join(modal::tip_modes(cut.dynamics, {}, cut.feed_direction_rad));
  if (!cut.workpiece_dynamics.modes.empty()) {
    join(modal::tip_modes(cut.workpiece_dynamics, {}, cut.feed_direction_rad, modal::ModeOwner::workpiece));
  }
  if (cell != nullptr && posture != nullptr && cut.robot_vibrates) {
    join(robot_modes(cut, *cell, joints, posture->base_from_feed));
  }
  return all;
}

constexpr double most_samples_per_s = 1e6;
constexpr double least_revolutions = 5.0;

/// The last whole revolution of a simulation at the steps of a static one.
Eigen::Matrix3Xd last_revolution(const simulation::Simulation& s, double spindle_speed_rad_per_s, Eigen::Index steps) {
  const double turns_per_sample = spindle_speed_rad_per_s / (2.0 * std::numbers::pi * s.sample_rate_hz);
  const Eigen::Index samples = s.force_n.rows();
  const double whole = std::floor(static_cast<double>(samples - 1) * turns_per_sample) - 1.0;
  Eigen::Matrix3Xd out(3, steps);
  if (whole < 0.0) return Eigen::Matrix3Xd(3, 0);
  for (Eigen::Index i = 0; i < steps; ++i) {
    const double at = (whole + static_cast<double>(i) / static_cast<double>(steps)) / turns_per_sample;
    const Eigen::Index low = std::min(static_cast<Eigen::Index>(at), samples - 2);
    const double share = at - static_cast<double>(low);
    out.col(i) = ((1.0 - share) * s.force_n.row(low) + share * s.force_n.row(low + 1)).transpose();
  }
  return out;
}

void vibrate(const ForcesResult& result, const modal::TipModes& structure, RevolutionForces& out, Progress& progress) {
  const Cut& cut = result.cut;
  const simulation::PostureCut vibrating = {.cutter = cut.cutter,
                                            .engagement = out.deflected.engagement,
                                            .coefficients = cut.coefficients,
                                            .motion = cut.motion,
                                            .structure = structure};
  const double revolutions_per_s = cut.motion.spindle_speed_rad_per_s / (2.0 * std::numbers::pi);
  simulation::SimulationOptions options;
  options.sample_rate_hz = std::min(std::ceil(revolutions_per_s * cut.force.steps), most_samples_per_s);
  options.seconds = std::max(options.seconds, least_revolutions / revolutions_per_s);
  out.vibration = simulation::simulate(vibrating, options, progress);
  out.vibrating_force_n = last_revolution(*out.vibration, cut.motion.spindle_speed_rad_per_s, cut.force.steps);
}

/// What turning the robot about the tool would do to the deflection under the mean force; none for an arm without a
/// spherical wrist, of which only the given posture is known.
std::optional<robot::Redundancy> turn_about_tool(const robot::Cell& cell, const CutPosture& posture,
                                                 const Eigen::Vector3d& force_n, const Eigen::VectorXd& joints) {
  const std::optional<robot::SphericalWristInverse> inverse = robot::spherical_wrist(cell.arm);
  if (!inverse) return std::nullopt;
  const Eigen::Matrix3d work_from_feed = cell.workpiece.linear().transpose() * posture.base_from_feed;
  return robot::redundancy(
      cell, *inverse, posture.pose,
      {.force_n = work_from_feed * force_n, .normal = work_from_feed.col(2), .previous = robot::Position6(joints)});
}

void run_revolution(ForcesResult& result, Progress& progress) {
  const Cut& cut = result.cut;
  RevolutionForces out;
  const auto deflected = [&](const Eigen::Matrix3d& compliance) {
    return cutting::static_deflection(cut.cutter, cut.cut, cut.coefficients, cut.motion, compliance, cut.force,
                                      cut.slices);
  };
  Eigen::VectorXd joints;
  const robot::Cell* cell = result.cell && !cut.joints_rad.empty() ? &result.cell->robot : nullptr;
  out.deflected = deflected(Eigen::Matrix3d::Zero());
  if (cell != nullptr) {
    out.rigid = out.deflected.force;
    joints = joints_of(cut, *cell);
    // The load changes the stiffness a little: once more with what the first pass gave.
    for (int pass = 0; pass < 2; ++pass) {
      out.posture = posture_of(cut, *cell, joints, out.deflected.force.mean_n);
      out.deflected = deflected(out.posture->compliance_m_per_n);
    }
    out.spindle_rotation = turn_about_tool(*cell, *out.posture, out.deflected.force.mean_n, joints);
  }
  if (out.deflected.status == cutting::StaticDeflection::Status::diverged) {
    result.warnings.emplace_back("The force pulls the tool in faster than the robot holds it: no equilibrium.");
  } else if (out.deflected.status == cutting::StaticDeflection::Status::lifts_off) {
    result.warnings.emplace_back("The force pushes the tool out of the cut altogether: the robot is too soft for it.");
  }
  if (const auto structure = structure_of(cut, cell, joints, out.posture ? &*out.posture : nullptr)) {
    vibrate(result, *structure, out, progress);
  }
  result.revolution = std::move(out);
}

ForcesResult begin(Cut cut, std::optional<cell::Cell> cell) {
  ForcesResult result = {.cut = std::move(cut), .cell = std::move(cell)};
  result.notes = result.cut.notes;
  if (result.cell) result.notes.insert(result.notes.end(), result.cell->notes.begin(), result.cell->notes.end());
  result.warnings = io::take_warnings(result.notes);
  return result;
}

}  // namespace

ForcesResult forces_of_revolution(Cut cut, std::optional<cell::Cell> cell, Progress& progress) {
  ForcesResult result = begin(std::move(cut), std::move(cell));
  run_revolution(result, progress);
  add_assumed(result.assumed, result.cut.assumed);
  if (result.cell) add_assumed(result.assumed, result.cell->assumed);
  return result;
}

ForcesResult forces_along(Cut cut, program::Program program, const std::filesystem::path& path,
                          std::optional<cell::Cell> cell, const ProgramRun& run, Progress& progress) {
  ForcesResult result = begin(std::move(cut), std::move(cell));
  run_program(result, std::move(program), path, run, progress);
  if (result.program->stock && result.program->stock->assumed) {
    result.assumed.push_back({.what = "Stock",
                              .taken = stock_text(*result.program),
                              .key = "stock.kind",
                              .file = result.cut.path.filename().string()});
  }
  add_assumed(result.assumed, result.cut.assumed);
  add_assumed(result.assumed, result.program->program.assumed);
  if (result.cell) add_assumed(result.assumed, cell::assumed_along_program(*result.cell, !run.joints.empty()));
  return result;
}

std::size_t ProgramForces::cutting_blocks() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(blocks, [](const BlockResult& row) { return row.force.cuts(); }));
}

std::vector<SpindleLoad> spindle_loads(const ForcesResult& result) {
  if (result.revolution) {
    const cutting::CuttingForce& force = result.revolution->deflected.force;
    return {{.spindle_speed_rad_per_s = result.cut.motion.spindle_speed_rad_per_s,
             .torque_n_m = force.mean_torque_n_m,
             .power_w = force.power_w}};
  }
  std::vector<SpindleLoad> loads;
  for (const BlockResult& row : result.program->blocks) {
    if (!row.force.cuts()) continue;
    loads.push_back({.line = result.program->program.blocks[row.force.block].line,
                     .spindle_speed_rad_per_s = row.force.spindle_speed_rad_per_s,
                     .torque_n_m = row.force.revolution_torque_n_m,
                     .power_w = row.force.sustained_power_w});
  }
  return loads;
}

}  // namespace robomill::process
