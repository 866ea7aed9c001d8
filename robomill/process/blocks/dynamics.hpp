#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>

#include "robomill/cell/cell.hpp"
#include "robomill/modal/modes.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/robot/arm.hpp"

namespace robomill::process {

/// Along which of the base's axes the cuts of a program push by more than a little: an upright flat end that does not
/// plunge hardly does along its own.
[[nodiscard]] std::array<bool, 3> pushed_axes(const ForcesResult& forces);

}  // namespace robomill::process
