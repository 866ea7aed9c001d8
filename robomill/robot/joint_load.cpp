#include "robomill/robot/joint_load.hpp"

#include <algorithm>
#include <cmath>
#include <kdl/chaindynparam.hpp>
#include <limits>
#include <string>

#include "robomill/base/error.hpp"
#include "robomill/robot/dynamics.hpp"
#include "robomill/robot/kinematics/kdl_chain.hpp"

namespace robomill::robot {
namespace {

void require_rates(const char* field, const Eigen::VectorXd& rates, const Arm& arm) {
  if (rates.size() == 0) return;
  if (rates.size() != arm.size()) {
    throw InvalidInput(field, static_cast<double>(rates.size()), "joints",
                       "must have one value a joint, " + std::to_string(arm.size()) + ", or none");
  }
  if (!rates.allFinite()) throw InvalidInput(field, "must be finite");
}

void require_wrench(const Wrench& wrench) {
  if (!wrench.force_n.allFinite()) throw InvalidInput("wrench.force_n", "must be finite");
  if (!wrench.moment_n_m.allFinite()) throw InvalidInput("wrench.moment_n_m", "must be finite");
}

/// Of each joint whether it and all that it carries have a mass.
std::vector<JointLoad::Status> mass_statuses(const Arm& arm) {
  std::vector<JointLoad::Status> out(arm.joints.size(), JointLoad::Status::mass_unknown);
  for (std::size_t i = arm.joints.size(); i-- > 0 && arm.joints[i].link.mass_kg > 0.0;) {
    out[i] = JointLoad::Status::known;
  }
  return out;
}

/// −Jᵀ F, a value a joint.
Eigen::VectorXd drive_against(const Eigen::Matrix<double, 6, Eigen::Dynamic>& jac, const Wrench& wrench) {
  return -(jac.topRows<3>().transpose() * wrench.force_n + jac.bottomRows<3>().transpose() * wrench.moment_n_m);
}

/// J at the point, of an arm and a position that are checked.
Eigen::Matrix<double, 6, Eigen::Dynamic> checked_jacobian(const Arm& arm,
                                                          const Eigen::Ref<const Eigen::VectorXd>& position,
                                                          const Eigen::Vector3d& point_m,
                                                          const JointLoadOptions& options) {
  arm.validate();
  options.validate(arm);
  if (!point_m.allFinite()) throw InvalidInput("point_m", "must be finite");
  return jacobian(arm, position, point_m);
}

/// All but what the wrench asks for.
std::vector<JointLoad> loads_of_masses(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position,
                                       const JointLoadOptions& options) {
  const auto n = static_cast<unsigned>(arm.size());
  const KDL::Chain chain = kdl_chain(arm);
  const Eigen::Vector3d& g = options.gravity_m_per_s2;
  KDL::ChainDynParam solver(chain, KDL::Vector(g.x(), g.y(), g.z()));
  KDL::JntArray at(n), speed(n), gravity(n), coriolis(n);
  at.data = position;
  solver.JntToGravity(at, gravity);
  if (options.velocity.size() > 0) {
    speed.data = options.velocity;
    solver.JntToCoriolis(at, speed, coriolis);
  }
  Eigen::VectorXd inertia = Eigen::VectorXd::Zero(arm.size());
  if (options.acceleration.size() > 0) inertia = mass_matrix(arm, position) * options.acceleration;
  const std::vector<JointLoad::Status> status = mass_statuses(arm);
  std::vector<JointLoad> out(arm.joints.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].status = status[i];
    if (status[i] == JointLoad::Status::mass_unknown) continue;
    const auto row = static_cast<Eigen::Index>(i);
    out[i].gravity = gravity.data(row);
    out[i].inertia = inertia(row);
    out[i].coriolis = coriolis.data(row);
  }
  return out;
}

/// Steiner: about a centre that is `away_m` from the body's own.
Eigen::Matrix3d inertia_about(const Link& link, const Eigen::Vector3d& away_m) {
  return link.inertia_kg_m2 +
         link.mass_kg * (away_m.squaredNorm() * Eigen::Matrix3d::Identity() - away_m * away_m.transpose());
}

/// Of each joint the torque up to which it has no sign.
std::vector<double> thresholds(std::span<const LoadedBlock> blocks, double share) {
  std::vector<double> out(blocks.front().joints.size(), 0.0);
  for (const LoadedBlock& block : blocks) {
    if (!block.cuts) continue;
    for (std::size_t j = 0; j < out.size(); ++j) {
      const JointLoadRange& load = block.joints[j];
      if (load.status == JointLoad::Status::known) out[j] = std::max({out[j], std::abs(load.min), std::abs(load.max)});
    }
  }
  for (double& value : out) value *= share;
  return out;
}

void require_ranges(std::span<const LoadedBlock> blocks) {
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const std::string path = "blocks[" + std::to_string(k + 1) + "].joints";
    if (blocks[k].joints.size() != blocks.front().joints.size()) {
      throw InvalidInput(path, static_cast<double>(blocks[k].joints.size()), "joints",
                         "must hold as many as the first block, " + std::to_string(blocks.front().joints.size()));
    }
    for (std::size_t j = 0; j < blocks[k].joints.size(); ++j) {
      const JointLoadRange& load = blocks[k].joints[j];
      if (std::isfinite(load.min) && std::isfinite(load.max) && load.min <= load.max) continue;
      throw InvalidInput(path + "[" + std::to_string(j + 1) + "]", "must hold finite torques, min <= max");
    }
  }
}

}  // namespace

