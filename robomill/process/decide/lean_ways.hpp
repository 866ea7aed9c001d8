#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "robomill/process/decide.hpp"
#include "robomill/process/decide/leans.hpp"
#include "robomill/process/decide/units.hpp"
#include "robomill/robot/collision.hpp"

namespace robomill::process {

/// The program with its tool leant, run through the material.
struct LeanWay {
  Lean lean = {};
  ForcesResult forces = {};
  std::vector<std::string> fails = {};  ///< of each stretch why it cannot be leant so; empty: it can
};

/// Every lean within the cone that some stretch can have: the robot can stand so, nothing is too near where it cuts,
/// and nothing but the ball cuts, so that the surface stays.
/// @param frames   of the stretches
/// @param notes    what was left out is added
/// @throws InvalidInput unless the cutter is a ball end; Interrupted
[[nodiscard]] std::vector<LeanWay> lean_ways(const DecideProblem& problem, const ProgramUnits& units,
                                             const std::vector<Eigen::Matrix3d>& frames,
                                             const robot::CollisionChecker& checker, std::vector<std::string>& notes,
                                             Progress& progress);

}  // namespace robomill::process
