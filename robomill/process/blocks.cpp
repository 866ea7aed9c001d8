#include "robomill/process/blocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>

#include "robomill/base/cost.hpp"
#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/process/blocks/classes.hpp"
#include "robomill/process/blocks/finished_surface.hpp"
#include "robomill/process/blocks/joint_torques.hpp"
#include "robomill/process/blocks/named_block.hpp"
#include "robomill/process/blocks/scans.hpp"
#include "robomill/process/blocks/stability.hpp"
#include "robomill/process/program_forces.hpp"

namespace robomill::process {

std::string named_block(const ForcesResult& forces, std::size_t block) {
  return fmt::format("block {} (line {})", block + 1, forces.program->program.blocks[block].line);
}

namespace {

/// Each cutting block to a class; evaluation is its number.
std::vector<std::size_t> classes_of(const ForcesResult& forces, const BlocksOptions& options,
                                    std::vector<BlockRow>& rows) {
  Classes classes(options.alike);
  const ProgramForces& program = *forces.program;
  const Eigen::Matrix3d base_from_work = forces.cell->robot.workpiece.linear();
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
        base_from_work * mean_stiffness(cut, forces.cut.coefficients) * base_from_work.transpose();
    row.evaluation = classes.add(i, {.spindle_speed_rad_per_s = row.spindle_speed_rad_per_s,
                                     .axial_depth_m = row.axial_depth_m,
                                     .feed_per_tooth_m = force.force.feed_per_tooth_m,
                                     .stiffness = stiffness,
                                     .along_feed = stiffness * (base_from_work * cut.work_from_feed.col(0)),
                                     .joints = force.joints});
  }
  return classes.first_blocks();
}

/// A result that several blocks share.
struct Shared {
  stability::BlockStability stability = {};
  SteadyMotion steady = {};
  std::vector<LeftPlace> places = {};  ///< by falling magnitude of the error; empty without a stock
  std::optional<bool> measured_nearby = {};
  double joint_distance_rad = 0.0;
  std::size_t unmatched = 0;
};

/// The greatest error first, so that a search for it among those that remain ends early.
std::vector<LeftPlace> sorted_places(const ForcesResult& forces, const std::vector<stability::SurfacePlace>& surface) {
  if (!forces.program->stock || surface.empty()) return {};
  std::vector<LeftPlace> out = left_places(surface, cutting::Profile(forces.cut.cutter), forces.cut);
  std::ranges::stable_sort(
      out, [](const LeftPlace& a, const LeftPlace& b) { return std::abs(a.error_m) > std::abs(b.error_m); });
  return out;
}

Shared evaluate(const ForcesResult& forces, std::size_t block, const DynamicsAt& dynamics,
                const BlocksOptions& options) {
  const BlockResult& row = forces.program->blocks[block];
  try {
    const PostureDynamics there = dynamics(row.joints);
    const JudgedCut judged = judged_cut({.setup = forces.cut,
                                         .cut = forces.program->cuts[block],
                                         .base_from_work = forces.cell->robot.workpiece.linear(),
                                         .spindle_speed_rad_per_s = row.force.spindle_speed_rad_per_s,
                                         .tolerance = options.tolerance},
                                        there.modes);
    return {.stability = judged.stability,
            .steady = judged.steady,
            .places = sorted_places(forces, judged.surface),
            .measured_nearby = there.measured_nearby,
            .joint_distance_rad = there.joint_distance_rad,
            .unmatched = there.unmatched};
  } catch (const InvalidInput& error) {
    throw within(named_block(forces, block) + ": ", error);
  }
}

std::vector<Shared> evaluate_classes(const ForcesResult& forces, const std::vector<std::size_t>& first,
                                     const DynamicsAt& dynamics, const BlocksOptions& options, Progress& progress) {
  std::vector<Shared> shared(first.size());
  progress.start("stability of blocks", first.size());
  parallel_for(first.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      progress.check();
      shared[k] = evaluate(forces, first[k], dynamics, options);
      progress.advance();
    }
  });
  return shared;
}

/// 1 - depth / limit, of the 5 % quantile where it is known; without a limit of the depth that was searched.
double margin_of(const BlockRow& row) {
  const stability::BlockStability& found = row.stability;
  double limit_m = std::isfinite(found.limit_5_percent_m) ? found.limit_5_percent_m : found.at.limit_depth_m;
  if (!std::isfinite(limit_m)) limit_m = found.searched_depth_m[1];
  return 1.0 - row.axial_depth_m / limit_m;
}

/// (95 % - 5 % quantile) / limit; 0 where it is not known.
double band_of(const stability::BlockStability& found) {
  const double band = (found.limit_95_percent_m - found.limit_5_percent_m) / found.at.limit_depth_m;
  return std::isfinite(band) ? band : 0.0;
}

/// What blocks leave of the finished surface, from the places of the cut that they share.
void fill_surface_left(const ForcesResult& forces, const std::vector<Shared>& shared, std::vector<BlockRow>& rows,
                       Progress& progress) {
  std::vector<const std::vector<LeftPlace>*> places(rows.size(), nullptr);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].cuts) places[i] = &shared[rows[i].evaluation].places;
  }
  const std::vector<double> left_m = surface_left_m(forces, places, progress);
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].surface_left_m = left_m[i];
}

