#pragma once
#include <Eigen/Core>
#include <optional>

#include "robomill/cell/cell.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/robot/arm.hpp"
#include "robomill/robot/dynamics.hpp"

namespace robomill::cell {

/// What hangs on the flange beside the last link, in that link's frame: a compact body.
[[nodiscard]] std::optional<robot::Link> payload_of(const Cell& cell);

/// The arm with what hangs on its flange, as far as the cell knows it.
[[nodiscard]] robot::Arm loaded_arm(const Cell& cell);

/// Whether the arm's own modes can be computed: masses of links and damping of every joint are there.
[[nodiscard]] bool vibrates(const robot::Arm& arm);

/// Modes of the arm at the tool's tip, in B.
[[nodiscard]] modal::ModalModel arm_modes(const robot::Cell& cell, const Eigen::VectorXd& joints,
                                          robot::Inertia inertia = robot::Inertia::full);

}  // namespace robomill::cell
