#include "robomill/jobs/decide/units.hpp"

#include <algorithm>
#include <optional>

namespace robomill::jobs {
namespace {

using program::Block;
using program::Program;

double way_m(const Program& program, std::size_t block) {
  return (program.blocks[block].end.tip_m - program.begin_of(block).tip_m).norm();
}

decision::ProgramCut cut_of(const ForcesResult& forces, LineUnit& unit) {
  const Program& program = forces.program->program;
  double length_m = 0.0;
  double duration_s = 0.0;
  for (std::size_t i = unit.first_block; i <= unit.last_block; ++i) {
    length_m += way_m(program, i);
    duration_s += program.blocks[i].duration_s;
  }
  decision::ProgramCut cut;
  unit.turns_only = !(length_m > 1e-9);
  // A tip that stands has no feed: the time of the line stands for one.
  cut.length_m = unit.turns_only ? duration_s : length_m;
  cut.feed_m_per_s = cut.length_m / duration_s;
  if (unit.turns_only) return cut;
  cut.tooth_feed_share = 0.0;
  for (const std::size_t i : unit.cutting) {
    const Eigen::Vector3d move_m = program.blocks[i].end.tip_m - program.begin_of(i).tip_m;
    if (-move_m.dot(program.blocks[i].end.axis) > 0.5 * move_m.norm()) unit.plunges = true;
    const double tip_m_per_s = way_m(program, i) / program.blocks[i].duration_s;
    cut.tooth_feed_share = std::max(cut.tooth_feed_share, forces.program->cuts[i].feed_speed_m_per_s / tip_m_per_s);
  }
  if (!(cut.tooth_feed_share > 0.0)) cut.tooth_feed_share = 1.0;
  return cut;
}

}  // namespace

ProgramUnits program_units(const ForcesResult& forces, const ProgramBlocks& blocks, bool at_speeds) {
  const Program& program = forces.program->program;
  ProgramUnits out;
  std::optional<std::size_t> rapid;  // the first since the last cut
  for (std::size_t first = 0; first < program.blocks.size();) {
    LineUnit unit = {.first_block = first, .last_block = first};
    const Block& block = program.blocks[first];
    while (unit.last_block + 1 < program.blocks.size() && program.blocks[unit.last_block + 1].line == block.line &&
           program.blocks[unit.last_block + 1].kind == block.kind) {
      ++unit.last_block;
    }
    first = unit.last_block + 1;
    for (std::size_t i = unit.first_block; i <= unit.last_block; ++i) {
      if (blocks.rows[i].cuts) unit.cutting.push_back(i);
    }
    if (block.kind == Block::Kind::rapid && !rapid) rapid = unit.first_block;
    if (unit.cutting.empty()) continue;
    const double speed = forces.program->blocks[unit.cutting.front()].force.spindle_speed_rad_per_s;
    const bool other =
        at_speeds && !out.stretches.empty() && speed != out.stretches.back().programmed_spindle_speed_rad_per_s;
    if (out.stretches.empty() || rapid || other) {
      out.speed_from.push_back(out.stretches.empty() ? 0 : rapid.value_or(unit.first_block));
      out.stretches.push_back(
          {.begin = out.lines.size(), .end = out.lines.size(), .programmed_spindle_speed_rad_per_s = speed});
    }
    rapid.reset();
    ++out.stretches.back().end;
    out.cuts.push_back(cut_of(forces, unit));
    out.lines.push_back(std::move(unit));
  }
  return out;
}

}  // namespace robomill::jobs
