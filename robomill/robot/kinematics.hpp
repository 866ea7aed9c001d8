#pragma once
#include <Eigen/Core>

#include "robomill/base/export.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/robot/pose.hpp"

// Method: robomill/robot/README.md, "Following a tool, with derivatives"

namespace robomill::robot {

/// What the drives of a machine can do; entries beyond its joints are 0. Rad or m, by joint. A position is within
/// limits where min_position <= q <= max_position.
struct ROBOMILL_API JointLimits {
  Position6 min_position = Position6::Constant(-1e300), max_position = Position6::Constant(1e300);
  Position6 max_velocity = Position6::Zero(), max_acceleration = Position6::Zero(), max_jerk = Position6::Zero();
  /// @param joints  how many
  /// @throws InvalidInput naming the member ("max_jerk[2]", counted from 1): limits that are not > 0, min >= max
  void validate(int joints) const;
};

/// A tool's pose along a parameter u with its derivatives by u; columns 0 to 3 hold the value and derivatives 1 to 3.
/// In the work frame W; the axis stays a unit vector (its derivatives say so).
struct ToolJet {
  Eigen::Matrix<double, 3, 4> tip_m = Eigen::Matrix<double, 3, 4>::Zero();
  Eigen::Matrix<double, 3, 4> axis = Eigen::Matrix<double, 3, 4>::Zero();
  Eigen::Matrix<double, 1, 4> gamma_rad = Eigen::Matrix<double, 1, 4>::Zero();
};

/// Joints along u: q, q', q'', q''' in columns 0 to 3; rows beyond the machine's joints are 0.
using JointJet = Eigen::Matrix<double, 6, 4>;

/// Whether a pose can be taken, and if not, why.
struct Reach {
  enum class Status {
    found,           ///< the pose is taken, and the joints can follow it
    out_of_reach,    ///< no position reaches the pose, whatever the limits
    outside_limits,  ///< the position found has `joint` beyond its limits; in closed form every position has one
    singular,        ///< the joints cannot follow a motion in some direction: condition number > max_condition_number
    jump             ///< reached, but a joint is farther than max_travel_rad or max_travel_m from the position before
  };
  Status status = Status::out_of_reach;
  int joint = -1;       ///< the one beyond its limit, or at fault in a singularity, from 0; -1 where none is
  double beyond = 0.0;  ///< outside limits: of that joint beyond its limit [rad or m]; out of reach: by how much [m],
                        ///< [rad] where only the wrist cannot bend far enough, 0 where there is no such number
};

/// Which of its ways to a pose an arm takes, and how far it is from where two ways meet.
struct Configuration {
  bool known = false;          ///< false of machines that have no such ways in closed form
  bool parallel_axes = false;  ///< axes 2, 3 and 4 are parallel; else the wrist is spherical
  bool shoulder_back = false;  ///< as InverseSolution, the next five too; of parallel axes see robot/README.md
  bool elbow_down = false;
  bool wrist_flipped = false;
  double shoulder_m = 0.0;
  double elbow_rad = 0.0;
  double wrist_rad = 0.0;
};

/// A machine that puts a tool at poses: up to six joints, one position followed from pose to pose.
class ROBOMILL_API Kinematics {
 public:
  Kinematics() = default;
  Kinematics(const Kinematics&) = delete;
  Kinematics& operator=(const Kinematics&) = delete;
  Kinematics(Kinematics&&) = delete;
  Kinematics& operator=(Kinematics&&) = delete;
  virtual ~Kinematics() = default;

  /// Number of joints, n <= 6.
  [[nodiscard]] virtual int joints() const noexcept = 0;
  [[nodiscard]] virtual const JointLimits& limits() const noexcept = 0;
  /// Whether gamma means anything to the machine.
  [[nodiscard]] virtual bool turns_about_axis() const noexcept = 0;
  /// All positions within limits (turns by ±2π too) that reach a pose; at most `room` of them into `out`, their number.
  [[nodiscard]] virtual int all(const ToolPose& pose, Position6* out, int room) const noexcept = 0;
  /// The position for a pose that is nearest to one before. Allocates nothing.
  [[nodiscard]] virtual Reach follow(const ToolPose& pose, const Position6& near,
                                     Position6& position) const noexcept = 0;
  /// The joints with their derivatives along u, exact: those of follow() and what implicit differentiation of the
  /// forward kinematics gives. Allocates nothing.
  [[nodiscard]] virtual Reach follow(const ToolJet& jet, const Position6& near, JointJet& joints) const noexcept = 0;
  /// The tool's pose that a position makes.
  [[nodiscard]] virtual ToolPose forward(const Position6& position) const noexcept = 0;
  /// How far a position is from a singularity, in (0, 1]: 1 / condition number of the machine's Jacobian, lengths in
  /// units of a characteristic length.
  [[nodiscard]] virtual double regularity(const Position6& position) const noexcept = 0;
  [[nodiscard]] virtual Configuration configuration(const Position6& /*position*/) const noexcept { return {}; }
};

}  // namespace robomill::robot
