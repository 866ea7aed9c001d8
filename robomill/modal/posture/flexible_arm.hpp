#pragma once
#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "robomill/modal/modes.hpp"
#include "robomill/robot/arm.hpp"

// Method: robomill/modal/README.md, "Modes over posture (`posture_model.hpp`)"

namespace robomill::modal::detail {

/// Which compliances a model of an arm has beside the turning of its joints.
struct ArmStructure {
  bool bearings = false;  ///< each joint tilts about two axes across its own
  bool bracket = false;   ///< what hangs on the flange turns on it about three axes
  int tool_modes = 0;     ///< masses on springs across the flange's z, each on the one before: spindle, tool
  /// Where the search starts: of the last link's mass, what does not ride on the bracket.
  double inner_share = 0.25;
  bool load = false;  ///< a joint's stiffness depends on the weight that it carries
};

/// Of ArmParameter::Kind::compliance.
inline constexpr double compliance_unit_m_per_n = 1e-8;

/// One number that a calibration may change.
struct ArmParameter {
  enum class Kind {
    joint_stiffness,    ///< ln of [N m/rad]
    joint_damping,      ///< ln of [N m s/rad]
    joint_load,         ///< slope of ln stiffness over |gravity torque| / its largest
    joint_unloaded,     ///< ln stiffness gained where a joint carries no weight: backlash makes it negative
    tilt_stiffness,     ///< ln
    tilt_damping,       ///< ln
    bracket_stiffness,  ///< an entry of the logarithm of its matrix
    bracket_damping,    ///< the same
    bracket_pivot,      ///< [m], what it turns about, from the flange along an axis of its frame
    tool_mass,          ///< ln of [kg]
    tool_stiffness,     ///< an entry of the logarithm of its matrix
    tool_damping,       ///< the same
    compliance,         ///< of the tip in flange axes [compliance_unit_m_per_n]: modes above those of the model
    rotor_inertia,      ///< ln
    body_mass,          ///< ln of mass and inertia together
    body_inertia,       ///< ln of the inertia alone
    body_center         ///< [m], along one axis of the link's frame
  };
  Kind kind = Kind::joint_stiffness;
  std::size_t index = 0;         ///< of the joint, coordinate, body or axis
  std::size_t axis = 0;          ///< of body_center; of a matrix the column less the row, which is `index`
  double start = 0.0;            ///< where the calibration starts
  double deviation = 1.0;        ///< prior standard deviation about the start
  double posture_deviation = 0;  ///< by how much it may differ from posture to posture; 0: it does not
};

[[nodiscard]] bool is_stiffness(ArmParameter::Kind kind);  ///< of a spring
[[nodiscard]] bool is_damping(ArmParameter::Kind kind);    ///< of a damper
/// A x = a × x.
[[nodiscard]] Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a);

/// tr(J Σ Jᴴ), the variances of J δ together; >= 0. @param by  J @param covariance  Σ of δ
[[nodiscard]] double total_variance(const Eigen::MatrixXcd& by, const Eigen::MatrixXd& covariance);

/// A serial arm with compliant joints that carries a spindle and a tool, M ẍ + C ẋ + K x = Bᵀ F with x the small turns
/// and displacements of its structure. Rigid bodies and geometry are the cell's; the parameters are those listed.
class FlexibleArm {
 public:
  struct Tool {
    double frequency_hz = 0.0, mass_kg = 0.0;
  };
  /// @param payload  what hangs on the flange beside the last link
  FlexibleArm(const robot::Cell& cell, const std::optional<robot::Link>& payload, const ArmStructure& structure,
              const std::vector<Tool>& tools);

  [[nodiscard]] const std::vector<ArmParameter>& parameters() const { return parameters_; }
  [[nodiscard]] const ArmStructure& structure() const { return structure_; }
  [[nodiscard]] const std::vector<Tool>& tools() const { return tools_; }
  [[nodiscard]] Eigen::VectorXd start() const;
  /// Sets the largest gravity torques, which the load is counted from.
  void scale_loads(const std::vector<Eigen::VectorXd>& postures);

