#pragma once
#include <Eigen/Core>

#include "robomill/base/export.hpp"

// Method: robomill/program/README.md, "Method"

namespace robomill::program {

/// Whose rotary axes the words A, B and C of a program turn. All programs here give positions of the tip (TCP) in the
/// part's frame W.
enum class Machine {
  xyzac_trt,   ///< the part on table C, that on table A; LinuxCNC's signs
  xyzbc_trt,   ///< the part on table C, that on table B; LinuxCNC's signs
  xyzac_head,  ///< the tool in head A, that on head C; right-handed
  xyzbc_head   ///< the tool in head B, that on head C; right-handed
};

/// Unit vector from the tip to the spindle, in W, of a machine whose axes stand at A, B and C [rad]. With s = sin,
/// c = cos:
///   xyzac_trt:  ( sC sA,  cC sA, cA)
///   xyzbc_trt:  (-cC sB,  sC sB, cB)
///   xyzac_head: Rz(C) Rx(A) e_z = ( sC sA, -cC sA, cA)
///   xyzbc_head: Rz(C) Ry(B) e_z = ( cC sB,  sC sB, cB)
/// The angle that the machine does not have is not looked at.
[[nodiscard]] ROBOMILL_API Eigen::Vector3d tool_axis(Machine machine, double a_rad, double b_rad, double c_rad);

/// A move of the rotary axes, each evenly in time: at the share s of the time, in [0, 1], the axis is tool_axis at
/// begin + s (end − begin).
struct ROBOMILL_API RotaryMove {
  Machine machine = Machine::xyzac_trt;
  Eigen::Vector3d begin_rad = Eigen::Vector3d::Zero();  ///< A, B, C; any number of turns
  Eigen::Vector3d end_rad = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d axis_at(double share) const;
  /// Number of parts of equal time, >= 1, whose great circles leave the move by no more than a tolerance:
  /// deviation_rad(parts) <= tolerance_rad. No part turns the axis by more than 0.5 rad.
  [[nodiscard]] double parts(double tolerance_rad) const;
  /// By how much the great circles through so many parts leave the move at the same time, at most. With the tilt t (A
  /// or B), c (C) and derivatives by s, the curve's acceleration along the sphere is
  ///     |D| = |c'| |cos t| √(sin² t c'² + 4 t'²) <= M,
  /// and great circles of n parts below 0.5 rad each leave it by at most M / (7.5 n²); on a plane it would be 8.
  [[nodiscard]] double deviation_rad(double parts) const;

 private:
  struct Bounds {
    double speed = 0.0, acceleration = 0.0;  ///< of the axis by s, at most
  };
  [[nodiscard]] Bounds bounds() const;
};

}  // namespace robomill::program
