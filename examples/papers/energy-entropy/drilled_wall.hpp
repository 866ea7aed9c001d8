#pragma once
// The wall of a simulated hole, as the source's photographs show it.
#include <Eigen/Core>

#include "examples/calibrate-holes/holes.hpp"

namespace robomill::examples {

/// How far the lips' outer corners cut beyond the drill's radius, unrolled: angles × turns [m]. A column is a turn at
/// the lips' full width; of the corners that pass in it the farthest counts; NaN where none does. Neither the drill's
/// margin nor the wall holds the drill, and its vibration along the axis is left out.
/// @param path_m  of the drill's axis across, a row a sample of the record, columns x and y; others are left out
[[nodiscard]] Eigen::MatrixXd drilled_wall(const Hole& hole, const Eigen::Ref<const Eigen::MatrixXd>& path_m,
                                           Eigen::Index angles);

}  // namespace robomill::examples
