#include "robomill/jobs/decide/block_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/jobs/blocks/classes.hpp"
#include "robomill/jobs/blocks/stability.hpp"
#include "robomill/jobs/blocks/stand_at.hpp"
#include "robomill/jobs/program_forces.hpp"
#include "robomill/stability/block.hpp"
#include "robomill/stability/surface_error.hpp"

namespace robomill::jobs {
namespace {

using decision::FeedRange;
using decision::LimitUse;
using decision::ProgramLimit;

/// Blocks that one look stands for differ by no more: it is the exact run that judges each of them.
constexpr double class_joint_rad = 2.0 * units::deg, class_cut_share = 0.05;
/// Limits are searched from this multiple of the depth on; of the map up to the other.
constexpr double shallowest = 0.25, map_deepest = 8.0;
/// What a look reserves of each limit for the blocks of its class.
constexpr double class_reserve = 0.01;
/// A speed is looked for within this of the programmed ones where the spindle's range is not given.
constexpr double default_speed_range = 0.4;
constexpr double not_reachable = std::numeric_limits<double>::quiet_NaN();

/// Lowers the upper end of a range of feeds.
void cap(FeedRange& range, double most_m_per_s, const LimitUse& by) {
  if (most_m_per_s >= range.most_m_per_s) return;
  range.most_m_per_s = most_m_per_s;
  range.most_by = by;
}

/// Radius of the outermost point that cuts.
double engaged_radius_m(const cutting::Engagement& engagement) {
  double radius = 0.0;
  for (std::size_t i = 0; i < engagement.slices.size(); ++i) {
    if (!engagement.of(i).empty()) radius = std::max(radius, engagement.slices[i].radius_m);
  }
  return radius;
}

/// Of the two limits the one that holds; 0: none.
double stricter(double a, double b) {
  return a > 0.0 && b > 0.0 ? std::min(a, b) : std::max(a, b);
}

JointSpeed joint_speed(const ForcesResult& forces, std::size_t block) {
  JointSpeed out;
  if (block == 0) return out;
  const program::Program& program = forces.program->program;
  const double way_m = (program.blocks[block].end.tip_m - program.begin_of(block).tip_m).norm();
  const Eigen::VectorXd turn = forces.program->blocks[block].joints - forces.program->blocks[block - 1].joints;
  const std::vector<robot::Joint>& joints = forces.cell->cell.arm.joints;
  for (Eigen::Index k = 0; k < turn.size(); ++k) {
    const double most = joints[static_cast<std::size_t>(k)].max_velocity;
    if (!(most > 0.0) || !(std::abs(turn(k)) > 0.0)) continue;
    const double feed = way_m * most / std::abs(turn(k));
    if (feed < out.feed_m_per_s) out = {.feed_m_per_s = feed, .allowed = most};
  }
  return out;
}

}  // namespace

BlockModel::BlockModel(const DecideProblem& problem)
    : problem_(problem),
      units_(program_units(problem.forces, problem.blocks, !problem.options.is_free(Free::spindle_speed))) {
  const std::array<double, 2> programmed = programmed_chips_m(problem.forces, problem.blocks);
  for (std::size_t k = 0; k < 2; ++k) {
    const double asked = problem.options.chip_thickness_m.at(k);
    chip_m_.at(k) = asked > 0.0 ? asked : programmed.at(k);
  }
  // A side that is not asked for gives way to the one that is.
  if (problem.options.chip_thickness_m[0] <= 0.0) chip_m_[0] = std::min(chip_m_[0], chip_m_[1]);
  if (problem.options.chip_thickness_m[1] <= 0.0) chip_m_[1] = std::max(chip_m_[0], chip_m_[1]);
  loads_ = block_loads(problem.forces, problem.blocks, chip_m_);
  pace_.resize(loads_.size());
  for (const LineUnit& line : units_.lines) {
    for (const std::size_t block : line.cutting) {
      pace_[block] = {.joint = joint_speed(problem.forces, block),
                      .radius_m = engaged_radius_m(problem.forces.program->cuts[block].engagement)};
    }
  }
  feed_share_.assign(units_.lines.size(), 1.0);
  inverse_ = spherical_wrist(problem.forces.cell->cell.arm);
  checker_ = collision_checker(*problem.forces.cell, problem.forces.file.cutter);
  sort_into_classes();
  set_search();
}

void BlockModel::sort_into_classes() {
  const ProgramForces& program = *problem_.forces.program;
  const Eigen::Matrix3d base_from_work = problem_.forces.cell->cell.workpiece.linear();
  Classes classes({.joint_rad = class_joint_rad, .cut_share = class_cut_share});
  class_of_.assign(program.blocks.size(), 0);
  line_of_.assign(program.blocks.size(), 0);
  for (std::size_t line = 0; line < units_.lines.size(); ++line) {
    std::vector<std::size_t>& looks = units_.cuts[line].looks;
    for (const std::size_t block : units_.lines[line].cutting) {
      const cutting::PoseEngagement& cut = program.cuts[block];
      const Eigen::Matrix3d stiffness =
          base_from_work * mean_stiffness(cut, problem_.forces.file.coefficients) * base_from_work.transpose();
      class_of_[block] = classes.add(
          block,
          {.axial_depth_m = engaged_depth_m(cut), .stiffness = stiffness, .joints = program.blocks[block].joints});
      line_of_[block] = line;
      if (std::ranges::find(looks, class_of_[block]) == looks.end()) looks.push_back(class_of_[block]);
    }
  }
  first_ = classes.first_blocks();
  more_margin_.assign(first_.size(), 0.0);
}

void BlockModel::set_search() {
  const DecideOptions& options = problem_.options;
  const decision::RecommendOptions& machine = problem_.machine;
  search_.teeth = problem_.forces.file.cutter.mill.teeth;
  search_.free_speed = options.is_free(Free::spindle_speed);
  search_.free_feed = options.is_free(Free::feed);
  search_.speed_window = machine.speed_window;
  search_.one_speed = options.speed_changes == SpeedChanges::none;
  search_.ramp_rad_per_s2 = options.goal == Goal::time ? options.spindle_ramp_rad_per_s2 : 0.0;
  search_.speed_step_rad_per_s = 10.0 * units::rpm;
  search_.feed_step_m_per_s = units::mm / units::minute;
  double low = machine.min_spindle_speed_rad_per_s;
  double high = machine.max_spindle_speed_rad_per_s;
  if (!machine.spindle.empty()) {
    low = std::max(low, machine.spindle.front().spindle_speed_rad_per_s);
    const double last = machine.spindle.back().spindle_speed_rad_per_s;
    high = high > 0.0 ? std::min(high, last) : last;
  }
  const auto [slowest, fastest] =
      std::ranges::minmax(units_.stretches, {}, &decision::ProgramStretch::programmed_spindle_speed_rad_per_s);
  const double about_low = (1.0 - default_speed_range) * slowest.programmed_spindle_speed_rad_per_s;
  const double about_high = (1.0 + default_speed_range) * fastest.programmed_spindle_speed_rad_per_s;
  if (low > 0.0 && high > 0.0 && low > high) {
    throw InvalidInput("spindle", "has no speed that both its range and its curve hold",
                       "Look at spindle.min_speed_rpm, max_speed_rpm and curve");
  }
  search_.min_spindle_speed_rad_per_s = low > 0.0 ? low : (high > 0.0 ? std::min(about_low, high) : about_low);
  search_.max_spindle_speed_rad_per_s = high > 0.0 ? high : std::max(about_high, search_.min_spindle_speed_rad_per_s);
  if (!options.is_free(Free::gamma)) return;
  search_.gamma_rad.clear();
  const int below = static_cast<int>(std::floor(-options.gamma_range_rad[0] / options.gamma_step_rad + 1e-9));
  const int above = static_cast<int>(std::floor(options.gamma_range_rad[1] / options.gamma_step_rad + 1e-9));
  for (int k = -below; k <= above; ++k) search_.gamma_rad.push_back(k * options.gamma_step_rad);
}

void BlockModel::limit_by_block(std::size_t cut, std::size_t block, double speed, FeedRange& range) const {
  const BlockLoad& load = loads_[block];
  if (!(load.chip_share > 0.0)) return;
  const DecideOptions& options = problem_.options;
  const BlockPace& pace = pace_[block];
  const double per_tooth = speed * search_.teeth / (2.0 * std::numbers::pi) / units_.cuts[cut].tooth_feed_share;
  const double programmed_chip_m = units_.cuts[cut].feed_m_per_s / per_tooth * load.chip_share;
  cap(range, pace.joint.feed_m_per_s, {ProgramLimit::joint_speed, pace.joint.allowed, pace.joint.allowed});
  const double least = load.feed_per_tooth_m[0] * per_tooth;
  if (least > range.least_m_per_s) {
    range.least_m_per_s = least;
    range.least_by = {ProgramLimit::least_chip, programmed_chip_m, chip_m_[0]};
  }
  cap(range, feed_share_[cut] * load.feed_per_tooth_m[2] * per_tooth,
      {ProgramLimit::greatest_chip, programmed_chip_m, chip_m_[1]});
  const double share = (1.0 - class_reserve) * feed_share_[cut];
  const auto keep = [&](ProgramLimit what, const LoadSamples& samples, double factor, double allowed) {
    cap(range, most_feed_per_tooth_m(load, samples, share * allowed / factor) * per_tooth,
        {what, samples[0] * factor, allowed});
  };
  if (options.max_force_n > 0.0) keep(ProgramLimit::force, load.force_n, 1.0, options.max_force_n);
  const double deflection_m = stricter(options.max_deflection_m, problem_.finish.max_deflection_m);
  if (deflection_m > 0.0) keep(ProgramLimit::deflection, load.deflection_m, 1.0, deflection_m);
  if (!problem_.machine.spindle.empty()) {
    const decision::SpindleCapacity able = decision::capacity_at(problem_.machine.spindle, speed);
    keep(ProgramLimit::torque, load.torque_n_m, 1.0, able.torque_n_m);
    keep(ProgramLimit::power, load.torque_n_m, speed, able.power_w);
  }
  const double cutting_speed = speed * pace.radius_m;
  const auto& [slowest, fastest] = options.cutting_speed_m_per_s;
  if (fastest > 0.0 && cutting_speed > fastest) {
    cap(range, 0.0, {ProgramLimit::cutting_speed, cutting_speed, fastest});
  }
  if (slowest > 0.0 && cutting_speed < slowest) {
    cap(range, 0.0, {ProgramLimit::cutting_speed, cutting_speed, slowest});
  }
}

FeedRange BlockModel::feeds(std::size_t cut, double speed) const {
  const LineUnit& line = units_.lines[cut];
  const DecideOptions& options = problem_.options;
  FeedRange range = {.least_m_per_s = 0.0, .most_m_per_s = std::numeric_limits<double>::infinity()};
  if (line.turns_only) {
    range.least_m_per_s = range.most_m_per_s = units_.cuts[cut].feed_m_per_s;
    return range;
  }
  const decision::RecommendOptions& machine = problem_.machine;
  if (speed < machine.min_spindle_speed_rad_per_s * (1.0 - 1e-9)) {
    cap(range, 0.0, {ProgramLimit::spindle_range, speed, machine.min_spindle_speed_rad_per_s});
  }
  if (machine.max_spindle_speed_rad_per_s > 0.0 && speed > machine.max_spindle_speed_rad_per_s * (1.0 + 1e-9)) {
    cap(range, 0.0, {ProgramLimit::spindle_range, speed, machine.max_spindle_speed_rad_per_s});
  }
  if (line.plunges) {
    cap(range, units_.cuts[cut].feed_m_per_s,
        {ProgramLimit::tip_speed, units_.cuts[cut].feed_m_per_s, units_.cuts[cut].feed_m_per_s});
  }
  if (options.max_feed_m_per_s > 0.0) {
    cap(range, options.max_feed_m_per_s,
        {ProgramLimit::tip_speed, units_.cuts[cut].feed_m_per_s, options.max_feed_m_per_s});
  }
  if (problem_.max_tip_speed_m_per_s > 0.0) {
    cap(range, problem_.max_tip_speed_m_per_s,
        {ProgramLimit::tip_speed, units_.cuts[cut].feed_m_per_s, problem_.max_tip_speed_m_per_s});
  }
  for (const std::size_t block : line.cutting) limit_by_block(cut, block, speed, range);
  // A plunge is not held up by the chip that it would need to be fed faster for.
  if (line.plunges) range.least_m_per_s = std::min(range.least_m_per_s, units_.cuts[cut].feed_m_per_s);
  if (!std::isfinite(range.most_m_per_s)) range.least_m_per_s = range.most_m_per_s = units_.cuts[cut].feed_m_per_s;
  return range;
}

const BlockModel::Stand& BlockModel::stand(std::size_t look_class, double gamma_rad) const {
  const std::pair key(look_class, gamma_rad);
  {
    const std::scoped_lock lock(mutex_);
    if (const auto found = stands_.find(key); found != stands_.end()) return found->second;
  }
  const robot::Cell& cell = problem_.forces.cell->cell;
  const Eigen::VectorXd& programmed = problem_.forces.program->blocks[first_[look_class]].joints;
  Stand out;
  std::optional<Eigen::VectorXd> joints = programmed;
  if (gamma_rad != 0.0) {
    robot::ToolPose pose = robot::tool_pose(cell, robot::forward(cell.arm, programmed));
    pose.gamma_rad += gamma_rad;
    joints = stand_at(cell, inverse_, pose, programmed);
    const bool clear = !joints || !checker_ || checker_->check(*joints).status == robot::Clearance::Status::clear;
    if (!clear) joints.reset();
  }
  if (joints) out = {.reachable = true, .modes = problem_.dynamics(*joints).modes};
  const std::scoped_lock lock(mutex_);
  return stands_.emplace(key, std::move(out)).first->second;
}

double BlockModel::margin_at(std::size_t look_class, const modal::ModalModel& modes, double speed, double deepest,
                             bool& stable) const {
  const cutting::PoseEngagement& cut = problem_.forces.program->cuts[first_[look_class]];
  const BlockCut at = {.file = problem_.forces.file,
                       .cut = cut,
                       .base_from_work = problem_.forces.cell->cell.workpiece.linear(),
                       .spindle_speed_rad_per_s = speed,
                       .tolerance = problem_.blocks_options.tolerance};
  const double depth_m = engaged_depth_m(cut);
  const stability::BlockStability found =
      stability::block_stability(block_problem(at, modes), speed, depth_m,
                                 {.tolerance = at.tolerance,
                                  .axial_depth_m = {shallowest * depth_m, deepest * depth_m},
                                  .margin = false,
                                  .regime = false});
  stable = found.at.stable;
  const bool limited = found.limit.status == stability::Limit::Status::found;
  return 1.0 - depth_m / (limited ? std::min(found.limit_5_percent_m, deepest * depth_m) : deepest * depth_m);
}

double BlockModel::deepest() const {
  return std::max(2.5, 2.0 / (1.0 - problem_.machine.depth_margin));
}

BlockModel::Raw BlockModel::compute(std::size_t look_class, double speed, double gamma_rad) const {
  Raw out;
  const Stand& there = stand(look_class, gamma_rad);
  out.reachable = there.reachable;
  if (!out.reachable) return out;
  out.margin = margin_at(look_class, there.modes, speed, deepest(), out.stable);
  if (!(most_surface_m() > 0.0) || !out.stable) return out;
  const double teeth_per_s = speed * search_.teeth / (2.0 * std::numbers::pi);
  const std::size_t block = first_[look_class];
  cutting::PoseEngagement cut = problem_.forces.program->cuts[block];
  const BlockCut at = {.file = problem_.forces.file,
                       .cut = cut,
                       .base_from_work = problem_.forces.cell->cell.workpiece.linear(),
                       .spindle_speed_rad_per_s = speed,
                       .tolerance = problem_.blocks_options.tolerance};
  const double depth_m = engaged_depth_m(cut);
  for (std::size_t k = 0; k < 2; ++k) {
    cut.feed_speed_m_per_s = loads_[block].feed_per_tooth_m.at(2 * k) * teeth_per_s;
    const stability::SurfacePoint surface =
        stability::surface_of_stable_cut(block_problem(at, there.modes), {speed, depth_m}, at.tolerance);
    out.surface_m.at(k) = std::abs(surface.surface_location_error_m);
  }
  return out;
}

BlockModel::Raw BlockModel::raw(std::size_t look_class, double speed, double gamma_rad) const {
  const RawKey key(look_class, speed, gamma_rad);
  {
    const std::scoped_lock lock(mutex_);
    if (const auto found = raw_.find(key); found != raw_.end()) return found->second;
  }
  const Raw out = compute(look_class, speed, gamma_rad);
  const std::scoped_lock lock(mutex_);
  raw_.emplace(key, out);
  return out;
}

decision::CutLook BlockModel::look(std::size_t look_class, double speed, std::size_t gamma) const {
  const Raw found = raw(look_class, speed, search_.gamma_rad[gamma]);
  decision::CutLook out;
  if (!found.reachable) {
    out.by = {ProgramLimit::posture, 1.0, 0.0};
    return out;
  }
  // No look finds more than the depths that it searches can show.
  const double asked = std::min(problem_.machine.depth_margin + more_margin_[look_class], 1.0 - 1.01 / deepest());
  out.by = {ProgramLimit::stability, found.margin, asked};
  out.holds = found.stable && found.margin >= asked;
  const double allowed = most_surface_m() * (1.0 - class_reserve);
  if (!out.holds || !(allowed > 0.0) || std::isnan(found.surface_m[1])) return out;
  if (found.surface_m[1] <= allowed) return out;  // where it falls with the feed the exact run looks at it
  const std::array<double, 3>& feed = loads_[first_[look_class]].feed_per_tooth_m;
  out.by = {ProgramLimit::surface_error, found.surface_m[0], most_surface_m()};
  if (found.surface_m[0] > allowed) {
    out.holds = false;
    return out;
  }
  const double share = (allowed - found.surface_m[0]) / (found.surface_m[1] - found.surface_m[0]);
  out.most_feed_per_tooth_m = std::lerp(feed[0], feed[2], share);
  return out;
}

double BlockModel::margin(std::size_t look_class, double speed, double gamma_rad) const {
  const Stand& there = stand(look_class, gamma_rad);
  bool stable = false;
  ++map_looks_;
  return there.reachable ? margin_at(look_class, there.modes, speed, map_deepest, stable) : not_reachable;
}

long long BlockModel::evaluations() const {
  const std::scoped_lock lock(mutex_);
  return static_cast<long long>(raw_.size()) + map_looks_;
}

void BlockModel::tighten_feed(std::size_t line, double share) {
  feed_share_[line] *= share;
}

void BlockModel::tighten_margin(std::size_t look_class, double more) {
  more_margin_[look_class] += more;
}

}  // namespace robomill::jobs
