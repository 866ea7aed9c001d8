#pragma once
#include <Eigen/Core>
#include <vector>

#include "robomill/process/decide/units.hpp"
#include "robomill/process/decide_options.hpp"
#include "robomill/process/forces.hpp"
#include "robomill/program/program.hpp"

namespace robomill::process {

/// A turn of the tool about the centre of its ball, from where the program has it: the ball, and so the surface that it
/// leaves, stays where it is.
struct Lean {
  double lead_rad = 0.0;  ///< towards the main feed
  double tilt_rad = 0.0;  ///< about it
  friend bool operator==(const Lean&, const Lean&) = default;
};

/// All within the cone but the program's own, by their angle.
[[nodiscard]] std::vector<Lean> leans_within(const DecideOptions& options);

/// Of each stretch x along its main feed, z along its mean axis, in W (columns). To and fro are one direction, and the
/// frame of a stretch turns as little as it can from that of the one before.
[[nodiscard]] std::vector<Eigen::Matrix3d> stretch_frames(const ForcesResult& forces, const ProgramUnits& units);

/// The program with the tool leant in each stretch, by the turn tilt x + lead y of its frame, the same at all its
/// blocks; durations stay. A lean holds from ProgramUnits::lean_from on.
/// @param leans  one a stretch
[[nodiscard]] program::Program leant(const ForcesResult& forces, const ProgramUnits& units,
                                     const std::vector<Eigen::Matrix3d>& frames, const std::vector<Lean>& leans);

}  // namespace robomill::process
