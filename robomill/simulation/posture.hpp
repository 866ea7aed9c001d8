#pragma once
#include "robomill/cutting/force.hpp"
#include "robomill/simulation/simulation.hpp"

// Method: robomill/simulation/README.md, "The cut"

namespace robomill::simulation {

/// Milling with any cutter in any posture. The engagement says what of it cuts; it stays as it is whatever vibrates.
/// Force and displacement are in the feed's frame F.
struct ROBOMILL_API PostureCut {
  cutting::Cutter cutter;
  cutting::Engagement engagement;
  cutting::MillingCoefficients coefficients;
  cutting::CutMotion motion;  ///< both > 0; small vibration needs no feed where there is no runout
  /// Of the tool against the workpiece, x, y and z in F; no modes: rigid. A robot that is only a stiffness is a
  /// compliance without modes.
  modal::TipModes structure;
  /// @throws InvalidInput naming the member
  void validate() const;
};

/// As for a MillingCut; the rings of the engagement are the slices (options.slices is not used), and there is no wall.
/// @throws InvalidInput if the cut or an option is out of range
/// @throws Interrupted  when progress asks to stop
[[nodiscard]] ROBOMILL_API Simulation simulate(const PostureCut& cut, const SimulationOptions& options = {},
                                               Progress& progress = Progress::none());
[[nodiscard]] ROBOMILL_API SmallVibration small_vibration(const PostureCut& cut, const SimulationOptions& options = {},
                                                          Progress& progress = Progress::none());

}  // namespace robomill::simulation
