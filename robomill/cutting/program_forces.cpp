#include "robomill/cutting/program_forces.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/cutting/coefficients/moving_mean.hpp"
#include "robomill/cutting/cut_limits.hpp"
#include "robomill/cutting/engagement.hpp"
#include "robomill/cutting/program/local.hpp"

namespace robomill::cutting {
namespace {

/// What one part of a block asks for.
struct PartForce {
  ForceSummary summary;
  Eigen::Vector3d mean_force_n = Eigen::Vector3d::Zero();  ///< in W
  double feed_per_tooth_m = 0.0;
};

/// Adds up parts of blocks, in their order.
class Account {
 public:
  Account(const ProgramForceOptions& options, std::vector<BlockForce>& blocks)
      : options_(options), blocks_(blocks), power_(options.power_time_s), heaviest_(blocks.size(), 0.0) {}

  void add(std::size_t at, double duration_s, const PartForce& part) {
    BlockForce& block = blocks_[at];
    const ForceSummary& force = part.summary;
    const double sustained_w = power_.add(force.power_w, duration_s);
    if (!(force.peak_force_n > 0.0)) return;
    block.sustained_power_w = std::max(block.sustained_power_w, sustained_w);
    block.cutting_time_s += duration_s;
    block.feed_per_tooth_m = std::max(block.feed_per_tooth_m, part.feed_per_tooth_m);
    block.mean_force_n += duration_s * part.mean_force_n;
    block.peak_force_n = std::max(block.peak_force_n, force.peak_force_n);
    block.mean_torque_n_m += duration_s * force.mean_torque_n_m;
    block.revolution_torque_n_m = std::max(block.revolution_torque_n_m, force.mean_torque_n_m);
    block.peak_torque_n_m = std::max(block.peak_torque_n_m, force.peak_torque_n_m);
    block.power_w += duration_s * force.power_w;
    block.peak_power_w = std::max(block.peak_power_w, force.power_w);
    const double weight = options_.weight ? options_.weight(at, part.mean_force_n) : part.mean_force_n.norm();
    if (weight > heaviest_[at]) {
      heaviest_[at] = weight;
      block.heaviest_force_n = part.mean_force_n;
    }
  }

  /// Sums become means.
  void close() {
    for (BlockForce& block : blocks_) {
      if (!block.cuts()) continue;
      block.mean_force_n /= block.cutting_time_s;
      block.mean_torque_n_m /= block.cutting_time_s;
      block.power_w /= block.cutting_time_s;
    }
  }

 private:
  const ProgramForceOptions& options_;
  std::vector<BlockForce>& blocks_;
  detail::MovingMean power_;
  std::vector<double> heaviest_;
};

double speed_of(const program::Block& block, const ProgramForceOptions& options) {
  return options.spindle_speed_rad_per_s > 0.0 ? options.spindle_speed_rad_per_s : block.spindle_speed_rad_per_s;
}

/// Every block with its spindle speed.
std::vector<BlockForce> turning_blocks(const program::Program& program, const ProgramForceOptions& options) {
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
  return blocks;
}

/// Reported with the line, before the kernel rejects it without one.
void check_feed(double feed_per_tooth_m, const program::Block& block) {
  if (feed_per_tooth_m <= 0.01) return;
  throw InvalidInput("feed_per_tooth_m", feed_per_tooth_m, "m",
                     "is too large for any cutter, in line " + std::to_string(block.line) + " of the program",
                     "Are its feed and the spindle speed right?");
}

constexpr std::size_t grain = 16;

/// A block's cut in the frame of the surface that it runs on, and that frame in W.
struct SurfaceCut {
  Cut cut;
  Eigen::Matrix3d work_from_feed = Eigen::Matrix3d::Identity();
};

SurfaceCut surface_cut(const LocalCut& local, const Eigen::Vector3d& axis, double axial_depth_m, double radius_m) {
  SurfaceCut out;
  out.work_from_feed = local.work_from_feed * Eigen::AngleAxisd(local.slope_rad, Eigen::Vector3d::UnitX());
  const Eigen::Vector3d leant =
      out.work_from_feed.transpose() * axis;  // (sin lead, -sin tilt cos lead, cos tilt cos lead)
  out.cut.axial_depth_m = axial_depth_m;
  out.cut.lead_rad = std::asin(std::clamp(leant.x(), -1.0, 1.0));
  out.cut.tilt_rad = std::atan2(-leant.y(), leant.z());
  // Tips run beside the surface: curvature and distance there are k / (1 + k R) and (1 + k R) times those on it.
  const double stretch = 1.0 - local.curvature_per_m * radius_m;
  constexpr double least_stretch = 0.1;
  const bool curved = stretch > least_stretch;
  out.cut.curvature_across_feed_per_m = curved ? local.curvature_per_m / stretch : 0.0;
  out.cut.radial_depth_m = std::min(local.stepover_m * (curved ? stretch : 1.0), 2.0 * radius_m);
  out.cut.direction = local.neighbour == LocalCut::Neighbour::none   ? MillingDirection::slot
                      : local.neighbour == LocalCut::Neighbour::left ? MillingDirection::down
                                                                     : MillingDirection::up;
  return out;
}

}  // namespace

void ProgramForceOptions::validate() const {
  if (spindle_speed_rad_per_s != 0.0) require_spindle_speed("spindle_speed_rad_per_s", spindle_speed_rad_per_s);
  require_positive("power_time_s", power_time_s, "s");
  force.validate();
  walk.validate();
}

std::vector<BlockForce> program_forces(const program::Program& program, const Cutter& cutter,
                                       const MillingCoefficients& coefficients, Workpiece& workpiece,
                                       const ProgramForceOptions& options, Progress& progress) {
  std::vector<BlockForce> blocks = turning_blocks(program, options);
  std::vector<PartForce> forces;
  Account account(options, blocks);
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
        check_feed(out.feed_per_tooth_m, program.blocks[part.block]);
        out.summary = kernel.summary(part.cut.engagement,
                                     {.feed_per_tooth_m = out.feed_per_tooth_m, .spindle_speed_rad_per_s = speed});
        out.mean_force_n = part.cut.work_from_feed * out.summary.mean_n;
      }
    });
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const BlockEngagement& part = parts[i];
      account.add(part.block, part.duration_s, forces[i]);
      if (options.observe && !part.cut.engagement.empty()) {
        options.observe({.block = part.block,
                         .cut = part.cut,
                         .feed_per_tooth_m = forces[i].feed_per_tooth_m,
                         .mean_force_n = forces[i].mean_force_n});
      }
      BlockForce& block = blocks[part.block];
      block.axial_depth_m = std::max(block.axial_depth_m, part.cut.axial_depth_m);
      block.radial_depth_m = std::max(block.radial_depth_m, part.cut.radial_depth_m);
      block.removed_volume_m3 += part.removed_volume_m3;
      if (part.shank) block.shank_depth_m = std::max(block.shank_depth_m, part.shank_depth_m);
      block.rapid_in_material = block.rapid_in_material || part.rapid_in_material;
    }
  };
  walk(program, cutter, workpiece, options.walk, deliver, progress);
  account.close();
  return blocks;
}

