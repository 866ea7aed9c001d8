#include "robomill/robot/redundancy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "robomill/base/error.hpp"
#include "robomill/robot/kinematics/choose.hpp"

namespace robomill::robot {
namespace {

using std::numbers::pi;

/// One tool pose, at any gamma.
class Turn {
 public:
  Turn(const Cell& cell, const SphericalWristInverse& inverse, const ToolPose& tool, const RedundancyOptions& options)
      : cell_(cell), inverse_(inverse), tool_(tool), options_(options) {
    choosing_.singularity = options.singularity;
    choosing_.point_m = tip_point(cell);
  }

  /// The best posture of all branches, or the one nearest to `near`.
  [[nodiscard]] RedundancySample at(double gamma_rad, const std::optional<Position6>& near) const {
    ToolPose tool = tool_;
    tool.gamma_rad = gamma_rad;
    const Position6 from = near.value_or(Position6::Zero());
    const InverseSolutions all = inverse_.solve(flange_pose(cell_, tool), from);
    if (near) return evaluated(gamma_rad, choose(cell_.arm, all, from, choosing_));
    RedundancySample best;
    best.gamma_rad = gamma_rad;
    best.status = choose(cell_.arm, all, from, choosing_).status;
    bool any = false;
    for (int k = 0; k < all.count; ++k) {
      InverseSolutions one = all;
      one.count = 1;
      one.solution[0] = all.solution[static_cast<std::size_t>(k)];
      const RedundancySample sample = evaluated(gamma_rad, choose(cell_.arm, one, from, choosing_));
      if (sample.status != Reach::Status::found || (any && !(cost(sample) < cost(best)))) continue;
      any = true;
      best = sample;
    }
    return best;
  }

  /// What is to be least; infinite where there is no posture.
  [[nodiscard]] double cost(const RedundancySample& sample) const {
    if (sample.status != Reach::Status::found || sample.buckled) return std::numeric_limits<double>::infinity();
    return sample.error_m.norm();
  }

  /// The least cost in [from, to] on the branch of `sample`, which lies between.
  [[nodiscard]] RedundancySample refined(const RedundancySample& sample, double from, double to) const {
    const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
    RedundancySample best = sample;
    const auto probe = [&](double gamma_rad) {
      const RedundancySample there = at(gamma_rad, best.position_rad);
      if (cost(there) < cost(best)) best = there;
      return cost(there);
    };
    double left = to - golden * (to - from), right = from + golden * (to - from);
    double cost_left = probe(left), cost_right = probe(right);
    while (to - from > options_.tolerance_rad) {
      if (cost_left < cost_right) {
        to = right;
        right = left;
        cost_right = cost_left;
        left = to - golden * (to - from);
        cost_left = probe(left);
      } else {
        from = left;
        left = right;
        cost_left = cost_right;
        right = from + golden * (to - from);
        cost_right = probe(right);
      }
    }
    return best;
  }

 private:
  [[nodiscard]] RedundancySample evaluated(double gamma_rad, const Choice& choice) const {
    RedundancySample out;
    out.gamma_rad = gamma_rad;
    out.status = choice.status;
    if (choice.status != Reach::Status::found) return out;
    out.position_rad = choice.position_rad;
    out.limit_distance_rad = within_limits(cell_.arm, out.position_rad).distance;
    const Eigen::Matrix3d to_b = cell_.workpiece.linear();
    const Wrench wrench{.force_n = to_b * options_.force_n};
    const Stiffness s = stiffness(cell_.arm, out.position_rad, tip_point(cell_), wrench, options_.singularity);
    out.condition_number = s.condition_number;
    out.buckled = s.status == Stiffness::Status::buckled;
    Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = to_b;
    out.compliance = turn.transpose() * s.compliance * turn;
    out.error_m = out.compliance.topLeftCorner<3, 3>() * options_.force_n;
    out.error_along_normal_m = out.error_m.dot(options_.normal);
    return out;
  }

  const Cell& cell_;
  const SphericalWristInverse& inverse_;
  const ToolPose& tool_;
  const RedundancyOptions& options_;
  ChooseOptions choosing_ = {};
};

}  // namespace

void RedundancyOptions::validate() const {
  if (!force_n.allFinite()) throw InvalidInput("force_n", "must be finite");
  if (!normal.allFinite() || std::abs(normal.norm() - 1.0) > 1e-6)
    throw InvalidInput("normal", "must be a unit vector");
  if (samples < 4) throw InvalidInput("samples", samples, "", "must be >= 4");
  require_positive("tolerance_rad", tolerance_rad, "rad");
  try {
    singularity.validate();
  } catch (const InvalidInput& error) {
    throw within("singularity.", error);
  }
  if (force_n.isZero(0.0)) {
    throw InvalidInput("force_n", "must not be zero: without a force there is no error to make least");
  }
}

Redundancy redundancy(const Cell& cell, const SphericalWristInverse& inverse, const ToolPose& tool,
                      const RedundancyOptions& options) {
  options.validate();
  cell.validate();
  if (!tool.tip_m.allFinite()) throw InvalidInput("tool.tip_m", "must be finite");
  if (!tool.axis.allFinite() || std::abs(tool.axis.norm() - 1.0) > 1e-6) {
    throw InvalidInput("tool.axis", "must be a unit vector");
  }
  const Turn turn(cell, inverse, tool, options);
  Redundancy out;
  out.samples.reserve(static_cast<std::size_t>(options.samples));
  const double step = 2.0 * pi / options.samples;
  std::size_t best = 0;
  for (int k = 0; k < options.samples; ++k) {
    out.samples.push_back(turn.at(-pi + k * step, options.previous));
    if (turn.cost(out.samples.back()) < turn.cost(out.samples[best])) best = out.samples.size() - 1;
  }
  if (!std::isfinite(turn.cost(out.samples[best]))) return out;
  out.status = Redundancy::Status::found;
  const RedundancySample& from = out.samples[best];
  out.best = turn.refined(from, from.gamma_rad - step, from.gamma_rad + step);
  return out;
}

}  // namespace robomill::robot