/// Stretches of blocks that lie beyond the measured postures.
std::vector<BeyondMeasured> stretches_beyond(const std::vector<BlockRow>& rows, const std::vector<Shared>& shared) {
  std::vector<BeyondMeasured> out;
  bool open = false;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const BlockRow& row = rows[i];
    if (!row.cuts) continue;
    const bool beyond = !row.measured_nearby.value_or(true);
    if (beyond) {
      if (!open) out.push_back({.first = i});
      BeyondMeasured& stretch = out.back();
      stretch.last = i;
      stretch.farthest_rad = std::max(stretch.farthest_rad, shared[row.evaluation].joint_distance_rad);
      stretch.band = std::max(stretch.band, band_of(row.stability));
    }
    open = beyond;
  }
  return out;
}

/// The median of the blocks within the measured postures.
double band_within(const std::vector<BlockRow>& rows) {
  std::vector<double> bands;
  for (const BlockRow& row : rows) {
    const double band = row.cuts && row.measured_nearby.value_or(false) ? band_of(row.stability) : 0.0;
    if (band > 0.0) bands.push_back(band);
  }
  if (bands.empty()) return 0.0;
  const auto middle = bands.begin() + static_cast<std::ptrdiff_t>(bands.size() / 2);
  std::ranges::nth_element(bands, middle);
  return *middle;
}

void sum_up(ProgramBlocks& out) {
  for (std::size_t i = 0; i < out.rows.size(); ++i) {
    const BlockRow& row = out.rows[i];
    if (!row.cuts) continue;
    if (out.cutting == 0 || worse(row, out.rows[out.worst])) out.worst = i;
    ++out.cutting;
    if (row.unstable()) ++out.unstable;
  }
}

/// By what README.md's "Cost" was measured at.
void require_affordable_blocks(std::size_t evaluations, std::size_t blocks) {
  constexpr double operations_of_evaluation = 3e7, bytes_of_block = 8e3, usual_evaluations = 500.0,
                   usual_blocks = 40'000.0;
  const auto different = static_cast<double>(evaluations), all = static_cast<double>(blocks);
  require_affordable(
      {.operations = operations_of_evaluation * different,
       .bytes = bytes_of_block * all,
       .dominant = dominant_of({{.field = "blocks of the program that differ",
                                 .value = different,
                                 .times_usual = different / usual_evaluations},
                                {.field = "blocks of the program", .value = all, .times_usual = all / usual_blocks}})});
}

}  // namespace

bool worse(const BlockRow& a, const BlockRow& b) {
  const auto rank = [](const BlockRow& row) {
    const auto known = [](double value) { return std::isnan(value) ? std::numeric_limits<double>::infinity() : value; };
    return std::tuple(!row.unstable(), known(row.stability.at.gain_margin), known(row.stability_margin));
  };
  return rank(a) < rank(b);
}

void BlockTolerance::validate() const {
  require_non_negative("joint_rad", joint_rad, "rad");
  require_non_negative("cut_share", cut_share, "");
}

void BlocksOptions::validate() const {
  alike.validate();
  require_positive("tolerance", tolerance, "");
  if (scan_points < 0 || (scan_points > 0 && scan_points % 2 == 0)) {
    throw InvalidInput("scan_points", scan_points, "", "must be 0 or odd");
  }
}

ProgramBlocks judge_blocks(const ForcesResult& forces, const DynamicsAt& dynamics, const BlocksOptions& options,
                           Progress& progress) {
  options.validate();
  require_cuts(forces);
  const auto begun = std::chrono::steady_clock::now();
  ProgramBlocks out;
  out.rows.resize(forces.program->blocks.size());
  const std::vector<std::size_t> first = classes_of(forces, options, out.rows);
  out.evaluations = first.size();
  require_affordable_blocks(first.size(), out.rows.size());
  const std::vector<Shared> shared = evaluate_classes(forces, first, dynamics, options, progress);
  for (BlockRow& row : out.rows) {
    if (!row.cuts) continue;
    row.stability = shared[row.evaluation].stability;
    row.steady = shared[row.evaluation].steady;
    row.measured_nearby = shared[row.evaluation].measured_nearby;
    row.unmatched = shared[row.evaluation].unmatched;
    row.stability_margin = margin_of(row);
  }
  fill_surface_left(forces, shared, out.rows, progress);
  add_joint_torques(forces, out);
  sum_up(out);
  out.beyond = stretches_beyond(out.rows, shared);
  out.band_within = band_within(out.rows);
  out.rigid_workpiece = options.workpiece_vibrates || !forces.cut.workpiece_dynamics.modes.empty();
  if (out.cutting > 0 && options.scan_points > 0) {
    out.scans = limit_scans(forces, out.worst, dynamics, options);
  }
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return out;
}

}  // namespace robomill::process