  /// A rigid body's motion by the coordinates.
  struct BodyMotion {
    double mass_kg = 0.0;
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();   ///< in B
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< of the link's frame, in B
    Eigen::Matrix3Xd linear, turning;                    ///< 3 x n: of its centre, and angular
    bool on_bracket = false;
  };
  /// A mass of the spindle's and tool's chain.
  struct ToolMotion {
    double mass_kg = 0.0;
    Eigen::MatrixXd input;  ///< n x 3, B_t
  };
  /// What a unit of a parameter adds to K and C, from one coordinate on.
  struct SpringChange {
    Eigen::Index first = 0, count = 0;  ///< 0: nothing
    Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero(), damping = Eigen::Matrix3d::Zero();
  };
  /// The structure at one posture.
  struct System {
    Eigen::MatrixXd mass, stiffness, damping;  ///< n x n
    Eigen::MatrixXd input;                     ///< n x 3, the tip's Jacobian in B
    std::vector<SpringChange> springs;         ///< of each parameter
    Eigen::Matrix3d flange_axes = Eigen::Matrix3d::Identity();
    Eigen::Vector3d compliance = Eigen::Vector3d::Zero();  ///< in flange axes [m/N]
    Eigen::VectorXd load;                                  ///< of each joint, |gravity torque| over its largest
    Eigen::VectorXd rotor;                                 ///< length n: inertia of the drives
    std::vector<BodyMotion> bodies;
    std::vector<ToolMotion> tools;
  };
  [[nodiscard]] System at(const Eigen::VectorXd& joints, const Eigen::VectorXd& parameters) const;

  /// H(s), 3 x 3 in B.
  static Eigen::Matrix3cd receptance(const System& system, std::complex<double> s);
  class ReceptanceLines;  // the same at many s, with derivatives

  /// Modes up to a frequency at the tip in B, the rest as a compliance.
  struct Modes {
    Eigen::VectorXcd pole;     ///< length m, rising
    Eigen::MatrixXcd shape;    ///< n x m, ψᵀ (C + 2 λ M) ψ = 1
    Eigen::Matrix3Xcd at_tip;  ///< 3 x m: R = L
    Eigen::Matrix3d rest;      ///< [m/N]
  };
  [[nodiscard]] Modes modes(const System& system, double highest_hz) const;
  /// ∂ ln f, ∂ ζ and ‖∂(R Rᵀ)‖ over ‖R Rᵀ‖ of each mode by each parameter, m x parameters each.
  struct Sensitivity {
    Eigen::MatrixXd log_frequency, damping_ratio;
    std::vector<Eigen::MatrixXcd> residue;  ///< of each mode, 9 x parameters, over ‖R Rᵀ‖
  };
  [[nodiscard]] Sensitivity sensitivity(const System& system, const Modes& modes) const;

 private:
  struct Coordinate {
    enum class Kind { joint, tilt, bracket, tool } kind = Kind::joint;
    std::size_t joint = 0, pair = 0;
    Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< in the frame before the joint turns, or of the flange
  };
  /// Coordinates that have one matrix of stiffness and one of damping.
  struct Group {
    Coordinate::Kind kind = Coordinate::Kind::joint;
    std::size_t first = 0, count = 1;
  };
  struct Body {
    std::size_t joint = 0;  ///< that moves it
    bool on_bracket = false;
    bool loose = false;  ///< a part of a link, told with the rest of it
    robot::Link link;
  };
  struct Placed;  // where the coordinates act in a posture
  void add(ArmParameter::Kind kind, std::size_t index, double start, double deviation, double posture_deviation = 0.0,
           std::size_t axis = 0);
  void split_last_link();
  void add_coordinates();
  [[nodiscard]] double first_stiffness(const Coordinate& at, const std::vector<Tool>& tools) const;
  void add_group_parameters(const Group& group, const std::vector<Tool>& tools, const System& plain);
  void add_mass_parameters(const std::vector<Tool>& tools);
  [[nodiscard]] bool translates(const Coordinate& at) const;
  [[nodiscard]] Eigen::VectorXd gravity_torque(const Eigen::VectorXd& joints) const;
  [[nodiscard]] Placed place(const Eigen::VectorXd& joints, const Eigen::VectorXd& parameters) const;
  void set_springs(const Eigen::VectorXd& parameters, System& out) const;
  void set_joint_springs(const Eigen::VectorXd& parameters, System& out) const;
  void add_bodies(const Placed& placed, const Eigen::VectorXd& parameters, System& out) const;
  void add_tools(const Eigen::VectorXd& parameters, System& out) const;
  [[nodiscard]] Eigen::Index joint_row(std::size_t joint) const;
  /// What the tip's input has more as the bracket's pivot moves: ∂Bᵀ x.
  [[nodiscard]] Eigen::Matrix3Xcd pivot_change(const System& system, std::size_t axis, const Eigen::MatrixXcd& x) const;
  struct Spanned;  // what modes move
  /// Yᵀ ∂M X by a parameter of mass, Y the modes and their conjugates, X the modes.
  [[nodiscard]] Eigen::MatrixXcd mass_change(const System& system, const ArmParameter& parameter,
                                             const Spanned& by) const;

  robot::Cell cell_;
  ArmStructure structure_;
  std::vector<Tool> tools_;  ///< as they were told
  std::vector<Coordinate> coordinates_;
  std::vector<Group> groups_;
  std::vector<Body> bodies_;
  std::vector<ArmParameter> parameters_;
  Eigen::Index bracket_row_ = 0;  ///< its first coordinate
  Eigen::VectorXd largest_load_;
};

}  // namespace robomill::modal::detail
