#include "robomill/process/compensate.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"
#include "robomill/decision/mirror.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/process/blocks/named_block.hpp"
#include "robomill/process/compensate/surface_runs.hpp"
#include "robomill/robot/kinematics/choose.hpp"
#include "robomill/robot/pose.hpp"
#include "robomill/robot/stiffness.hpp"

namespace robomill::process {
namespace {

using Offsets = std::vector<Eigen::Vector3d>;
using BlockState = CompensatedBlock::State;

SurfaceLeft left_of(const LeftBlock& block, const Eigen::Vector3d& offset_m) {
  SurfaceLeft out;
  if (!block.leaves()) return out;
  out.width_m = block.condition.width_m;
  out.state = SurfaceLeft::State::unstable;
  if (!block.stable) return out;
  out.state = block.opposite ? SurfaceLeft::State::opposite_walls : SurfaceLeft::State::known;
  out.error_m = block.worst_m;
  out.rms_m = block.condition.rms_m(offset_m);
  return out;
}

/// Offsets of the points, made to those of the blocks between.
Offsets of_blocks(const Offsets& points) {
  Offsets out;
  for (std::size_t i = 1; i < points.size(); ++i) out.emplace_back(0.5 * (points[i - 1] + points[i]));
  return out;
}

program::Program moved(const program::Program& program, const Offsets& points) {
  program::Program out = program;
  out.start.tip_m += points.front();
  for (std::size_t i = 0; i < out.blocks.size(); ++i) out.blocks[i].end.tip_m += points[i + 1];
  return out;
}

double length_m(const program::Program& program, std::size_t block) {
  return (program.blocks[block].end.tip_m - program.begin_of(block).tip_m).norm();
}

/// Follows the joints to the moved ends of the blocks.
void check_joints(const ForcesResult& forces, const Offsets& points) {
  const robot::Cell& cell = forces.cell->robot;
  const std::vector<BlockResult>& rows = forces.program->blocks;
  parallel_for(rows.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d& offset_m = points[i + 1];
      if (offset_m.isZero(0.0)) continue;
      robot::ToolPose pose = robot::tool_pose(cell, robot::forward(cell.arm, rows[i].joints));
      pose.tip_m += offset_m;
      const robot::NearResult near = robot::solve_near(cell.arm, robot::flange_pose(cell, pose), rows[i].joints);
      const auto reject = [&](const std::string& rule) {
        throw InvalidInput(InvalidInput::Parts{.field = named_block(forces, i),
                                               .rule = fmt::format("{} once it is compensated", rule),
                                               .hint = "Move [workpiece] origin_mm, or do without compensation"});
      };
      if (near.status != robot::NearResult::Status::converged) reject("is out of the robot's reach");
      const robot::LimitCheck limits = robot::within_limits(cell.arm, near.position);
      if (!limits.inside) {
        reject(fmt::format("takes joint {} {:.3g}° beyond its limit", limits.joint + 1, -limits.distance / units::deg));
      }
    }
  });
}

/// Looks for the offsets that agree with the forces which they cause.
class OffsetSearch {
 public:
  OffsetSearch(const ForcesResult& forces, const DynamicsAt& dynamics, const CompensateOptions& options,
               Progress& progress)
      : program_(forces.program->program), options_(options), runs_(forces, dynamics, options, progress) {
    mirror_ = {.max_offset_m = options.offsets.max_offset_m,
               .blend_m = options.blend_m > 0.0 ? options.blend_m : forces.cut.cutter.mill.diameter_m};
    const std::size_t count = program_.blocks.size();
    points_.point_m.assign(count + 1, Eigen::Vector3d::Zero());
    points_.bounded.assign(count + 1, false);
    points_.blended.assign(count, false);
    lost_.assign(count, false);
    before_ = last_ = runs_.run(program_, of_blocks(points_.point_m));
    kept_ = before_;
  }

  void run(Compensation& out) {
    if (!std::ranges::any_of(before_, [](const LeftBlock& block) { return wanted(block); })) return;
    out.status = Compensation::Status::unsettled;
    while (out.passes < options_.most_passes) {
      if (!step(out.passes)) {
        out.status = Compensation::Status::settled;
        return;
      }
      ++out.passes;
      last_ = runs_.run(moved(program_, points_.point_m), of_blocks(points_.point_m));
      for (std::size_t i = 0; i < last_.size(); ++i) {
        if (before_[i].cuts && !last_[i].cuts) lost_[i] = true;
        // What a neighbour's offset has covered for once is asked for all the same.
        if (last_[i].leaves()) kept_[i] = last_[i];
      }
    }
    if (!step(out.passes)) out.status = Compensation::Status::settled;
  }

