#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/coupling/assembly.hpp"

namespace robomill::coupling::detail {

/// What an artefact does at points along it, its end 2 held: x_i = Σ_j receptance_ij f_j + carry_i x_end, in one plane,
/// u and θ of each point in turn.
struct ArtefactPoints {
  Eigen::MatrixXcd receptance;  ///< 2P x 2P
  Eigen::MatrixXcd carry;       ///< 2P x 2
  Eigen::Matrix2cd stiffness;   ///< dynamic stiffness of end 2, all points free
};

/// One a frequency.
/// @param position_m  of the points from the free end, increasing, within the artefact
[[nodiscard]] std::vector<ArtefactPoints> artefact_points(const std::vector<Segment>& artefact,
                                                          const std::vector<double>& position_m,
                                                          const Eigen::VectorXd& frequency_hz);

}  // namespace robomill::coupling::detail
