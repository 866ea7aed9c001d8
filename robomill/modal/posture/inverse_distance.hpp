#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/modal/modes.hpp"
#include "robomill/robot/arm.hpp"

namespace robomill::modal {

/// The modes of the tool's tip in one posture, in the robot's base axes.
struct PostureModes {
  Eigen::VectorXd joints;  ///< length n [rad or m]
  ModalModel modes;        ///< responses x, y and z of point 0; excitations those or the first of them
};

/// Axes in which residue matrices of different postures are compared and averaged: those of modes that stand still in
/// space, or those of modes that turn with the tool.
enum class ResidueAxes { base, flange };

/// Modes of a posture as the mean of those of measured postures, weighted by 1 / d², d the distance of the joints:
///     ln f = Σ w_p ln f_p,  ln ζ = Σ w_p ln ζ_p,  R Lᵀ = nearest of rank one to Σ w_p R_p L_pᵀ,  w_p ∝ 1 / d_p².
/// Modes of different postures are paired by frequency and by the MAC of their residues; one that less than half of the
/// weight knows is left out. Residuals are averaged as they are. An excitation that was not measured is taken from the
/// responses by reciprocity, L ∝ R. At a measured posture its own modes are given.
/// The deviations are those of the postures' values about the mean, weighted, and the modes' own where they know them.
/// @param arm     for flange axes; a spindle that is turned against the flange changes nothing
/// @param joints  length n
/// @throws InvalidInput naming "measured[k].member" (k from 1): none at all, a posture of another length or not finite,
///     a model that is not valid or not of the tip; "joints"
[[nodiscard]] ModalModel inverse_distance(const std::vector<PostureModes>& measured, const robot::Arm& arm,
                                          const Eigen::VectorXd& joints, ResidueAxes axes);

}  // namespace robomill::modal
