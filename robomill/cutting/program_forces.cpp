#include "robomill/cutting/program_forces.hpp"

#include <algorithm>
#include <numbers>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"

namespace robomill::cutting {
namespace {

/// One part of a block, and what it weighs in the block's means.
struct PartForce {
  ForceSummary summary;
  Eigen::Vector3d mean_force_n = Eigen::Vector3d::Zero();  ///< in W
  double feed_per_tooth_m = 0.0;
};

void add(const BlockEngagement& part, const PartForce& force, double share, BlockForce& block) {
  block.axial_depth_m = std::max(block.axial_depth_m, part.cut.axial_depth_m);
  block.radial_depth_m = std::max(block.radial_depth_m, part.cut.radial_depth_m);
  block.feed_per_tooth_m = std::max(block.feed_per_tooth_m, force.feed_per_tooth_m);
  block.mean_force_n += share * force.mean_force_n;
  block.peak_force_n = std::max(block.peak_force_n, force.summary.peak_force_n);
  block.mean_torque_n_m += share * force.summary.mean_torque_n_m;
  block.peak_torque_n_m = std::max(block.peak_torque_n_m, force.summary.peak_torque_n_m);
  block.power_w += share * force.summary.power_w;
  block.removed_volume_m3 += part.removed_volume_m3;
  if (part.shank) block.shank_depth_m = std::max(block.shank_depth_m, part.shank_depth_m);
  block.rapid_in_material = block.rapid_in_material || part.rapid_in_material;
}

double speed_of(const program::Block& block, const ProgramForceOptions& options) {
  return options.spindle_speed_rad_per_s > 0.0 ? options.spindle_speed_rad_per_s : block.spindle_speed_rad_per_s;
}

}  // namespace

void ProgramForceOptions::validate() const {
  require_non_negative("spindle_speed_rad_per_s", spindle_speed_rad_per_s, "rad/s");
  force.validate();
  walk.validate();
}

std::vector<BlockForce> program_forces(const program::Program& program, const Cutter& cutter,
                                       const MillingCoefficients& coefficients, Workpiece& workpiece,
                                       const ProgramForceOptions& options, Progress& progress) {
  options.validate();
  std::vector<BlockForce> blocks(program.blocks.size());
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const program::Block& block = program.blocks[i];
    blocks[i].block = i;
    blocks[i].spindle_speed_rad_per_s = speed_of(block, options);
    if (block.kind == program::Block::Kind::feed && !(blocks[i].spindle_speed_rad_per_s > 0.0)) {
      throw InvalidInput("spindle_speed_rad_per_s",
                         "must be given: line " + std::to_string(block.line) + " of the program cuts without one",
                         "The program has no S word before it");
    }
  }
  constexpr std::size_t grain = 16;
  std::vector<PartForce> forces;
  const auto deliver = [&](std::span<const BlockEngagement> parts) {
    forces.assign(parts.size(), {});
    parallel_for(parts.size(), grain, [&](std::size_t begin, std::size_t end) {
      ForceKernel kernel(cutter, coefficients, options.force);
      for (std::size_t i = begin; i < end; ++i) {
        const BlockEngagement& part = parts[i];
        if (part.cut.engagement.empty()) continue;
        const double speed = blocks[part.block].spindle_speed_rad_per_s;
        const double teeth_per_s = speed * cutter.mill.teeth / (2.0 * std::numbers::pi);
        PartForce& out = forces[i];
        out.feed_per_tooth_m = part.cut.feed_speed_m_per_s / teeth_per_s;
        out.summary = kernel.summary(part.cut.engagement,
                                     {.feed_per_tooth_m = out.feed_per_tooth_m, .spindle_speed_rad_per_s = speed});
        out.mean_force_n = part.cut.work_from_feed * out.summary.mean_n;
      }
    });
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const BlockEngagement& part = parts[i];
      add(part, forces[i], part.share_to - part.share_from, blocks[part.block]);
    }
  };
  walk(program, cutter, workpiece, options.walk, deliver, progress);
  return blocks;
}

}  // namespace robomill::cutting