  [[nodiscard]] const decision::MirrorOffsets& points() const { return points_; }
  [[nodiscard]] const std::vector<LeftBlock>& before() const { return before_; }
  [[nodiscard]] const std::vector<LeftBlock>& last() const { return last_; }
  [[nodiscard]] bool lost(std::size_t block) const { return lost_[block]; }
  [[nodiscard]] bool settled() const { return runs_.settled(); }

 private:
  static bool wanted(const LeftBlock& block) { return block.leaves() && block.stable && !block.opposite; }

  /// The offsets that the last run asks for; false where they are those that it had.
  bool step(int pass) {
    std::vector<decision::MirrorBlock> blocks(program_.blocks.size());
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      blocks[i].feed = program_.blocks[i].kind != program::Block::Kind::rapid;
      blocks[i].length_m = length_m(program_, i);
      if (wanted(kept_[i]) && !lost_[i]) blocks[i].condition = kept_[i].condition;
    }
    decision::MirrorOffsets next = decision::mirror_offsets(blocks, mirror_);
    bool changes = false;
    for (std::size_t i = 0; i < next.point_m.size(); ++i) {
      const Eigen::Vector3d change = next.point_m[i] - points_.point_m[i];
      const double close_m = std::max(options_.tolerance_m, options_.tolerance_share * next.point_m[i].norm());
      if (change.norm() > close_m) changes = true;
      if (pass >= 2) next.point_m[i] = points_.point_m[i] + 0.5 * change;
    }
    if (changes && pass < options_.most_passes) points_ = std::move(next);
    return changes;
  }

  const program::Program& program_;
  const CompensateOptions& options_;
  SurfaceRuns runs_;
  decision::MirrorOptions mirror_;
  decision::MirrorOffsets points_;
  std::vector<LeftBlock> before_, last_, kept_;
  std::vector<bool> lost_;
};

void fill_blocks(const OffsetSearch& search, Compensation& out) {
  const decision::MirrorOffsets& points = search.points();
  const Offsets offsets = of_blocks(points.point_m);
  double area_m2 = 0.0;
  double before = 0.0;
  double after = 0.0;
  for (std::size_t i = 0; i < out.blocks.size(); ++i) {
    CompensatedBlock& block = out.blocks[i];
    block.offset_m = offsets[i];
    out.largest_offset_m = std::max(out.largest_offset_m, points.point_m[i + 1].norm());
    block.before = left_of(search.before()[i], Eigen::Vector3d::Zero());
    block.after = left_of(search.last()[i], offsets[i]);
    using Left = SurfaceLeft::State;
    // A block is what its last run shows; where that leaves nothing, what the first one did.
    const Left left = block.after.state == Left::nothing ? block.before.state : block.after.state;
    if (left == Left::unstable) block.state = BlockState::unstable;
    if (left == Left::opposite_walls) block.state = BlockState::opposite_walls;
    if (left == Left::known) {
      block.state = points.bounded[i] || points.bounded[i + 1] ? BlockState::bounded : BlockState::compensated;
      if (search.lost(i)) block.state = BlockState::lost;
    }
    const bool compensated = block.state == BlockState::compensated || block.state == BlockState::bounded;
    if (!compensated || block.before.state != Left::known || block.after.state != Left::known) continue;
    const double length = length_m(out.program, i);
    area_m2 += length * block.after.width_m;
    before += length * block.after.width_m * std::pow(block.before.rms_m, 2);
    after += length * block.after.width_m * std::pow(block.after.rms_m, 2);
  }
  if (!(area_m2 > 0.0)) return;
  out.rms_before_m = std::sqrt(before / area_m2);
  out.rms_after_m = std::sqrt(after / area_m2);
}

void warn_of_state(BlockState state, const char* text, Compensation& out) {
  std::size_t count = 0;
  std::size_t first = 0;
  for (std::size_t i = out.blocks.size(); i-- > 0;) {
    if (out.blocks[i].state != state) continue;
    ++count;
    first = i;
  }
  if (count == 0) return;
  out.warnings.push_back(fmt::format("{} block{} {}, the first in line {} (block {}).", count, count == 1 ? "" : "s",
                                     text, out.program.blocks[first].line, first + 1));
}

