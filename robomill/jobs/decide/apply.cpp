#include "robomill/jobs/decide/apply.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/jobs/blocks/named_block.hpp"
#include "robomill/jobs/blocks/stand_at.hpp"
#include "robomill/jobs/program_forces.hpp"
#include "robomill/robot/pose.hpp"

namespace robomill::jobs {

program::Program decided_program(const ForcesResult& forces, const ProgramUnits& units,
                                 const decision::ProgramDecision& decision, bool free_speed) {
  program::Program out = forces.program->program;
  for (std::size_t k = 0; k < units.stretches.size() && free_speed; ++k) {
    const std::size_t end = k + 1 < units.stretches.size() ? units.speed_from[k + 1] : out.blocks.size();
    for (std::size_t i = units.speed_from[k]; i < end; ++i) {
      if (out.blocks[i].spindle == program::Spindle::off) continue;
      out.blocks[i].spindle_speed_rad_per_s = decision.stretches[k].spindle_speed_rad_per_s;
    }
  }
  for (std::size_t c = 0; c < units.lines.size(); ++c) {
    const LineUnit& line = units.lines[c];
    if (line.turns_only) continue;
    // One factor a line: chords of an arc keep their shares of its time.
    const double slower = units.cuts[c].feed_m_per_s / decision.feed_m_per_s[c];
    for (std::size_t i = line.first_block; i <= line.last_block; ++i) out.blocks[i].duration_s *= slower;
  }
  return out;
}

std::vector<double> gamma_offsets(const program::Program& program, const ProgramUnits& units,
                                  const decision::ProgramDecision& decision) {
  constexpr double unset = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> out(program.blocks.size() + 1, unset);
  std::vector<double> way(out.size(), 0.0);
  for (std::size_t i = 0; i < program.blocks.size(); ++i) {
    way[i + 1] = way[i] + (program.blocks[i].end.tip_m - program.begin_of(i).tip_m).norm();
  }
  for (std::size_t c = 0; c < units.lines.size(); ++c) {
    const LineUnit& line = units.lines[c];
    const double blocks = static_cast<double>(line.last_block - line.first_block + 1);
    for (std::size_t i = line.first_block; i <= line.last_block + 1; ++i) {
      out[i] = std::lerp(decision.gamma_begin_rad[c], decision.gamma_end_rad[c],
                         static_cast<double>(i - line.first_block) / blocks);
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

std::vector<robot::Position6> joints_at(const ForcesResult& forces, const program::Program& program,
                                        const std::vector<double>& gamma_offset_rad) {
  const robot::Cell& cell = forces.cell->cell;
  const std::optional<robot::SphericalWristInverse> inverse = spherical_wrist(cell.arm);
  std::vector<robot::Position6> out;
  for (std::size_t i = 0; i < forces.program->blocks.size(); ++i) {
    const Eigen::VectorXd& programmed = forces.program->blocks[i].joints;
    const double turn = gamma_offset_rad.empty() ? 0.0 : gamma_offset_rad[i + 1];
    const Eigen::Vector3d move_m = program.blocks[i].end.tip_m - forces.program->program.blocks[i].end.tip_m;
    if (turn == 0.0 && move_m.isZero(0.0)) {
      out.emplace_back(programmed);
      continue;
    }
    robot::ToolPose pose = robot::tool_pose(cell, robot::forward(cell.arm, programmed));
    pose.gamma_rad += turn;
    pose.tip_m += move_m;
    const Eigen::VectorXd near = i > 0 ? Eigen::VectorXd(out.back()) : programmed;
    const std::optional<Eigen::VectorXd> joints = stand_at(cell, inverse, pose, near);
    if (!joints) {
      throw InvalidInput(InvalidInput::Parts{
          .where = named_block(forces, i),
          .field = "γ and offset",
          .rule = fmt::format("cannot be taken: {:.3g}° and {:.3g} mm", turn / units::deg, move_m.norm() / units::mm)});
    }
    out.emplace_back(*joints);
  }
  return out;
}

}  // namespace robomill::jobs
