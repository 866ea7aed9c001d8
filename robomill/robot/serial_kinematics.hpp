#pragma once
#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "robomill/base/export.hpp"
#include "robomill/robot/arm.hpp"
#include "robomill/robot/inverse.hpp"
#include "robomill/robot/kinematics.hpp"
#include "robomill/robot/stiffness.hpp"

// Method: robomill/robot/README.md, "Following a tool, with derivatives"

namespace robomill::robot {

struct ROBOMILL_API SerialOptions {
  SingularityOptions singularity = {};  ///< of the Jacobian at the tool's tip
  double max_travel_rad = HUGE_VAL;     ///< > 0; jump where max |q − near| > this, q the joints, near those before
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// A serial arm of six revolute joints that carries a tool: in closed form where the wrist is spherical
/// (SphericalWristInverse), else by damped Newton steps from the position before.
///
/// Derivatives: with the twist V = (tip', Ω) of the flange at the tip, its angular velocity in W
///     Ω = o × o' + (γ' − (i j' − j i') / (1 + k)) o,    o = axis = (i, j, k)
/// (the twist of the reference from which γ counts is the second term), and joint screws S_i at the tip,
///     J q' = V,   J q'' = V' − Σ S_i' q_i',   J q''' = V'' − Σ (2 S_i' q_i'' + S_i'' q_i')
/// with S_i' = V_{i−1} × S_i along the chain, V_i = V_{i−1} + S_i q_i'. V is taken at the point of space where the tip
/// is. Where the axis is −z of W gamma has no direction to count from: singular, no joint at fault.
class ROBOMILL_API SerialKinematics final : public Kinematics {
 public:
  /// Position limits, velocities, accelerations and jerks are the joints' own.
  /// @throws InvalidInput naming the member: "cell.arm.joints" unless it has six, all revolute
  explicit SerialKinematics(const Cell& cell, const SerialOptions& options = {});

  [[nodiscard]] const Cell& cell() const noexcept { return cell_; }
  /// Whether all branches of a pose are known in closed form.
  [[nodiscard]] bool closed_form() const noexcept { return inverse_.has_value(); }

  [[nodiscard]] int joints() const noexcept override { return 6; }
  [[nodiscard]] const JointLimits& limits() const noexcept override { return limits_; }
  [[nodiscard]] bool turns_about_axis() const noexcept override { return true; }
  [[nodiscard]] int all(const ToolPose& pose, Position6* out, int room) const noexcept override;
  [[nodiscard]] Reach follow(const ToolPose& pose, const Position6& near, Position6& position) const noexcept override;
  [[nodiscard]] Reach follow(const ToolJet& jet, const Position6& near, JointJet& joints) const noexcept override;
  [[nodiscard]] ToolPose forward(const Position6& position) const noexcept override;
  [[nodiscard]] double regularity(const Position6& position) const noexcept override;
  [[nodiscard]] Configuration configuration(const Position6& position) const noexcept override;

 private:
  struct Screws;
  [[nodiscard]] Reach reach(const ToolPose& pose, const Position6& near, Position6& position,
                            Screws& screws) const noexcept;
  [[nodiscard]] int search(const Eigen::Isometry3d& flange, Position6* branches) const noexcept;
  [[nodiscard]] Reach place(const Eigen::Isometry3d& flange, const Position6& near, Position6& position,
                            Posture& posture) const noexcept;
  void undo(const Posture& posture, Screws& screws) const noexcept;

  Cell cell_;
  SerialOptions options_;
  JointLimits limits_;
  std::optional<SphericalWristInverse> inverse_;
  bool parallel_axes_ = false;
};

}  // namespace robomill::robot
