#include "robomill/cell/check/tool_places.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "robomill/path/postures/posture_walk.hpp"
#include "robomill/robot/serial_kinematics.hpp"

namespace robomill::cell {
namespace {

constexpr double homing = 0.05;  // of margin that half a turn of a joint away from home is worth
constexpr int turns_in_closed_form = 72, turns_by_search = 24;  // a search costs a thousand times as much

}  // namespace

robot::Position6 position_of(const std::vector<double>& joints) {
  robot::Position6 out = robot::Position6::Zero();
  for (std::size_t i = 0; i < std::min<std::size_t>(joints.size(), 6); ++i) {
    out(static_cast<Eigen::Index>(i)) = joints[i];
  }
  return out;
}

/// What a search over ways and turns has met.
struct ToolPlaces::Search {
  std::optional<Stand> best = {};
  double best_score = -HUGE_VAL;
  double least_beyond = HUGE_VAL;  ///< of the ways outside limits: the largest excess of the best of them
  robot::Position6 beyond_at = robot::Position6::Zero();
  double beyond_gamma_rad = 0.0;
  double least_condition = HUGE_VAL;  ///< of the ways that are singular
  double singular_gamma_rad = 0.0;
};

ToolPlaces::ToolPlaces(const Cell& cell, const Eigen::Isometry3d& workpiece) : cell_(&cell) {
  home_ = position_of(cell.home);
  if (cell.hybrid) {
    robot::HybridMachine machine = *cell.hybrid;
    machine.workpiece = workpiece;
    machine_ = std::make_unique<robot::HybridKinematics>(machine);
    machine.limits = {};
    unlimited_ = std::make_unique<robot::HybridKinematics>(machine);
    gamma_rad_ = {0.0};
    return;
  }
  arm_cell_ = cell.robot;
  arm_cell_.workpiece = workpiece;
  auto arm = std::make_unique<robot::SerialKinematics>(arm_cell_);
  if (arm->closed_form()) {
    inverse_.emplace(arm_cell_.arm);
  } else {
    robot::Cell free = arm_cell_;
    for (robot::Joint& joint : free.arm.joints) {
      joint.min_position = -std::numbers::pi;
      joint.max_position = std::numbers::pi;
    }
    unlimited_ = std::make_unique<robot::SerialKinematics>(free);
  }
  const int turns = inverse_ ? turns_in_closed_form : turns_by_search;
  for (int k = 0; k < turns; ++k) gamma_rad_.push_back(2.0 * std::numbers::pi * k / turns);
  if (cell.gamma_given) gamma_rad_ = {cell.redundant_gamma_rad};
  machine_ = std::move(arm);
}

robot::Image ToolPlaces::image_of(int joint, double value) const {
  const double low = machine_->limits().min_position(joint), high = machine_->limits().max_position(joint);
  if (cell_->hybrid) return {.position = value, .beyond = std::max({low - value, value - high, 0.0})};
  const double middle = high - low < 1e3 ? 0.5 * (low + high) : std::clamp(0.0, low, high);
  return robot::nearest_image(arm_cell_.arm.joints[static_cast<std::size_t>(joint)], value, middle);
}

double ToolPlaces::margin_of(const robot::Position6& position) const {
  return std::min(path::limit_share(*machine_, position).share, machine_->regularity(position));
}

ToolPlaces::Ways ToolPlaces::ways_to(const robot::ToolPose& pose) const {
  Ways out;
  if (inverse_) {
    const robot::InverseSolutions solutions = inverse_->solve(robot::flange_pose(arm_cell_, pose));
    for (; out.count < solutions.count; ++out.count) {
      const auto k = static_cast<std::size_t>(out.count);
      out.position[k] = solutions.solution[k].position_rad;
    }
    out.out_of_reach_m = solutions.out_of_reach_m;
    out.out_of_reach_rad = solutions.out_of_reach_rad;
    return out;
  }
  out.count = unlimited_->all(pose, out.position.data(), static_cast<int>(most_ways));
  if (out.count > 0) return out;
  robot::Position6 unused;
  out.out_of_reach_m = unlimited_->follow(pose, robot::Position6::Zero(), unused).beyond;
  return out;
}

void ToolPlaces::consider(const robot::ToolPose& pose, const robot::Position6& way, Search& search) const {
  robot::Position6 placed = way;
  double beyond = 0.0;
  for (int i = 0; i < machine_->joints(); ++i) {
    const robot::Image image = image_of(i, way(i));
    placed(i) = image.position;
    beyond = std::max(beyond, image.beyond);
  }
  if (beyond > 0.0) {
    if (!(beyond < search.least_beyond)) return;
    search.least_beyond = beyond;
    search.beyond_at = placed;
    search.beyond_gamma_rad = pose.gamma_rad;
    return;
  }
  const double regularity = machine_->regularity(placed);
  if (!(regularity * robot::SingularityOptions{}.max_condition_number >= 1.0)) {
    if (!(1.0 / regularity < search.least_condition)) return;
    search.least_condition = 1.0 / regularity;
    search.singular_gamma_rad = pose.gamma_rad;
    return;
  }
  const double margin = std::min(path::limit_share(*machine_, placed).share, regularity);
  const double score = margin - homing * (placed - home_).cwiseAbs().maxCoeff() / std::numbers::pi;
  if (!(score > search.best_score)) return;
  search.best_score = score;
  search.best = Stand{.position = placed, .gamma_rad = pose.gamma_rad, .margin = margin};
}

ToolPlaces::Found ToolPlaces::find(const program::Pose& pose) const {
  Search search;
  double least_m = HUGE_VAL, least_rad = HUGE_VAL;
  robot::ToolPose tool{.tip_m = pose.tip_m, .axis = pose.axis, .gamma_rad = gamma_rad_.front()};
  for (const double gamma_rad : gamma_rad_) {
    tool.gamma_rad = gamma_rad;
    const Ways ways = ways_to(tool);
    for (int k = 0; k < ways.count; ++k) consider(tool, ways.position[static_cast<std::size_t>(k)], search);
    if (ways.count > 0) continue;
    if (ways.out_of_reach_m > 0.0) least_m = std::min(least_m, ways.out_of_reach_m);
    if (ways.out_of_reach_rad > 0.0) least_rad = std::min(least_rad, ways.out_of_reach_rad);
  }
  if (search.best) return {.stand = search.best};
  Found out;
  Miss& miss = out.miss;
  if (std::isfinite(search.least_condition)) {
    tool.gamma_rad = search.singular_gamma_rad;
    miss.status = robot::Reach::Status::singular;
    miss.condition_number = search.least_condition;
  } else if (std::isfinite(search.least_beyond)) {
    tool.gamma_rad = search.beyond_gamma_rad;
    miss.status = robot::Reach::Status::outside_limits;
    const robot::JointLimits& limits = machine_->limits();
    for (int i = 0; i < machine_->joints(); ++i) {
      const double at = search.beyond_at(i), limit = std::clamp(at, limits.min_position(i), limits.max_position(i));
      if (at != limit) miss.beyond.push_back({.joint = i, .position = at, .limit = limit});
    }
  } else {
    miss.out_of_reach_m = std::isfinite(least_m) ? least_m : 0.0;
    if (!std::isfinite(least_m) && std::isfinite(least_rad)) miss.out_of_reach_rad = least_rad;
  }
  miss.pose = tool;
  return out;
}

std::optional<ToolPlaces::Stand> ToolPlaces::follow(const program::Pose& pose, const Stand& before) const {
  Stand out = before;
  const robot::Reach reach =
      machine_->follow(robot::ToolPose{.tip_m = pose.tip_m, .axis = pose.axis, .gamma_rad = before.gamma_rad},
                       before.position, out.position);
  if (reach.status != robot::Reach::Status::found) return std::nullopt;
  out.margin = margin_of(out.position);
  return out;
}

std::optional<ToolPlaces::Stand> ToolPlaces::find_quickly(const program::Pose& pose, const Stand& near) const {
  if (std::optional<Stand> there = follow(pose, near)) return there;
  if (inverse_ || cell_->hybrid) return find(pose).stand;
  std::vector<Stand> seeds = {near};
  for (const double elbow : {1.0, -1.0}) {
    for (const double wrist : {1.0, -1.0}) {
      Stand& bent = seeds.emplace_back();
      bent.position(2) = 0.5 * std::numbers::pi * elbow;
      bent.position(4) = 0.5 * std::numbers::pi * wrist;
    }
  }
  std::optional<Stand> best;
  for (Stand& seed : seeds) {
    for (const double gamma_rad : gamma_rad_) {
      seed.gamma_rad = gamma_rad;
      const std::optional<Stand> there = follow(pose, seed);
      if (there && (!best || there->margin > best->margin)) best = there;
    }
  }
  return best;
}

}  // namespace robomill::cell
