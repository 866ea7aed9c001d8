#include "robomill/robot/kinematics/choose.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "robomill/base/error.hpp"
#include "robomill/robot/condition.hpp"
#include "robomill/robot/kinematics/images.hpp"
#include "robomill/robot/kinematics/newton.hpp"

namespace robomill::robot {
namespace {

double condition_at(const Arm& arm, const Position6& position, const ChooseOptions& options) noexcept {
  Posture posture;
  posture.update(arm, position);
  Eigen::Matrix<double, 6, 6> jac;
  posture.jacobian(arm, posture.flange * options.point_m, jac);
  return condition_of(jac, options.singularity.characteristic_length_m);
}

/// Where a way through the poses may begin: between the limits, at zero where there are none.
Position6 middle(const Arm& arm) {
  Position6 out = Position6::Zero();
  for (Eigen::Index i = 0; i < 6; ++i) {
    const Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    if (joint.max_position - joint.min_position < 1e3) out(i) = 0.5 * (joint.min_position + joint.max_position);
  }
  return out;
}

Followed follow_from(const Arm& arm, const SphericalWristInverse& inverse,
                     const std::vector<Eigen::Isometry3d>& flanges, const Position6& start,
                     const ChooseOptions& options) {
  Followed out;
  out.position_rad.reserve(flanges.size());
  Position6 previous = start;
  for (const Eigen::Isometry3d& flange : flanges) {
    out.last = choose(arm, inverse.solve(flange, previous), previous, options);
    out.status = out.last.status;
    if (out.status != Reach::Status::found) break;
    out.largest_travel_rad = std::max(out.largest_travel_rad, out.last.travel_rad);
    previous = out.last.position_rad;
    out.position_rad.push_back(previous);
    ++out.reached;
  }
  return out;
}

/// The start, each joint shifted by whole turns so that all of a way from it, which knew no limits, lies within them;
/// nearest to the middle of the limits, and unshifted where there is none.
Position6 shifted_start(const Arm& arm, const Followed& way, const Position6& start, const Position6& wanted) {
  Position6 least = start, most = start;
  for (const Position6& position : way.position_rad) {
    least = least.cwiseMin(position);
    most = most.cwiseMax(position);
  }
  Position6 out = start;
  for (Eigen::Index i = 0; i < 6; ++i) {
    Joint room = arm.joints[static_cast<std::size_t>(i)];
    room.min_position += start(i) - least(i);
    room.max_position -= most(i) - start(i);
    const Image image = nearest_image(room, start(i), wanted(i));
    if (room.min_position <= room.max_position && image.beyond == 0.0) out(i) = image.position;
  }
  return out;
}

void require_six(const Arm& arm) {
  arm.validate();
  if (arm.joints.size() == 6) return;
  throw InvalidInput("arm.joints", static_cast<double>(arm.joints.size()), "joints", "must be six");
}

}  // namespace

void ChooseOptions::validate() const {
  try {
    singularity.validate();
  } catch (const InvalidInput& error) {
    throw within("singularity.", error);
  }
  if (!point_m.allFinite()) throw InvalidInput("point_m", "must be finite");
  if (!weight.allFinite() || weight.minCoeff() < 0.0) throw InvalidInput("weight", "must be >= 0");
  if (!(max_travel_rad > 0.0)) throw InvalidInput("max_travel_rad", max_travel_rad, "rad", "must be > 0");
}

void NearOptions::validate() const {
  require_positive("tolerance_m", tolerance_m, "m");
  require_positive("tolerance_rad", tolerance_rad, "rad");
  if (max_iterations < 1) throw InvalidInput("max_iterations", max_iterations, "", "must be >= 1");
}

Choice choose(const Arm& arm, const InverseSolutions& solutions, const Position6& previous,
              const ChooseOptions& options) noexcept {
  Choice out{.out_of_reach_m = solutions.out_of_reach_m, .out_of_reach_rad = solutions.out_of_reach_rad};
  if (solutions.count == 0) return out;
  const Picked best = pick(arm, solutions, previous, options.weight);
  out.position_rad = best.placed.position_rad;
  out.travel_rad = (out.position_rad - previous).cwiseAbs().maxCoeff();
  out.joint = best.placed.joint;
  out.beyond_rad = best.placed.beyond_rad;
  if (out.joint >= 0) {
    out.status = Reach::Status::outside_limits;
    return out;
  }
  out.condition_number = condition_at(arm, out.position_rad, options);
  const bool singular = !(out.condition_number <= options.singularity.max_condition_number);
  out.status = singular                                  ? Reach::Status::singular
               : out.travel_rad > options.max_travel_rad ? Reach::Status::jump
                                                         : Reach::Status::found;
  return out;
}

Followed follow(const Arm& arm, const SphericalWristInverse& inverse, const std::vector<Eigen::Isometry3d>& flanges,
                const std::optional<Position6>& start, const ChooseOptions& options) {
  options.validate();
  require_six(arm);
  if (flanges.empty()) throw InvalidInput("flanges", "must hold at least one pose");
  if (start) return follow_from(arm, inverse, flanges, *start, options);
  const Position6 from = middle(arm);
  // Where no way stands within limits, the nearest one says why.
  Followed best = follow_from(arm, inverse, {flanges.front()}, from, options);
  Arm free = arm;
  for (Joint& joint : free.joints) {
    joint.min_position = -HUGE_VAL;
    joint.max_position = HUGE_VAL;
  }
  const InverseSolutions first = inverse.solve(flanges.front(), from);
  bool any = false;
  for (int k = 0; k < first.count; ++k) {
    const Position6& start_k = first.solution[static_cast<std::size_t>(k)].position_rad;
    const Followed unlimited = follow_from(free, inverse, flanges, start_k, options);
    const Position6 shifted = shifted_start(arm, unlimited, start_k, from);
    const Placed placed = place(arm, shifted, shifted, options.weight);
    if (placed.joint >= 0) continue;
    Followed way = follow_from(arm, inverse, flanges, placed.position_rad, options);
    const bool better =
        way.reached > best.reached || (way.reached == best.reached && way.largest_travel_rad < best.largest_travel_rad);
    if (!any || better) best = std::move(way);
    any = true;
  }
  return best;
}

NearResult solve_near(const Arm& arm, const Eigen::Isometry3d& flange, const Eigen::Ref<const Eigen::VectorXd>& seed,
                      const NearOptions& options) {
  options.validate();
  if (!flange.matrix().allFinite()) throw InvalidInput("flange", "must be finite");
  NearResult out{.position = seed};
  if (seed.size() != arm.size()) {
    throw InvalidInput("position", static_cast<double>(seed.size()), "joints",
                       "must have one value a joint, " + std::to_string(arm.size()));
  }
  if (!seed.allFinite()) throw InvalidInput("position", "must be finite");
  const NewtonEnd end = newton(arm, flange, out.position, options);
  out.error_m = end.error_m;
  out.error_rad = end.error_rad;
  if (out.error_m <= options.tolerance_m && out.error_rad <= options.tolerance_rad) {
    out.status = NearResult::Status::converged;
  }
  return out;
}

}  // namespace robomill::robot