std::vector<BlockForce> local_program_forces(const program::Program& program, const Cutter& cutter,
                                             const MillingCoefficients& coefficients, double axial_depth_m,
                                             const ProgramForceOptions& options, Progress& progress) {
  if (cutter.kind != CutterKind::ball_end) {
    throw InvalidInput("kind", "must be a ball end where there is no stock", "Other cutters need a workpiece");
  }
  const double radius = 0.5 * cutter.mill.diameter_m;
  std::vector<BlockForce> blocks = turning_blocks(program, options);
  const LocalCuts cuts(program, cutter.mill.diameter_m);
  std::vector<PartForce> forces(blocks.size());
  std::vector<PoseEngagement> seen(options.observe ? blocks.size() : 0);
  progress.start("forces", blocks.size());
  parallel_for(blocks.size(), grain, [&](std::size_t begin, std::size_t end) {
    ForceKernel kernel(cutter, coefficients, options.force);
    for (std::size_t i = begin; i < end; ++i) {
      progress.advance();
      const program::Block& block = program.blocks[i];
      const program::Pose& from = program.begin_of(i);
      const double way = (block.end.tip_m - from.tip_m).norm();
      if (block.kind != program::Block::Kind::feed || !(way > 0.0)) continue;
      const SurfaceCut surface =
          surface_cut(cuts.at(i), program::between(from, block.end, 0.5).axis, axial_depth_m, radius);
      constexpr double steepest = 1.5;  // beyond 86 degrees
      if (std::abs(surface.cut.lead_rad) > steepest) {
        throw InvalidInput("program",
                           "line " + std::to_string(block.line) +
                               " plunges along the tool's axis; neighbouring passes "
                               "does not resolve such a cut",
                           "Give the stock");
      }
      BlockForce& out = blocks[i];
      PartForce& force = forces[i];
      const double teeth_per_s = out.spindle_speed_rad_per_s * cutter.mill.teeth / (2.0 * std::numbers::pi);
      force.feed_per_tooth_m = way / block.duration_s / teeth_per_s;
      check_feed(force.feed_per_tooth_m, block);
      out.axial_depth_m = axial_depth_m;
      out.radial_depth_m = surface.cut.radial_depth_m;
      Engagement engagement = engage(cutter, surface.cut);
      force.summary = kernel.summary(engagement, {.feed_per_tooth_m = force.feed_per_tooth_m,
                                                  .spindle_speed_rad_per_s = out.spindle_speed_rad_per_s});
      force.mean_force_n = surface.work_from_feed * force.summary.mean_n;
      out.removed_volume_m3 = force.summary.removal_rate_m3_per_s * block.duration_s;
      if (options.observe) {
        seen[i] = {.engagement = std::move(engagement),
                   .work_from_feed = surface.work_from_feed,
                   .feed_speed_m_per_s = way / block.duration_s,
                   .axial_depth_m = axial_depth_m,
                   .radial_depth_m = out.radial_depth_m};
      }
    }
  });
  Account account(options, blocks);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    account.add(i, program.blocks[i].duration_s, forces[i]);
    if (!options.observe || seen[i].engagement.empty()) continue;
    options.observe({.block = i,
                     .cut = seen[i],
                     .feed_per_tooth_m = forces[i].feed_per_tooth_m,
                     .mean_force_n = forces[i].mean_force_n});
  }
  account.close();
  return blocks;
}

}  // namespace robomill::cutting
