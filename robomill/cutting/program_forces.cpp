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

double speed_of(const program::Block& block, const ProgramForceOptions& options) {
  return options.spindle_speed_rad_per_s > 0.0 ? options.spindle_speed_rad_per_s : block.spindle_speed_rad_per_s;
}

/// Adds up parts of blocks, in their order, and hands a block out as the next one begins.
class Account {
 public:
  Account(const program::Program& program, const ProgramForceOptions& options, const DeliverForce& deliver)
      : program_(program), options_(options), deliver_(deliver), power_(options.power_time_s) {}

  /// @return the block, to which more may be added before the next one begins
  BlockForce& add(std::size_t at, double duration_s, const PartForce& part) {
    begin(at);
    const ForceSummary& force = part.summary;
    const double sustained_w = power_.add(force.power_w, duration_s);
    if (!(force.peak_force_n > 0.0)) return block_;
    block_.sustained_power_w = std::max(block_.sustained_power_w, sustained_w);
    block_.cutting_time_s += duration_s;
    block_.feed_per_tooth_m = std::max(block_.feed_per_tooth_m, part.feed_per_tooth_m);
    block_.mean_force_n += duration_s * part.mean_force_n;
    block_.peak_force_n = std::max(block_.peak_force_n, force.peak_force_n);
    block_.mean_torque_n_m += duration_s * force.mean_torque_n_m;
    block_.revolution_torque_n_m = std::max(block_.revolution_torque_n_m, force.mean_torque_n_m);
    block_.peak_torque_n_m = std::max(block_.peak_torque_n_m, force.peak_torque_n_m);
    block_.power_w += duration_s * force.power_w;
    block_.peak_power_w = std::max(block_.peak_power_w, force.power_w);
    const double weight = options_.weight ? options_.weight(at, part.mean_force_n) : part.mean_force_n.norm();
    if (weight > heaviest_) {
      heaviest_ = weight;
      block_.heaviest_force_n = part.mean_force_n;
    }
    return block_;
  }

  /// Hands out the last block.
  void close() {
    if (!begun_) return;
    if (block_.cuts()) {  // sums become means
      block_.mean_force_n /= block_.cutting_time_s;
      block_.mean_torque_n_m /= block_.cutting_time_s;
      block_.power_w /= block_.cutting_time_s;
    }
    deliver_(block_);
    begun_ = false;
  }

 private:
  void begin(std::size_t at) {
    if (begun_ && block_.block == at) return;
    close();
    block_ = {.block = at, .spindle_speed_rad_per_s = speed_of(program_.blocks[at], options_)};
    heaviest_ = 0.0;
    begun_ = true;
  }

  const program::Program& program_;
  const ProgramForceOptions& options_;
  const DeliverForce& deliver_;
  detail::MovingMean power_;
  BlockForce block_;
  double heaviest_ = 0.0;  ///< of the block's parts
  bool begun_ = false;
};

void check_speeds(const program::Program& program, const ProgramForceOptions& options) {
  for (const program::Block& block : program.blocks) {
    if (block.kind != program::Block::Kind::feed || speed_of(block, options) > 0.0) continue;
    throw InvalidInput("spindle_speed_rad_per_s",
                       "must be given: line " + std::to_string(block.line) + " of the program cuts without one",
                       "The program has no S word before it");
  }
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

void program_forces(const program::Program& program, const Cutter& cutter, const MillingCoefficients& coefficients,
                    Workpiece& workpiece, const ProgramForceOptions& options, const DeliverForce& deliver,
                    Progress& progress) {
  options.validate();
  check_speeds(program, options);
  std::vector<PartForce> forces;
  Account account(program, options, deliver);
  const auto add_up = [&](std::span<const BlockEngagement> parts) {
    forces.assign(parts.size(), {});
    parallel_for(parts.size(), grain, [&](std::size_t begin, std::size_t end) {
      ForceKernel kernel(cutter, coefficients, options.force);
      for (std::size_t i = begin; i < end; ++i) {
        const BlockEngagement& part = parts[i];
        if (part.cut.engagement.empty()) continue;
        const program::Block& block = program.blocks[part.block];
        const double speed = speed_of(block, options);
        const double teeth_per_s = speed * cutter.mill.teeth / (2.0 * std::numbers::pi);
        PartForce& out = forces[i];
        out.feed_per_tooth_m = part.cut.feed_speed_m_per_s / teeth_per_s;
        check_feed(out.feed_per_tooth_m, block);
        out.summary = kernel.summary(part.cut.engagement,
                                     {.feed_per_tooth_m = out.feed_per_tooth_m, .spindle_speed_rad_per_s = speed});
        out.mean_force_n = part.cut.work_from_feed * out.summary.mean_n;
      }
    });
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const BlockEngagement& part = parts[i];
      BlockForce& block = account.add(part.block, part.duration_s, forces[i]);
      if (options.observe && !part.cut.engagement.empty()) {
        options.observe({.block = part.block,
                         .cut = part.cut,
                         .feed_per_tooth_m = forces[i].feed_per_tooth_m,
                         .mean_force_n = forces[i].mean_force_n});
      }
      block.axial_depth_m = std::max(block.axial_depth_m, part.cut.axial_depth_m);
      block.radial_depth_m = std::max(block.radial_depth_m, part.cut.radial_depth_m);
      block.removed_volume_m3 += part.removed_volume_m3;
      if (part.shank) block.shank_depth_m = std::max(block.shank_depth_m, part.shank_depth_m);
      block.rapid_in_material = block.rapid_in_material || part.rapid_in_material;
    }
  };
  walk(program, cutter, workpiece, options.walk, add_up, progress);
  account.close();
}

