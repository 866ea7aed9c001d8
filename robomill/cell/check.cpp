#include "robomill/cell/check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/cell/check/drawing.hpp"
#include "robomill/cell/check/placement.hpp"
#include "robomill/cell/check/shown.hpp"
#include "robomill/cell/check/tool_places.hpp"
#include "robomill/cell/dynamics.hpp"
#include "robomill/cell/files/cell_toml.hpp"
#include "robomill/cell/posture_choice.hpp"
#include "robomill/path/postures/posture_walk.hpp"
#include "robomill/program/files/program_files.hpp"

namespace robomill::cell {
namespace {

/// Finer than what reach and limits are judged by, and coarse enough for long arcs.
constexpr double chord_tolerance_m = 1e-4, axis_tolerance_rad = 0.1 * units::deg;
constexpr std::size_t most_blocks = 200'000;

/// The flange, before any mount, in B.
Eigen::Isometry3d flange_at(const Cell& cell, const robot::Position6& position) {
  if (!cell.hybrid) {
    return robot::forward(cell.robot.arm, position) * cell.mount().inverse();
  }
  const robot::HybridMachine& machine = *cell.hybrid;
  const robot::PlatformPose platform = robot::HybridKinematics(machine).platform(position);
  const Eigen::AngleAxisd tilt(platform.alpha_rad, Eigen::Vector3d::UnitX());
  return Eigen::Translation3d(position(3), position(4), 0.0) * tilt *
         Eigen::Translation3d(0.0, 0.0, platform.height_m) *
         Eigen::AngleAxisd(platform.beta_rad, Eigen::Vector3d::UnitY()) *
         Eigen::Translation3d(0.0, 0.0, machine.platform_to_flange_m);
}

CellStand stand_at(const Cell& cell, const robot::Kinematics& machine, std::string name,
                   const robot::Position6& position) {
  CellStand out{.name = std::move(name), .position = position};
  out.flange = flange_at(cell, position);
  out.tool = machine.forward(position);
  out.tip_m = cell.robot.workpiece * out.tool.tip_m;
  out.axis = cell.robot.workpiece.linear() * out.tool.axis;
  const robot::JointLimits& limits = machine.limits();
  for (int i = 0; i < machine.joints(); ++i) {
    out.to_limit(i) = std::min(position(i) - limits.min_position(i), limits.max_position(i) - position(i));
  }
  out.nearest_joint = path::limit_share(machine, position).joint;
  out.condition_number = 1.0 / machine.regularity(position);
  return out;
}

void add_limit_stands(const robot::Kinematics& machine, const robot::Position6& home, CellCheck& out) {
  for (int i = 0; i < machine.joints(); ++i) {
    for (const bool upper : {false, true}) {
      const double limit = upper ? machine.limits().max_position(i) : machine.limits().min_position(i);
      if (!is_limit(limit)) continue;
      robot::Position6 position = home;
      position(i) = limit;
      out.at_limits.push_back(stand_at(
          out.cell, machine, fmt::format("joint {} at its {} limit", i + 1, upper ? "upper" : "lower"), position));
    }
  }
}

void require_joints(const CellCheckJob& job, int joints) {
  if (job.joints.empty() || job.joints.size() == static_cast<std::size_t>(joints)) return;
  throw InvalidInput("joints", fmt::format("must hold one value a joint, {}; it holds {}", joints, job.joints.size()));
}

/// The program's poses, or the workpiece's origin with the spindle along its z.
Targets targets_of(const CellCheckJob& job, program::ProgramFile* program) {
  if (program == nullptr) return {.head = {.pose = {program::Pose{}}}};
  try {
    Targets out{.head = path::read_head(*program, most_blocks), .source = program};
    if (out.head.line.empty()) throw InvalidInput(job.program.string(), "must hold at least one block");
    return out;
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    if (parts.where.empty()) parts.where = job.program.string();
    throw InvalidInput(std::move(parts));
  }
}

std::unique_ptr<program::ProgramFile> open_program_of(const CellCheckJob& job, const Cell& cell) {
  if (job.program.empty()) return nullptr;
  program::ProgramReading reading = program_reading(cell);
  reading.chord_tolerance_m = chord_tolerance_m;
  reading.axis_tolerance_rad = axis_tolerance_rad;
  return program::open_program(job.program, reading);
}

/// What the cell leaves open, and what would help that is no other pose of the workpiece.
void note_what_is_open(const Targets& targets, CellCheck& out, Progress& progress) {
  Cell& cell = out.cell;
  out.notes = cell.notes;
  for (std::string& note : calibration_notes(cell)) out.notes.push_back(std::move(note));
  if (!cell.origin_given) {
    out.notes.push_back(
        "The cell has no workpiece.origin_mm: the program's frame was taken to stand in the robot's base.");
  }
  if (!cell.length_given) {
    out.notes.push_back("The cell has no tool.length_mm: the tip was taken to be at the spindle frame's origin.");
  }
  if (cell.home.empty()) {
    out.notes.push_back(
        "The cell has no robot.start_joints_deg: home is every joint at 0, or in the middle of its limits.");
  }
  if (out.placement.works() || !cell.gamma_given) return;
  cell.gamma_given = false;
  if (const Placement free = judge(cell, cell.robot.workpiece, targets, progress); free.works()) {
    out.notes.push_back(fmt::format(
        "Without robot.gamma_deg the workpiece can stay where it is: the flange then stands at {:.0f}° about the tool.",
        free.choice.posture.gamma_rad.front() / units::deg));
  }
  cell.gamma_given = true;
}

}  // namespace

CellCheck run_cell_check(const CellCheckJob& job, Progress& progress) {
  CellFile file = read_cell(job.cell, Robots::any);
  return run_cell_check(job, std::move(static_cast<Cell&>(file)), progress);
}

CellCheck run_cell_check(const CellCheckJob& job, Cell read, Progress& progress) {
  CellCheck out;
  out.cell = std::move(read);
  const Cell& cell = out.cell;
  const std::unique_ptr<robot::Kinematics> machine = kinematics(cell);
  out.joints = machine->joints();
  out.limits = machine->limits();
  if (cell.hybrid) out.prismatic.fill(true);
  require_joints(job, out.joints);
  const std::unique_ptr<program::ProgramFile> program = open_program_of(job, cell);
  const Targets targets = targets_of(job, program.get());
  out.whole = targets.head.whole;
  if (program) out.program = job.program.filename().string();

  const robot::Position6 home = home_of(cell, *machine);
  if (!job.joints.empty()) {
    out.stands.push_back(stand_at(cell, *machine, "as asked for", position_of(job.joints)));
  }
  out.stands.push_back(stand_at(cell, *machine, "home", home));
  add_limit_stands(*machine, home, out);
  out.placement = judge(cell, cell.robot.workpiece, targets, progress);
  if (out.placement.works()) {
    out.stands.push_back(stand_at(cell, *machine, program ? "program's start" : "workpiece's origin",
                                  out.placement.choice.posture.start));
  } else {
    out.proposals = propose(cell, out.placement, targets, job.most_proposals, progress);
  }
  out.drawing = draw_cell(out, targets.head);
  note_what_is_open(targets, out, progress);
  if (!out.whole) {
    out.notes.push_back(
        fmt::format("{} goes on after its first {} moves, which alone are judged. robomill smooth follows all of it.",
                    out.program, most_blocks));
  }
  if (program && out.placement.works()) {
    for (std::string& note : posture_notes(out.placement.choice)) out.notes.push_back(std::move(note));
  }
  return out;
}

}  // namespace robomill::cell
