#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>

#include "robomill/jobs/files/cell_toml.hpp"
#include "robomill/jobs/forces.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/robot/arm.hpp"

namespace robomill::jobs {

/// What hangs on the flange beside the last link, in that link's frame: a compact body.
[[nodiscard]] std::optional<robot::Link> payload_of(const CellFile& cell);

/// Whether the arm's own modes can be computed: masses of links and damping of every joint are there.
[[nodiscard]] bool vibrates(const robot::Arm& arm);

/// Along which of the base's axes the cuts of a program push by more than a little: an upright flat end that does not
/// plunge hardly does along its own.
[[nodiscard]] std::array<bool, 3> pushed_axes(const ForcesResult& forces);

/// Modes of the arm at the tool's tip, in B.
[[nodiscard]] modal::ModalModel arm_modes(const robot::Cell& cell, const Eigen::VectorXd& joints);

}  // namespace robomill::jobs
