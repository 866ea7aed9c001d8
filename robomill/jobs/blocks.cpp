#include "robomill/jobs/blocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/base/units.hpp"
#include "robomill/jobs/blocks/classes.hpp"
#include "robomill/jobs/blocks/scans.hpp"
#include "robomill/jobs/blocks/stability.hpp"

namespace robomill::jobs {
namespace {

/// Warnings of stretches beyond these are counted.
constexpr std::size_t most_stretches = 8;

/// Beyond every margin: limits are looked for down to a sixteenth of the depth.
constexpr double chatters = 1e3;
/// A limit whose 95 % quantile is this multiple of the 5 % one is hardly known.
constexpr double hardly_known = 4.0;

/// Each cutting block to a class; evaluation is its number.
std::vector<std::size_t> classes_of(const ForcesResult& forces, const BlocksOptions& options,
                                    std::vector<BlockRow>& rows) {
  Classes classes({.joint_rad = options.joint_tolerance_rad, .cut_share = options.cut_tolerance});
  const ProgramForces& program = *forces.program;
  const Eigen::Matrix3d base_from_work = forces.cell->cell.workpiece.linear();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const BlockResult& force = program.blocks[i];
    const cutting::PoseEngagement& cut = program.cuts[i];
    if (!force.force.cuts() || cut.engagement.empty()) continue;
    BlockRow& row = rows[i];
    row.cuts = true;
    row.axial_depth_m = engaged_depth_m(cut);
    row.radial_depth_m = cut.radial_depth_m;
    row.spindle_speed_rad_per_s = force.force.spindle_speed_rad_per_s;
    const Eigen::Matrix3d stiffness =
        base_from_work * mean_stiffness(cut, forces.file.coefficients) * base_from_work.transpose();
    row.evaluation = classes.add(i, {.spindle_speed_rad_per_s = row.spindle_speed_rad_per_s,
                                     .axial_depth_m = row.axial_depth_m,
                                     .stiffness = stiffness,
                                     .joints = force.joints});
  }
  return classes.first_blocks();
}

/// A result that several blocks share.
struct Shared {
  CutStability cut = {};
  std::optional<bool> measured_nearby = {};
  double joint_distance_rad = 0.0;
};

/// "block 12 (line 40)"
std::string named_block(const ForcesResult& forces, std::size_t block) {
  return fmt::format("block {} (line {})", block + 1, forces.program->program.blocks[block].line);
}

std::vector<Shared> evaluate_classes(const ForcesResult& forces, const std::vector<std::size_t>& first,
                                     const DynamicsAt& dynamics, const BlocksOptions& options, Progress& progress) {
  std::vector<Shared> shared(first.size());
  const ProgramForces& program = *forces.program;
  progress.start("stability of blocks", first.size());
  parallel_for(first.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      progress.check();
      const std::size_t block = first[k];
      const PostureDynamics there = dynamics(program.blocks[block].joints);
      shared[k].measured_nearby = there.measured_nearby;
      shared[k].joint_distance_rad = there.joint_distance_rad;
      shared[k].cut = cut_stability({.file = forces.file,
                                     .cut = program.cuts[block],
                                     .base_from_work = forces.cell->cell.workpiece.linear(),
                                     .spindle_speed_rad_per_s = program.blocks[block].force.spindle_speed_rad_per_s,
                                     .tolerance = options.tolerance},
                                    there.modes);
      progress.advance();
    }
  });
  return shared;
}

/// 1 - depth / limit, of the 5 % quantile where it is known; without a limit of the depth that was searched.
double margin_of(const BlockRow& row) {
  const CutStability& cut = row.cut;
  double limit_m = std::isfinite(cut.limit_5_percent_m) ? cut.limit_5_percent_m : cut.limit_depth_m;
  if (!std::isfinite(limit_m)) limit_m = cut.searched_depth_m;
  return 1.0 - row.axial_depth_m / limit_m;
}

std::string note_of(const BlockResult& force, const BlockRow& row) {
  if (force.settled == BlockResult::Settled::lost) return "engagement lost";
  if (!row.cuts) return {};
  if (force.settled == BlockResult::Settled::unsettled) return "deflection does not settle";
  if (row.cut.below_range) return "unstable at the least depth that was looked at: the limit is no higher";
  if (row.cut.limit_95_percent_m > hardly_known * row.cut.limit_5_percent_m) {
    return "the limit is hardly known: see its 5 and 95 % quantiles";
  }
  if (row.cut.lower_bound) return "limit is a lower bound: process damping is not known";
  if (!std::isfinite(row.cut.limit_depth_m)) {
    return fmt::format("no limit up to {:.4g} mm", row.cut.searched_depth_m / units::mm);
  }
  return {};
}