void report(const OffsetSearch& search, const CompensateOptions& options, Compensation& out) {
  warn_of_state(BlockState::unstable, "of finishing passes chatter and are not compensated", out);
  warn_of_state(BlockState::opposite_walls,
                "leave both walls of a slot, which want opposite offsets, and are not compensated", out);
  warn_of_state(BlockState::lost, "would lose the cut and are not compensated", out);
  const std::string bound =
      fmt::format("are offset by the most that is allowed, {:.4g} mm", options.offsets.max_offset_m / units::mm);
  warn_of_state(BlockState::bounded, bound.c_str(), out);
  if (out.status == Compensation::Status::unsettled) {
    out.warnings.push_back(
        fmt::format("Offsets still change after {} passes: the predicted errors are those of the "
                    "last one.",
                    out.passes));
  }
  if (!search.settled()) {
    out.warnings.emplace_back("Force and deflection did not settle in some blocks; their errors are uncertain.");
  }
  if (out.status == Compensation::Status::nothing_to_do) {
    out.notes.emplace_back("No finishing pass leaves a surface whose error is known: nothing is compensated.");
    return;
  }
  out.notes.push_back(fmt::format(
      "Finishing passes are moved by up to {:.1f} µm; their predicted error falls from {:.1f} to {:.1f} µm (rms over "
      "the surface).",
      out.largest_offset_m / units::um, out.rms_before_m / units::um, out.rms_after_m / units::um));
  const std::vector<bool>& blended = search.points().blended;
  const auto count = std::ranges::count(blended, true);
  if (count == 0) return;
  const auto first = static_cast<std::size_t>(std::ranges::find(blended, true) - blended.begin());
  out.notes.push_back(
      fmt::format("{} block{} beside compensated ones {} moved too, so that the path has no step, the "
                  "first in line {} (block {}).",
                  count, count == 1 ? "" : "s", count == 1 ? "is" : "are", out.program.blocks[first].line, first + 1));
}

}  // namespace

void CompensateOptions::validate() const {
  offsets.validate();
  require_non_negative("blend_m", blend_m, "m");
  require_positive("tolerance_m", tolerance_m, "m");
  require_non_negative("tolerance_share", tolerance_share, "");
  require_positive("tolerance", tolerance, "");
  alike.validate();
  if (most_passes < 1 || most_passes > 20) {
    throw InvalidInput("most_passes", most_passes, "", "must be 1 to 20");
  }
}

Compensation compensate(const ForcesResult& forces, const DynamicsAt& dynamics, const CompensateOptions& options,
                        Progress& progress) {
  options.validate();
  if (!forces.program) throw InvalidInput("forces", "must be those along a program");
  Compensation out;
  out.program = forces.program->program;
  out.blocks.resize(out.program.blocks.size());
  if (options.offsets.controller_compensates) {
    out.status = Compensation::Status::left_to_controller;
    out.notes.emplace_back("The controller compensates the deflection: the program is left as it is.");
    return out;
  }
  OffsetSearch search(forces, dynamics, options, progress);
  search.run(out);
  check_joints(forces, search.points().point_m);
  fill_blocks(search, out);
  out.program = moved(out.program, search.points().point_m);
  report(search, options, out);
  return out;
}

DynamicsAt static_dynamics(const cell::Cell& cell) {
  return [cell = cell.robot](const Eigen::VectorXd& joints) {
    constexpr double frequency_hz = 50e3;
    constexpr double damping_ratio = 0.7;
    const robot::Stiffness stiffness = robot::stiffness(cell.arm, joints, robot::tip_point(cell));
    const Eigen::Matrix3d block = stiffness.compliance.topLeftCorner<3, 3>();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(0.5 * (block + block.transpose()));
    PostureDynamics out;
    out.modes.excitations = out.modes.responses = modal::tip_axes();
    const double omega = 2.0 * std::numbers::pi * frequency_hz;
    for (Eigen::Index k = 0; k < 3; ++k) {
      const double compliance = principal.eigenvalues()(k);
      if (!(compliance > 0.0)) continue;
      modal::Mode mode = modal::mode_from_mass({.frequency_hz = frequency_hz,
                                                .damping_ratio = damping_ratio,
                                                .modal_mass_kg = 1.0 / (compliance * omega * omega)},
                                               0, 1);
      mode.left = principal.eigenvectors().col(k) * mode.left(0);
      mode.right = principal.eigenvectors().col(k) * mode.right(0);
      out.modes.modes.push_back(std::move(mode));
    }
    return out;
  };
}

}  // namespace robomill::process
