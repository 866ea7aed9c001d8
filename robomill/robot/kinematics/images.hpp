#pragma once
#include <Eigen/Core>

#include "robomill/robot/arm.hpp"
#include "robomill/robot/inverse.hpp"

namespace robomill::robot {

/// An angle's image by whole turns that is nearest to `previous` within the joint's limits, and how far beyond them the
/// best image is where none is within.
struct Image {
  double position = 0.0, beyond = 0.0;
};
Image nearest_image(const Joint& joint, double angle, double previous) noexcept;

/// A position of six joints moved by whole turns to where it is nearest to another within the arm's limits.
struct Placed {
  Position6 position_rad = Position6::Zero();
  Eigen::Index joint = -1;  ///< the one that no turn brings within its limits, worst of them
  double beyond_rad = 0.0;  ///< … and how far beyond it stays
  double cost = 0.0;        ///< Σ (weight travel)²
};
Placed place(const Arm& arm, const Position6& solution, const Position6& previous, const Position6& weight) noexcept;

/// The solution to take of several: the least beyond the limits, of those the nearest.
struct Picked {
  Placed placed = {};
  int solution = -1;  ///< -1: none
};
Picked pick(const Arm& arm, const InverseSolutions& solutions, const Position6& previous,
            const Position6& weight) noexcept;

}  // namespace robomill::robot
