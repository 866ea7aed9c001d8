#pragma once
#include <Eigen/Core>
#include <array>

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

/// Which of A, B and C tilts the tool: 0, A, or 1, B. C turns it.
[[nodiscard]] ROBOMILL_API Eigen::Index tilt_index(Machine machine);

/// Where the rotary axes stand (A, B, C [rad]) for a tool axis: the inverse of tool_axis. With the angle t in [0, π]
/// from e_z to the axis, and the turn c in (-π, π] of C that puts a tool tilted by t there,
///     first: tilt t, C = c        second: tilt -t, C = c + π
/// both give it, within 1e-12 (1e-15 off the poles). At a pole, within 1e-13 rad of ±e_z, C is free.
/// @param axis        unit vector from the tip to the spindle, in W
/// @param free_c_rad  C where it is free
/// The angle that the machine does not have is 0.
[[nodiscard]] ROBOMILL_API std::array<Eigen::Vector3d, 2> rotary_of_axis(Machine machine, const Eigen::Vector3d& axis,
                                                                         double free_c_rad);

/// Of both solutions of rotary_of_axis with any whole turns of either angle, the one nearest to where the rotary axes
/// stand: least √(Δtilt² + ΔC²), so that C neither unwinds nor swings round where the tool passes the pole. Where C is
/// free it stays. Of two that are equally near within 1e-9, the first.
/// @param from_rad  A, B, C as they stand; the angle that the machine does not have stays
[[nodiscard]] ROBOMILL_API Eigen::Vector3d nearest_rotary(Machine machine, const Eigen::Vector3d& axis,
                                                          const Eigen::Vector3d& from_rad);

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
