#include "robomill/process/decide/way_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/base/units.hpp"
#include "robomill/process/blocks/named_block.hpp"
#include "robomill/process/blocks/stability.hpp"
#include "robomill/process/blocks/stand_at.hpp"
#include "robomill/process/decide/outcome.hpp"
#include "robomill/stability/block.hpp"
#include "robomill/stability/forced_vibration.hpp"
#include "robomill/stability/surface_error.hpp"

namespace robomill::process {
namespace {

using decision::FeedRange;
using decision::LimitUse;
using decision::ProgramLimit;

/// Limits are searched from this multiple of the depth on; of the map up to the other.
constexpr double shallowest = 0.25, map_deepest = 8.0;
/// What a look reserves of each limit for the blocks of its class.
constexpr double class_reserve = 0.01;
constexpr double not_reachable = std::numeric_limits<double>::quiet_NaN();

/// Lowers the upper end of a range of feeds.
void cap(FeedRange& range, double most_m_per_s, const LimitUse& by) {
  if (most_m_per_s >= range.most_m_per_s) return;
  range.most_m_per_s = most_m_per_s;
  range.most_by = by;
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
  const std::vector<robot::Joint>& joints = forces.cell->robot.arm.joints;
  for (Eigen::Index k = 0; k < turn.size(); ++k) {
    const double most = joints[static_cast<std::size_t>(k)].max_velocity;
    if (!(most > 0.0) || !(std::abs(turn(k)) > 0.0)) continue;
    const double feed = way_m * most / std::abs(turn(k));
    if (feed < out.feed_m_per_s) out = {.feed_m_per_s = feed, .allowed = most};
  }
  return out;
}

/// What remains of a block's surface error at the end, as programmed; 1 where that is not known.
double left_share(const ForcesResult& forces, const BlockRow& row) {
  if (!row.cuts || row.unstable()) return 1.0;
  const double whole_m = std::abs(row.steady.surface_error_m);
  const double left_m = left_surface_error_m(forces, row);
  if (std::isnan(whole_m) || std::isnan(left_m)) return 0.0;
  return whole_m > 0.0 ? std::min(left_m / whole_m, 1.0) : 1.0;
}

}  // namespace

WayModel::WayModel(const WaySetting& setting, const ForcesResult& forces, ProgramUnits units)
    : setting_(setting), forces_(forces), units_(std::move(units)) {
  loads_ = block_loads(forces, units_.lines, setting.chip_m);
  pace_.resize(loads_.size());
  for (const LineUnit& line : units_.lines) {
    for (const std::size_t block : line.cutting) {
      pace_[block] = {.joint = joint_speed(forces, block),
                      .radius_m = engaged_radius_m(forces.program->cuts[block].engagement)};
    }
  }
  feed_share_.assign(units_.lines.size(), 1.0);
  chip_factor_.assign(units_.lines.size(), 1.0);
  sort_into_classes();
}

void WayModel::sort_into_classes() {
  const ProgramForces& program = *forces_.program;
  const Eigen::Matrix3d base_from_work = forces_.cell->robot.workpiece.linear();
  Classes classes(look_tolerance);
  class_of_.assign(program.blocks.size(), no_class);
  for (std::size_t line = 0; line < units_.lines.size(); ++line) {
    std::vector<std::size_t>& looks = units_.cuts[line].looks;
    looks.clear();
    for (const std::size_t block : units_.lines[line].cutting) {
      const cutting::PoseEngagement& cut = program.cuts[block];
      const Eigen::Matrix3d stiffness =
          base_from_work * mean_stiffness(cut, forces_.cut.coefficients) * base_from_work.transpose();
      class_of_[block] = classes.add(
          block,
          {.axial_depth_m = engaged_depth_m(cut), .stiffness = stiffness, .joints = program.blocks[block].joints});
      looks.push_back(class_of_[block]);
    }
    std::ranges::sort(looks);
    looks.erase(std::unique(looks.begin(), looks.end()), looks.end());
  }
  first_ = classes.first_blocks();
  more_margin_.assign(first_.size(), 0.0);
  vibration_share_.assign(first_.size(), 1.0);
  left_share_.assign(first_.size(), 0.0);
  const std::vector<BlockRow>& rows = setting_.problem->blocks.rows;
  for (std::size_t i = 0; i < class_of_.size(); ++i) {
    if (class_of_[i] == no_class) continue;
    left_share_[class_of_[i]] = std::max(left_share_[class_of_[i]], left_share(setting_.problem->forces, rows[i]));
  }
}

std::optional<std::size_t> WayModel::class_of(std::size_t block) const {
  return class_of_[block] == no_class ? std::nullopt : std::optional(class_of_[block]);
}

double WayModel::teeth_per_s(double speed) const {
  return speed * forces_.cut.cutter.mill.teeth / (2.0 * std::numbers::pi);
}

void WayModel::limit_by_block(std::size_t line, std::size_t block, double speed, FeedRange& range) const {
  const BlockLoad& load = loads_[block];
  if (!(load.chip_share > 0.0)) return;
  const DecideOptions& options = setting_.problem->options;
  const BlockPace& pace = pace_[block];
  const double per_tooth = teeth_per_s(speed) / units_.cuts[line].tooth_feed_share;
  const double programmed_chip_m = units_.cuts[line].feed_m_per_s / per_tooth * load.chip_share;
  cap(range, pace.joint.feed_m_per_s,
      {ProgramLimit::joint_speed, pace.joint.allowed * units_.cuts[line].feed_m_per_s / pace.joint.feed_m_per_s,
       pace.joint.allowed});
  const double least = chip_factor_[line] * load.feed_per_tooth_m[0] * per_tooth;
  if (least > range.least_m_per_s) {
    range.least_m_per_s = least;
    range.least_by = {ProgramLimit::least_chip, programmed_chip_m, setting_.chip_m[0]};
  }
  cap(range, feed_share_[line] * load.feed_per_tooth_m[2] * per_tooth,
      {ProgramLimit::greatest_chip, programmed_chip_m, setting_.chip_m[1]});
  const double share = (1.0 - class_reserve) * feed_share_[line];
  const auto keep = [&](ProgramLimit what, const LoadSamples& samples, double factor, double allowed) {
    cap(range, most_feed_per_tooth_m(load, samples, share * allowed / factor) * per_tooth,
        {what, samples[0] * factor, allowed});
  };
  if (options.max_force_n > 0.0) keep(ProgramLimit::force, load.force_n, 1.0, options.max_force_n);
  const double deflection_m = stricter(options.max_deflection_m, setting_.problem->finish.max_deflection_m);
  if (deflection_m > 0.0) keep(ProgramLimit::deflection, load.deflection_m, 1.0, deflection_m);
  if (!setting_.problem->machine.spindle.empty()) {
    const decision::SpindleCapacity able = decision::capacity_at(setting_.problem->machine.spindle, speed);
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

LimitUse WayModel::at_feed(std::size_t line, LimitUse use, double feed_m_per_s, double speed) const {
  const double feed_per_tooth_m = feed_m_per_s * units_.cuts[line].tooth_feed_share / teeth_per_s(speed);
  double greatest = 0.0;
  for (const std::size_t block : units_.lines[line].cutting) {
    const BlockLoad& load = loads_[block];
    if (!(load.chip_share > 0.0)) continue;
    double value = 0.0;
    if (use.limit == ProgramLimit::force) {
      value = load_at(load, load.force_n, feed_per_tooth_m);
    } else if (use.limit == ProgramLimit::deflection) {
      value = load_at(load, load.deflection_m, feed_per_tooth_m);
    } else if (use.limit == ProgramLimit::torque || use.limit == ProgramLimit::power) {
      value = load_at(load, load.torque_n_m, feed_per_tooth_m) * (use.limit == ProgramLimit::power ? speed : 1.0);
    } else {
      return use;
    }
    greatest = std::max(greatest, value);
  }
  use.value = greatest;
  return use;
}

FeedRange WayModel::feeds(std::size_t line, double speed) const {
  const LineUnit& unit = units_.lines[line];
  const DecideOptions& options = setting_.problem->options;
  FeedRange range = {.least_m_per_s = 0.0, .most_m_per_s = std::numeric_limits<double>::infinity()};
  if (unit.turns_only) {
    range.least_m_per_s = range.most_m_per_s = units_.cuts[line].feed_m_per_s;
    return range;
  }
  const decision::MachineLimits& machine = setting_.problem->machine;
  if (speed < machine.min_spindle_speed_rad_per_s * (1.0 - 1e-9)) {
    cap(range, 0.0, {ProgramLimit::spindle_range, speed, machine.min_spindle_speed_rad_per_s});
  }
  if (machine.max_spindle_speed_rad_per_s > 0.0 && speed > machine.max_spindle_speed_rad_per_s * (1.0 + 1e-9)) {
    cap(range, 0.0, {ProgramLimit::spindle_range, speed, machine.max_spindle_speed_rad_per_s});
  }
  if (unit.plunges) {
    cap(range, units_.cuts[line].feed_m_per_s,
        {ProgramLimit::tip_speed, units_.cuts[line].feed_m_per_s, units_.cuts[line].feed_m_per_s});
  }
  if (options.max_feed_m_per_s > 0.0) {
    cap(range, options.max_feed_m_per_s,
        {ProgramLimit::tip_speed, units_.cuts[line].feed_m_per_s, options.max_feed_m_per_s});
  }
  if (setting_.problem->max_tip_speed_m_per_s > 0.0) {
    cap(range, setting_.problem->max_tip_speed_m_per_s,
        {ProgramLimit::tip_speed, units_.cuts[line].feed_m_per_s, setting_.problem->max_tip_speed_m_per_s});
  }
  for (const std::size_t block : unit.cutting) limit_by_block(line, block, speed, range);
  // A plunge is not held up by the chip that it would need to be fed faster for.
  if (unit.plunges) range.least_m_per_s = std::min(range.least_m_per_s, units_.cuts[line].feed_m_per_s);
  const bool empty = range.least_m_per_s > range.most_m_per_s;
  range.most_by = at_feed(line, range.most_by, empty ? range.least_m_per_s : units_.cuts[line].feed_m_per_s, speed);
  if (!std::isfinite(range.most_m_per_s)) range.least_m_per_s = range.most_m_per_s = units_.cuts[line].feed_m_per_s;
  return range;
}

const WayModel::Stand& WayModel::stand(std::size_t look_class, double gamma_rad) const {
  const std::pair key(look_class, gamma_rad);
  {
    const std::scoped_lock lock(mutex_);
    if (const auto found = stands_.find(key); found != stands_.end()) return found->second;
  }
  const robot::Cell& cell = forces_.cell->robot;
  const Eigen::VectorXd& programmed = forces_.program->blocks[first_[look_class]].joints;
  Stand out;
  std::optional<Eigen::VectorXd> joints = programmed;
  if (gamma_rad != 0.0) {
    robot::ToolPose pose = robot::tool_pose(cell, robot::forward(cell.arm, programmed));
    pose.gamma_rad += gamma_rad;
    joints = stand_at(cell, setting_.inverse, pose, programmed);
  }
  // A program whose posture is as given is not stopped by obstacles.
  if (joints && setting_.posture_free && setting_.checker != nullptr &&
      setting_.checker->check(*joints).status != robot::Clearance::Status::clear) {
    joints.reset();
  }
  if (joints) out = {.reachable = true, .modes = setting_.problem->dynamics(*joints).modes};
  const std::scoped_lock lock(mutex_);
  return stands_.emplace(key, std::move(out)).first->second;
}

BlockCut WayModel::cut_at(std::size_t look_class, double speed) const {
  return {.setup = forces_.cut,
          .cut = forces_.program->cuts[first_[look_class]],
          .base_from_work = forces_.cell->robot.workpiece.linear(),
          .spindle_speed_rad_per_s = speed,
          .tolerance = setting_.problem->blocks_options.tolerance};
}

double WayModel::margin_at(std::size_t look_class, const modal::ModalModel& modes, double speed, double deepest,
                           bool* stable) const {
  const BlockCut at = cut_at(look_class, speed);
  const double depth_m = engaged_depth_m(at.cut);
  const stability::BlockStability found =
      stability::block_stability(block_problem(at, modes), speed, depth_m,
                                 {.tolerance = at.tolerance,
                                  .axial_depth_m = {shallowest * depth_m, deepest * depth_m},
                                  .point = false,
                                  .margin = false,
                                  .regime = false});
  if (stable != nullptr) *stable = !found.limited() || found.limit.axial_depth_m > depth_m;
  return 1.0 - depth_m / std::min(found.limit_5_percent_m, deepest * depth_m);
}

double WayModel::deepest() const {
  return std::max(2.5, 2.0 / (1.0 - setting_.problem->machine.depth_margin));
}

ClassLook WayModel::compute(std::size_t look_class, double speed, double gamma_rad) const {
  ClassLook out;
  const Stand& there = stand(look_class, gamma_rad);
  out.reachable = there.reachable;
  if (!out.reachable) return out;
  const bool surface = most_surface_m() > 0.0 && left_share_[look_class] > 0.0;
  // One steady motion costs a small part of the search for a limit: what vibrates too much needs none.
  if (!surface) {
    add_steady_motion(look_class, there.modes, speed, out);
    decision::CutLook ignored;
    out.stable = !keep_vibration(look_class, out, ignored) && is_stable(look_class, there.modes, speed);
    if (out.stable) return out;
  }
  out.margin = margin_at(look_class, there.modes, speed, deepest(), &out.stable);
  if (surface && out.stable) add_steady_motion(look_class, there.modes, speed, out);
  return out;
}

bool WayModel::is_stable(std::size_t look_class, const modal::ModalModel& modes, double speed) const {
  const BlockCut at = cut_at(look_class, speed);
  return stability::evaluate_point(block_problem(at, modes), {.tolerance = at.tolerance},
                                   {.spindle_speed_rad_per_s = speed, .axial_depth_m = engaged_depth_m(at.cut)})
             .spectral_radius < 1.0;
}

void WayModel::add_steady_motion(std::size_t look_class, const modal::ModalModel& modes, double speed,
                                 ClassLook& out) const {
  const std::size_t block = first_[look_class];
  if (!(loads_[block].feed_per_tooth_m[0] > 0.0)) return;
  const bool surface = most_surface_m() > 0.0 && left_share_[look_class] > 0.0;
  const BlockCut at = cut_at(look_class, speed);
  const stability::OperatingPoint point = {.spindle_speed_rad_per_s = speed, .axial_depth_m = engaged_depth_m(at.cut)};
  for (std::size_t k = 0; k < 2; ++k) {
    stability::LobesProblem problem = block_problem(at, modes);
    problem.spatial->feed_per_tooth_m = loads_[block].feed_per_tooth_m.at(2 * k);
    if (!surface) {
      out.vibration_m.at(k) = stability::ForcedResponse(problem).at(point).amplitude_m;
      continue;
    }
    const stability::SurfacePoint left = stability::surface_of_stable_cut(problem, point, at.tolerance);
    out.surface_m.at(k) = left_share_[look_class] * std::abs(left.surface_location_error_m);
    out.vibration_m.at(k) = left.vibration.amplitude_m;
  }
}

ClassLook WayModel::known_or_computed(std::size_t look_class, double speed, double gamma_rad) const {
  const LookKey key(look_class, speed, gamma_rad);
  {
    const std::scoped_lock lock(mutex_);
    if (const auto found = looks_.find(key); found != looks_.end()) return found->second;
  }
  ClassLook out;
  try {
    out = compute(look_class, speed, gamma_rad);
  } catch (const InvalidInput& error) {
    InvalidInput::Parts parts = error.parts();
    if (parts.where.empty()) parts.where = named_block(forces_, first_[look_class]);
    throw InvalidInput(std::move(parts));
  }
  const std::scoped_lock lock(mutex_);
  looks_.emplace(key, out);
  return out;
}

decision::CutLook WayModel::look(std::size_t look_class, double speed, double gamma_rad) const {
  const ClassLook found = known_or_computed(look_class, speed, gamma_rad);
  decision::CutLook out;
  if (!found.reachable) {
    out.by = {ProgramLimit::posture, 1.0, 0.0};
    return out;
  }
  const bool quiet = keep_vibration(look_class, found, out);
  if (!quiet && found.stable) return out;
  // No look finds more than the depths that it searches can show.
  const double asked =
      std::min(setting_.problem->machine.depth_margin + more_margin_[look_class], 1.0 - 1.01 / deepest());
  const LimitUse margin = {ProgramLimit::stability, found.stable ? found.margin : std::min(found.margin, 0.0), asked};
  out.holds = found.stable && found.margin >= asked;
  if (!out.holds || out.by.limit == ProgramLimit::none) out.by = margin;
  out.holds = out.holds && keep_surface(look_class, found, out);
  return out;
}

bool WayModel::keep_surface(std::size_t look_class, const ClassLook& found, decision::CutLook& out) const {
  const double allowed = most_surface_m() * (1.0 - class_reserve);
  if (!(allowed > 0.0) || std::isnan(found.surface_m[1])) return true;
  if (found.surface_m[1] <= allowed) return true;  // where it falls with the feed the exact run looks at it
  const std::array<double, 3>& feed = loads_[first_[look_class]].feed_per_tooth_m;
  const LimitUse use = {ProgramLimit::surface_error, found.surface_m[0], most_surface_m()};
  if (found.surface_m[0] > allowed) {
    out.by = use;
    return false;
  }
  const double share = (allowed - found.surface_m[0]) / (found.surface_m[1] - found.surface_m[0]);
  const double most_m = std::lerp(feed[0], feed[2], share);
  if (most_m >= out.most_feed_per_tooth_m) return true;
  out.most_feed_per_tooth_m = most_m;
  out.by = use;
  out.by_feed_per_tooth_m = feed[0];
  out.by_rise_per_m = (found.surface_m[1] - found.surface_m[0]) / (feed[2] - feed[0]);
  return true;
}

bool WayModel::keep_vibration(std::size_t look_class, const ClassLook& found, decision::CutLook& out) const {
  if (std::isnan(found.vibration_m[0]) || std::isnan(found.vibration_m[1])) return true;
  const std::array<double, 3>& all = loads_[first_[look_class]].feed_per_tooth_m;
  const std::array<double, 2> feed = {all[0], all[2]};
  const double share = (1.0 - class_reserve) * vibration_share_[look_class];
  // The amplitude is convex in the feed: between the ends what is too much lies below its chord.
  std::array<double, 2> over = {};
  for (std::size_t k = 0; k < 2; ++k) over.at(k) = found.vibration_m.at(k) - share * feed.at(k);
  if (over[0] <= 0.0 && over[1] <= 0.0) return true;
  const std::size_t worse = over[0] / feed[0] > over[1] / feed[1] ? 0 : 1;
  const LimitUse use = {ProgramLimit::forced_vibration, found.vibration_m.at(worse), feed.at(worse)};
  if (over[0] > 0.0 && over[1] > 0.0) {
    const std::size_t nearer = 1 - worse;
    out.by = {ProgramLimit::forced_vibration, found.vibration_m.at(nearer), feed.at(nearer)};
    return false;
  }
  const double at_m = std::lerp(feed[0], feed[1], over[0] / (over[0] - over[1]));
  if (over[0] > 0.0) {
    out.least_feed_per_tooth_m = at_m;
    out.least_by = use;
  } else {
    out.most_feed_per_tooth_m = at_m;
    out.by = use;
  }
  return true;
}

double WayModel::margin(std::size_t look_class, double speed, double gamma_rad) const {
  const Stand& there = stand(look_class, gamma_rad);
  {
    const std::scoped_lock lock(mutex_);
    ++map_looks_;
  }
  return there.reachable ? margin_at(look_class, there.modes, speed, map_deepest, nullptr) : not_reachable;
}

long long WayModel::evaluations() const {
  const std::scoped_lock lock(mutex_);
  return static_cast<long long>(looks_.size()) + map_looks_;
}

}  // namespace robomill::process
