#include "robomill/process/decide/apply.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "robomill/process/blocks/stand_at.hpp"
#include "robomill/process/program_forces.hpp"
#include "robomill/robot/pose.hpp"

namespace robomill::process {

program::Program at_conditions(program::Program program, const ProgramUnits& units,
                               const std::vector<StretchConditions>& conditions) {
  for (std::size_t k = 0; k < units.stretches.size(); ++k) {
    const std::optional<double>& speed = conditions[k].spindle_speed_rad_per_s;
    const std::size_t end = k + 1 < units.stretches.size() ? units.speed_from[k + 1] : program.blocks.size();
    for (std::size_t i = units.speed_from[k]; speed && i < end; ++i) {
      if (program.blocks[i].spindle == program::Spindle::off) continue;
      program.blocks[i].spindle_speed_rad_per_s = *speed;
    }
    for (std::size_t c = units.stretches[k].begin; c < units.stretches[k].end; ++c) {
      // One factor a line: chords of an arc keep their shares of its time.
      const double slower = conditions[k].slower[c - units.stretches[k].begin];
      for (std::size_t i = units.lines[c].first_block; i <= units.lines[c].last_block; ++i) {
        program.blocks[i].duration_s *= slower;
      }
    }
  }
  return program;
}

std::vector<double> gamma_offsets(const program::Program& program, const ProgramUnits& units,
                                  const std::vector<LineGamma>& lines) {
  constexpr double unset = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> out(program.blocks.size() + 1, unset);
  const std::vector<double> way = ways_m(program);
  for (std::size_t c = 0; c < units.lines.size(); ++c) {
    const LineUnit& line = units.lines[c];
    const double blocks = static_cast<double>(line.last_block - line.first_block + 1);
    for (std::size_t i = line.first_block; i <= line.last_block + 1; ++i) {
      out[i] = std::lerp(lines[c].begin_rad, lines[c].end_rad, static_cast<double>(i - line.first_block) / blocks);
    }
  }
  std::optional<std::size_t> known;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (std::isnan(out[i])) continue;
    const std::size_t from = known ? *known + 1 : 0;
    for (std::size_t k = from; k < i; ++k) {
      const double span = known ? way[i] - way[*known] : 0.0;
      out[k] = span > 0.0 ? std::lerp(out[*known], out[i], (way[k] - way[*known]) / span) : out[i];
    }
    known = i;
  }
  for (std::size_t k = known ? *known + 1 : 0; k < out.size(); ++k) out[k] = known ? out[*known] : 0.0;
  return out;
}

Stands joints_at(const ForcesResult& forces, const program::Program& program,
                 const std::vector<double>& gamma_offset_rad) {
  const robot::Cell& cell = forces.cell->robot;
  const program::Program& before = forces.program->program;
  const std::optional<robot::SphericalWristInverse> inverse = spherical_wrist(cell.arm);
  Stands out;
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    const Eigen::VectorXd& programmed = forces.program->blocks[i].joints;
    const double turn = gamma_offset_rad.empty() ? 0.0 : gamma_offset_rad[i + 1];
    const Eigen::Vector3d move_m = program.blocks[i].end.tip_m - before.blocks[i].end.tip_m;
    const bool leans = program.blocks[i].end.axis != before.blocks[i].end.axis;
    if (turn == 0.0 && move_m.isZero(0.0) && !leans) {
      out.joints.emplace_back(programmed);
      continue;
    }
    robot::ToolPose pose = robot::tool_pose(cell, robot::forward(cell.arm, programmed));
    pose.gamma_rad += turn;
    pose.tip_m += move_m;
    if (leans) pose.axis = program.blocks[i].end.axis;
    const Eigen::VectorXd near = i > 0 ? Eigen::VectorXd(out.joints.back()) : programmed;
    const std::optional<Eigen::VectorXd> joints = stand_at(cell, inverse, pose, near);
    if (!joints) {
      out.lost = i;
      return out;
    }
    out.joints.emplace_back(*joints);
  }
  // The flange is turned about the tool as it is where the first block ends.
  robot::ToolPose begin = robot::tool_pose(cell, robot::forward(cell.arm, out.joints.front()));
  begin.tip_m = program.start.tip_m;
  begin.axis = program.start.axis;
  if (!gamma_offset_rad.empty()) begin.gamma_rad += gamma_offset_rad[0] - gamma_offset_rad[1];
  const bool turned = !gamma_offset_rad.empty() && gamma_offset_rad[0] != 0.0;
  if (const std::optional<Eigen::VectorXd> joints = stand_at(cell, inverse, begin, out.joints.front())) {
    out.start = robot::Position6(*joints);
  } else if (turned || program.start.axis != before.start.axis) {
    out.lost = 0;
  }
  return out;
}

}  // namespace robomill::process
