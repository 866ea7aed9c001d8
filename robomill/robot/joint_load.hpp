#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/base/units.hpp"
#include "robomill/robot/arm.hpp"
#include "robomill/robot/stiffness.hpp"

// Method: robomill/robot/README.md, "Joint loads (`joint_load.hpp`)"

namespace robomill::robot {

/// Torques (forces where the joint is prismatic) are in N m (N), positive along the joint's axis.
struct ROBOMILL_API JointLoadOptions {
  /// In B. A base that stands tilted has it elsewhere than along −z.
  Eigen::Vector3d gravity_m_per_s2 = {0.0, 0.0, -units::standard_gravity};
  Eigen::VectorXd velocity = {};      ///< length n [rad/s or m/s]; empty: at rest
  Eigen::VectorXd acceleration = {};  ///< length n [rad/s² or m/s²]; empty: zero
  /// @throws InvalidInput naming the member
  void validate(const Arm& arm) const;
};

/// What the drive of one joint gives, and what for.
struct ROBOMILL_API JointLoad {
  enum class Status {
    known,        ///< every link that the joint moves has a mass
    mass_unknown  ///< one of them has none (mass_kg = 0): what it weighs is not known, and not taken as nothing
  };
  Status status = Status::mass_unknown;
  double gravity = 0.0;   ///< g(q); zero where mass_unknown, as the next two
  double inertia = 0.0;   ///< M(q) q̈, with the rotors
  double coriolis = 0.0;  ///< C(q, q̇) q̇
  double wrench = 0.0;    ///< −Jᵀ F, known always
  /// τ, the sum of the four; none where mass_unknown.
  [[nodiscard]] std::optional<double> torque() const;
};

/// τ of the equation of motion, by joint:
///     M(q) q̈ + C(q, q̇) q̇ + g(q) = τ + Jᵀ F,    g = ∂V/∂q
/// τ is what the drive must give: at rest it holds the weight up (g) and opposes what the wrench F on the robot would
/// turn (−Jᵀ F). Friction and the springs or weights of a balancer are not in it.
/// @param position  length n
/// @param point_m   where F attacks, in the flange frame
/// @param wrench    F, ON THE ROBOT, in B
/// @throws InvalidInput if the arm or an option is not valid, a length is not n, or a number is not finite
[[nodiscard]] ROBOMILL_API std::vector<JointLoad> joint_loads(const Arm& arm,
                                                              const Eigen::Ref<const Eigen::VectorXd>& position,
                                                              const Eigen::Vector3d& point_m, const Wrench& wrench = {},
                                                              const JointLoadOptions& options = {});

/// The arm with what hangs on its flange made part of the last link: masses add up, about their common centre. A last
/// link without a mass of its own then counts as one that has it.
/// @param payload  in the frame after the last joint, as the link is
/// @throws InvalidInput if the arm or the payload is not valid, or the payload has no mass
[[nodiscard]] ROBOMILL_API Arm with_payload(const Arm& arm, const Link& payload);

/// Between what a joint's load goes while the force swings.
struct JointLoadRange {
  JointLoad::Status status = JointLoad::Status::mass_unknown;
  double min = 0.0, max = 0.0;  ///< of τ, min <= max; zero where mass_unknown
};
/// Of every joint the lowest and highest τ over wrenches that attack one after the other in one posture: those of the
/// cut over a revolution. Each acts as if it stood still: vibration of the arm is not in it.
/// @param wrenches  one at least
/// @throws InvalidInput as joint_loads, or if there is no wrench
[[nodiscard]] ROBOMILL_API std::vector<JointLoadRange> joint_load_ranges(
    const Arm& arm, const Eigen::Ref<const Eigen::VectorXd>& position, const Eigen::Vector3d& point_m,
    std::span<const Wrench> wrenches, const JointLoadOptions& options = {});

/// max(|min|, |max|) over the joint's max_torque, above 1 where the drive cannot give it; none where the joint has no
/// limit or the load is not known.
[[nodiscard]] ROBOMILL_API std::optional<double> torque_share(const Joint& joint, const JointLoadRange& load);

/// A block of a program, or any other stretch, with the loads on its joints.
struct LoadedBlock {
  std::vector<JointLoadRange> joints = {};  ///< n; the same n in all blocks
  bool cuts = true;                         ///< whether the tool is in the cut
};

struct ROBOMILL_API ReversalOptions {
  /// In [0, 1): a torque of at most this share of the joint's largest, of all blocks that cut, has no sign: rounding is
  /// no reversal, and a joint whose axis gravity does not turn none in every block.
  double least_share = 1e-6;
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// A joint whose load turns round while it cuts: its gear leaves one flank for the other, and through the backlash in
/// between nothing holds the tool.
struct LoadReversal {
  enum class Kind {
    within,  ///< the block's own range holds both signs: at every revolution, or as gravity turns
    between  ///< the load has the other sign than when it last had one, in the same stretch of blocks that cut
  };
  std::size_t block = 0;   ///< from 0; of `between` the one with the new sign
  Eigen::Index joint = 0;  ///< from 0
  Kind kind = Kind::within;
};
/// Which joints reverse under load (`backlash reversal`) in which block, by block, then joint. A block that does not
/// cut or whose load is not known has none, and after it a joint's sign starts anew.
/// @throws InvalidInput if blocks differ in their number of joints, or a range is not finite or has min > max
[[nodiscard]] ROBOMILL_API std::vector<LoadReversal> load_reversals(std::span<const LoadedBlock> blocks,
                                                                    const ReversalOptions& options = {});

}  // namespace robomill::robot