/// Stretches of blocks that lie beyond the measured postures.
void warn_of_region(const ForcesResult& forces, const std::vector<Shared>& shared, ProgramBlocks& out) {
  std::size_t stretches = 0;
  std::size_t from = 0;
  std::size_t to = 0;
  double farthest_rad = 0.0;
  double spread = 0.0;
  bool open = false;
  const auto close = [&] {
    if (open && ++stretches <= most_stretches) {
      std::string text =
          fmt::format("From {} to {} the robot stands up to {:.3g}° of a joint from the nearest measured posture",
                      named_block(forces, from), named_block(forces, to), farthest_rad / units::deg);
      if (spread > 0.0)
        text += fmt::format("; the 5 to 95 % band of the limit is up to {:.0f} % of it", 100.0 * spread);
      out.warnings.push_back(text + ".");
    }
    open = false;
  };
  for (std::size_t i = 0; i < out.rows.size(); ++i) {
    const BlockRow& row = out.rows[i];
    if (!row.cuts) continue;
    if (row.measured_nearby.value_or(true)) {
      close();
      continue;
    }
    if (!open) {
      open = true;
      from = i;
      farthest_rad = spread = 0.0;
    }
    to = i;
    farthest_rad = std::max(farthest_rad, shared[row.evaluation].joint_distance_rad);
    const double band = (row.cut.limit_95_percent_m - row.cut.limit_5_percent_m) / row.cut.limit_depth_m;
    if (std::isfinite(band)) spread = std::max(spread, band);
  }
  close();
  if (stretches > most_stretches) {
    out.warnings.push_back(fmt::format("{} more stretches leave the measured postures.", stretches - most_stretches));
  }
}

void sum_up(const ForcesResult& forces, const std::vector<Shared>& shared, ProgramBlocks& out) {
  double least = std::numeric_limits<double>::infinity();
  std::size_t bounds = 0;
  for (std::size_t i = 0; i < out.rows.size(); ++i) {
    const BlockRow& row = out.rows[i];
    if (!row.cuts) continue;
    ++out.cutting;
    if (row.unstable()) ++out.unstable;
    if (row.cut.lower_bound) ++bounds;
    // A block that chatters is worse than one that may.
    const double margin = row.stability_margin - (row.unstable() ? chatters : 0.0);
    if (margin < least) {
      least = margin;
      out.worst = i;
    }
  }
  if (out.unstable > 0) {
    const BlockRow& row = out.rows[out.worst];
    out.warnings.insert(
        out.warnings.begin(),
        fmt::format("{} of {} blocks that cut are predicted to chatter; the worst is {}: {:.4g} mm deep at a limit of "
                    "{:.4g} mm, {} chatter of {} at {:.4g} Hz.",
                    out.unstable, out.cutting, named_block(forces, out.worst), row.axial_depth_m / units::mm,
                    row.cut.limit_depth_m / units::mm, row.cut.regime, to_string(row.cut.mode),
                    row.cut.chatter_frequency_hz));
  }
  if (bounds > 0) {
    out.notes.push_back(fmt::format(
        "The limits of {} blocks are lower bounds: process damping, which is not known, lifts limits at low speed.",
        bounds));
  }
  warn_of_region(forces, shared, out);
}

}  // namespace

void BlocksOptions::validate() const {
  require_non_negative("joint_tolerance_rad", joint_tolerance_rad, "rad");
  require_non_negative("cut_tolerance", cut_tolerance, "");
  require_positive("tolerance", tolerance, "");
  if (scan_points < 0 || (scan_points > 0 && scan_points % 2 == 0)) {
    throw InvalidInput("scan_points", scan_points, "", "must be 0 or odd");
  }
}

ProgramBlocks judge_blocks(const ForcesResult& forces, const DynamicsAt& dynamics, const BlocksOptions& options,
                           Progress& progress) {
  options.validate();
  if (!forces.cell || !forces.program || forces.program->cuts.size() != forces.program->blocks.size()) {
    throw InvalidInput("forces", "must be those along a program, with a cell and the cut of each block");
  }
  const auto begun = std::chrono::steady_clock::now();
  ProgramBlocks out;
  out.rows.resize(forces.program->blocks.size());
  const std::vector<std::size_t> first = classes_of(forces, options, out.rows);
  out.evaluations = first.size();
  const std::vector<Shared> shared = evaluate_classes(forces, first, dynamics, options, progress);
  for (std::size_t i = 0; i < out.rows.size(); ++i) {
    BlockRow& row = out.rows[i];
    if (row.cuts) {
      row.cut = shared[row.evaluation].cut;
      row.measured_nearby = shared[row.evaluation].measured_nearby;
      row.stability_margin = margin_of(row);
    }
    row.note = note_of(forces.program->blocks[i], row);
  }
  sum_up(forces, shared, out);
  if (out.cutting > 0 && options.scan_points > 0) {
    out.scans = limit_scans(forces, out.worst, dynamics, options);
  }
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return out;
}

}  // namespace robomill::jobs
