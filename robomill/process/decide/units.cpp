#include "robomill/process/decide/units.hpp"

#include <algorithm>
#include <optional>

namespace robomill::process {
namespace {

using program::Block;
using program::Program;

bool plunges(const Program& program, std::size_t block) {
  const Eigen::Vector3d move_m = program.blocks[block].end.tip_m - program.begin_of(block).tip_m;
  return -move_m.dot(program.blocks[block].end.axis) > 0.5 * move_m.norm();
}

decision::ProgramCut cut_of(const ForcesResult& forces, LineUnit& unit) {
  const Program& program = forces.program->program;
  double length_m = 0.0;
  double duration_s = 0.0;
  for (std::size_t i = unit.first_block; i <= unit.last_block; ++i) {
    length_m += way_m(program, i, i);
    duration_s += program.blocks[i].duration_s;
  }
  decision::ProgramCut cut;
  unit.turns_only = !(length_m > 1e-9);
  // A tip that stands has no feed: the time of the line stands for one.
  cut.length_m = unit.turns_only ? duration_s : length_m;
  cut.feed_m_per_s = cut.length_m / duration_s;
  if (unit.turns_only) return cut;
  unit.plunges = false;
  cut.tooth_feed_share = 0.0;
  for (const std::size_t i : unit.cutting) {
    if (plunges(program, i)) unit.plunges = true;
    const double tip_m_per_s = way_m(program, i, i) / program.blocks[i].duration_s;
    cut.tooth_feed_share = std::max(cut.tooth_feed_share, forces.program->cuts[i].feed_speed_m_per_s / tip_m_per_s);
  }
  if (!(cut.tooth_feed_share > 0.0)) cut.tooth_feed_share = 1.0;
  return cut;
}

}  // namespace

std::vector<double> ways_m(const Program& program) {
  std::vector<double> out = {0.0};
  out.reserve(program.blocks.size() + 1);
  for (std::size_t i = 0; i < program.blocks.size(); ++i) out.push_back(out.back() + way_m(program, i, i));
  return out;
}

double way_m(const Program& program, std::size_t first, std::size_t last) {
  double way = 0.0;
  for (std::size_t i = first; i <= last; ++i) way += (program.blocks[i].end.tip_m - program.begin_of(i).tip_m).norm();
  return way;
}

bool plunges_in_line(const Program& program, std::size_t block) {
  const auto same = [&](std::size_t i) { return program.blocks[i].line == program.blocks[block].line; };
  std::size_t first = block;
  while (first > 0 && same(first - 1)) --first;
  for (std::size_t i = first; i < program.blocks.size() && same(i); ++i) {
    if (plunges(program, i)) return true;
  }
  return false;
}

ProgramUnits program_units(const ForcesResult& forces, const ProgramBlocks& blocks, bool at_speeds) {
  const Program& program = forces.program->program;
  ProgramUnits out;
  std::optional<std::size_t> rapid;    // the first since the last cut
  std::optional<std::size_t> longest;  // … and the longest
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
    if (block.kind == Block::Kind::rapid) {
      if (!rapid) rapid = unit.first_block;
      for (std::size_t i = unit.first_block; i <= unit.last_block; ++i) {
        if (!longest || way_m(program, i, i) > way_m(program, *longest, *longest)) longest = i;
      }
    }
    if (unit.cutting.empty()) continue;
    const double speed = forces.program->blocks[unit.cutting.front()].force.spindle_speed_rad_per_s;
    const bool other =
        at_speeds && !out.stretches.empty() && speed != out.stretches.back().programmed_spindle_speed_rad_per_s;
    if (out.stretches.empty() || rapid || other) {
      out.speed_from.push_back(out.stretches.empty() ? 0 : rapid.value_or(unit.first_block));
      out.lean_from.push_back(out.stretches.empty() ? 0 : longest.value_or(unit.first_block));
      out.stretches.push_back(
          {.begin = out.lines.size(), .end = out.lines.size(), .programmed_spindle_speed_rad_per_s = speed});
    }
    rapid.reset();
    longest.reset();
    ++out.stretches.back().end;
    out.cuts.push_back(cut_of(forces, unit));
    out.lines.push_back(std::move(unit));
  }
  return out;
}

ProgramUnits units_again(const ProgramUnits& units, const ForcesResult& forces) {
  ProgramUnits out = units;
  for (std::size_t k = 0; k < out.lines.size(); ++k) {
    LineUnit& line = out.lines[k];
    line.cutting.clear();
    for (std::size_t i = line.first_block; i <= line.last_block; ++i) {
      const bool cuts = forces.program->blocks[i].force.cuts() && !forces.program->cuts[i].engagement.empty();
      if (cuts) line.cutting.push_back(i);
    }
    out.cuts[k] = cut_of(forces, line);
  }
  return out;
}

}  // namespace robomill::process
