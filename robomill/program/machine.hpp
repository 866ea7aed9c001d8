#pragma once
#include <Eigen/Core>

#include "robomill/base/export.hpp"

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

}  // namespace robomill::program