std::vector<BlockForce> program_forces(const program::Program& program, const Cutter& cutter,
                                       const MillingCoefficients& coefficients, Workpiece& workpiece,
                                       const ProgramForceOptions& options, Progress& progress) {
  std::vector<BlockForce> blocks;
  blocks.reserve(program.blocks.size());
  program_forces(
      program, cutter, coefficients, workpiece, options, [&](const BlockForce& force) { blocks.push_back(force); },
      progress);
  return blocks;
}

namespace {

/// A block beside its neighbouring pass.
struct LocalForce {
  PartForce part;
  PoseEngagement cut;  ///< empty engagement: it does not cut
  double removed_volume_m3 = 0.0;
};

/// Finds the forces of blocks beside their neighbouring passes.
class LocalForces {
 public:
  LocalForces(const program::Program& program, const Cutter& cutter, double axial_depth_m,
              const ProgramForceOptions& options)
      : program_(program),
        cutter_(cutter),
        axial_depth_m_(axial_depth_m),
        options_(options),
        cuts_(program, cutter.mill.diameter_m) {}

  [[nodiscard]] LocalForce of(std::size_t i, ForceKernel& kernel) const {
    LocalForce out;
    const program::Block& block = program_.blocks[i];
    const program::Pose& from = program_.begin_of(i);
    const double way = (block.end.tip_m - from.tip_m).norm();
    if (block.kind != program::Block::Kind::feed || !(way > 0.0)) return out;
    const SurfaceCut surface = surface_cut(cuts_.at(i), program::between(from, block.end, 0.5).axis, axial_depth_m_,
                                           0.5 * cutter_.mill.diameter_m);
    constexpr double steepest = 1.5;  // beyond 86 degrees
    if (std::abs(surface.cut.lead_rad) > steepest) {
      throw InvalidInput("program",
                         "line " + std::to_string(block.line) +
                             " plunges along the tool's axis; neighbouring passes "
                             "does not resolve such a cut",
                         "Give the stock");
    }
    const double speed = speed_of(block, options_);
    const double teeth_per_s = speed * cutter_.mill.teeth / (2.0 * std::numbers::pi);
    PartForce& force = out.part;
    force.feed_per_tooth_m = way / block.duration_s / teeth_per_s;
    check_feed(force.feed_per_tooth_m, block);
    out.cut = {.engagement = engage(cutter_, surface.cut),
               .work_from_feed = surface.work_from_feed,
               .feed_speed_m_per_s = way / block.duration_s,
               .axial_depth_m = axial_depth_m_,
               .radial_depth_m = surface.cut.radial_depth_m};
    force.summary = kernel.summary(out.cut.engagement,
                                   {.feed_per_tooth_m = force.feed_per_tooth_m, .spindle_speed_rad_per_s = speed});
    force.mean_force_n = surface.work_from_feed * force.summary.mean_n;
    out.removed_volume_m3 = force.summary.removal_rate_m3_per_s * block.duration_s;
    return out;
  }

 private:
  const program::Program& program_;
  const Cutter& cutter_;
  double axial_depth_m_;
  const ProgramForceOptions& options_;
  LocalCuts cuts_;
};

}  // namespace

void local_program_forces(const program::Program& program, const Cutter& cutter,
                          const MillingCoefficients& coefficients, double axial_depth_m,
                          const ProgramForceOptions& options, const DeliverForce& deliver, Progress& progress) {
  if (cutter.kind != CutterKind::ball_end) {
    throw InvalidInput("kind", "must be a ball end where there is no stock", "Other cutters need a workpiece");
  }
  options.validate();
  check_speeds(program, options);
  const std::size_t count = program.blocks.size();
  progress.start("forces", count);
  const LocalForces local(program, cutter, axial_depth_m, options);
  Account account(program, options, deliver);
  std::vector<LocalForce> found;
  constexpr std::size_t batch = 4096;
  for (std::size_t first = 0; first < count; first += batch) {
    found.assign(std::min(batch, count - first), {});
    parallel_for(found.size(), grain, [&](std::size_t begin, std::size_t end) {
      ForceKernel kernel(cutter, coefficients, options.force);
      for (std::size_t i = begin; i < end; ++i) {
        progress.advance();
        found[i] = local.of(first + i, kernel);
      }
    });
    for (std::size_t i = 0; i < found.size(); ++i) {
      const LocalForce& one = found[i];
      BlockForce& block = account.add(first + i, program.blocks[first + i].duration_s, one.part);
      block.axial_depth_m = one.cut.axial_depth_m;
      block.radial_depth_m = one.cut.radial_depth_m;
      block.removed_volume_m3 = one.removed_volume_m3;
      if (!options.observe || one.cut.engagement.empty()) continue;
      options.observe({.block = first + i,
                       .cut = one.cut,
                       .feed_per_tooth_m = one.part.feed_per_tooth_m,
                       .mean_force_n = one.part.mean_force_n});
    }
  }
  account.close();
}

std::vector<BlockForce> local_program_forces(const program::Program& program, const Cutter& cutter,
                                             const MillingCoefficients& coefficients, double axial_depth_m,
                                             const ProgramForceOptions& options, Progress& progress) {
  std::vector<BlockForce> blocks;
  blocks.reserve(program.blocks.size());
  local_program_forces(
      program, cutter, coefficients, axial_depth_m, options, [&](const BlockForce& force) { blocks.push_back(force); },
      progress);
  return blocks;
}

}  // namespace robomill::cutting
