#pragma once
#include <Eigen/Core>

#include "robomill/modal/modes.hpp"
#include "robomill/robot/arm.hpp"

namespace robomill::jobs {

/// Whether the arm's own modes can be computed: masses of links and damping of every joint are there.
[[nodiscard]] bool vibrates(const robot::Arm& arm);

/// Modes of the arm at the tool's tip, in B.
[[nodiscard]] modal::ModalModel arm_modes(const robot::Cell& cell, const Eigen::VectorXd& joints);

/// The same structure in other axes, q' = T q, with x, y and z; a direction that the model does not know stays rigid.
/// @throws InvalidInput as modal::tip_modes
[[nodiscard]] modal::ModalModel in_axes(const modal::ModalModel& model, const Eigen::Matrix3d& turn);

}  // namespace robomill::jobs
