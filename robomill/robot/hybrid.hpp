#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

#include "robomill/base/export.hpp"
#include "robomill/robot/kinematics.hpp"
#include "robomill/robot/stiffness.hpp"

// Method: robomill/robot/README.md, "Following a tool, with derivatives"

namespace robomill::robot {

/// The five-axis hybrid machine 2-UPR-RPU + two slides; docs/frames.md draws it. Base points A1 = (a, 0, 0),
/// A2 = (−a, 0, 0), A3 = (0, e, 0); platform points B1 = (b, 0, 0), B2 = (−b, 0, 0), B3 = (0, c, 0) in the platform's
/// frame, which stands at o = Rx(α) (0, 0, ℓ), turned by R = Rx(α) Ry(β), in a carriage that slides by (X, Y, 0).
/// The tool points along +z of the platform. Joints: q1, q2 the UPR legs, q3 the RPU leg, q4 = X, q5 = Y, all in m.
struct ROBOMILL_API HybridMachine {
  double base_half_width_m = 0.300;                             ///< a > 0
  double platform_half_width_m = 0.120;                         ///< b > 0
  double platform_offset_m = 0.120;                             ///< c
  double base_offset_m = 0.300;                                 ///< e > 0
  double platform_to_flange_m = 0.050;                          ///< >= 0; with the tool's length it makes h
  double tool_length_m = 0.0;                                   ///< >= 0; from the flange to the tip
  Eigen::Isometry3d workpiece = Eigen::Isometry3d::Identity();  ///< work frame W in the machine's frame
  JointLimits limits = {};
  /// @throws InvalidInput naming the member; of the limits only that min < max
  void validate() const;
  /// h, from the platform's point o to the tip [m].
  [[nodiscard]] double tool_offset_m() const { return platform_to_flange_m + tool_length_m; }
};

/// Where the platform stands in its carriage.
struct PlatformPose {
  double alpha_rad = 0.0, beta_rad = 0.0;  ///< R = Rx(α) Ry(β), |β| < π/2
  double height_m = 0.0;                   ///< ℓ
};

struct ROBOMILL_API HybridOptions {
  SingularityOptions singularity = {};  ///< of the Jacobian of the five joints by the tip and the axis
  double max_travel_m = HUGE_VAL;       ///< > 0; jump where max |q − near| > this, q the joints, near those before
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// Kinematics of the hybrid machine, in closed form. With t = −axis and the tip P in the machine's frame
///     sin β = t_x,  (cos α, sin α) = (t_z, −t_y) / cos β,  ℓ = P_z / cos α − h cos β,
///     X = P_x − h sin β,  Y = P_y + P_z tan α,
///     q1² = (b cos β − a)² + (ℓ − b sin β)²,  q2² = (b cos β − a)² + (ℓ + b sin β)²,
///     q3² = c² + ℓ² + e² − 2 e (c cos α − ℓ sin α).
/// One branch, and gamma means nothing. The legs do not hold the platform (singular) at ℓ² cos β = a b sin² β (legs 1
/// and 2) and with B3 in the base's plane, c sin α + ℓ cos α = 0 (leg 3); the platform stands above both. Out of reach:
/// below them (by how much ℓ is short), and t_z <= 0 (the tool would point back at the base).
class ROBOMILL_API HybridKinematics final : public Kinematics {
 public:
  /// @throws InvalidInput naming the member of the machine or the options
  explicit HybridKinematics(const HybridMachine& machine, const HybridOptions& options = {});

  [[nodiscard]] const HybridMachine& machine() const noexcept { return machine_; }
  /// The platform for three leg lengths: ℓ² is the largest root m of m (m − S)² + 4 a² (D² − b² m) = 0 with
  /// S = (q1² + q2²)/2 − a² − b² and D = (q2² − q1²)/4; not finite where no platform fits the legs.
  [[nodiscard]] PlatformPose platform(const Position6& position) const noexcept;

  [[nodiscard]] int joints() const noexcept override { return 5; }
  [[nodiscard]] const JointLimits& limits() const noexcept override { return machine_.limits; }
  [[nodiscard]] bool turns_about_axis() const noexcept override { return false; }
  [[nodiscard]] int all(const ToolPose& pose, Position6* out, int room) const noexcept override;
  [[nodiscard]] Reach follow(const ToolPose& pose, const Position6& near, Position6& position) const noexcept override;
  [[nodiscard]] Reach follow(const ToolJet& jet, const Position6& near, JointJet& joints) const noexcept override;
  [[nodiscard]] ToolPose forward(const Position6& position) const noexcept override;
  [[nodiscard]] double regularity(const Position6& position) const noexcept override;

  /// A PlatformPose by the sines and cosines of its angles.
  struct Stand {
    double sin_alpha = 0.0, cos_alpha = 1.0, sin_beta = 0.0, cos_beta = 1.0, height_m = 0.0;
  };

 private:
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  using Row5 = Eigen::Matrix<double, 1, 5>;
  /// ∂(joints)/∂(tip, axis), the axis' two angles times the characteristic length, and its inverse.
  struct Rates {
    Matrix5 forth = Matrix5::Zero(), back = Matrix5::Zero();
  };
  [[nodiscard]] Rates rates(const Position6& position, const Stand& at) const noexcept;
  [[nodiscard]] Reach check(const Position6& position, const Position6& near, const Stand& at) const noexcept;

  HybridMachine machine_;
  HybridOptions options_;
};

}  // namespace robomill::robot
