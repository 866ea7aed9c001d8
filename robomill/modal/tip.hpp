#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/base/export.hpp"
#include "robomill/modal/mode_id.hpp"
#include "robomill/modal/modes.hpp"

// Method: robomill/modal/README.md, "Outputs"

namespace robomill::modal {

/// A modal model as the cut sees it: at the tool tip and in the feed's frame (x along the feed, y to its left, z kept),
///   q = 2 Re Σ_k right_k z_k + compliance F,  dz_k/dt = pole_k z_k + left_k^T F.
/// Scaled so that ‖2 right_k‖ = 1: every z_k is then a displacement in m, whatever scale the mode came with.
struct TipModes {
  Eigen::VectorXcd pole;       ///< length n [rad/s]
  Eigen::Matrix3Xcd right;     ///< 3 x n; a row that the model does not know is zero
  Eigen::Matrix3Xcd left;      ///< 3 x n [m/(N s)]
  Eigen::Matrix3d compliance;  ///< real part of the stiffness residuals [m/N]
  std::vector<ModeId> id;      ///< length n
};

/// @param keep_modes  numbers of the modes that take part, from 1; empty: all
/// @param feed_direction_rad  of the feed in the model's x-y plane, counter-clockwise from x
/// @param owner  of the model
/// @throws InvalidInput if the model knows neither x nor y at a tip, has several points that could be the tip, or a
/// number is wrong
[[nodiscard]] ROBOMILL_API TipModes tip_modes(const ModalModel& model, const std::vector<int>& keep_modes,
                                              double feed_direction_rad, ModeOwner owner = ModeOwner::tool);

/// The same structure in another frame: q' = T q, F' = T F.
/// @param turn  T, orthogonal
[[nodiscard]] ROBOMILL_API TipModes turned(const TipModes& modes, const Eigen::Matrix3d& turn);

/// x, y and z of the tip.
[[nodiscard]] ROBOMILL_API const std::vector<Dof>& tip_axes();

/// The same of a modal model at its tip, over tip_axes(): modes with their deviations, and residuals. A direction that
/// the model does not know stays rigid.
/// @throws InvalidInput if the model knows neither x nor y at a tip, or has several points that could be the tip
[[nodiscard]] ROBOMILL_API ModalModel turned(const ModalModel& model, const Eigen::Matrix3d& turn);

/// The modes of one structure and then of the other, tool and workpiece: what counts in a cut is the displacement of
/// one against the other, and the force that pushes one pushes the other back, so that receptances add.
[[nodiscard]] ROBOMILL_API TipModes joined(const TipModes& one, const TipModes& other);

}  // namespace robomill::modal
