#pragma once
// Arms with a spindle whose true dynamics a simple model lacks, for judging models over postures.
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "robomill/modal/frf.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/robot/arm.hpp"

namespace robomill {
class Random;
}

namespace robomill::modal::testing {

class ArmDice;

/// How FRFs are measured.
struct Hammering {
  bool force_in_z = true;        ///< else the force columns x and y alone
  double noise_ratio = 0.05;     ///< deviation of a line's complex error, a share of |H|
  double first_line_hz = 5.0;    ///< [Hz]
  double last_line_hz = 700.0;   ///< [Hz]
  double line_spacing_hz = 1.0;  ///< [Hz]
};

/// A six-axis arm with a spindle, made from a seed. Even seeds: like a KR210, 1.1 t; odd ones: like a UR10, 30 kg.
///
/// M ẍ + C ẋ + K x = Tᵀ F about a posture. Coordinates x: each joint turns about its axis and tilts about two axes
/// across it, in its bearings; where (seed / 2) is odd the spindle's bracket tilts at the flange about two axes or
/// three; the tool is a chain of two masses on springs in two directions across its axis (its first pair of modes at
/// 300 to 550 Hz, its second above 600 Hz). Where (seed / 4) is odd the spindle lies across the last axis, else along
/// it. A joint's stiffness rises with what gravity asks of it and falls where backlash is not held to one side:
///     k = k0 (1 + a |τ| / τ_ref) (1 - b exp(-(τ / τ_hit)²)),  a <= 0.15, b <= 0.1.
/// The mass matrix is the kinetic energy of all bodies, Σ Jᵀ M J, written apart from robomill/robot/dynamics.
class SimulatedArm {
 public:
  explicit SimulatedArm(std::uint64_t seed);

  [[nodiscard]] bool is_heavy() const { return heavy_; }                    ///< like a KR210
  [[nodiscard]] int bracket_axes() const { return bracket_axes_; }          ///< 0: there is no bracket
  [[nodiscard]] bool is_spindle_across() const { return spindle_across_; }  ///< of the last axis

  /// The spindle frame in the flange frame: `flange` of the cells' arms has it folded in.
  [[nodiscard]] const Eigen::Isometry3d& mount() const { return mount_; }

  /// What somebody knows of it: geometry and joint limits exactly; links, rotors, stiffness and damping of the joints
  /// each off by up to 20 %. The last link holds the spindle; nothing is told of bearings, bracket and tool.
  [[nodiscard]] const robot::Cell& told() const { return told_; }
  /// The same without errors: rigid but for the joints, each with its k0.
  [[nodiscard]] const robot::Cell& exact() const { return exact_; }
  [[nodiscard]] const std::vector<Eigen::VectorXd>& measured_postures() const { return measured_; }  ///< 12
  [[nodiscard]] const std::vector<Eigen::VectorXd>& held_out_postures() const { return held_out_; }  ///< 8

  /// The n coordinates: 18 of the joints (turn, tilt, tilt; joint by joint), the bracket's, 4 of the tool.
  struct Matrices {
    Eigen::MatrixXd mass, damping, stiffness;  ///< n x n
    Eigen::Matrix3Xd tip;                      ///< T, 3 x n: displacement of the tip in the base axes
  };
  [[nodiscard]] Matrices matrices(const Eigen::VectorXd& joints) const;
  /// Modes of the tip in the base axes (point 0; x, y, z), those up to a frequency; what the others give at rest stands
  /// in the stiffness residuals.
  [[nodiscard]] ModalModel modes(const Eigen::VectorXd& joints, double up_to_hz = 700.0) const;
  /// T (-ω² M + iω C + K)⁻¹ Tᵀ, 3 x 3.
  [[nodiscard]] FrfSet receptance(const Eigen::VectorXd& joints, const Eigen::VectorXd& frequency_hz) const;
  /// The same with noise, and its deviation with each line.
  [[nodiscard]] FrfSet measure(const Eigen::VectorXd& joints, std::uint64_t seed,
                               const Hammering& hammering = {}) const;

 private:
  struct Pose;
  void make_links(ArmDice& dice);
  void make_springs(ArmDice& dice);
  void make_damping(ArmDice& dice);
  void tell(ArmDice& dice);
  void choose_postures(Random& random);
  [[nodiscard]] Pose pose(const Eigen::VectorXd& joints) const;
  [[nodiscard]] Eigen::Index size() const { return 18 + bracket_axes_ + 4; }
  [[nodiscard]] Eigen::MatrixXd mass(const Pose& pose) const;
  [[nodiscard]] Eigen::VectorXd stiffness(const Pose& pose) const;

  bool heavy_ = true, spindle_across_ = false;
  int bracket_axes_ = 0;
  robot::Cell exact_, told_;
  Eigen::Isometry3d mount_ = Eigen::Isometry3d::Identity();  // the spindle frame in the flange frame
  Eigen::VectorXd home_;
  std::array<robot::Link, 6> links_ = {};  // without the spindle, in the frames after the joints
  robot::Link spindle_ = {};               // in the spindle frame
  double shaft_kg_ = 0.0, tool_kg_ = 0.0, tool_turn_rad_ = 0.0;
  Eigen::VectorXd spring_, dashpot_;                   // one a coordinate; of the joints k0
  std::array<double, 6> load_gain_ = {}, slack_ = {};  // a and b
  std::array<double, 6> load_reference_n_m_ = {};      // τ_ref
  std::vector<Eigen::VectorXd> measured_, held_out_;
};

}  // namespace robomill::modal::testing
