#include "robomill/process/compensate/surface_runs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/base/parallel.hpp"
#include "robomill/modal/tip.hpp"
#include "robomill/process/blocks/named_block.hpp"
#include "robomill/process/blocks/stability.hpp"

namespace robomill::process {
namespace {

constexpr int most_bends = 5;
/// Force and deflection agree where it changes by less than this, or by less than this share of it.
constexpr double bend_close_m = 0.5e-6, bend_share = 0.02;
constexpr std::size_t no_cut = static_cast<std::size_t>(-1);

/// q / F at rest.
Eigen::Matrix3d static_compliance(const modal::TipModes& modes) {
  Eigen::Matrix3d out = modes.compliance;
  for (Eigen::Index k = 0; k < modes.pole.size(); ++k) {
    out += 2.0 * (modes.right.col(k) * modes.left.col(k).transpose() / -modes.pole(k)).real();
  }
  return out;
}

}  // namespace

SurfaceRuns::SurfaceRuns(const ForcesResult& forces, const DynamicsAt& dynamics, const CompensateOptions& options,
                         Progress& progress)
    : forces_(forces),
      dynamics_(dynamics),
      vibrates_(static_cast<bool>(dynamics)),
      options_(options),
      progress_(progress),
      profile_(forces.cut.cutter) {
  if (!forces.cell || !forces.program || !forces.program->stock) {
    throw InvalidInput("forces", "must be those along a program, with a cell and a stock",
                       "What remains of the surface is not known beside neighbouring passes alone");
  }
  if (!vibrates_) dynamics_ = static_dynamics(*forces.cell);
  const std::size_t count = forces.program->blocks.size();
  bend_m_.assign(count, Eigen::Vector3d::Zero());
  if (!forces.program->deflected) return;
  for (std::size_t i = 0; i < count; ++i) bend_m_[i] = forces.program->blocks[i].deflection_m;
}

std::vector<cutting::BlockForce> SurfaceRuns::cut_once(const program::Program& program, cutting::Workpiece& workpiece) {
  const process::Cut& cut = forces_.cut;
  cutting::ProgramForceOptions options = {.spindle_speed_rad_per_s = cut.motion.spindle_speed_rad_per_s,
                                          .power_time_s = cut.power_time_s,
                                          .force = cut.force};
  options.walk.tip_offset_m = bend_m_;
  engaged_.assign(program.blocks.size(), {});
  std::vector<double> area_m2(program.blocks.size(), 0.0);
  options.observe = [&](const cutting::PartOfBlock& part) {
    const double area = cutting::patch_area_m2(part.cut.engagement);
    if (area <= area_m2[part.block]) return;
    area_m2[part.block] = area;
    engaged_[part.block] = part.cut;
  };
  return cutting::program_forces(program, cut.cutter, cut.coefficients, workpiece, options, progress_);
}

void SurfaceRuns::sort_cuts(const std::vector<cutting::BlockForce>& forces) {
  Classes classes(options_.alike);
  const Eigen::Matrix3d base_from_work = forces_.cell->robot.workpiece.linear();
  cut_of_.assign(forces.size(), no_cut);
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const cutting::PoseEngagement& cut = engaged_[i];
    if (!forces[i].cuts() || cut.engagement.empty()) continue;
    const double teeth_per_s =
        forces[i].spindle_speed_rad_per_s * forces_.cut.cutter.mill.teeth / (2.0 * std::numbers::pi);
    const Eigen::Matrix3d stiffness =
        base_from_work * mean_stiffness(cut, forces_.cut.coefficients) * base_from_work.transpose();
    cut_of_[i] = classes.add(i, {.spindle_speed_rad_per_s = forces[i].spindle_speed_rad_per_s,
                                 .axial_depth_m = engaged_depth_m(cut),
                                 .feed_per_tooth_m = cut.feed_speed_m_per_s / teeth_per_s,
                                 .stiffness = stiffness,
                                 .along_feed = stiffness * (base_from_work * cut.work_from_feed.col(0)),
                                 .joints = forces_.program->blocks[i].joints});
  }
  first_ = classes.first_blocks();
}

/// Calls f with each cut; errors name its first block.
template <class F>
void SurfaceRuns::for_cuts(F&& f) {
  parallel_for(cuts_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      progress_.check();
      try {
        f(k, cuts_[k]);
      } catch (const InvalidInput& error) {
        throw within(named_block(forces_, first_[k]) + ": ", error);
      }
    }
  });
}