void JointLoadOptions::validate(const Arm& arm) const {
  if (!gravity_m_per_s2.allFinite()) throw InvalidInput("gravity_m_per_s2", "must be finite");
  require_rates("velocity", velocity, arm);
  require_rates("acceleration", acceleration, arm);
}

std::optional<double> JointLoad::torque() const {
  if (status == Status::mass_unknown) return std::nullopt;
  return gravity + inertia + coriolis + wrench;
}

std::vector<JointLoad> joint_loads(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position,
                                   const Eigen::Vector3d& point_m, const Wrench& wrench,
                                   const JointLoadOptions& options) {
  const Eigen::Matrix<double, 6, Eigen::Dynamic> jac = checked_jacobian(arm, position, point_m, options);
  require_wrench(wrench);
  std::vector<JointLoad> out = loads_of_masses(arm, position, options);
  const Eigen::VectorXd against = drive_against(jac, wrench);
  for (std::size_t i = 0; i < out.size(); ++i) out[i].wrench = against(static_cast<Eigen::Index>(i));
  return out;
}

Arm with_payload(const Arm& arm, const Link& payload) {
  arm.validate();
  require_positive("payload.mass_kg", payload.mass_kg, "kg");
  Arm out = arm;
  Link& link = out.joints.back().link;
  const Link own = link;
  link.mass_kg = own.mass_kg + payload.mass_kg;
  link.center_m = (own.mass_kg * own.center_m + payload.mass_kg * payload.center_m) / link.mass_kg;
  link.inertia_kg_m2 =
      inertia_about(own, own.center_m - link.center_m) + inertia_about(payload, payload.center_m - link.center_m);
  out.validate();
  return out;
}

std::vector<JointLoadRange> joint_load_ranges(const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position,
                                              const Eigen::Vector3d& point_m, std::span<const Wrench> wrenches,
                                              const JointLoadOptions& options) {
  if (wrenches.empty()) throw InvalidInput("wrenches", "must hold at least one");
  const Eigen::Matrix<double, 6, Eigen::Dynamic> jac = checked_jacobian(arm, position, point_m, options);
  const std::vector<JointLoad> own = loads_of_masses(arm, position, options);
  Eigen::VectorXd low = Eigen::VectorXd::Constant(arm.size(), std::numeric_limits<double>::infinity()), high = -low;
  for (const Wrench& wrench : wrenches) {
    require_wrench(wrench);
    const Eigen::VectorXd against = drive_against(jac, wrench);
    low = low.cwiseMin(against).eval();
    high = high.cwiseMax(against).eval();
  }
  std::vector<JointLoadRange> out(own.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].status = own[i].status;
    const std::optional<double> steady = own[i].torque();
    if (!steady) continue;
    out[i].min = *steady + low(static_cast<Eigen::Index>(i));
    out[i].max = *steady + high(static_cast<Eigen::Index>(i));
  }
  return out;
}

std::optional<double> torque_share(const Joint& joint, const JointLoadRange& load) {
  if (load.status != JointLoad::Status::known || !(joint.max_torque > 0.0)) return std::nullopt;
  return std::max(std::abs(load.min), std::abs(load.max)) / joint.max_torque;
}

void ReversalOptions::validate() const {
  if (!(least_share >= 0.0 && least_share < 1.0)) {
    throw InvalidInput("least_share", least_share, "", "must be in [0, 1)",
                       "It is a share of the joint's largest load");
  }
}

std::vector<LoadReversal> load_reversals(std::span<const LoadedBlock> blocks, const ReversalOptions& options) {
  options.validate();
  require_ranges(blocks);
  std::vector<LoadReversal> out;
  if (blocks.empty()) return out;
  const std::vector<double> least = thresholds(blocks, options.least_share);
  std::vector<int> sign(least.size(), 0);  // of each joint's load when it last had one alone
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    for (std::size_t j = 0; j < least.size(); ++j) {
      const JointLoadRange& load = blocks[k].joints[j];
      if (!blocks[k].cuts || load.status != JointLoad::Status::known) {
        sign[j] = 0;
        continue;
      }
      const bool down = load.min<-least[j], up = load.max> least[j];
      if (!down && !up) continue;
      const int now = down && up ? 0 : (up ? 1 : -1);
      if (now == 0 || now * sign[j] < 0) {
        out.push_back({.block = k,
                       .joint = static_cast<Eigen::Index>(j),
                       .kind = now == 0 ? LoadReversal::Kind::within : LoadReversal::Kind::between});
      }
      sign[j] = now;
    }
  }
  return out;
}

}  // namespace robomill::robot
