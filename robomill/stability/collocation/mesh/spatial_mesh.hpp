#pragma once
#include <Eigen/Core>

#include "robomill/stability/collocation/collocation_case.hpp"
#include "robomill/stability/collocation/mesh/edge_contacts.hpp"

namespace robomill::stability::detail {

/// The period of a cut in three directions in pieces, and the force's answer at their nodes.
///
/// K(θ) of all edges in the cut is never needed at an angle: the force of a piece is the polynomial that has the same
/// moments as the true one, f_i = Σ_l M_il (q_l - q_l(before)) with M_il = ∫ ℓ_i ℓ_l K dθ / ∫ ℓ_i² dθ, ℓ the Lagrange
/// polynomials of the piece's Gauss points. Where edges enter and leave within a piece the moments stay exact, so that
/// only jumps of K have borders of their own (docs/theory/three-directions.md).
///
/// @param fastest_per_rad  radians of the fastest mode in one of rotation
/// @param axes_from_tool   R: the structure's axes are those of q' = R q, q in T
/// @param out              mesh, and of its pieces `stiffness` and `delayed`
void build_spatial_mesh(const EdgeContacts& contacts, double fastest_per_rad, const Eigen::Matrix3d& axes_from_tool,
                        const MeshLevel& level, CollocationCase& out);

}  // namespace robomill::stability::detail