void SurfaceRuns::find_structures(const std::vector<cutting::BlockForce>& forces) {
  const Eigen::Matrix3d base_from_work = forces_.cell->robot.workpiece.linear();
  cuts_.assign(first_.size(), {});
  for_cuts([&](std::size_t k, Cut& cut) {
    const std::size_t block = first_[k];
    const modal::ModalModel modes = dynamics_(forces_.program->blocks[block].joints).modes;
    const double speed = forces[block].spindle_speed_rad_per_s;
    cut.problem = block_problem({.setup = forces_.cut,
                                 .cut = engaged_[block],
                                 .base_from_work = base_from_work,
                                 .spindle_speed_rad_per_s = speed,
                                 .tolerance = options_.tolerance},
                                modes);
    cut.point = {speed, engaged_depth_m(engaged_[block])};
    const Eigen::Matrix3d compliance = static_compliance(modal::tip_modes(modes, {}, 0.0));
    cut.compliance_m_per_n = base_from_work.transpose() * compliance * base_from_work;
  });
}

/// Where each block's tip stands in the next run; whether any has still to settle.
bool SurfaceRuns::bend(const std::vector<cutting::BlockForce>& forces, int pass) {
  const double most_m = 0.5 * forces_.cut.cutter.mill.diameter_m;
  bool moves = false;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    Eigen::Vector3d bent = Eigen::Vector3d::Zero();
    if (cut_of_[i] != no_cut) bent = cuts_[cut_of_[i]].compliance_m_per_n * forces[i].mean_force_n;
    if (bent.norm() > most_m) bent *= most_m / bent.norm();
    const Eigen::Vector3d change = bent - bend_m_[i];
    if (change.norm() <= std::max(bend_close_m, bend_share * bend_m_[i].norm())) continue;
    moves = true;
    // From the third run on by halves: a tool that jumps out of the cut and back settles between.
    bend_m_[i] += (pass >= 2 ? 0.5 : 1.0) * change;
  }
  return moves;
}

void SurfaceRuns::find_places(Cut& cut) const {
  if (!(cut.problem.spatial->feed_per_tooth_m > 0.0)) return;
  cut.places =
      left_places(stability::surface_profile(cut.problem, cut.point, options_.tolerance), profile_, forces_.cut);
}

/// Of the places that a block leaves those that stand on the surface at the end, each with the share of the block along
/// which it does.
std::vector<decision::WallPlace> SurfaceRuns::remaining(const program::Program& program, std::size_t block,
                                                        const cutting::Workpiece& workpiece) const {
  const cutting::PoseEngagement& cut = engaged_[block];
  const BlockStations stations(program, block, bend_m_[block], cut, profile_);
  std::vector<decision::WallPlace> out;
  for (const LeftPlace& place : cuts_[cut_of_[block]].places) {
    const double share = stations.share_on(workpiece, place);
    if (share == 0.0) continue;
    out.push_back({.normal = cut.work_from_feed * place.normal_in_feed,
                   .error_m = place.error_m,
                   .width_m = place.width_m * share});
  }
  return out;
}

std::vector<LeftBlock> SurfaceRuns::run(const program::Program& program, const std::vector<Eigen::Vector3d>& offset_m) {
  const std::size_t count = program.blocks.size();
  std::vector<cutting::BlockForce> forces;
  std::optional<cutting::Workpiece> workpiece;
  std::vector<Eigen::Vector3d> stood_m;
  bool moves = true;
  for (int pass = 0; pass < most_bends && moves; ++pass) {
    workpiece.emplace(forces_.program->stock->stock, forces_.cut.dexel_m);
    forces = cut_once(program, *workpiece);
    sort_cuts(forces);
    find_structures(forces);
    stood_m = bend_m_;
    moves = bend(forces, pass);
  }
  settled_ = settled_ && !moves;
  bend_m_.swap(stood_m);  // where the tips stood in the run that the workpiece is of
  for_cuts([&](std::size_t, Cut& cut) { find_places(cut); });
  std::vector<LeftBlock> out(count);
  parallel_for(count, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      out[i].cuts = forces[i].cuts();
      if (cut_of_[i] == no_cut) continue;
      const std::vector<decision::WallPlace> places = remaining(program, i, *workpiece);
      out[i].condition = decision::condition_of(places);
      out[i].opposite = decision::opposite_walls(places);
      for (const decision::WallPlace& place : places) {
        const double error_m = place.error_m - place.normal.dot(offset_m[i]);
        if (std::abs(error_m) > std::abs(out[i].worst_m)) out[i].worst_m = error_m;
      }
    }
  });
  bend_m_.swap(stood_m);
  for (std::size_t i = 0; i < count; ++i) {
    if (out[i].leaves()) cuts_[cut_of_[i]].leaves = true;
  }
  if (!vibrates_) return out;
  for_cuts([&](std::size_t, Cut& cut) {
    if (!cut.leaves) return;
    stability::LobesOptions options;
    options.tolerance = options_.tolerance;
    cut.stable = stability::evaluate_point(cut.problem, options, cut.point).stable;
  });
  for (std::size_t i = 0; i < count; ++i) {
    if (out[i].leaves()) out[i].stable = cuts_[cut_of_[i]].stable;
  }
  return out;
}

}  // namespace robomill::process
