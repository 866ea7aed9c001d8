#include "robomill/path/postures/posture_walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

namespace robomill::path {
namespace {

constexpr double unlimited = 1e300;
constexpr double antipodal = 1e-6;  // [rad] from half a turn: the great circle is no longer determined
constexpr int most_halvings = 24;

std::size_t block_of(const Head& head, double t) {
  return std::min(static_cast<std::size_t>(t), head.line.size() - 1);
}

}  // namespace

program::Pose Head::at(double t) const {
  const std::size_t block = block_of(*this, t);
  return program::between(pose[block], pose[block + 1], t - static_cast<double>(block));
}

Head read_head(program::Source& source, std::size_t max_blocks) {
  Head out;
  source.rewind();
  out.pose.push_back(source.start());
  program::Block block;
  while (source.next(block)) {
    if (out.line.size() == max_blocks) {
      out.whole = false;
      break;
    }
    const double angle = program::angle_between(out.pose.back().axis, block.end.axis);
    if (!(angle < std::numbers::pi - antipodal)) {
      throw InvalidInput("block " + std::to_string(out.line.size() + 1) + " (line " + std::to_string(block.line) + ")",
                         "must not turn the axis by half a turn: there is no one way", "Give a pose between");
    }
    out.pose.push_back(block.end);
    out.line.push_back(block.line);
  }
  source.rewind();
  return out;
}

double steps_of(const Head& head, std::size_t block, const PostureOptions& options) {
  const program::Pose &from = head.pose[block], &to = head.pose[block + 1];
  return std::max(program::angle_between(from.axis, to.axis) / options.max_axis_step_rad,
                  (to.tip_m - from.tip_m).norm() / options.max_tip_step_m);
}

std::vector<double> stations(const Head& head, const PostureOptions& options) {
  std::vector<double> out = {0.0};
  double since = 0.0;
  for (std::size_t block = 0; block < head.line.size(); ++block) {
    const double steps = steps_of(head, block, options), begin = static_cast<double>(block);
    const int parts = static_cast<int>(std::min(std::ceil(steps), 1e6));
    for (int part = 1; part < parts; ++part) out.push_back(begin + static_cast<double>(part) / parts);
    since = parts > 1 ? 1.0 : since + steps;
    if (since < 1.0 && block + 1 < head.line.size()) continue;
    out.push_back(begin + 1.0);
    since = 0.0;
  }
  return out;
}

std::vector<double> thinned(const std::vector<double>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<double> out;
  out.reserve(most);
  for (std::size_t k = 0; k < most; ++k) out.push_back(all[k * (all.size() - 1) / (most - 1)]);
  return out;
}

double gamma_at(const std::vector<double>& gamma_rad, double t) {
  if (gamma_rad.size() == 1) return gamma_rad.front();
  const std::size_t below = std::min(static_cast<std::size_t>(t), gamma_rad.size() - 2);
  return gamma_rad[below] + (t - static_cast<double>(below)) * (gamma_rad[below + 1] - gamma_rad[below]);
}

LimitShare limit_share(const robot::Kinematics& kinematics, const robot::Position6& position) {
  LimitShare out;
  const robot::JointLimits& limits = kinematics.limits();
  for (int i = 0; i < kinematics.joints(); ++i) {
    const double low = limits.min_position(i), high = limits.max_position(i);
    if (low <= -unlimited && high >= unlimited) continue;
    const double half = std::min(0.5 * high - 0.5 * low, std::numbers::pi);
    const double share = std::min(position(i) - low, high - position(i)) / half;
    if (share < out.share) out = {.share = share, .joint = i};
  }
  return out;
}

Walk walk(const robot::Kinematics& kinematics, const Head& head, const std::vector<double>& along,
          const std::vector<double>& gamma_rad, const robot::Position6& start, const WalkOptions& options) {
  Walk out;
  robot::Position6 position = start, next;
  const auto try_at = [&](double t) {
    const program::Pose pose = head.at(t);
    return kinematics.follow(
        robot::ToolPose{.tip_m = pose.tip_m, .axis = pose.axis, .gamma_rad = gamma_at(gamma_rad, t)}, position, next);
  };
  const auto look = [&](double t, double regularity) {
    const LimitShare share = limit_share(kinematics, next);
    const double least = std::min(share.share, regularity);
    if (least < out.margin.least) {
      out.margin = {.least = least,
                    .block = block_of(head, t),
                    .joint = share.share <= regularity ? share.joint : -1,
                    .position = next};
    }
    position = next;
    out.last = next;
    out.low = out.low.cwiseMin(next);
    out.high = out.high.cwiseMax(next);
    out.t = t;
  };
  out.low = out.high = out.last = start;
  out.reach = try_at(along.front());
  if (out.reach.status != robot::Reach::Status::found) return out;
  look(along.front(), kinematics.regularity(next));
  std::array<double, most_halvings + 2> ahead = {};
  for (std::size_t k = 1; k < along.size(); ++k) {
    const double finest = std::ldexp(along[k] - along[k - 1], -std::min(options.halvings, most_halvings));
    std::size_t waiting = 0;
    ahead[waiting++] = along[k];
    while (waiting > 0) {
      const double t = ahead[waiting - 1];
      out.reach = try_at(t);
      const bool found = out.reach.status == robot::Reach::Status::found;
      const bool can_halve = t - out.t > 1.5 * finest && waiting < ahead.size();
      int joint = -1;
      const double step = found ? (next - position).cwiseAbs().maxCoeff(&joint) : 0.0;
      const bool near = found && step <= options.max_step;
      const double regularity = near && (options.careful || waiting == 1) ? kinematics.regularity(next) : 1.0;
      if (can_halve && !(near && (!options.careful || step <= regularity))) {
        ahead[waiting] = 0.5 * (out.t + t);
        ++waiting;
        continue;
      }
      if (found && step > options.max_step) {
        out.reach = {.status = robot::Reach::Status::jump, .joint = joint, .beyond = step};
      }
      if (out.reach.status != robot::Reach::Status::found) {
        out.t = t;
        return out;
      }
      look(t, regularity);
      --waiting;
    }
  }
  return out;
}

}  // namespace robomill::path
